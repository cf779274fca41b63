//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::screen::Start;
use crate::filter::{ZeroPhase, cheby2};
use crate::fit::{Found, sketch};
use crate::model::Model;
use crate::prepare::slower;
use crate::signals::Signals;

/// Stopband edge of the coarse filter at 5 kHz, Hz.
const COARSE_HZ: f64 = 60.0;
/// Starts that are followed through the coarse filter.
const FOLLOWED: usize = 2;

/// The optima that coarse descents lead to, each with its model.
pub fn coupled(data: &[&Signals], starts: &[Start]) -> Vec<(Model, Found)> {
    let coarse: Vec<Signals> = data.iter().filter_map(|signals| slowed(signals)).collect();
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let sketched = starts.iter().take(FOLLOWED).map(|start| (&start.model, sketch(&coarse, &start.model)));
    let best = sketched
        .filter(|(_, found)| found.cost.is_finite())
        .min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    let Some((model, found)) = best else { return Vec::new() };
    let mut model = model.clone();
    model.set_values(&found.p);
    let fine = sketch(data, &model);
    if fine.cost.is_finite() { vec![(model, fine)] } else { Vec::new() }
}

/// The same signals through a slower measurement filter.
fn slowed(signals: &Signals) -> Option<Signals> {
    let edge = COARSE_HZ * slower(signals.rate_hz);
    let filter = ZeroPhase::new(cheby2(3, 20.0, edge, signals.rate_hz).ok()?);
    let mut slow = Signals { filter: Some(filter), substeps: 2, ..signals.clone() };
    slow.filter_torque();
    Some(slow)
}
