//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::ends::{Ends, SAME, at_most, cost, firsts, least, on, others, rivals};
use super::screen::{Screen, Start, alone};
use super::shown::{detents, shown};
use super::slower::{self, BEFORE, COARSE_HZ, MIDDLE_HZ, beginnings, enough, slowed};
use super::strides::{FEW, strides};
use super::thinned::Thinned;
use super::unseen::seen_next;
use super::watch::Watch;
use crate::effects::{Id, Place};
use crate::fit::{Found, glance, loads, sketch, sketch_within, used};
use crate::model::{Model, Slot};
use crate::order::descending;
use crate::rule::rule;
use crate::signals::Signals;

/// Starts that are looked at by a few steps through the coarse filter, and those of them that are followed.
const LOOKED: usize = 8;
const FOLLOWED: usize = 3;
/// Samples of captures that the coarse search looks at, and those that it first glances at.
const ENOUGH: usize = 30_000;
const GLANCED: usize = 12_000;
/// Sums of squares through the filter in between of what is followed to its end, in times of the best.
pub(super) const RIVAL: f64 = 1.15;
/// Ends that are followed to their end; the others only as long as they may leave less than these.
const FINE: usize = 2;
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

/// Couplings beside a screen's model, fitted from coarse to fine. What explains much less of it through the coarse
/// filter than another does is not followed further, nor what explains less than a `rival` that looks like one. If they
/// `may_come`, detents come with them that show through them.
pub fn coupled(whole: &Screen<'_>, couplings: &[Id], may_come: bool, rival: Option<&Model>) -> Vec<Ways> {
    let (data, base, watch) = (whole.data, whole.model, whole.watch);
    let first = beginnings(data, ENOUGH);
    let first: Vec<&Signals> = first.iter().collect();
    let coarse = slowed(&first, COARSE_HZ);
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let without = squares(&coarse, base);
    let few = slowed(&beginnings(data, GLANCED).iter().collect::<Vec<_>>(), COARSE_HZ);
    let few: Vec<&Signals> = few.iter().collect();
    let screen = Screen::new(&few, base, watch);
    // What is in the model beside the base may load the shaft as well as the knob.
    let beside: Vec<Id> = base.effects().filter(|id| Model::may_be_at_shaft(*id)).collect();
    let shaft = (!beside.is_empty()).then(|| Screen::new(&few, base, watch).with_shaft(beside.clone()));
    let floor = slower::floor(&first, COARSE_HZ, &coarse, base);
    let middle = slowed(data, MIDDLE_HZ);
    let middle: Vec<_> = middle.iter().collect();
    let view = Screen::new(&middle, base, watch);
    let middle_floor = slower::floor(data, MIDDLE_HZ, &middle, base);
    let mut ways = Vec::new();
    let mut looked: Vec<(usize, Model)> = Vec::new();
    let mut detented = looked.clone();
    for id in couplings {
        let starts = screen.starts(*id);
        let before = shaft.iter().flat_map(|screen| screen.starts(*id).into_iter().take(LOOKED));
        looked
            .extend(before.chain(starts.iter().take(LOOKED).cloned()).map(|start| (ways.len(), start.model)));
        if may_come {
            // Detents may be too fast for the coarse filter.
            let through = shown(&view, *id, &view.starts(*id), &beside, middle_floor);
            detented.extend(through.into_iter().map(|start| (ways.len(), start.model)));
        }
        ways.push(Ways { id: *id, starts, end: None });
    }
    alone(&mut looked);
    let mut seen = watch.each(&looked, |(of, model)| (*of, on(model, |m| glance(&few, m))));
    seen.sort_by_cached_key(cost);
    // What a rival leaves, of which an end leaves about as much at most; a few steps lead but a part of the way.
    let beaten = |view: &[&Signals]| rival.map_or(f64::INFINITY, |model| squares(view, model));
    let halfway = rival.map_or(f64::INFINITY, |_| 0.5 * (beaten(&few) + screen.squares));
    let (seen, _) = rivals(halfway, seen);
    let close = RIVAL * beaten(&coarse);
    let rmse = (close / used(&coarse)).sqrt();
    let own = |of: usize| seen.iter().filter(move |(own, _)| *own == of).take(FOLLOWED);
    let coarsely = |few: Vec<&(usize, (Model, Found))>| {
        watch.each(&few, |(of, (model, _))| (*of, on(model, |m| sketch_within(&coarse, m, rmse))))
    };
    let mut ends = coarsely((0..ways.len()).filter_map(|of| own(of).next()).collect());
    // Where one leads to what noise leaves no other is needed.
    let enough = enough(&coarse, floor);
    let found = |(of, (model, _)): &(usize, (Model, Found))| {
        ends.iter()
            .any(|(own, (end, found))| own == of && end.shafts() == model.shafts() && found.cost <= enough)
    };
    let rest = (0..ways.len()).flat_map(|of| own(of).skip(1)).filter(|one| !found(one)).collect();
    ends.extend(coarsely(rest));
    let (mut ends, _) = rivals(close, ends);
    ends.sort_by_cached_key(cost);
    others(&mut ends, f64::INFINITY);
    let strode = |(view, without): (&[&Signals], f64), ends: &Ends, floor: f64| {
        watch.each(ends, |(of, end)| (*of, strode(view, end.clone(), floor, without, watch)))
    };
    // Without a floor nothing can be said to be too little.
    let worth = if floor.is_nan() { 0.0 } else { rule().worth_coarse * (without - floor) };
    let mut ends = strode((&coarse, without), &ends, floor);
    ends.sort_by_cached_key(cost);
    let most = at_most(&ends, without, floor).min(without - worth);
    let (ends, _) = rivals(most, ends);
    let (mut ends, mut worse) = open(ends);
    others(&mut ends, f64::INFINITY);
    detented.extend(softer(data, &ends, [COARSE_HZ, MIDDLE_HZ]));
    detented.extend(ends.into_iter().map(|(of, (model, _))| (of, model)));
    let close = RIVAL * beaten(&middle);
    let rmse = (close / used(&middle)).sqrt();
    let mut between = watch.each(&detented, |(of, model)| (*of, on(model, |m| glance(&middle, m))));
    between.sort_by_cached_key(cost);
    let (best, more) = firsts(between);
    let followed = |ends: &Ends| {
        watch.each(ends, |(of, (model, _))| (*of, on(model, |m| sketch_within(&middle, m, rmse))))
    };
    let mut between = followed(&best);
    // Where noise alone is left no other is needed; where much else is missing a joint's end moves with that, and a few
    // steps tell what it is worth.
    let hopeless = |ends: &Ends| least(ends) > rule().hopeless.powi(2) * middle_floor;
    let told = hopeless(&between) || least(&between) <= slower::enough(&middle, middle_floor);
    between.extend(if told { more } else { followed(&more) });
    let (mut between, _) = rivals(close, between);
    between.sort_by_cached_key(cost);
    others(&mut between, RIVAL);
    let (between, more) = rivals(at_most(&between, view.squares, middle_floor), between);
    worse.extend(more);
    let (between, shut) = open(between);
    worse.extend(shut);
    let roughly = hopeless(&between);
    let mut between =
        if roughly { firsts(between).0 } else { strode((view.data, view.squares), &between, middle_floor) };
    between.sort_by_cached_key(cost);
    others(&mut between, RIVAL);
    led(&mut ways, finely(data, &between, worse, roughly, watch));
    ways
}

