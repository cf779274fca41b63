//! Load-dependent friction: what presses the surfaces together makes them rub.

use super::{Carrier, Effect, Id, LoadEffect, Nonlinear, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// mu |detent torque|, with the sign of omega: the detents, with their harmonics, press as hard as they push.
pub struct LoadFriction;

impl Effect<1> for LoadFriction {
    const ID: &'static str = "load_friction";
    const LAW: &'static str = "mu |detent torque| sgn(omega)";
    const SOURCE: &'static str =
        "Amontons 1699; Dohring, Lee & Newman 1993 (load-dependent transmission friction)";
    const SHOWS: &'static str = "wherever the detent pushes, with the sign of the motion";
    const CONFUSED: &'static [&'static str] = &["detent_harmonics", "position_friction"];
    const NEEDS: Option<&'static str> = Some("detent");
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::ByNormalLoad);
    const TOUCHES: &'static [Channel] = &[Channel::Mu];
    const WORDS: Words = Words {
        name: "friction grows with the force of the detent",
        about: "What the detent pushes with also presses surfaces together, which then rub harder.",
        causes: &[
            "a detent spring that presses the shaft against one side of its bearing",
            "friction between ball and wheel",
            "a bearing that is weak beside the detent",
        ],
        remedies: &[
            "press from two opposite sides, so that the bearing is not loaded",
            "use a rolling bearing near the detent",
            "grease the detent",
        ],
        latex: r"\mu\,|\tau_{\text{detent}}|\,\operatorname{sgn}\omega",
    };
    const PARAMS: [Param; 1] =
        [Param::shape("mu", Unit::NUMBER, [-10.0, 10.0], 0.0, "friction per detent torque")
            .plausibly(0.0, f64::INFINITY)];

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        carrier.sized(Id::LoadFriction, [0.02, 1.0], |mu| [mu])
    }
}

impl LoadEffect<1> for LoadFriction {
    #[inline(always)]
    fn load<T: Scalar>([mu]: &[T; 1], _: &Motion<T>) -> Load<T> {
        Load { mu: *mu, ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_grows_with_the_torque_of_the_detent_whichever_way_it_pushes() {
        for press in [-2.0, 2.0] {
            let motion = Motion::exact(0.0, 0.0, -1.0, 0.0);
            let load = Load::detent(press).plus(LoadFriction::load(&[0.1], &motion));
            assert!((load.sliding(&motion) - (press - 0.2)).abs() < 1e-15);
        }
    }
}
