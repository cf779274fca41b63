//! Torque drift: the baseline of the torque sensor creeps.

use super::{Carrier, Context, Effect, Id, Over, SensorEffect, Survey, Words};
use crate::motion::Motion;
use crate::param::{Param, Unit, Usual};
use crate::prelude::*;
use crate::scalar::Scalar;
use nalgebra::{Matrix4, Vector4};

/// tau + d t^n + e exp(-t/T) + sum of c_k cos(pi k t/L): a creep by a power of time, a transient of a sensor that
/// settles, and what wanders slowly within the length L of the capture.
///
/// A constant is left out, for the difference of `coulomb` pos and neg holds it.
pub struct TorqueDrift;

/// A torque of which position explains this share is one over position,
const FOLLOWS: f64 = 0.9;
/// if the motion goes this many times its range, there and back.
const RETURNS: f64 = 1.25;
/// Moments at which that is asked, about.
const MOMENTS: usize = 1000;
/// Times below this share of a unit are the start.
const START: f64 = 1e-6;

const fn wave(name: &'static str, meaning: &'static str) -> Param {
    Param::linear(name, Unit::of(1, 0, 0), meaning).of_a_run()
}

impl Effect<8> for TorqueDrift {
    const ID: &'static str = "torque_drift";
    const LAW: &'static str = "tau + d t^n + e exp(-t/T) + sum of c_k cos(pi k t/L), k = 1, 2, 3";
    const SOURCE: &'static str = "zero drift and creep of strain-gauge sensors; OIML R 60";
    const SHOWS: &'static str = "over time, whatever the motion";
    const CONFUSED: &'static [&'static str] = &["friction_drift"];
    const WORDS: Words = Words {
        title: "torque drift",
        name: "the zero of the torque reading drifts",
        about: "The reading creeps over time whatever the knob does.",
        causes: &[
            "a sensor or an amplifier that warms up",
            "creep of a strain gauge and its glue after a load",
            "a cable that pulls on the sensor",
        ],
        remedies: &[
            "switch on half an hour before recording",
            "set the zero before each capture",
            "fix cables, and shield the sensor from draught",
        ],
        latex: r"\tau + d\,t^{\,n} + e\,e^{-t/T} + \sum_{k=1}^{3} c_k \cos\frac{\pi k\,t}{L}",
    };
    const OVER: Over = Over::Time;
    const GIVEN: Option<&'static str> = Some("a voltage that a motor is given has no zero that drifts");
    const PARAMS: [Param; 8] = [
        wave("d", "creep after a second"),
        Param::shape("n", Unit::NUMBER, [0.1, 4.0], 1.0, "power of time"),
        wave("e", "transient at the start"),
        Param::shape("T", Unit::of(0, 0, 1), [1e-3, 1e6], 1.0, "time constant of the transient"),
        wave("c1", "half a wave over L"),
        wave("c2", "a wave over L"),
        wave("c3", "a wave and a half over L"),
        Param::shape("L", Unit::of(0, 0, 1), [1e-3, 1e9], 1.0, "length of the capture").usually(Usual::Fixed),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 8]> {
        let share = |s: f64| (s * survey.duration_s).max(1e-3);
        let shapes = [[0.5, 0.1], [1.0, 0.1], [1.0, 0.3], [2.0, 0.1]];
        shapes.map(|[n, s]| [0.0, n, 0.0, share(s), 0.0, 0.0, 0.0, share(1.0)]).into()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 8] {
        // A transient that dies away, on a creep over the whole capture.
        let length = carrier.survey.duration_s.max(1e-3);
        carrier.sized(Id::TorqueDrift, [carrier.floor, 100.0 * carrier.floor], |torque| {
            let [c1, c2, c3] = [0.1, 0.1, -0.05].map(|share| share * torque);
            [torque / length, 1.0, 0.7 * torque, 0.15 * length, c1, c2, c3, length]
        })
    }

    /// What has the same value again wherever the knob comes by again is no matter of time.
    fn implausible(p: &[f64; 8], context: &Context) -> Vec<String> {
        let every = 1 + context.theta.len() / MOMENTS;
        let theta: Vec<f64> = context.theta.iter().step_by(every).copied().collect();
        let way: f64 = theta.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        if way < RETURNS * context.travel() {
            return Vec::new();
        }
        let drift = |t: &f64| Self::sense(p, &Motion::exact(*t, 0.0, 0.0, 0.0), 0.0);
        let drift: Vec<f64> = context.t.iter().step_by(every).map(drift).collect();
        if over_position(&theta, &drift, context.travel()) < FOLLOWS {
            return Vec::new();
        }
        vec!["it follows the position, there and back: it is a torque over position".into()]
    }
}

/// The share of the variance of `y` that a cubic in positions of some range explains.
fn over_position(theta: &[f64], y: &[f64], range: f64) -> f64 {
    let middle = theta.iter().sum::<f64>() / theta.len() as f64;
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    let (mut gram, mut slope, mut squares) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
    for (theta, y) in theta.iter().zip(y) {
        let x = (theta - middle) / range;
        let powers = Vector4::new(1.0, x, x * x, x * x * x);
        gram += powers * powers.transpose();
        slope += powers * (y - mean);
        squares += (y - mean).powi(2);
    }
    gram.cholesky().map_or(0.0, |gram| slope.dot(&gram.solve(&slope)) / squares)
}

impl SensorEffect<8> for TorqueDrift {
    #[inline(always)]
    fn sense<T: Scalar>([d, n, e, constant, c1, c2, c3, length]: &[T; 8], motion: &Motion<T>, tau: T) -> T {
        let creep = *d * motion.t.max(T::of(START)).powf(*n);
        let (s, c) = (T::of(core::f64::consts::PI) * motion.t / *length).sin_cos();
        let (s2, cos2) = (T::of(2.0) * s * c, c * c - s * s);
        let waves = *c1 * c + *c2 * cos2 + *c3 * (cos2 * c - s2 * s);
        tau + creep + *e * (-motion.t / *constant).exp() + waves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_baseline_creeps_whatever_the_torque() {
        let at = |t: f64, tau: f64| {
            TorqueDrift::sense(
                &[0.5, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
                &Motion::exact(t, 0.0, 1.0, 0.0),
                tau,
            )
        };
        assert!((at(3.0, 1.0) - 5.5).abs() < 1e-12 && (at(3.0, -1.0) - 3.5).abs() < 1e-12);
    }

    #[test]
    fn a_drift_that_is_a_spring_over_a_motion_there_and_back_is_none() {
        let theta: Vec<f64> =
            (0..5000).map(|i| (f64::from(i) * core::f64::consts::PI / 2500.0).cos()).collect();
        let said = |p: &[f64; 8], theta: &[f64]| {
            let context = Context {
                t: (0..5000).map(|i| f64::from(i) * 1e-3).take(theta.len()).collect(),
                theta: theta.to_vec(),
                ..Context::default()
            };
            TorqueDrift::implausible(p, &context).len()
        };
        let [spring, creep] =
            [[0.0, 1.0, 0.0, 1.0, 0.0, 0.3, 0.0, 5.0], [0.1, 1.0, 0.2, 0.5, 0.0, 0.0, 0.0, 5.0]];
        assert_eq!([said(&spring, &theta), said(&creep, &theta), said(&spring, &theta[..2500])], [1, 0, 0]);
    }
}
