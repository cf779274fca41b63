//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::divided::divided;
use super::ends::{Ends, RIVAL, at_most, cost, firsts, least, on, others, rivals};
use super::fine::finely;
use super::screen::{Screen, Start, alone};
use super::shown::shown;
use super::slower::{self, COARSE_HZ, MIDDLE_HZ, beginnings, enough, slowed};
use super::strides::{FEW, strides};
use super::thinned::Thinned;
use super::unseen::softer;
use super::watch::Watch;
use crate::effects::Id;
use crate::fit::{Found, glance, sketch, sketch_within, used};
use crate::model::Model;
use crate::order::descending;
use crate::rule::rule;
use crate::signals::Signals;

/// Starts that are looked at by a few steps through the coarse filter, and those of them that are followed.
const LOOKED: usize = 8;
const FOLLOWED: usize = 3;
/// Samples of captures that the coarse search looks at, and those that it first glances at.
const ENOUGH: usize = 30_000;
const GLANCED: usize = 12_000;
/// Sums of squares of what needs fewer parameters, in times of the other's, that are hardly more.
const HARDLY: f64 = 1.005;

/// Where the starts of a coupling lead to.
pub struct Ways {
    /// Which.
    pub id: Id,
    /// Its starts, most promising first.
    pub starts: Vec<Start>,
    /// The best end, if one was worth the fine search.
    pub end: Option<(Model, Found)>,
}

/// Captures through a slower filter, and what is left of the sum of squares there.
struct View<'a> {
    data: &'a [&'a Signals],
    watch: &'a Watch<'a>,
    /// By the model without a joint, and by noise.
    without: f64,
    floor: f64,
    /// What is no rival any more of what looks like a joint.
    close: f64,
}

impl<'a> View<'a> {
    /// These captures, `slowed` by a filter with this edge.
    fn of(
        whole: &Screen<'a>,
        data: &[&Signals],
        edge: f64,
        slowed: &'a [&'a Signals],
        rival: Option<&Model>,
    ) -> Self {
        Self {
            data: slowed,
            watch: whole.watch,
            without: squares(slowed, whole.model),
            floor: slower::floor(data, edge, slowed, whole.model),
            close: RIVAL * left(slowed, rival),
        }
    }

    /// Where descents lead, as long as they may lead to a rival.
    fn down(&self, from: &Ends) -> Ends {
        let rmse = (self.close / used(self.data)).sqrt();
        self.watch.each(from, |(of, (model, _))| (*of, on(model, |m| sketch_within(self.data, m, rmse))))
    }

    /// Where strides lead from there, best first.
    fn strode(&self, ends: &Ends) -> Ends {
        let strode =
            |end: &(Model, Found)| strode(self.data, end.clone(), self.floor, self.without, self.watch);
        let mut ends = self.watch.each(ends, |(of, end)| (*of, strode(end)));
        ends.sort_by_cached_key(cost);
        ends
    }

    /// What needs no better end.
    fn enough(&self) -> f64 {
        enough(self.data, self.floor)
    }

    /// Whether these are so far from what noise leaves that much else is missing: an end moves with that, and a few steps
    /// tell what it is worth.
    fn hopeless(&self, ends: &Ends) -> bool {
        least(ends) > rule().hopeless.powi(2) * self.floor
    }
}

/// What a rival leaves, if there is one.
fn left(data: &[&Signals], rival: Option<&Model>) -> f64 {
    rival.map_or(f64::INFINITY, |model| squares(data, model))
}

/// Couplings beside a screen's model, fitted from coarse to fine. What explains much less of it through the coarse
/// filter than another does is not followed further, nor what explains less than a `rival` that looks like one. If they
/// `may_come`, detents come with them that show through them.
pub fn coupled(whole: &Screen<'_>, couplings: &[Id], may_come: bool, rival: Option<&Model>) -> Vec<Ways> {
    let (data, base) = (whole.data, whole.model);
    let first = beginnings(data, ENOUGH);
    let first: Vec<&Signals> = first.iter().collect();
    let [coarse, middle] = [slowed(&first, COARSE_HZ), slowed(data, MIDDLE_HZ)];
    let [coarse, middle]: [Vec<&Signals>; 2] = [&coarse, &middle].map(|view| view.iter().collect());
    let coarse = View::of(whole, &first, COARSE_HZ, &coarse, rival);
    let middle = View::of(whole, data, MIDDLE_HZ, &middle, rival);
    // What is in the model beside the base may load the shaft as well as the knob.
    let beside: Vec<Id> = base.effects().filter(|id| Model::may_be_at_shaft(*id)).collect();
    let (mut ways, seen) = looked(whole, couplings, &beside, rival);
    // Detents may be too fast for the coarse filter.
    let mut starts = if may_come { detented(&middle, base, couplings, &beside) } else { Vec::new() };
    let (ends, mut worse) = coarsely(&coarse, &seen, ways.len());
    starts.extend(softer(data, &ends, [COARSE_HZ, MIDDLE_HZ]));
    let apart = |(of, id): (usize, &Id)| divided(whole, *id).into_iter().map(move |model| (of, model));
    starts.extend(couplings.iter().enumerate().flat_map(apart));
    starts.extend(ends.into_iter().map(|(of, (model, _))| (of, model)));
    let (ends, more, roughly) = between(&middle, &starts);
    worse.extend(more);
    led(&mut ways, finely(data, &ends, worse, roughly, whole.watch));
    ways
}

