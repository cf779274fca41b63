//! Impacts: where the motion is rougher than its usual jerk allows, and there only, the jerk is raised.
//!
//! A knob that slips, hits its end stop or takes up backlash changes its acceleration within a sample. At the
//! jerk of the rest of the capture the smoother rounds that off over its whole memory, before and after. The
//! sensors then lie off the smoothed motion by far more than their noise; windows where they do are found by
//! chi-square, and the smoother runs again with more jerk in them. Without such a window the first run stands.
//!
//! How much: what the last run spent there, with a margin. A run spreads an impact over all windows that were
//! raised, but most of it lies where it happened, so that from run to run the raised windows close in on it
//! and the others fall back to the usual jerk (the re-weighting of I. F. Gorodnitsky and B. D. Rao, "Sparse
//! signal reconstruction from limited data using FOCUSS", IEEE Transactions on Signal Processing 45(3), 1997;
//! here window by window and never below the usual jerk). A window that stays out of line is raised further.
//!
//! A wild reading of a single sensor looks like an impact at first, and is left out (`strays`);
//! sensors that contradict each other for several samples are smoothed with a standard deviation that may be
//! too small.

use super::lifts::{Lifts, WINDOW};
use super::rts::{Motion, smooth_rows};
use super::sensors::Sensors;
use super::state::Model;
use std::ops::{Range, RangeInclusive};

/// Runs of the smoother at most.
const RUNS: usize = 6;

/// A window is out of line if white noise alone does that less than once in exp(16) windows, nine million.
const UNLIKELY: f64 = 16.0;

/// What the chi-square of a window of white noise, 8 degrees of freedom, exceeds one time in ten, per degree.
const UPPER_TENTH: f64 = 1.67;

/// The jerk variance of a window is taken this many times what the last run spent there.
const MARGIN: f64 = 4.0;

/// A window that is out of line still is raised by this factor from run to run.
const STUBBORN: f64 = 8.0;

/// The jerk is not raised beyond the point where it moves the angle in one step by this many times its noise:
/// there the smoother passes through every sample.
const MOST: f64 = 1e4;

/// The motion of a first run, with the jerk of `model` except where there are impacts.
pub fn with_impacts(sensors: &Sensors<'_>, model: &Model, first: Motion) -> Motion {
    let mut lifts = Lifts::default();
    let mut motion = first;
    // The least that each window is raised; none where the motion is smooth.
    let mut least: Vec<Option<f64>> = Vec::new();
    for _ in 1..RUNS {
        let out_of_line = out_of_line(sensors, model, &motion);
        if !out_of_line.contains(&true) {
            break;
        }
        least.resize(out_of_line.len(), None);
        let flagged = || (0..out_of_line.len()).filter(|&i| out_of_line[i]);
        for i in flagged() {
            least[i] = Some(least[i].map_or(1.0, |_| STUBBORN * lifts.windows[i]));
        }
        for near in flagged().flat_map(|i| neighbours(sensors, i)) {
            least[near].get_or_insert(1.0);
        }
        let raised = |(i, least): (usize, &Option<f64>)| {
            least.map_or(1.0, |least| spent(sensors, model, &motion, i).max(least).min(most(model)))
        };
        let raised: Vec<f64> = least.iter().enumerate().map(raised).collect();
        lifts = Lifts { windows: (0..raised.len()).map(|i| highest_around(&raised, i)).collect() };
        motion = smooth_rows(sensors, model, &lifts);
    }
    motion
}

/// The windows before and after window `i`, as far as the next that has a reading of the angle.
fn neighbours(sensors: &Sensors<'_>, i: usize) -> RangeInclusive<usize> {
    let read = |rows: &[f64]| rows.iter().any(|theta| theta.is_finite());
    let windows = sensors.theta.chunks(WINDOW);
    let after = windows.clone().skip(i + 1).position(read).map_or(i, |gap| i + 1 + gap);
    let before = windows.take(i).rev().position(read).map_or(i, |gap| i - 1 - gap);
    before..=after
}

