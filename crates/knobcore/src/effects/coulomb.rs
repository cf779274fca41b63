//! Coulomb friction: a level per direction, whatever the speed.

use super::{Base, Carrier, Effect, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// +pos while omega > 0, -neg while omega < 0; both are magnitudes.
///
/// A negative magnitude creates energy: the model then lacks an effect that the friction has absorbed.
pub struct Coulomb;

impl Effect<2> for Coulomb {
    const ID: &'static str = "coulomb";
    const LAW: &'static str = "+pos for omega > 0, -neg for omega < 0";
    const SOURCE: &'static str = "Coulomb 1785; C_vel of Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "as a step of the torque wherever the direction changes";
    const TOUCHES: &'static [Channel] = &[Channel::Back, Channel::Forth];
    const STEADY: bool = true;
    const WORDS: Words = Words {
        title: "dry friction",
        name: "there is dry friction",
        about: "Surfaces that rub resist motion with the same torque at any speed, perhaps another one in \
                each direction.",
        causes: &[
            "sliding bearings, seals and wipers",
            "a friction washer or brake that is meant to be felt",
            "surfaces that are pressed together too hard",
        ],
        remedies: &[
            "grease or change the pair of materials",
            "lower the preload of bearings, seals or washers",
            "use rolling bearings",
        ],
        latex: r"\tau = \begin{cases} C_{+} & \omega > 0 \\ -C_{-} & \omega < 0 \end{cases}",
    };
    const OVER: Over = Over::Velocity;
    const BASE: Option<Base> = Some(Base::Always);
    const PARAMS: [Param; 2] = [
        Param::linear("neg", Unit::of(1, 0, 0), "dry friction moving backward, a magnitude")
            .plausibly(0.0, f64::INFINITY),
        Param::linear("pos", Unit::of(1, 0, 0), "dry friction moving forward, a magnitude")
            .plausibly(0.0, f64::INFINITY),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        let dry = if carrier.dry > 0.0 { carrier.dry } else { 0.004 };
        [dry, dry]
    }
}

impl LoadEffect<2> for Coulomb {
    #[inline(always)]
    fn load<T: Scalar>([neg, pos]: &[T; 2], _: &Motion<T>) -> Load<T> {
        Load { resist: [*neg, *pos], ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque(omega: f64) -> f64 {
        let motion = Motion::exact(0.0, 0.0, omega, 0.0);
        Coulomb::load(&[1.5, 2.0], &motion).sliding(&motion)
    }

    #[test]
    fn dry_friction_takes_the_sign_of_the_speed_and_not_its_size() {
        assert_eq!((torque(1e-9), torque(50.0)), (2.0, 2.0));
        assert_eq!((torque(-1e-9), torque(-50.0)), (-1.5, -1.5));
    }

    #[test]
    fn where_the_sign_of_the_speed_is_not_known_the_expected_friction_is_predicted() {
        let motion = Motion { forward: 0.25, ..Motion::exact(0.0, 0.0, 1e-6, 0.0) };
        let tau: f64 = Coulomb::load(&[1.5, 2.0], &motion).sliding(&motion);
        assert!((tau - (0.25 * 2.0 - 0.75 * 1.5)).abs() < 1e-15);
    }
}
