//! Which parts of a capture stand for the whole.

use super::sensors::Sensors;
use nalgebra::Vector3;
use std::ops::Range;

/// Number of stretches.
const STRETCHES: usize = 8;

/// Readings of theta in one stretch.
const READINGS: usize = 512;

/// Longest stretch, where most readings of theta are missing.
const LONGEST: usize = 4096;

/// One sample: steps since the one before, and (theta, omega, alpha) in SI, NaN where missing.
pub type Row = (f64, Vector3<f64>);

/// Stretches of the capture from the calmest to the liveliest, evenly spaced in rank. A capture that rests
/// for an hour and moves for a second is thus seen moving.
pub fn stretches(sensors: &Sensors<'_>, step: f64) -> Vec<Vec<Row>> {
    let n = sensors.len();
    let readings = sensors.theta.iter().filter(|theta| theta.is_finite()).count().max(1);
    let length = (READINGS * n / readings).min(LONGEST);
    let parts = n / length;
    if parts <= STRETCHES {
        return vec![rows(sensors, step, 0..n)];
    }
    let mut ranked: Vec<Range<usize>> = (0..parts).map(|part| part * length..(part + 1) * length).collect();
    ranked.sort_by_cached_key(|range| Rank(liveliness(&sensors.theta[range.clone()])));
    let chosen = (0..STRETCHES).map(|i| ranked[(parts - 1) * (i + 1) / STRETCHES].clone());
    chosen.map(|range| rows(sensors, step, range)).collect()
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

fn rows(sensors: &Sensors<'_>, step: f64, range: Range<usize>) -> Vec<Row> {
    let since = |k: usize| if k == 0 { 1.0 } else { (sensors.t[k] - sensors.t[k - 1]) / step };
    range.map(|k| (since(k), sensors.row(k))).collect()
}

/// A number with a total order.
struct Rank(f64);

impl PartialEq for Rank {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Rank {}

impl PartialOrd for Rank {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Rank {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