/// The highest of window `i` and those beside it: when in a sample an impact falls is not known, and sensors
/// do not all see it at once.
fn highest_around(raised: &[f64], i: usize) -> f64 {
    raised[i.saturating_sub(1)..(i + 2).min(raised.len())].iter().copied().fold(1.0, f64::max)
}

/// The most that jerk is raised.
fn most(model: &Model) -> f64 {
    (MOST * model.variance[0].sqrt() / model.jerk).max(1.0)
}

/// Windows whose readings lie off the motion by more than chance.
fn out_of_line(sensors: &Sensors<'_>, model: &Model, motion: &Motion) -> Vec<bool> {
    let sums = sums(sensors, model, motion);
    let spreads = sums.each_ref().map(|sums| spread(sums));
    beyond_chance(&sums, &spreads)
}

/// Of each sensor that is there, window by window: the sum of squares of its residuals in units of its noise, and
/// their degrees of freedom.
pub fn sums(sensors: &Sensors<'_>, model: &Model, motion: &Motion) -> [Vec<(f64, f64)>; 3] {
    let windows = || (0..sensors.len()).step_by(WINDOW).map(|k| k..(k + WINDOW).min(sensors.len()));
    let jumps = |i: usize, column: Option<&[f64]>| -> Vec<(f64, f64)> {
        let Some(column) = column.filter(|_| model.variance[i].is_finite()) else { return Vec::new() };
        let noise = model.variance[i] / model.scale[i].powi(2);
        windows().map(|rows| jumps_off(column, &motion.values[i], noise, rows)).collect()
    };
    let theta = windows().map(|rows| angles_off(sensors.theta, motion, model.variance[0], rows)).collect();
    [theta, jumps(1, sensors.omega), jumps(2, sensors.alpha)]
}

/// Residuals of the angle: sum of their squares in units of the noise, and the degrees of freedom that the
/// smoother leaves to them.
fn angles_off(theta: &[f64], motion: &Motion, noise: f64, rows: Range<usize>) -> (f64, f64) {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for k in rows.filter(|&k| theta[k].is_finite()) {
        squares += (theta[k] - motion.values[0][k]).powi(2) / noise;
        freedom += (1.0 - motion.sds[0][k].powi(2) / noise).max(0.0);
    }
    (squares, freedom)
}

/// Residuals of a rate: only what changes from sample to sample counts, so that a sensor with a wrong gain, a
/// lag or a drift does not pass for an impact. As (a - b)^2 / 4 <= (a^2 + b^2) / 2, chance does no more to
/// these than to the residuals.
fn jumps_off(rate: &[f64], motion: &[f64], noise: f64, rows: Range<usize>) -> (f64, f64) {
    let (mut squares, mut freedom) = (0.0, 1.0);
    for k in rows.start.max(1)..rows.end {
        let change = (rate[k] - motion[k]) - (rate[k - 1] - motion[k - 1]);
        if change.is_finite() {
            squares += change * change / (4.0 * noise);
            freedom += 1.0;
        }
    }
    (squares, freedom)
}

/// How much larger the sums of a sensor are than those of white noise, at least 1. Noise that is not white has
/// larger ones everywhere: if a tenth of them are larger than white noise has them, all are measured by that
/// (overdispersion: P. McCullagh and J. A. Nelder, "Generalized Linear Models", Chapman and Hall 1989, section
/// 4.5; by a quantile, as the impacts must not count).
pub fn spread(sums: &[(f64, f64)]) -> f64 {
    let mut ratios: Vec<f64> =
        sums.iter().filter(|sum| sum.1 > 0.5).map(|(squares, freedom)| squares / freedom).collect();
    let tenth = ratios.len() * 9 / 10;
    if ratios.is_empty() {
        return 1.0;
    }
    (*ratios.select_nth_unstable_by(tenth, f64::total_cmp).1 / UPPER_TENTH).max(1.0)
}

