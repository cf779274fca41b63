//! How strongly the motion is driven, by cross-validation.
//!
//! Each sample is predicted from all others; the best jerk predicts best. No sample need be left out for
//! it: with residual e = z - x_smooth and p the share of the sensor's variance that the smoother keeps,
//! the error of that prediction is e / (1 - p) (G. Wahba, "Spline Models for Observational Data", SIAM 1990,
//! section 4.2).
//!
//! Why not the likelihood of the filter's innovations: it is right when the jerk truly is white. Hand and motor
//! motion is smoother than that, and then the likelihood follows the noise too closely (G. Wahba, "A comparison
//! of GCV and GML for choosing the smoothing parameter in the generalized spline smoothing problem", Annals of
//! Statistics 13(4), 1985): its velocities are then noisier than those of cross-validation. The
//! standard deviations that go with a cross-validated smoother cover the truth on average over the capture
//! (G. Wahba, Journal of the Royal Statistical Society B 45(1), 1983).

use super::activity::stretches;
use super::lifts::Lifts;
use super::rts::smooth_rows;
use super::sensors::{Noise, Sensors};
use super::state::Model;

/// Shortest memory that is tried, in readings: the smoother then passes through every sample.
const SHORTEST_MEMORY: f64 = 0.05;

/// The same of an encoder's counts: as many samples as are off by nearly as much where it is a little slow. Where most
/// are, it is [`Reading::Stairs`].
const COUNTS: f64 = 10.0;

/// The same of stairs, in samples, and the fewest of them. A stair of few samples is read little better than a count,
/// and the errors of those beside it are as much alike; one of many is read to a small part of a count.
const STAIRS: f64 = 30.0;
const FEWEST_STAIRS: f64 = 2.0;

/// Standard deviations by which no count is off, and hardly a reading.
const FAR: f64 = 4.0;

/// Share of the readings that may be: those around impacts.
const SELDOM: f64 = 0.1;

/// Longest memory that is tried.
const LONGEST_MEMORY: f64 = 1e4;

/// The next memory that is tried is this many times longer.
const LONGER: f64 = 3.0;

/// Samples in a stretch, at first.
const LENGTH: usize = 1024;

/// A stretch must be this many memories long to tell them apart; if the best is longer, longer stretches
/// are taken.
const SPAN: f64 = 16.0;

/// Longer memories are not tried once the error is this many times the least.
const HOPELESS: f64 = 10.0;

/// The memory is found to within this part of itself; less hardly matters.
const ENOUGH: f64 = 0.1;

/// Least share of a sample's variance that others must decide for it to say something about the jerk.
const TOO_FREE: f64 = 1e-9;

/// Samples at either end of a stretch that are smoothed but not counted. An end lacks neighbours; a stretch
/// has many more ends per sample than a capture, and would ask for too lively a jerk.
const MARGIN: usize = 20;

/// How theta is read, where no other sensor speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Each with a noise of its own.
    Free,
    /// In counts of an encoder: while it is slow, neighbours are off by nearly as much.
    Counted,
    /// One per stair of a slow encoder.
    Stairs,
}

/// `noise` with the jerk that predicts each sample best from the others. The errors of neighbouring counts and
/// stairs are alike, so that they predict one another, and a memory as short as that would be believed.
pub fn jerk_by_cross_validation(sensors: &Sensors<'_>, noise: Noise, reading: Reading) -> Noise {
    let step = sensors.step();
    // Memory L is reached when jerk h^(5/2) = theta noise / L^3.
    let with = |memory: f64| Noise { jerk: noise.theta / (memory.powi(3) * step.powf(2.5)), ..noise };
    let readings = sensors.theta.iter().filter(|theta| theta.is_finite()).count();
    let spacing = sensors.len() as f64 / readings as f64;
    let alone = noise.omega.is_infinite() && noise.alpha.is_infinite();
    let mut shortest = match reading {
        _ if !alone => SHORTEST_MEMORY,
        Reading::Free => SHORTEST_MEMORY * spacing,
        Reading::Counted => COUNTS * spacing,
        Reading::Stairs => (STAIRS / spacing).clamp(FEWEST_STAIRS, COUNTS) * spacing,
    };
    let mut length = ((LENGTH as f64 * spacing) as usize).min(sensors.len());
    // An encoder that rests now and then is not slow for that: a memory that leaves so much is too long.
    let far = |memory: f64| {
        let model = Model::new(&with(memory), step);
        stretches(sensors, length).iter().map(|part| share_far(part, &model, &noise)).fold(0.0, f64::max)
    };
    while shortest > SHORTEST_MEMORY * spacing && far(shortest) > SELDOM {
        shortest /= LONGER;
    }
    loop {
        let parts = stretches(sensors, length);
        let whole = parts.len() == 1;
        let longest = if whole { LONGEST_MEMORY } else { length as f64 / SPAN };
        let memory = best_memory(shortest, longest, |memory| {
            let model = Model::new(&with(memory), step);
            parts.iter().map(|part| prediction_error(part, &model, &noise)).sum()
        });
        if whole || memory < longest / LONGER {
            return with(memory);
        }
        shortest = (memory / LONGER).max(shortest);
        length = (4 * length).min(sensors.len());
    }
}

