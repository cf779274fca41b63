//! Are there detents, and which?

use super::scan::{Scan, scan};
use super::separable::{Found, Layout, descend};
use crate::effects::Id;
use crate::error::Result;
use crate::floor::Floor;
use crate::model::Model;
use crate::signals::Signals;

/// A peak of the scan stands out when it takes off this many times what the median frequency does: a missing
/// effect fills the scan broadly, detents are a line.
const STANDS_OUT: f64 = 30.0;
/// Chance of detents where there is noise alone.
const CHANCE: f64 = 1e-4;
/// Detents must explain this share of what the model without them leaves above the noise.
const SHARE: f64 = 0.2;
/// Peaks of the scan that are followed to their optimum, if they reach this share of the best.
const CANDIDATES: usize = 3;
const RIVAL: f64 = 0.8;

/// The best descent over the peaks of the scan. The sweeps of every descent count as evaluations.
pub fn best_from_scan(
    data: &[&Signals],
    model: &Model,
    layout: &Layout,
    start: &[f64],
    scan: &Scan,
) -> Result<Option<Found>> {
    let peaks = scan.peaks();
    let best_gain = peaks.first().map_or(0.0, |peak| peak.1);
    let period = model.index("detent.P")?;
    let mut best: Option<Found> = None;
    let (mut evaluations, mut iterations) = (0, 0);
    for (p, _) in peaks.iter().take(CANDIDATES).filter(|peak| peak.1 >= RIVAL * best_gain) {
        let mut start = start.to_vec();
        start[period] = *p;
        let found = descend(data, model, layout, &start);
        evaluations += found.evaluations;
        if best.as_ref().is_none_or(|b| found.cost < b.cost) {
            iterations = found.iterations;
            best = Some(found);
        }
    }
    Ok(best.map(|found| Found { evaluations, iterations, ..found }))
}

/// The scan beside everything of `model` but its detents, evaluated where `start` has the other parameters.
pub fn scan_beside(data: &[&Signals], model: &Model) -> Option<(Model, Found, Scan)> {
    let effects: Vec<Id> = model.effects().filter(|id| *id != Id::Detent).collect();
    let bare = model.only(&effects).ok()?;
    let layout = Layout::of(&bare);
    let found = descend(data, &bare, &layout, &bare.values());
    let scan = scan(data, &bare, &found.p, &layout.free)?;
    Some((bare, found, scan))
}

/// Whether a detent that takes `gain` off the sum of squares stands out of the scan and explains a share of
/// the error that a user would care about.
///
/// In noise alone each gain is the noise's variance times a chi-square number of two degrees of freedom, so
/// that the largest of n stays below twice the variance times ln(n / chance).
pub fn worth_it(gain: f64, without: &Found, scan: &Scan, floor: &Floor) -> bool {
    let (white, squares) = if floor.white.is_finite() { (floor.white, floor.squares) } else { (0.0, 0.0) };
    let by_chance = 2.0 * white * (scan.gain.len() as f64 / CHANCE).ln();
    gain >= by_chance.max(STANDS_OUT * scan.background()) && gain >= SHARE * (without.cost - squares).max(0.0)
}

/// Whether the detents that were found explain the error better than a smooth position function does.
pub fn beat_smooth(data: &[&Signals], bare: &Model, with: &Found) -> Result<bool> {
    // A smooth function of position, with as many parameters, would take off as much where there are no
    // detents but a spring, gravity or a bent shaft.
    let smooth = bare.with(Id::PositionPolynomial)?;
    let rival = descend(data, &smooth, &Layout::of(&smooth), &smooth.values());
    Ok(with.cost < rival.cost)
}
