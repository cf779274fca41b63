//! Torque drift: the baseline of the torque sensor creeps.

use super::{Effect, SensorEffect, Survey};
use crate::motion::Motion;
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// tau + d (t/T)^n + e exp(-t/tau_e): a creep by a power of time, and a transient of a sensor that settles.
///
/// A constant is left out, for the difference of `coulomb` pos and neg holds it.
pub struct TorqueDrift;

/// Times below this share of a unit are the start.
const START: f64 = 1e-6;

impl Effect<4> for TorqueDrift {
    const ID: &'static str = "torque_drift";
    const LAW: &'static str = "tau + d t^n + e exp(-t/T)";
    const SOURCE: &'static str = "zero drift and creep of strain-gauge sensors; OIML R 60";
    const SHOWS: &'static str = "over time, whatever the motion";
    const CONFUSED: &'static [&'static str] = &["friction_drift"];
    const PARAMS: [Param; 4] = [
        Param::linear("d", Unit::of(1, 0, 0), "creep after a second"),
        Param::shape("n", Unit::NUMBER, [0.1, 4.0], 1.0, "power of time"),
        Param::linear("e", Unit::of(1, 0, 0), "transient at the start"),
        Param::shape("T", Unit::of(0, 0, 1), [1e-3, 1e6], 1.0, "time constant of the transient"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 4]> {
        let share = |s: f64| (s * survey.duration_s).max(1e-3);
        [[0.5, 0.1], [1.0, 0.1], [1.0, 0.3], [2.0, 0.1]]
            .into_iter()
            .map(|[n, s]| [0.0, n, 0.0, share(s)])
            .collect()
    }
}

impl SensorEffect<4> for TorqueDrift {
    #[inline(always)]
    fn sense<T: Scalar>([d, n, e, constant]: &[T; 4], motion: &Motion<T>, tau: T) -> T {
        let creep = *d * motion.t.max(T::of(START)).powf(*n);
        tau + creep + *e * (-motion.t / *constant).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_baseline_creeps_whatever_the_torque() {
        let at = |t: f64, tau: f64| {
            TorqueDrift::sense(&[0.5, 2.0, 0.0, 1.0], &Motion::exact(t, 0.0, 1.0, 0.0), tau)
        };
        assert!((at(3.0, 1.0) - 5.5).abs() < 1e-12 && (at(3.0, -1.0) - 3.5).abs() < 1e-12);
    }
}
