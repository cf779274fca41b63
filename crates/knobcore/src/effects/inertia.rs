//! Inertia: the torque that accelerates the knob.

use super::{Base, Carrier, Effect, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// M alpha.
pub struct Inertia;

impl Effect<1> for Inertia {
    const ID: &'static str = "inertia";
    const LAW: &'static str = "M alpha";
    const SOURCE: &'static str = "Newton; the acceleration part of Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "in proportion to acceleration";
    const TOUCHES: &'static [Channel] = &[Channel::Inertia];
    const STEADY: bool = true;
    const WORDS: Words = Words {
        title: "inertia",
        name: "the knob has mass",
        about: "The mass of what turns resists every change of its speed.",
        causes: &[
            "the mass of the knob, most of all far from its axis",
            "the rotor and the coupling that turn along",
        ],
        remedies: &["make the knob lighter or smaller in diameter", "take off what turns along without need"],
        latex: r"M\,\alpha",
    };
    const OVER: Over = Over::Acceleration;
    const BASE: Option<Base> = Some(Base::Always);
    const PARAMS: [Param; 1] =
        [Param::linear("M", Unit::of(1, -1, 2), "moment of inertia").plausibly(0.0, f64::INFINITY)];

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        [carrier.inertia()]
    }
}

impl LoadEffect<1> for Inertia {
    #[inline(always)]
    fn load<T: Scalar>([m]: &[T; 1], _: &Motion<T>) -> Load<T> {
        Load { inertia: *m, ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knob_of_twice_the_inertia_takes_twice_the_torque_at_any_speed() {
        for omega in [-3.0, 0.0, 8.0] {
            let motion = Motion::exact(0.0, 1.0, omega, 5.0);
            let torque = |m: f64| Inertia::load(&[m], &motion).sliding(&motion);
            assert_eq!(torque(0.4), 2.0);
            assert_eq!(torque(0.8), 2.0 * torque(0.4));
        }
    }
}
