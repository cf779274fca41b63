//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::screen::{Screen, Start};
use super::watch::Watch;
use crate::effects::{Id, Place};
use crate::error::Result;
use crate::filter::{ZeroPhase, cheby2};
use crate::fit::{Fit, Found, glance, refine, settled, sketch};
use crate::floor::Floor;
use crate::model::{Model, Role};
use crate::prepare::slower;
use crate::rule::rule;
use crate::signals::Signals;

/// Stopband edges at 5 kHz of the filter that the search goes through and of the one in between, Hz.
pub(super) const COARSE_HZ: f64 = 60.0;
pub(super) const MIDDLE_HZ: f64 = 150.0;
/// Starts that are looked at by a few steps through the coarse filter, and those of them that are followed.
const LOOKED: usize = 8;
const FOLLOWED: usize = 3;
/// Samples of captures that the coarse search looks at.
const ENOUGH: usize = 30_000;
/// Ends whose sums of squares differ by less than this share are one.
const SAME: f64 = 1e-3;

/// Rounds of kicks, how many lead on in each, and by what each moves the first two parameters of a joint: its gap and
/// stiffness, or stiffness and damping.
const SHAKEN: usize = 3;
const LED: usize = 4;
const KICKS: [[f64; 2]; 8] =
    [[0.7, 0.4], [0.85, 0.4], [0.85, 1.0], [0.93, 1.0], [1.08, 1.0], [1.18, 1.0], [1.18, 2.5], [1.0, 0.5]];

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
/// filter than another does is not followed further.
pub fn coupled(whole: &Screen<'_>, couplings: &[Id]) -> Vec<Ways> {
    let (data, base, watch) = (whole.data, whole.model, whole.watch);
    let coarse = beginnings(data, ENOUGH);
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let screen = Screen::new(&coarse, base, watch);
    // What is in the model beside the base may load the shaft as well as the knob.
    let beside: Vec<Id> = base.effects().filter(|id| Model::may_be_at_shaft(*id)).collect();
    let shaft = (!beside.is_empty()).then(|| Screen::new(&coarse, base, watch).with_shaft(beside));
    let mut ways: Vec<Ways> = Vec::new();
    let mut looked: Vec<(usize, Model)> = Vec::new();
    for id in couplings {
        let starts = screen.starts(*id);
        let before = shaft.iter().flat_map(|screen| screen.starts(*id).into_iter().take(LOOKED));
        let models = before.chain(starts.iter().take(LOOKED).cloned()).map(|start| (ways.len(), start.model));
        looked.extend(models);
        ways.push(Ways { id: *id, starts, end: None });
    }
    let mut seen = watch.each(&looked, |(of, model)| (*of, on(model, |m| glance(&coarse, m))));
    seen.sort_by(|(_, (_, a)), (_, (_, b))| a.cost.total_cmp(&b.cost));
    let few = |of: usize| seen.iter().filter(move |(own, _)| *own == of).take(FOLLOWED);
    let few: Vec<&(usize, (Model, Found))> = (0..ways.len()).flat_map(few).collect();
    let mut ends = watch.each(&few, |(of, (model, _))| (*of, on(model, |m| sketch(&coarse, m))));
    ends.sort_by(|(_, (_, a)), (_, (_, b))| a.cost.total_cmp(&b.cost));
    let floor = Floor::of(&coarse, base).squares;
    // Without a floor nothing can be said to be too little.
    let (floor, excess) = if floor.is_nan() { (0.0, 0.0) } else { (floor, screen.squares - floor) };
    let least = ends.first().map_or(0.0, |(_, (_, found))| (found.cost - floor).max(0.0));
    let enough = screen.squares - rule().worth_coarse * excess;
    ends.retain(|(_, (_, found))| {
        found.cost <= enough.min(floor + rule().rival_coarse * least + rule().close_coarse * excess)
    });
    // Two starts mostly lead to one end.
    let mut kept: Vec<(usize, f64)> = Vec::new();
    ends.retain(|(of, (_, found))| {
        let known = kept.iter().any(|(own, cost)| own == of && found.cost <= (1.0 + SAME) * cost);
        kept.push((*of, found.cost));
        !known
    });
    let middle = slowed(data, MIDDLE_HZ);
    let middle: Vec<&Signals> = middle.iter().collect();
    let mut fine = watch.each(&ends, |(of, (model, _))| {
        let (model, _) = on(model, |m| sketch(&middle, m));
        (*of, on(&model, |m| sketch(data, m)))
    });
    fine.retain(|(_, (_, found))| found.cost.is_finite());
    led(&mut ways, fine);
    ways
}

