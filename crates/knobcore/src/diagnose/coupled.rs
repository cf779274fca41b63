//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::screen::{Screen, Start, alone, survey};
use super::shown::{detents, shown};
use super::slower::{self, COARSE_HZ, MIDDLE_HZ, beginnings, slowed};
use super::strides::{FEW, ROUNDS, strides};
use super::thinned::Thinned;
use super::watch::{Tell, Watch};
use crate::effects::{Id, Place};
use crate::error::Result;
use crate::fit::{Fit, Found, glance, loads, refine, report, settled, sketch};
use crate::floor::Floor;
use crate::model::{Model, Slot};
use crate::order::{Ascending, descending};
use crate::rule::rule;
use crate::signals::Signals;

/// Starts that are looked at by a few steps through the coarse filter, and those of them that are followed.
const LOOKED: usize = 8;
const FOLLOWED: usize = 3;
/// Samples of captures that the coarse search looks at, and those that it first glances at.
const ENOUGH: usize = 30_000;
const GLANCED: usize = 12_000;
/// Starts of a joint in another's place that are followed.
const PLACED: usize = 2;
/// Sums of squares through the filter in between of what is followed to its end, in times of the best.
const RIVAL: f64 = 1.15;
/// Ends whose sums of squares differ by less than this share are one.
const SAME: f64 = 1e-3;

/// Ends of descents, each with the place of its way among the ways.
type Ends = Vec<(usize, (Model, Found))>;

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
/// filter than another does is not followed further. If they `may_come`, detents come with them that show through them.
pub fn coupled(whole: &Screen<'_>, couplings: &[Id], may_come: bool) -> Vec<Ways> {
    let (data, base, watch) = (whole.data, whole.model, whole.watch);
    let first = beginnings(data, ENOUGH);
    let first: Vec<&Signals> = first.iter().collect();
    let coarse = slowed(&first, COARSE_HZ);
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let screen = Screen::new(&coarse, base, watch);
    // What is in the model beside the base may load the shaft as well as the knob.
    let beside: Vec<Id> = base.effects().filter(|id| Model::may_be_at_shaft(*id)).collect();
    let shaft = (!beside.is_empty()).then(|| Screen::new(&coarse, base, watch).with_shaft(beside.clone()));
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
    let few = slowed(&beginnings(data, GLANCED).iter().collect::<Vec<_>>(), COARSE_HZ);
    let few: Vec<&Signals> = few.iter().collect();
    let mut seen = watch.each(&looked, |(of, model)| (*of, on(model, |m| glance(&few, m))));
    seen.sort_by_cached_key(cost);
    let own = |of: usize| seen.iter().filter(move |(own, _)| *own == of).take(FOLLOWED);
    let few: Vec<_> = (0..ways.len()).flat_map(own).collect();
    let mut ends = watch.each(&few, |(of, (model, _))| (*of, on(model, |model| sketch(&coarse, model))));
    ends.sort_by_cached_key(cost);
    others(&mut ends, f64::INFINITY);
    let strode = |view: &Screen<'_>, ends: &Ends, floor: f64| {
        watch.each(ends, |(of, end)| (*of, strode(view.data, end.clone(), floor, view.squares, watch)))
    };
    // Without a floor nothing can be said to be too little.
    let enough = if floor.is_nan() { 0.0 } else { rule().worth_coarse * (screen.squares - floor) };
    let mut ends = strode(&screen, &ends, floor);
    ends.sort_by_cached_key(cost);
    let most = rival(&ends, screen.squares, floor).min(screen.squares - enough);
    let (mut ends, _) = rivals(most, ends);
    others(&mut ends, f64::INFINITY);
    detented.extend(ends.into_iter().map(|(of, (model, _))| (of, model)));
    let mut between = watch.each(&detented, |(of, model)| (*of, on(model, |m| sketch(&middle, m))));
    between.sort_by_cached_key(cost);
    others(&mut between, RIVAL);
    let (between, worse) = rivals(rival(&between, view.squares, middle_floor), between);
    let mut between = strode(&view, &between, middle_floor);
    between.sort_by_cached_key(cost);
    others(&mut between, RIVAL);
    let mut fine = watch.each(&between, |(of, (model, _))| (*of, on(model, |m| sketch(data, m))));
    // What was followed no further is told by where the best leads it.
    let beaten = |found: Found| Found { cost: f64::INFINITY, ..found };
    fine.extend(worse.into_iter().map(|(of, (model, found))| (of, (model, beaten(found)))));
    fine.extend(crossed(&fine, watch, |model| sketch(data, model)));
    fine.retain(|(_, (_, found))| found.cost.is_finite());
    led(&mut ways, fine);
    ways
}

