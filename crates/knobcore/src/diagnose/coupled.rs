//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::screen::{Screen, Start};
use super::strides::strides;
use super::watch::Watch;
use crate::effects::Id;
use crate::error::Result;
use crate::filter::{ZeroPhase, cheby2};
use crate::fit::{Fit, Found, glance, refine, settled, sketch};
use crate::floor::Floor;
use crate::model::Model;
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

/// Fits a model from values near its best. The error of one with a coupling is rough at its finest: it is descended in
/// strides too, as long as more than noise is left.
///
/// # Errors
/// As of [`crate::fit::fit`].
pub fn converge(data: &[&Signals], model: &Model) -> Result<Fit> {
    let mut best = refine(data, model)?;
    if model.is_coupled() && (rule().converged..rule().hopeless).contains(&(best.rmse / best.noise_floor)) {
        let led = strides(data, &best.model, &Watch::new(&|_| true, 1));
        best = refine(data, &led).ok().filter(|led| led.rmse < best.rmse).unwrap_or(best);
    }
    settled(data, best, |model| refine(data, model))
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
