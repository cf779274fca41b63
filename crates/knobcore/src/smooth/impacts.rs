//! Impacts: where the motion is rougher than its usual jerk allows, and there only, the jerk is raised.
//!
//! A knob that slips, hits its end stop or takes up backlash changes its acceleration within a sample. At the
//! jerk of the rest of the capture the smoother rounds that off over its whole memory, before and after. The
//! angles then lie off the smoothed motion by far more than their noise; windows where they do are found by
//! chi-square, and the smoother runs again with more jerk in them.
//!
//! How much: what the last run spent there, with a margin. A run spreads an impact over all windows that were
//! raised, but most of it lies where it happened, so that from run to run the raised windows close in on it
//! and the others fall back to the usual jerk (the re-weighting of I. F. Gorodnitsky and B. D. Rao, "Sparse
//! signal reconstruction from limited data using FOCUSS", IEEE Transactions on Signal Processing 45(3), 1997;
//! here window by window and never below the usual jerk).

use super::lifts::Lifts;
use super::rts::{Motion, smooth_rows};
use super::sensors::Sensors;
use super::state::Model;

/// Readings of the angle in a window, about: a power of two.
const WINDOW_BITS: u32 = 3;

/// Runs of the smoother at most.
const RUNS: usize = 6;

/// A window is out of line if chance alone does that once in exp(30).
const UNLIKELY: f64 = 30.0;

/// The jerk variance of a window is taken this many times what the last run spent there.
const MARGIN: f64 = 4.0;

/// The jerk is not raised beyond the point where it moves the angle in one step by this many times its noise:
/// there the smoother passes through every sample.
const MOST: f64 = 1e4;

/// The motion, with the jerk of `model` except where there are impacts.
pub fn smooth_with_impacts(sensors: &Sensors<'_>, model: &Model) -> Motion {
    let mut motion = smooth_rows(sensors, model, &Lifts::default());
    let readings = sensors.theta.iter().filter(|theta| theta.is_finite()).count();
    let bits = WINDOW_BITS + (sensors.len() / readings).ilog2();
    let mut rough: Vec<bool> = Vec::new();
    for _ in 1..RUNS {
        let out_of_line = out_of_line(sensors, model, &motion, 1 << bits);
        if !out_of_line.contains(&true) {
            break;
        }
        rough.resize(out_of_line.len(), false);
        for i in (0..rough.len()).filter(|&i| out_of_line[i]) {
            rough[i.saturating_sub(1)..(i + 2).min(out_of_line.len())].fill(true);
        }
        let mut lifts = Lifts::usual(sensors.len(), bits);
        for (i, lift) in lifts.windows.iter_mut().enumerate().filter(|(i, _)| rough[*i]) {
            *lift = spent(sensors, model, &motion, i << bits, 1 << bits);
        }
        motion = smooth_rows(sensors, model, &lifts);
    }
    motion
}

/// Windows of `length` samples whose angles lie off the motion by more than chance: the sum of squares of
/// the residuals, in units of the noise, has the tail of a chi-square with the degrees of freedom that the
/// smoother leaves to them, or less (B. Laurent and P. Massart, Annals of Statistics 28(5), 2000, lemma 1).
fn out_of_line(sensors: &Sensors<'_>, model: &Model, motion: &Motion, length: usize) -> Vec<bool> {
    let rows = sensors.theta.chunks(length);
    let (values, sds) = (motion.values[0].chunks(length), motion.sds[0].chunks(length));
    let windows = rows.zip(values).zip(sds);
    windows
        .map(|((theta, value), sd)| {
            let (mut squares, mut freedom) = (0.0, 0.0);
            for k in (0..theta.len()).filter(|&k| theta[k].is_finite()) {
                squares += (theta[k] - value[k]).powi(2) / model.variance[0];
                freedom += (1.0 - sd[k] * sd[k] / model.variance[0]).max(0.0);
            }
            squares > freedom + 2.0 * (freedom * UNLIKELY).sqrt() + 2.0 * UNLIKELY
        })
        .collect()
}

/// The jerk that the motion spent from row `first` over `length` samples, with a margin, in units of the
/// usual.
fn spent(sensors: &Sensors<'_>, model: &Model, motion: &Motion, first: usize, length: usize) -> f64 {
    let last = (first + length).min(sensors.len()) - 1;
    let first = first.saturating_sub(1);
    let alpha = &motion.values[2][first..=last];
    let jumps: f64 = alpha.windows(2).map(|pair| ((pair[1] - pair[0]) * model.scale[2]).powi(2)).sum();
    // Over one step, jerk adds a quarter of its square to the variance of alpha h^2 / 2.
    let steps = (sensors.t[last] - sensors.t[first]) / model.scale[1];
    let jerk = (MARGIN * 4.0 * jumps / steps).sqrt();
    (jerk.min(MOST * model.variance[0].sqrt()) / model.jerk).max(1.0)
}