/// The memory of least `cost`: a coarse scan from the shortest, then a golden section around the best.
fn best_memory(shortest: f64, longest: f64, cost: impl Fn(f64) -> f64) -> f64 {
    let (mut best, mut least) = (shortest, f64::INFINITY);
    let mut memory = shortest;
    while memory <= longest {
        let error = cost(memory);
        if error < least {
            (best, least) = (memory, error);
        } else if error > HOPELESS * least {
            break;
        }
        memory *= LONGER;
    }
    let (low, high) = ((best / LONGER).max(shortest), (best * LONGER).min(longest));
    golden_section(|log| cost(log.exp()), low.ln(), high.ln()).exp()
}

/// Sum of the squared errors of predicting each sample from all others, in units of the sensor's noise.
fn prediction_error(sensors: &Sensors<'_>, model: &Model, noise: &Noise) -> f64 {
    let level = [noise.theta, noise.omega, noise.alpha];
    let motion = smooth_rows(sensors, model, &Lifts::default());
    let mut sum = 0.0;
    let margin = MARGIN.min(sensors.len() / 8);
    let mut before: [(f64, f64); 3] = [(f64::NAN, 0.0); 3];
    for k in margin..sensors.len() - margin {
        let z = sensors.row(k);
        for i in (0..3).filter(|&i| z[i].is_finite() && level[i].is_finite()) {
            // Most are as sure as the one before.
            let sd = motion.sds[i][k];
            if before[i].0 != sd {
                let kept = (sd * model.scale[i]).powi(2) / model.variance[i];
                before[i] = (sd, ((1.0 - kept).max(TOO_FREE) * level[i]).recip());
            }
            sum += ((z[i] - motion.values[i][k]) * before[i].1).powi(2);
        }
    }
    if sum.is_finite() { sum } else { f64::INFINITY }
}

/// Share of the angles that lie far off the motion.
fn share_far(sensors: &Sensors<'_>, model: &Model, noise: &Noise) -> f64 {
    let motion = smooth_rows(sensors, model, &Lifts::default());
    let pairs = sensors.theta.iter().zip(&motion.values[0]).filter(|(theta, _)| theta.is_finite());
    let (far, all) = pairs.fold((0.0, 0.0), |(far, all), (theta, smooth)| {
        (far + f64::from((theta - smooth).abs() > FAR * noise.theta), all + 1.0)
    });
    far / f64::max(all, 1.0)
}

/// Minimum of `f` between `low` and `high` (J. Kiefer, Proceedings of the AMS 4, 1953).
fn golden_section(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut left, mut right) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_left, mut at_right) = (f(left), f(right));
    while high - low > ENOUGH {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = f(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = f(right);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_least_cost_is_found_wherever_it_lies() {
        for right in [1.0, 3.0, 17.0, 90.0, 100.0] {
            let found = best_memory(1.0, 100.0, |memory: f64| 1.0 + (memory / right).ln().powi(2));
            assert!((found / right).ln().abs() < 2.0 * ENOUGH, "{found} {right}");
        }
    }

    #[test]
    fn of_two_dips_of_the_cost_the_deeper_one_is_found() {
        // In steps of the scan: a shallow one at 2.7, where a search through all of it would first look, a deep one at 6.
        let cost = |memory: f64| {
            let at = memory.ln() / LONGER.ln();
            f64::min(1.2 + (at - 2.7).powi(2), 1.0 + 4.0 * (at - 6.0).powi(2))
        };
        for unit in [1e-3, 1.0, 1e3] {
            let found = best_memory(1.0, 1e4, |memory| unit * cost(memory)).ln() / LONGER.ln();
            assert!((found - 6.0).abs() < 2.0 * ENOUGH, "{found}");
        }
    }
}
