//! End stop: a stiff ramp beyond an angle, on each side.

use super::{Effect, LoadEffect, Survey};
use crate::motion::{Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// k_hi above - k_lo below + d (above + below) omega, where above = max(theta - hi, 0), below = max(lo - theta, 0).
///
/// The damping grows with the depth, so that the torque has no step where a stop begins (Hunt & Crossley 1975).
pub struct EndStop;

impl Effect<5> for EndStop {
    const ID: &'static str = "end_stop";
    const LAW: &'static str =
        "k_hi x_hi - k_lo x_lo + d (x_hi + x_lo) omega, x_hi = max(theta - hi, 0), x_lo = max(lo - theta, 0)";
    const SOURCE: &'static str = "Hunt & Crossley 1975 (damping in impacts), its exponent 1";
    const SHOWS: &'static str = "over position, at the ends of the range";
    const CONFUSED: &'static [&'static str] = &["position_polynomial", "return_spring"];
    const PARAMS: [Param; 5] = [
        Param::linear("k_lo", Unit::of(1, -1, 0), "stiffness of the lower stop")
            .plausibly(0.0, f64::INFINITY),
        Param::shape("lo", Unit::of(0, 1, 0), [-1e6, 1e6], -1e6, "where the lower stop begins"),
        Param::linear("k_hi", Unit::of(1, -1, 0), "stiffness of the upper stop")
            .plausibly(0.0, f64::INFINITY),
        Param::shape("hi", Unit::of(0, 1, 0), [-1e6, 1e6], 1e6, "where the upper stop begins"),
        Param::linear("d", Unit::of(1, -2, 1), "damping within a stop, by depth")
            .plausibly(0.0, f64::INFINITY),
    ];

    fn odd(&[k_lo, lo, k_hi, hi, _]: &[f64; 5]) -> Option<&'static str> {
        let overlap = k_lo != 0.0 && k_hi != 0.0 && lo >= hi;
        overlap.then_some("its stops overlap: between them they are a spring and no stops")
    }

    fn starts(survey: &Survey) -> Vec<[f64; 5]> {
        let (low, range) = (Survey::quantile(&survey.theta, 0.0), survey.range());
        let at = |share: f64| low + share * range;
        [0.03, 0.08, 0.15, 0.25, 0.4].into_iter().map(|x| [0.0, at(x), 0.0, at(1.0 - x), 0.0]).collect()
    }
}

impl LoadEffect<5> for EndStop {
    #[inline(always)]
    fn load<T: Scalar>([k_lo, lo, k_hi, hi, d]: &[T; 5], motion: &Motion<T>) -> Load<T> {
        let zero = T::of(0.0);
        let above = (motion.theta - *hi).max(zero);
        let below = (*lo - motion.theta).max(zero);
        Load::drive(*k_hi * above - *k_lo * below + *d * (above + below) * motion.omega)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_silent_between_and_pushes_back_beyond() {
        let torque = |theta: f64| {
            EndStop::load(&[2.0, -1.0, 3.0, 1.0, 0.0], &Motion::exact(0.0, theta, 0.5, 0.0)).drive
        };
        assert_eq!((torque(-1.0), torque(0.3), torque(1.0)), (0.0, 0.0, 0.0));
        assert_eq!((torque(-1.5), torque(2.0)), (-1.0, 3.0));
    }

    #[test]
    fn a_knob_that_bounces_off_leaves_energy_in_the_stop() {
        let torque = |omega: f64| {
            EndStop::load(&[2.0, -1.0, 3.0, 1.0, 0.4], &Motion::exact(0.0, 1.5, omega, 0.0)).drive
        };
        assert!((torque(0.5) - 1.6).abs() < 1e-12 && (torque(-0.5) - 1.4).abs() < 1e-12);
    }
}