/// Gives each of the ways the best of the ends that are its own, by its place among them.
pub(super) fn led(ways: &mut [Ways], mut ends: Vec<(usize, (Model, Found))>) {
    // The best last, so that it stays.
    ends.sort_by(|(_, (_, a)), (_, (_, b))| b.cost.total_cmp(&a.cost));
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

/// Fits a model from values near its best. The error of one with a coupling is rough at its finest: it is
/// approached through slower filters too, and the best end counts.
///
/// # Errors
/// As of [`crate::fit::fit`].
pub fn converge(data: &[&Signals], model: &Model) -> Result<Fit> {
    let mut best = refine(data, model)?;
    if model.is_coupled() && (rule().converged..rule().hopeless).contains(&(best.rmse / best.noise_floor)) {
        let by_way_of = |edges: &[f64]| {
            let mut model = best.model.clone();
            for edge in edges {
                let slow = slowed(data, *edge);
                (model, _) = on(&model, |m| sketch(&slow.iter().collect::<Vec<_>>(), m));
            }
            refine(data, &model)
        };
        let ways: [&[f64]; 2] = [&[MIDDLE_HZ], &[COARSE_HZ, MIDDLE_HZ]];
        let watch = Watch::new(&|_| true, ways.len());
        let others = watch.each(&ways, |edges| by_way_of(edges).ok()).into_iter().flatten();
        best = others.fold(best, |best, fit| if fit.rmse < best.rmse { fit } else { best });
        best = shaken(data, best, &watch);
    }
    settled(data, best, |model| refine(data, model))
}

/// A fit with a coupling, where kicks of the joint lead on from its end: the error there is so rough that a descent stops
/// in the first dent. As long as they do, and more than noise is left.
fn shaken(data: &[&Signals], mut best: Fit, watch: &Watch<'_>) -> Fit {
    for _ in 0..SHAKEN {
        if best.rmse <= rule().converged * best.noise_floor {
            break;
        }
        let mut seen = watch.each(&kicked(&best.model), |model| on(model, |m| glance(data, m)));
        seen.sort_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        seen.truncate(LED);
        let ends = watch.each(&seen, |(model, _)| refine(data, model).ok());
        let end = ends.into_iter().flatten().min_by(|a, b| a.rmse.total_cmp(&b.rmse));
        let Some(end) = end.filter(|end| end.rmse < (1.0 - SAME) * best.rmse) else { break };
        best = end;
    }
    best
}

/// A model with the first two of its joint's free parameters moved, each and together.
fn kicked(model: &Model) -> Vec<Model> {
    let joint = |at: &usize| {
        let slot = &model.slots()[*at];
        slot.effect.info().place == Place::Coupling && slot.role == Role::Free && slot.value > 0.0
    };
    let own: Vec<usize> = (0..model.slots().len()).filter(joint).take(2).collect();
    let at = |times: &[f64; 2]| {
        let mut p = model.values();
        own.iter().zip(times).for_each(|(at, times)| p[*at] *= times);
        let mut kicked = model.clone();
        kicked.set_values(&p);
        kicked
    };
    KICKS.iter().map(at).collect()
}

/// The beginnings of captures, of so many samples at most, through the coarse filter.
pub(super) fn beginnings(data: &[&Signals], most: usize) -> Vec<Signals> {
    let beginnings: Vec<Signals> = data.iter().map(|signals| beginning(signals, most)).collect();
    slowed(&beginnings.iter().collect::<Vec<_>>(), COARSE_HZ)
}

/// The first samples of a capture: enough to find what is then followed through all of it.
fn beginning(signals: &Signals, most: usize) -> Signals {
    let mut left = most;
    let mut segments = Vec::new();
    for segment in &signals.segments {
        let taken = segment.len().min(left);
        left -= taken;
        if taken >= most / 10 {
            segments.push(segment.start..segment.start + taken);
        }
    }
    if segments.is_empty() {
        return signals.clone();
    }
    let mut weight = vec![0.0; signals.len()];
    for segment in &segments {
        weight[segment.clone()].copy_from_slice(&signals.weight[segment.clone()]);
    }
    Signals { weight, segments, ..signals.clone() }
}

/// The same captures through a slower measurement filter; without those that are sampled too slowly for it.
pub(super) fn slowed(data: &[&Signals], edge_hz: f64) -> Vec<Signals> {
    let slow = |signals: &&Signals| {
        let edge = edge_hz * slower(signals.rate_hz);
        let filter = ZeroPhase::new(cheby2(3, 20.0, edge, signals.rate_hz).ok()?);
        // What a slower filter lets through needs no finer steps.
        let substeps = if edge_hz > COARSE_HZ { 2 } else { 1 };
        let mut slow = Signals { filter: Some(filter), substeps, ..Signals::clone(signals) };
        slow.filter_torque();
        Some(slow)
    };
    data.iter().filter_map(slow).collect()
}
