//! Counts of a slow encoder: a stair held for c samples is one reading, not c.
//!
//! When the angle crosses less than one count per sample and the sensor's own noise does not dither it, the
//! quantisation error is a sawtooth, not white noise: taken at face value, the held samples say "at rest"
//! and the next one "a jolt". The middle of each stair is where the angle is nearest to its count, so that
//! sample is kept and the others count as missing. Errors from stair to stair are then nearly independent.

use super::resolution::quantum;
use std::ops::Range;

/// Samples in a stair that is worth the name: dither breaks it up before.
const HELD: usize = 4;

/// A stair counts as this many samples at most when stairs are weighed against the rest: a knob that sticks for
/// seconds and slips at many counts per sample is no slow encoder.
const WORTH: usize = 16;

/// Where less than this share of the samples lies on stairs, every sample is a reading of its own.
const MOSTLY: f64 = 0.2;

/// A stair this many times longer than the usual one is a rest; it is read once per usual stair.
const REST: usize = 3;

/// The angle with one reading per stair, NaN elsewhere; `None` if it is no staircase.
pub fn one_reading_per_step(theta: &[f64]) -> Option<Vec<f64>> {
    let step = quantum(theta);
    let stairs = stairs(theta);
    if step == 0.0 || share_on_stairs(theta, &stairs, step) < MOSTLY {
        return None;
    }
    let mut lengths: Vec<usize> =
        stairs.iter().map(ExactSizeIterator::len).filter(|&length| length > 1).collect();
    if lengths.is_empty() {
        return None;
    }
    let middle = lengths.len() / 2;
    let usual = *lengths.select_nth_unstable(middle).1;
    let mut readings = vec![f64::NAN; theta.len()];
    let mut upper = false;
    for stair in stairs {
        let pieces = if stair.len() > REST * usual { stair.len().div_ceil(usual) } else { 1 };
        for piece in 0..pieces {
            let first = stair.start + stair.len() * piece / pieces;
            let last = stair.start + stair.len() * (piece + 1) / pieces - 1;
            // Of two middle samples, take the earlier and the later in turn: no lag on average.
            let middle = (first + last + usize::from(upper)) / 2;
            upper = !upper;
            readings[middle] = theta[middle];
        }
    }
    Some(readings)
}

/// Runs of equal samples.
fn stairs(theta: &[f64]) -> Vec<Range<usize>> {
    let mut stairs = Vec::new();
    let mut first = 0;
    for k in 1..=theta.len() {
        if k == theta.len() || theta[k] != theta[first] {
            stairs.push(first..k);
            first = k;
        }
    }
    stairs
}

/// Share of the samples on stairs with a single step at either end.
fn share_on_stairs(theta: &[f64], stairs: &[Range<usize>], step: f64) -> f64 {
    let single = |from: f64, to: f64| ((to - from).abs() / step - 1.0).abs() < 0.1;
    let worth = |stair: &Range<usize>| stair.len().min(WORTH);
    let held: usize = stairs
        .windows(3)
        .filter(|three| {
            let [before, here, after] = [0, 1, 2].map(|i| theta[three[i].start]);
            three[1].len() >= HELD && single(before, here) && single(here, after)
        })
        .map(|three| worth(&three[1]))
        .sum();
    held as f64 / stairs.iter().map(worth).sum::<usize>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_ramp_is_read_once_per_count() {
        let theta: Vec<f64> = (0..1000).map(|k| f64::from(k / 20)).collect();
        let readings = one_reading_per_step(&theta).unwrap();
        assert_eq!(readings.iter().filter(|theta| theta.is_finite()).count(), 50);
        assert!(readings[9].is_finite() && readings[30].is_finite());
    }

    #[test]
    fn dither_leaves_every_sample_a_reading() {
        let theta: Vec<f64> = (0..1000).map(|k| f64::from(k / 20 + (k * 7) % 3)).collect();
        assert!(one_reading_per_step(&theta).is_none());
    }

    #[test]
    fn a_knob_that_sticks_between_fast_slips_is_no_staircase() {
        // Each slip starts and ends by a single count and runs at three counts per sample between.
        let slip = |k: i32| (3 * k - 2).clamp(0, 301) + i32::from(k > 102);
        let theta: Vec<f64> = (0..9000).map(|k| f64::from(302 * (k / 3000) + slip(k % 3000))).collect();
        assert!(one_reading_per_step(&theta).is_none());
    }

    #[test]
    fn rest_is_no_staircase() {
        assert!(one_reading_per_step(&[1.5; 100]).is_none());
    }
}