/// The starts of each coupling, and where a few steps through the coarse filter lead from the most promising.
fn looked(whole: &Screen<'_>, couplings: &[Id], beside: &[Id], rival: Option<&Model>) -> (Vec<Ways>, Ends) {
    let (base, watch) = (whole.model, whole.watch);
    let few = slowed(&beginnings(whole.data, GLANCED).iter().collect::<Vec<_>>(), COARSE_HZ);
    let few: Vec<&Signals> = few.iter().collect();
    let screen = Screen::new(&few, base, watch);
    let shaft = (!beside.is_empty()).then(|| Screen::new(&few, base, watch).with_shaft(beside.to_vec()));
    let mut ways = Vec::new();
    let mut looked: Vec<(usize, Model)> = Vec::new();
    for id in couplings {
        let starts = screen.starts(*id);
        let before = shaft.iter().flat_map(|screen| screen.starts(*id).into_iter().take(LOOKED));
        looked
            .extend(before.chain(starts.iter().take(LOOKED).cloned()).map(|start| (ways.len(), start.model)));
        ways.push(Ways { id: *id, starts, end: None });
    }
    alone(&mut looked);
    let mut seen = watch.each(&looked, |(of, model)| (*of, on(model, |m| glance(&few, m))));
    seen.sort_by_cached_key(cost);
    // Of what a rival leaves an end leaves about as much at most; a few steps lead but a part of the way.
    let halfway = rival.map_or(f64::INFINITY, |_| 0.5 * (left(&few, rival) + screen.squares));
    (ways, rivals(halfway, seen).0)
}

/// Starts of couplings with detents that show through them.
fn detented(view: &View<'_>, base: &Model, couplings: &[Id], beside: &[Id]) -> Vec<(usize, Model)> {
    let screen = Screen::new(view.data, base, view.watch);
    let of = |(of, id): (usize, &Id)| {
        let through = shown(&screen, *id, &screen.starts(*id), beside, view.floor);
        through.into_iter().map(move |start| (of, start.model)).collect::<Vec<_>>()
    };
    couplings.iter().enumerate().flat_map(of).collect()
}

/// Where so many ways lead through the coarse filter from what was `seen`, best first: rivals, and what ends worse.
fn coarsely(view: &View<'_>, seen: &Ends, ways: usize) -> (Ends, Ends) {
    let own = |of: usize| seen.iter().filter(move |(own, _)| *own == of).take(FOLLOWED).cloned();
    let mut ends = view.down(&(0..ways).filter_map(|of| own(of).next()).collect());
    // Where one leads to what noise leaves no other is needed.
    let enough = view.enough();
    let found = |(of, (model, _)): &(usize, (Model, Found))| {
        ends.iter()
            .any(|(own, (end, found))| own == of && end.shafts() == model.shafts() && found.cost <= enough)
    };
    let rest = (0..ways).flat_map(|of| own(of).skip(1)).filter(|one| !found(one)).collect();
    ends.extend(view.down(&rest));
    let (mut ends, _) = rivals(view.close, ends);
    ends.sort_by_cached_key(cost);
    others(&mut ends, f64::INFINITY);
    let ends = view.strode(&ends);
    // Without a floor nothing can be said to be too little.
    let worth = if view.floor.is_nan() { 0.0 } else { rule().worth_coarse * (view.without - view.floor) };
    let most = at_most(&ends, view.without, view.floor).min(view.without - worth);
    let (mut ends, worse) = open(rivals(most, ends).0);
    others(&mut ends, f64::INFINITY);
    (ends, worse)
}

/// Where starts lead through the filter in between, best first: rivals, and what ends worse. And whether they lead so far
/// from what noise leaves that more than a few steps would be wasted.
fn between(view: &View<'_>, starts: &[(usize, Model)]) -> (Ends, Ends, bool) {
    let mut seen = view.watch.each(starts, |(of, model)| (*of, on(model, |m| glance(view.data, m))));
    seen.sort_by_cached_key(cost);
    let (best, more) = firsts(seen);
    let mut ends = view.down(&best);
    // Where noise alone is left no other is needed either.
    let told = view.hopeless(&ends) || least(&ends) <= view.enough();
    ends.extend(if told { more } else { view.down(&more) });
    let (mut ends, _) = rivals(view.close, ends);
    ends.sort_by_cached_key(cost);
    others(&mut ends, RIVAL);
    let (ends, mut worse) = rivals(at_most(&ends, view.without, view.floor), ends);
    let (ends, shut) = open(ends);
    worse.extend(shut);
    let roughly = view.hopeless(&ends);
    let mut ends = if roughly { firsts(ends).0 } else { view.strode(&ends) };
    others(&mut ends, RIVAL);
    (ends, worse, roughly)
}

