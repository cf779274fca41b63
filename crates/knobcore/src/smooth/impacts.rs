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

use super::lifts::{Lifts, WINDOW};
use super::rts::{Motion, smooth_rows};
use super::sensors::Sensors;
use super::state::Model;

/// Runs of the smoother at most.
const RUNS: usize = 6;

/// A window is out of line if chance alone does that once in exp(30).
const UNLIKELY: f64 = 30.0;

/// The jerk variance of a window is taken this many times what the last run spent there.
const MARGIN: f64 = 4.0;

/// A window that is out of line still is raised by this factor from run to run.
const STUBBORN: f64 = 8.0;

/// The jerk is not raised beyond the point where it moves the angle in one step by this many times its noise:
/// there the smoother passes through every sample.
const MOST: f64 = 1e4;

/// The motion, with the jerk of `model` except where there are impacts.
pub fn smooth_with_impacts(sensors: &Sensors<'_>, model: &Model) -> Motion {
    let mut lifts = Lifts::default();
    let mut motion = smooth_rows(sensors, model, &lifts);
    // The least that each window is raised; none where the motion is smooth.
    let mut least: Vec<Option<f64>> = Vec::new();
    let runs: usize = std::env::var("RUNS").map_or(RUNS,|x|x.parse().unwrap());
    let esc: f64 = std::env::var("ESC").map_or(STUBBORN,|x|x.parse().unwrap());
    for _ in 1..runs {
        let out_of_line = out_of_line(sensors, model, &motion);
        if !out_of_line.contains(&true) {
            break;
        }
        least.resize(out_of_line.len(), None);
        let flagged = || (0..out_of_line.len()).filter(|&i| out_of_line[i]);
        for i in flagged() {
            least[i] = Some(least[i].map_or(1.0, |_| esc * lifts.windows[i]));
        }
        for near in flagged().flat_map(|i| neighbours(sensors, i)) {
            least[near].get_or_insert(1.0);
        }
        let spent = |(i, least): (usize, &Option<f64>)| {
            least.map_or(1.0, |least| spent(sensors, model, &motion, i).max(least).min(most(model)))
        };
        lifts = Lifts { windows: least.iter().enumerate().map(spent).collect() };
        if let Ok(w)=std::env::var("DBG"){let w:usize=w.parse().unwrap(); eprintln!("{:?} {:?} rough {} oo {}",lifts.windows[w-6..w+7].iter().map(|x|(x*10.0).round()/10.0).collect::<Vec<_>>(),&out_of_line[w-6..w+7].iter().map(|x|u8::from(*x)).collect::<Vec<_>>(),least.iter().filter(|x|x.is_some()).count(),out_of_line.iter().filter(|x|**x).count());}
        motion = smooth_rows(sensors, model, &lifts);
    }
    motion
}

/// The windows before and after window `i`, as far as the next that has a reading of the angle.
fn neighbours(sensors: &Sensors<'_>, i: usize) -> std::ops::RangeInclusive<usize> {
    let read = |rows: &[f64]| rows.iter().any(|theta| theta.is_finite());
    let windows = sensors.theta.chunks(WINDOW);
    let after = windows.clone().skip(i + 1).position(read).map_or(i, |gap| i + 1 + gap);
    let before = windows.take(i).rev().position(read).map_or(i, |gap| i - 1 - gap);
    before..=after
}

/// The most that jerk is raised.
fn most(model: &Model) -> f64 {
    (MOST * model.variance[0].sqrt() / model.jerk).max(1.0)
}

/// Windows whose angles lie off the motion by more than chance: the sum of squares of
/// the residuals, in units of the noise, has the tail of a chi-square with the degrees of freedom that the
/// smoother leaves to them, or less (B. Laurent and P. Massart, Annals of Statistics 28(5), 2000, lemma 1).
fn out_of_line(sensors: &Sensors<'_>, model: &Model, motion: &Motion) -> Vec<bool> {
    let unl: f64 = std::env::var("UNL").map_or(UNLIKELY,|x|x.parse().unwrap());
    let rows = sensors.theta.chunks(WINDOW);
    let (values, sds) = (motion.values[0].chunks(WINDOW), motion.sds[0].chunks(WINDOW));
    let windows = rows.zip(values).zip(sds);
    windows
        .map(|((theta, value), sd)| {
            let (mut squares, mut freedom) = (0.0, 0.0);
            for k in (0..theta.len()).filter(|&k| theta[k].is_finite()) {
                squares += (theta[k] - value[k]).powi(2) / model.variance[0];
                freedom += (1.0 - sd[k] * sd[k] / model.variance[0]).max(0.0);
            }
            squares > freedom + 2.0 * (freedom * unl).sqrt() + 2.0 * unl
        })
        .collect()
}

/// The jerk that the motion spent in window `i`, with a margin, in units of the usual.
fn spent(sensors: &Sensors<'_>, model: &Model, motion: &Motion, i: usize) -> f64 {
    let last = ((i + 1) * WINDOW).min(sensors.len()) - 1;
    let first = (i * WINDOW).saturating_sub(1);
    let alpha = &motion.values[2][first..=last];
    let jumps: f64 = alpha.windows(2).map(|pair| ((pair[1] - pair[0]) * model.scale[2]).powi(2)).sum();
    // Over one step, jerk adds a quarter of its square to the variance of alpha h^2 / 2.
    let steps = (sensors.t[last] - sensors.t[first]) / model.scale[1];
    (std::env::var("MARGIN").map_or(MARGIN,|x|x.parse().unwrap()) * 4.0 * jumps / steps).sqrt() / model.jerk
}