/// The same ends with a shaft that gives way where a slower filter does not see it and the next does.
fn softer(data: &[&Signals], ends: &Ends, edges: [f64; 2]) -> Vec<(usize, Model)> {
    let seen = |(of, (model, _)): &(usize, (Model, Found))| Some((*of, seen_next(data, model, edges)?));
    ends.iter().filter_map(seen).collect()
}

/// Where ends, best first, lead with all that was measured: `roughly` a few steps each. The `worse` ones are told by
/// where the best leads them.
fn finely(data: &[&Signals], ends: &Ends, worse: Ends, roughly: bool, watch: &Watch<'_>) -> Ends {
    let (first, rest) = ends.split_at(ends.len().min(FINE));
    let mut first: Vec<(usize, Model)> = first.iter().map(|(of, (model, _))| (*of, model.clone())).collect();
    if !roughly {
        first.extend(softer(data, ends, [MIDDLE_HZ, BEFORE * MIDDLE_HZ]));
    }
    let to = |model: &Model, within: f64| {
        if roughly { glance(data, model) } else { sketch_within(data, model, within) }
    };
    let mut fine = watch.each(&first, |(of, model)| (*of, on(model, |m| to(m, f64::INFINITY))));
    let within = (RIVAL * least(&fine) / used(data)).sqrt();
    fine.extend(watch.each(rest, |(of, (model, _))| (*of, on(model, |m| to(m, within)))));
    let beaten = |found: Found| Found { cost: f64::INFINITY, ..found };
    fine.extend(worse.into_iter().map(|(of, (model, found))| (of, (model, beaten(found)))));
    let within = (RIVAL * least(&fine) / used(data)).sqrt();
    let lowest = least(&fine);
    fine.extend(crossed(&fine, watch, |model| to(model, within)));
    if least(&fine) < lowest {
        // What went on from the best end is better: that one goes on from there.
        fine.extend(crossed(&fine, watch, |model| to(model, within)));
    }
    fine.retain(|(_, (_, found))| found.cost.is_finite());
    fine
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

/// Where each coupling but the best leads to from the best one's end: a gap that closes is compliance, and a soft shaft with
/// play is what both have nearly the same error for.
fn crossed(
    ends: &[(usize, (Model, Found))],
    watch: &Watch<'_>,
    to: impl Fn(&Model) -> Found + Sync,
) -> Vec<(usize, (Model, Found))> {
    let by_cost =
        |a: &&(usize, (Model, Found)), b: &&(usize, (Model, Found))| a.1.1.cost.total_cmp(&b.1.1.cost);
    let Some((best, (from, lowest))) = ends.iter().min_by(by_cost) else { return Vec::new() };
    let own = |of: usize| ends.iter().filter(move |(own, _)| *own == of).min_by(by_cost);
    let worse: Vec<(usize, Model)> = (0..=ends.iter().map(|(of, _)| *of).max().unwrap_or(0))
        .filter(|of| of != best)
        .filter_map(own)
        .filter(|(_, (_, found))| found.cost > (1.0 + SAME) * lowest.cost)
        .filter_map(|(of, (model, _))| Some((*of, crossing(model, from)?)))
        .collect();
    watch.each(&worse, |(of, model)| (*of, on(model, &to)))
}

/// A model with the values that another ended with, and with the detents that came with that one's coupling.
fn crossing(model: &Model, from: &Model) -> Option<Model> {
    let has = |model: &Model| detents().is_some_and(|own| model.has(own));
    if has(model) == has(from) {
        return Some(joined_as(model, from));
    }
    let coupling = model.effects().find(|id| id.info().place == Place::Coupling)?;
    Some(joined_as(&joined_by(from, coupling)?, from))
}

/// What a model's coupling joins, joined by another.
pub(super) fn joined_by(model: &Model, other: Id) -> Option<Model> {
    model.shafts().iter().try_fold(loads(model).with(other).ok()?, |with, id| with.with_at_shaft(*id).ok())
}

/// A model with the values of another, and its coupling's with those that go by the same names in the other's.
pub(super) fn joined_as(model: &Model, other: &Model) -> Model {
    let mut joined = model.clone();
    let joins = |slot: &&Slot| slot.effect.info().place == Place::Coupling;
    for slot in model.slots() {
        let same = other.slots().iter().find(|from| from.name() == slot.name());
        let like = || other.slots().iter().filter(joins).find(|from| from.param.name == slot.param.name);
        let from = same.or_else(|| if joins(&slot) { like() } else { None });
        if let Some(from) = from {
            // The other's bounds may be wider; the name is its own.
            let _ = joined.set(&slot.name(), from.value.clamp(slot.param.lower, slot.param.upper));
        }
    }
    joined
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
    use crate::param::Axis;

    fn joined(id: Id, values: &[(&str, f64)]) -> Model {
        let mut model = Model::equation_1(Axis::Rotary, false).with(id).unwrap();
        values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
        model
    }

    #[test]
    fn a_gap_that_closed_is_a_start_of_compliance_with_its_stiffness_and_share() {
        let closed =
            [("backlash.gap", 0.0), ("backlash.k", 45.0), ("backlash.d", 1e-3), ("backlash.share", 0.6)];
        let gap = joined(Id::Backlash, &[&closed[..], &[("inertia.M", 5e-5)]].concat());
        let soft = joined_as(&joined(Id::Compliance, &[("compliance.k", 7.0), ("inertia.M", 1e-4)]), &gap);
        let value = |name: &str| soft.slots()[soft.index(name).unwrap()].value;
        let names = ["compliance.k", "compliance.d", "compliance.share", "inertia.M"];
        assert_eq!(names.map(value), [45.0, 1e-3, 0.6, 5e-5]);
    }

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
            let model = joined(id, &[]);
            (of, (model.clone(), Found { cost, ..glance(&[], &model) }))
        };
        for (gap, shut) in [(1.001, true), (0.999, true), (0.99, false)] {
            let ends = [(0, Id::Backlash, gap), (1, Id::Compliance, 1.0)].into_iter().map(end).collect();
            let [went, closed] = <[Ends; 2]>::from(open(ends)).map(|ends| ends.len());
            assert_eq!((went, closed), if shut { (1, 1) } else { (2, 0) }, "{gap}");
        }
    }

    #[test]
    fn from_the_best_end_of_all_those_joints_go_on_that_ended_worse() {
        let end = |(id, cost, k): (Id, f64, f64)| {
            let name = format!("{}.k", id.info().id);
            let model = joined(id, &[(&name, k)]);
            let found = glance(&[], &model);
            (model, Found { cost, ..found })
        };
        let watch = Watch::new(&|_| true, 1);
        for (other, again) in [(1.5e-4, true), (1.000_1e-4, false)] {
            let ends = [(1, end((Id::Backlash, other, 7.0))), (0, end((Id::Compliance, 1e-4, 45.0)))];
            let went = crossed(&ends, &watch, |model| Found { cost: 5e-5, ..glance(&[], model) });
            assert_eq!(went.len(), usize::from(again), "{other}");
            for (of, (model, found)) in went {
                assert_eq!((of, found.cost), (1, 5e-5));
                assert_eq!(model.values()[model.index("backlash.k").unwrap()], 45.0);
            }
        }
    }

    #[test]
    fn each_way_is_given_the_best_of_its_own_ends_and_none_where_it_has_none() {
        let model = joined(Id::Compliance, &[]);
        let end = |(of, cost): (usize, f64)| (of, (model.clone(), Found { cost, ..glance(&[], &model) }));
        let mut ways: Vec<Ways> =
            (0..3).map(|_| Ways { id: Id::Compliance, starts: Vec::new(), end: None }).collect();
        led(&mut ways, [(0, 3.0), (2, 2.0), (0, 1.0), (2, 5.0), (0, 4.0)].into_iter().map(end).collect());
        let costs: Vec<Option<f64>> =
            ways.iter().map(|way| way.end.as_ref().map(|(_, found)| found.cost)).collect();
        assert_eq!(costs, [Some(1.0), None, Some(2.0)]);
    }
}