/// The ends whose joint is not another's, and those of which another with fewer parameters leaves hardly more: a gap that
/// closed is compliance. They go on from the other's end.
fn open(ends: Ends) -> (Ends, Ends) {
    let is_other = |(of, (model, found)): &(usize, (Model, Found)), own: &(usize, (Model, Found))| {
        *of != own.0
            && found.cost <= HARDLY * own.1.1.cost
            && model.free().count() < own.1.0.free().count()
            && model.shafts() == own.1.0.shafts()
    };
    let shut: Vec<bool> = ends.iter().map(|own| ends.iter().any(|other| is_other(other, own))).collect();
    let mut shut = shut.into_iter();
    ends.into_iter().partition(|_| !shut.next().unwrap_or(false))
}

/// The sum of squares that a model leaves, (N m)^2.
pub(super) fn squares(data: &[&Signals], model: &Model) -> f64 {
    Thinned::of(data).columns(data, model, &[]).2
}

/// Gives each of the ways the best of the ends that are its own, by its place among them.
pub(super) fn led(ways: &mut [Ways], mut ends: Vec<(usize, (Model, Found))>) {
    // The best last, so that it stays.
    ends.sort_by_cached_key(|(_, (_, found))| descending(found.cost));
    for (of, end) in ends {
        ways[of].end = Some(end);
    }
}

/// Where strides lead to from where a descent ended. Surfaces that meet and part a little earlier or later are dents in
/// the error even through a slow filter, and a descent by derivatives ends in any of them. None leads there from far above
/// what the model leaves `without` the joint.
pub(super) fn strode(
    data: &[&Signals],
    (model, found): (Model, Found),
    floor: f64,
    without: f64,
    watch: &Watch<'_>,
) -> (Model, Found) {
    if found.cost <= enough(data, floor) || found.cost > RIVAL * without {
        return (model, found);
    }
    on(&strides(data, &model, floor, FEW, watch), |model| sketch(data, model))
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::floor::Floor;

    #[test]
    fn where_nothing_is_left_but_noise_nobody_strides_on() {
        let gap = [("backlash.gap", 8e-3), ("backlash.k", 90.0), ("backlash.d", 0.06)];
        let signals = recorded(&knob(&[Id::Backlash], &gap), "a");
        let data = [&signals];
        let off = [("backlash.gap", 6e-3), ("backlash.k", 40.0), ("backlash.d", 0.03)];
        let start = knob(&[Id::Backlash], &off);
        let (watch, floor) = (Watch::new(&|_| true, 1), Floor::of(&data, &start).squares);
        let (model, found) = on(&start, |model| sketch(&data, model));
        let (went, cost) = (model.values(), found.cost);
        let (model, found) = strode(&data, (model, found), floor, f64::INFINITY, &watch);
        assert_eq!((model.values(), found.cost), (went, cost));
    }

    #[test]
    fn a_gap_that_explains_hardly_more_than_compliance_goes_on_from_there_and_one_that_does_goes_on_by_itself()
     {
        let end = |(of, id, cost): (usize, Id, f64)| {
            let model = knob(&[id], &[]);
            (of, (model.clone(), Found { cost, ..glance(&[], &model) }))
        };
        for (gap, shut) in [(1.001, true), (0.999, true), (0.99, false)] {
            let ends = [(0, Id::Backlash, gap), (1, Id::Compliance, 1.0)].into_iter().map(end).collect();
            let [went, closed] = <[Ends; 2]>::from(open(ends)).map(|ends| ends.len());
            assert_eq!((went, closed), if shut { (1, 1) } else { (2, 0) }, "{gap}");
        }
    }

    #[test]
    fn each_way_is_given_the_best_of_its_own_ends_and_none_where_it_has_none() {
        let model = knob(&[Id::Compliance], &[]);
        let end = |(of, cost): (usize, f64)| (of, (model.clone(), Found { cost, ..glance(&[], &model) }));
        let mut ways: Vec<Ways> =
            (0..3).map(|_| Ways { id: Id::Compliance, starts: Vec::new(), end: None }).collect();
        led(&mut ways, [(0, 3.0), (2, 2.0), (0, 1.0), (2, 5.0), (0, 4.0)].into_iter().map(end).collect());
        let costs: Vec<Option<f64>> =
            ways.iter().map(|way| way.end.as_ref().map(|(_, found)| found.cost)).collect();
        assert_eq!(costs, [Some(1.0), None, Some(2.0)]);
    }
}
