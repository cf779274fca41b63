//! Which parts of a capture stand for the whole.

use super::sensors::Sensors;
use crate::order::Ascending;
use std::ops::Range;

/// Number of stretches.
const STRETCHES: usize = 4;

/// Stretches of `length` samples, from the calmest to the liveliest, evenly spaced in rank: a capture that rests
/// for an hour and moves for a second is thus seen moving. All of a short capture.
pub fn stretches<'a>(sensors: &Sensors<'a>, length: usize) -> Vec<Sensors<'a>> {
    let parts = sensors.len() / length;
    if parts <= STRETCHES {
        return vec![*sensors];
    }
    let mut ranked: Vec<(f64, Range<usize>)> = (0..parts)
        .map(|part| part * length..(part + 1) * length)
        .map(|rows| (liveliness(&sensors.theta[rows.clone()]), rows))
        .collect();
    ranked.sort_by_cached_key(|(lively, _)| Ascending(*lively));
    (0..STRETCHES).map(|i| sensors.rows(ranked[(parts - 1) * (i + 1) / STRETCHES].1.clone())).collect()
}

/// The third difference of theta across the stretch: its jerk, at the scale of the stretch.
fn liveliness(theta: &[f64]) -> f64 {
    let readings: Vec<f64> = theta.iter().copied().filter(|theta| theta.is_finite()).collect();
    if readings.len() < 4 {
        return 0.0;
    }
    let at = |quarter: usize| readings[quarter * (readings.len() - 1) / 3];
    (at(3) - 3.0 * at(2) + 3.0 * at(1) - at(0)).abs()
}