/// What an end may leave at most that is a rival of the best of these, where so much is left without a coupling.
fn rival(ends: &Ends, squares: f64, floor: f64) -> f64 {
    let floor = if floor.is_nan() { 0.0 } else { floor };
    let best = ends.iter().map(|(_, (_, found))| found.cost).fold(f64::INFINITY, f64::min);
    floor + rule().rival_coarse * (best - floor).max(0.0) + rule().close_coarse * (squares - floor)
}

/// The ends that leave at most so much, and the others.
fn rivals(most: f64, ends: Ends) -> (Ends, Ends) {
    ends.into_iter().partition(|(_, (_, found))| found.cost <= most)
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
fn joined_by(model: &Model, other: Id) -> Option<Model> {
    model.shafts().iter().try_fold(loads(model).with(other).ok()?, |with, id| with.with_at_shaft(*id).ok())
}

/// A fit with another coupling in the place of a model's own, from where that one ended. None for a model without one or
/// with that one, where no such model can be followed, and if `tell` no longer wanted it.
pub fn in_place(data: &[&Signals], model: &Model, other: Id, tell: &Tell<'_>) -> Option<Fit> {
    if !model.is_coupled() || model.has(other) {
        return None;
    }
    let bare = joined_as(&joined_by(model, other)?, model);
    // What its own joint lacks it starts with.
    let mut starts = vec![bare.clone()];
    for values in other.law().starts(&survey(data, &loads(model))) {
        let mut start = bare.clone();
        for (param, value) in other.info().params.iter().zip(values) {
            // The names are the joint's own, the values within their bounds.
            let _ = start.set(&format!("{}.{}", other.info().id, param.name), value);
        }
        let start = joined_as(&start, model);
        if starts.iter().all(|known| known.values() != start.values()) {
            starts.push(start);
        }
    }
    let watch = Watch::new(tell, starts.len());
    let looked = watch.each(&starts, |start| on(start, |model| glance(data, model)));
    let mut looked: Vec<(usize, (Model, Found))> = looked.into_iter().map(|end| (0, end)).collect();
    looked.sort_by_cached_key(cost);
    others(&mut looked, RIVAL);
    looked.truncate(PLACED);
    let ends = watch.each(&looked, |(_, (model, _))| on(model, |model| sketch(data, model)));
    let (model, found) = ends.into_iter().min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))?;
    if watch.wanted() { report(data, &model, found).ok() } else { None }
}

