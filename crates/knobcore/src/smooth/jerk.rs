//! How strongly the motion is driven, by cross-validation.
//!
//! Each sample is predicted from all others; the best jerk predicts best. No sample need be left out for
//! it: with residual e = z - x_smooth and p the share of the sensor's variance that the smoother keeps,
//! the error of that prediction is e / (1 - p) (G. Wahba, "Spline Models for Observational Data", SIAM 1990,
//! theorem 4.2.1).
//!
//! Why not the likelihood of the filter's innovations: it is right when the jerk truly is white. Hand and motor
//! motion is smoother than that, and then the likelihood follows the noise too closely (G. Wahba, "A comparison
//! of GCV and GML for choosing the smoothing parameter in the generalized spline smoothing problem", Annals of
//! Statistics 13(4), 1985): on simulated knobs, velocity errors 1.1 to 2.5 times those of cross-validation. The
//! standard deviations that go with a cross-validated smoother cover the truth on average over the capture
//! (G. Wahba, Journal of the Royal Statistical Society B 45(1), 1983).

use super::activity::stretches;
use super::rts::smooth_rows;
use super::sensors::{Noise, Sensors};
use super::state::Model;

/// Memories of the smoother, in samples, among which the best is looked for: 0.05, 0.15, ... 10^4.
const SHORTEST_MEMORY: f64 = 0.05;
const LONGER: f64 = 3.0;
const MEMORIES: i32 = 12;

/// Longer memories are not tried once the error is this many times the least.
const HOPELESS: f64 = 10.0;

/// The jerk is found to within this part of its logarithm; its error hardly matters below.
const ENOUGH: f64 = 0.3;

/// Least share of a sample's variance that others must decide for it to say something about the jerk.
const TOO_FREE: f64 = 1e-9;

/// `noise` with the jerk that predicts each sample best from the others.
pub fn jerk_by_cross_validation(sensors: &Sensors<'_>, noise: Noise) -> Noise {
    let step = sensors.step();
    let parts = stretches(sensors);
    let with = |log_jerk: f64| Noise { jerk: log_jerk.exp(), ..noise };
    let cost = |log_jerk: f64| {
        let model = Model::new(&with(log_jerk), step);
        parts.iter().map(|part| prediction_error(part, &model, &noise)).sum::<f64>()
    };
    let (mut best, mut least) = (0.0, f64::INFINITY);
    for i in 0..MEMORIES {
        let memory = SHORTEST_MEMORY * LONGER.powi(i);
        let log_jerk = (noise.theta / (memory.powi(3) * step.powf(2.5))).ln();
        let error = cost(log_jerk);
        if error < least {
            (best, least) = (log_jerk, error);
        } else if error > HOPELESS * least {
            break;
        }
    }
    let width = 3.0 * LONGER.ln();
    with(golden_section(cost, best - width, best + width))
}

/// Sum of the squared errors of predicting each sample from all others, in units of the sensor's noise.
fn prediction_error(sensors: &Sensors<'_>, model: &Model, noise: &Noise) -> f64 {
    let level = [noise.theta, noise.omega, noise.alpha];
    let motion = smooth_rows(sensors, model);
    let mut sum = 0.0;
    for k in 0..sensors.len() {
        let z = sensors.row(k);
        for i in (0..3).filter(|&i| z[i].is_finite() && level[i].is_finite()) {
            let kept = (motion.sds[i][k] * model.scale[i]).powi(2) / model.variance[i];
            let error = (z[i] - motion.values[i][k]) / (1.0 - kept).max(TOO_FREE);
            sum += (error / level[i]).powi(2);
        }
    }
    if sum.is_finite() { sum } else { f64::INFINITY }
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
