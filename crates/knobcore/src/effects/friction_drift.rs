//! Friction drift: a knob that warms up.

use super::{Carrier, Effect, Id, LoadEffect, Survey, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Dry friction times 1 + rise exp(-t / tau), t since the start of the capture.
pub struct FrictionDrift;

impl Effect<2> for FrictionDrift {
    const ID: &'static str = "friction_drift";
    const LAW: &'static str = "coulomb (1 + rise exp(-t/tau))";
    const SOURCE: &'static str =
        "first-order warm-up; Armstrong-Helouvry, Dupont & Canudas de Wit 1994, section 2";
    const SHOWS: &'static str = "over time, with the sign of the motion";
    const CONFUSED: &'static [&'static str] = &["torque_drift", "position_friction"];
    const TOUCHES: &'static [Channel] = &[Channel::FrictionScale];
    const WORDS: Words = Words {
        title: "friction drift",
        name: "friction changes while the capture goes on",
        about: "Friction begins higher or lower than it ends, as grease warms up or spreads.",
        causes: &[
            "grease that is cold or has set at rest",
            "a bearing that warms up",
            "surfaces that wear in",
        ],
        remedies: &[
            "turn the knob for a minute before recording",
            "keep the temperature steady",
            "use a lubricant whose viscosity depends less on temperature",
        ],
        latex: r"C_{\pm} \left(1 + r\,e^{-t/T}\right) \operatorname{sgn}\omega",
    };
    const PARAMS: [Param; 2] = [
        Param::shape(
            "rise",
            Unit::NUMBER,
            [-0.99, 100.0],
            0.0,
            "excess at the start, a share of the dry friction",
        )
        .of_a_run(),
        Param::shape("tau", Unit::of(0, 0, 1), [1e-3, 1e6], 1.0, "time constant"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 2]> {
        [0.03, 0.15, 0.5, 2.0].into_iter().map(|share| [0.0, (share * survey.duration_s).max(1e-3)]).collect()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        let tau = (0.3 * carrier.survey.duration_s).max(1e-3);
        carrier.sized(Id::FrictionDrift, [0.2, 3.0], |rise| [rise, tau])
    }
}

impl LoadEffect<2> for FrictionDrift {
    #[inline(always)]
    fn load<T: Scalar>([rise, tau]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        Load::friction_scale(T::of(1.0) + *rise * (-motion.t / *tau).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_relaxes_to_coulomb_as_the_knob_warms_up() {
        let level =
            |t: f64| FrictionDrift::load(&[0.8, 2.0], &Motion::exact(t, 0.0, 1.0, 0.0)).friction_scale;
        assert!((level(0.0) - 1.8).abs() < 1e-12 && (level(100.0) - 1.0).abs() < 1e-12);
        assert!((level(2.0) - (1.0 + 0.8 / core::f64::consts::E)).abs() < 1e-12);
    }
}