/// A model with the values of another, and its coupling's with those that go by the same names in the other's.
fn joined_as(model: &Model, other: &Model) -> Model {
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

/// Keeps of each way's ends, best first, those within so many times the best; two starts mostly lead to one end.
fn others(ends: &mut Vec<(usize, (Model, Found))>, within: f64) {
    let mut kept: Vec<(usize, f64)> = Vec::new();
    ends.retain(|(of, (_, found))| {
        let own: Vec<f64> = kept.iter().filter(|(own, _)| own == of).map(|(_, cost)| *cost).collect();
        let rivals = own.first().is_none_or(|best| found.cost <= within * best);
        let other = own.last().is_none_or(|last| found.cost > (1.0 + SAME) * last);
        if rivals && other {
            kept.push((*of, found.cost));
        }
        rivals && other
    });
}

/// The sum of squares that a model leaves, (N m)^2.
pub(super) fn squares(data: &[&Signals], model: &Model) -> f64 {
    Thinned::of(data).columns(data, model, &[]).2
}

/// What an end is sorted by.
pub(super) fn cost((_, (_, found)): &(usize, (Model, Found))) -> Ascending {
    Ascending(found.cost)
}

/// Gives each of the ways the best of the ends that are its own, by its place among them.
pub(super) fn led(ways: &mut [Ways], mut ends: Vec<(usize, (Model, Found))>) {
    // The best last, so that it stays.
    ends.sort_by_cached_key(|(_, (_, found))| descending(found.cost));
    for (of, end) in ends {
        ways[of].end = Some(end);
    }
}

/// A model where a descent from it ended.
pub(super) fn on(model: &Model, to: impl Fn(&Model) -> Found) -> (Model, Found) {
    let found = to(model);
    let mut model = model.clone();
    model.set_values(&found.p);
    (model, found)
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
    if found.cost <= rule().converged.powi(2) * floor || found.cost > RIVAL * without {
        return (model, found);
    }
    on(&strides(data, &model, floor, FEW, watch), |model| sketch(data, model))
}

/// Fits a model from values near its best. The error of one with a coupling is rough at its finest: it is descended in
/// strides too, as long as more than noise is left.
///
/// # Errors
/// As of [`crate::fit::fit`].
pub fn converge(data: &[&Signals], model: &Model) -> Result<Fit> {
    if !model.is_coupled() {
        return settled(data, refine(data, model)?, |model| refine(data, model));
    }
    let near = |squares: f64, floor: f64| {
        (rule().converged.powi(2)..rule().hopeless.powi(2)).contains(&(squares / floor))
    };
    let led = |model: &Model, floor: f64| {
        refine(data, &strides(data, model, floor, ROUNDS, &Watch::new(&|_| true, 1)))
    };
    // What a search has followed is near its end: a descent before the strides and one after them were one too many.
    let floor = Floor::of(data, model).squares;
    let best = if near(squares(data, model), floor) {
        led(model, floor)?
    } else {
        let best = refine(data, model)?;
        if near(best.rmse.powi(2), best.noise_floor.powi(2)) {
            let led = led(&best.model, Floor::of(data, &best.model).squares).ok();
            led.filter(|led| led.rmse < best.rmse).unwrap_or(best)
        } else {
            best
        }
    };
    settled(data, best, |model| refine(data, model))
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
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
    fn a_joint_that_stands_in_for_another_is_followed_from_where_that_one_ended() {
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let truth =
            knob(&[Id::Compliance, Id::ReturnSpring], &[&joint[..], &[("return_spring.k", 0.1)]].concat());
        let truth = truth.with_at_shaft(Id::ReturnSpring).unwrap();
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let soft = refine(&data, &truth).unwrap();
        let gap = in_place(&data, &soft.model, Id::Backlash, &|_| true).unwrap();
        assert!(gap.model.at_shaft(Id::ReturnSpring) && !gap.model.has(Id::Compliance));
        // A gap that closes is compliance, but for surfaces that do not pull.
        assert!(gap.rmse < 1.5 * soft.rmse, "{} {}", gap.rmse, soft.rmse);
        assert!(in_place(&data, &soft.model, Id::Compliance, &|_| true).is_none());
        assert!(in_place(&data, &knob(&[], &[]), Id::Backlash, &|_| true).is_none());
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
    fn of_each_coupling_the_ends_that_differ_and_are_nearly_as_good_are_followed() {
        let model = joined(Id::Compliance, &[]);
        let end = |(of, cost): (usize, f64)| {
            let found = glance(&[], &model);
            (of, (model.clone(), Found { cost, ..found }))
        };
        let mut ends: Vec<_> =
            [(0, 1.0), (0, 1.0001), (1, 1.05), (0, 1.1), (0, 1.2), (1, 1.3)].into_iter().map(end).collect();
        others(&mut ends, RIVAL);
        let kept: Vec<(usize, f64)> = ends.iter().map(|(of, (_, found))| (*of, found.cost)).collect();
        assert_eq!(kept, [(0, 1.0), (1, 1.05), (0, 1.1)]);
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
