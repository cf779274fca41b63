//! Noise levels from the capture itself, sensor by sensor.
//!
//! The motion of a knob is smooth from sample to sample and noise is not: over seven samples the sixth
//! divided difference of a motion at 10 Hz, sampled at 5 kHz, is 10^-11 of its amplitude, and that of white
//! noise is all there. Unlike a joint likelihood of noise and jerk, this does not trade one sensor's noise
//! for a livelier motion when the motion is not the white jerk of the model.

use super::jerk::{Reading, jerk_by_cross_validation};
use super::resolution::{least_noise, quantum};
use super::sensors::{Noise, Sensors};
use super::staircase::one_reading_per_step;
use crate::error::Result;
use crate::order::nth;

/// Samples in one difference.
const SAMPLES: usize = 7;

/// Differences taken at most, spread over the capture: the level is then known to about 2 %.
const DIFFERENCES: usize = 8192;

/// Readings that repeat the one before, as a share, where an encoder counts less than once a reading now and then.
const SLOW: f64 = 0.03;

/// Noise below this share of a count is that of counting.
const COUNTED: f64 = 0.5;

/// Median of |x| of a normal x, in standard deviations.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// The noise of each sensor and the strength of the jerk, from the capture alone.
///
/// # Errors
/// Lengths that differ, times that do not increase, fewer than three finite angles.
pub fn noise_from_capture(sensors: &Sensors<'_>) -> Result<Noise> {
    sensors.check()?;
    let readings = one_reading_per_step(sensors.theta);
    let sensors = Sensors { theta: readings.as_deref().unwrap_or(sensors.theta), ..*sensors };
    let mut differences = None;
    let [theta, omega, alpha] = [Some(sensors.theta), sensors.omega, sensors.alpha]
        .map(|column| column.map_or(f64::INFINITY, |column| level(sensors.t, column, &mut differences)));
    let noise = Noise { theta, omega, alpha, jerk: 0.0 };
    let counted = repeats(sensors.theta) > SLOW && noise.theta < COUNTED * quantum(sensors.theta);
    let reading = match readings {
        Some(_) => Reading::Stairs,
        None if counted => Reading::Counted,
        None => Reading::Free,
    };
    Ok(jerk_by_cross_validation(&sensors, noise, reading))
}

/// Share of the readings that are the same as the one before.
fn repeats(theta: &[f64]) -> f64 {
    let readings: Vec<f64> = theta.iter().copied().filter(|theta| theta.is_finite()).collect();
    let same = readings.windows(2).filter(|pair| pair[0] == pair[1]).count();
    same as f64 / readings.len().max(1) as f64
}

/// Standard deviation of the white noise in `column`; infinite if nothing in it is finite. What was taken of the column
/// before it is taken of this one, where that has readings in the same rows.
fn level(t: &[f64], column: &[f64], taken: &mut Option<Differences>) -> f64 {
    let seen: Vec<usize> = (0..t.len()).filter(|&k| column[k].is_finite()).collect();
    if seen.is_empty() {
        return f64::INFINITY;
    }
    let differences = match taken.take() {
        Some(same) if same.seen == seen => same,
        _ => Differences::of(t, seen),
    };
    let mut sizes = differences.sizes(column);
    *taken = Some(differences);
    let (least, middle) = (least_noise(column), sizes.len() / 2);
    nth(&mut sizes, middle).map_or(least, |size| least.max(size / MEDIAN))
}

/// Divided differences of readings at whatever times, scaled so that white noise keeps its variance.
struct Differences {
    /// The rows of the readings.
    seen: Vec<usize>,
    /// Readings from one difference to the next.
    stride: usize,
    /// Of each what its readings count.
    weights: Vec<[f64; SAMPLES]>,
}

impl Differences {
    fn of(t: &[f64], seen: Vec<usize>) -> Self {
        let stride = (seen.len() / DIFFERENCES).max(1);
        let weights = seen.windows(SAMPLES).step_by(stride).map(|rows| weights(t, rows)).collect();
        Self { seen, stride, weights }
    }

    /// How large those of a column are.
    fn sizes(&self, column: &[f64]) -> Vec<f64> {
        let each = self.seen.windows(SAMPLES).step_by(self.stride).zip(&self.weights);
        each.map(|(rows, weights)| {
            let terms = weights.iter().zip(rows).map(|(weight, &at)| weight * (column[at] - column[rows[0]]));
            terms.sum::<f64>().abs()
        })
        .collect()
    }
}

/// What each of `rows` counts in their divided difference, so scaled.
fn weights(t: &[f64], rows: &[usize]) -> [f64; SAMPLES] {
    let share = (t[rows[SAMPLES - 1]] - t[rows[0]]).recip();
    let mut products = [1.0; SAMPLES];
    for (i, &late) in rows.iter().enumerate() {
        for (j, &early) in rows[..i].iter().enumerate() {
            let apart = share * (t[late] - t[early]);
            products[i] *= apart;
            products[j] *= -apart;
        }
    }
    let weights = products.map(f64::recip);
    let gain = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    weights.map(|weight| weight / gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise as Random;

    #[test]
    fn noise_is_told_from_motion_at_uneven_times() {
        let mut normal = Random::new(3);
        let t: Vec<f64> =
            (0..20_000).map(|k| (f64::from(k) + 0.4 * (f64::from(k) * 1.7).sin()) * 2e-4).collect();
        let theta: Vec<f64> = t.iter().map(|t| (12.0 * t).sin() + 1e-5 * normal.normal()).collect();
        assert!((level(&t, &theta, &mut None) / 1e-5 - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_is_taken_of_one_column_is_another_columns_only_in_the_same_rows() {
        let mut normal = Random::new(4);
        let t: Vec<f64> = (0..3000).map(|k| f64::from(k) * 2e-4).collect();
        let mut noise = |sd: f64| -> Vec<f64> { t.iter().map(|_| sd * normal.normal()).collect() };
        let (first, same, mut other) = (noise(1.0), noise(2.0), noise(3.0));
        other.iter_mut().step_by(3).for_each(|reading| *reading = f64::NAN);
        let mut taken = None;
        for column in [&first, &same, &other, &first] {
            assert_eq!(level(&t, column, &mut taken), level(&t, column, &mut None));
        }
    }

    #[test]
    fn readings_repeat_where_they_are_the_same_as_the_one_before() {
        assert_eq!(repeats(&[1.0, 1.0, f64::NAN, 1.0, 2.0]), 0.5);
        assert_eq!(repeats(&[1.0, 2.0, 1.0, 2.0]), 0.0);
        assert_eq!(repeats(&[]), 0.0);
    }
}