/// In which windows the sums of any sensor, of that spread, are too large for chance.
pub fn beyond_chance(sums: &[Vec<(f64, f64)>; 3], spreads: &[f64; 3]) -> Vec<bool> {
    let mut found = vec![false; sums[0].len()];
    for (sums, spread) in sums.iter().zip(spreads) {
        let beyond = sums.iter().map(|(squares, freedom)| *squares > spread * chance(*freedom));
        found.iter_mut().zip(beyond).for_each(|(found, beyond)| *found |= beyond);
    }
    found
}

/// What a chi-square exceeds once in exp(UNLIKELY) at most (B. Laurent and P. Massart, Annals of Statistics
/// 28(5), 2000, lemma 1).
fn chance(freedom: f64) -> f64 {
    freedom + 2.0 * (freedom * UNLIKELY).sqrt() + 2.0 * UNLIKELY
}

/// The jerk that the motion spent in window `i`, with a margin, in units of the usual.
fn spent(sensors: &Sensors<'_>, model: &Model, motion: &Motion, i: usize) -> f64 {
    let last = ((i + 1) * WINDOW).min(sensors.len()) - 1;
    let first = (i * WINDOW).saturating_sub(1);
    let alpha = &motion.values[2][first..=last];
    let jumps: f64 = alpha.windows(2).map(|pair| ((pair[1] - pair[0]) * model.scale[2]).powi(2)).sum();
    // Over one step, jerk adds a quarter of its square to the variance of alpha h^2 / 2.
    let steps = (sensors.t[last] - sensors.t[first]) / model.scale[1];
    (MARGIN * 4.0 * jumps / steps).sqrt() / model.jerk
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_counts_with_those_beside_it() {
        let raised = [2.0, 1.0, 1.0, 1.0, 1.0, 5.0, 1.0, 7.0];
        let highest: Vec<f64> = (0..8).map(|i| highest_around(&raised, i)).collect();
        assert_eq!(highest, [2.0, 2.0, 1.0, 1.0, 5.0, 5.0, 7.0, 7.0]);
    }

    #[test]
    fn noise_is_as_much_larger_as_its_squares_for_each_degree_of_freedom() {
        for freedom in [2.0, 10.0] {
            assert!((spread(&vec![(4.0 * freedom, freedom); 50]) * UPPER_TENTH - 4.0).abs() < 1e-12);
        }
        assert_eq!(spread(&[(0.1, 5.0); 9]), 1.0);
    }

    #[test]
    fn of_many_degrees_of_freedom_chance_is_that_of_a_normal_number() {
        // exp(-z^2 / 2) bounds how often a normal number exceeds z.
        let (freedom, least) = (1e8_f64, (2.0 * UNLIKELY).sqrt());
        let z = (chance(freedom) - freedom) / (2.0 * freedom).sqrt();
        assert!((least..1.01 * least).contains(&z), "{z} {least}");
        assert!(chance(0.0) >= 2.0 * UNLIKELY);
    }

    #[test]
    fn a_motion_of_the_usual_jerk_has_spent_as_much_but_for_the_margin() {
        let mut random = crate::random::Noise::new(6);
        let (n, step) = (4000, 2e-4);
        let t: Vec<f64> = (0..n).map(|k| step * f64::from(k)).collect();
        let theta = vec![0.0; t.len()];
        let sensors = Sensors { t: &t, theta: &theta, omega: None, alpha: None };
        for jerk in [1e2, 1e4] {
            let level = super::super::sensors::Noise {
                theta: 1e-4,
                omega: f64::INFINITY,
                alpha: f64::INFINITY,
                jerk,
            };
            let model = Model::new(&level, step);
            let mut motion = smooth_rows(&sensors, &model, &Lifts::default());
            // Its acceleration goes as a random walk, with this spectral density of the jerk.
            let mut alpha = 0.0;
            for value in &mut motion.values[2] {
                alpha += jerk * step.sqrt() * random.normal();
                *value = alpha;
            }
            let all: Vec<f64> = (0..t.len() / WINDOW).map(|i| spent(&sensors, &model, &motion, i)).collect();
            let mean = all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64;
            assert!((mean / MARGIN - 1.0).abs() < 0.1, "{jerk}: {mean}");
        }
    }
}
