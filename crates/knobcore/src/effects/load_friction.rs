//! Load-dependent friction: what presses the surfaces together makes them rub.

use super::{Carrier, Context, Effect, Id, LoadEffect, Nonlinear, Survey, Words, short};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::prelude::*;
use crate::scalar::Scalar;

/// mu |load|, with the sign of omega. The load is what the surfaces that slide hand on: the torque of the detents,
/// every other one over position that the model has (springs, gravity, cogging, stops), and that of the inertia, of the
/// last two the share which lies beyond these surfaces: gears hand on gravity and not the inertia of their motor's rotor,
/// and the ball of a detent neither.
///
/// A load that is always the same is `coulomb`.
pub struct LoadFriction;

impl Effect<3> for LoadFriction {
    const ID: &'static str = "load_friction";
    const LAW: &'static str =
        "mu |detent + s_theta (other torques over position) + s_alpha M alpha| sgn(omega)";
    const SOURCE: &'static str =
        "Amontons 1699; Dohring, Lee & Newman 1993 (load-dependent transmission friction)";
    const SHOWS: &'static str =
        "wherever a detent, a spring, gravity or inertia pushes hard, with the sign of the motion";
    const CONFUSED: &'static [&'static str] =
        &["detent_harmonics", "position_friction", "directional_detent"];
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::ByLoad);
    const TOUCHES: &'static [Channel] = &[Channel::Mu, Channel::PositionShare, Channel::InertiaShare];
    const STEADY: bool = true;
    const WORDS: Words = Words {
        title: "friction under load",
        name: "friction grows with the load",
        about: "What a detent, a spring, gravity or inertia pushes with also presses surfaces together, which \
                then rub harder.",
        causes: &[
            "gears, whose teeth rub by what they hand on",
            "a detent spring that presses the shaft against one side of its bearing",
            "friction between ball and wheel",
            "a bearing that is weak beside its load",
        ],
        remedies: &[
            "use gears of a higher efficiency: spur gears for worms, few stages, another grease",
            "press from two opposite sides, so that the bearing is not loaded",
            "use a rolling bearing near the load",
            "grease the detent",
        ],
        latex: r"\mu\,\bigl|\tau_{\text{detent}} + s_\theta\,\tau(\theta) + s_\alpha\,M\alpha\bigr|\,\operatorname{sgn}\omega",
    };
    const PARAMS: [Param; 3] = [
        Param::shape("mu", Unit::NUMBER, [-10.0, 10.0], 0.0, "friction per load")
            .plausibly(0.0, f64::INFINITY),
        Param::shape(
            "s_theta",
            Unit::NUMBER,
            [0.0, 1.0],
            1.0,
            "share of torques over position, but for detents, in the load",
        )
        .usually(Usual::Weighs([Channel::NormalLoad, Channel::PositionLoad])),
        Param::shape("s_alpha", Unit::NUMBER, [0.0, 1.0], 1.0, "share of the inertia in the load"),
    ];

    fn starts(_: &Survey) -> Vec<[f64; 3]> {
        [0.0, 0.5, 1.0].map(|share| [0.0, 1.0, share]).into()
    }

    /// Friction under a load of inertia that takes more torque than that inertia would never let it go.
    fn implausible(&[mu, _, share]: &[f64; 3], _: &Context) -> Vec<String> {
        let jams = mu * share >= 1.0;
        jams.then(|| format!("{} of the inertia's own torque would jam it", short(mu * share, 2)))
            .into_iter()
            .collect()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        carrier.sized(Id::LoadFriction, [0.02, 0.9], |mu| [mu, 1.0, 1.0])
    }
}

impl LoadEffect<3> for LoadFriction {
    #[inline(always)]
    fn load<T: Scalar>([mu, position, inertia]: &[T; 3], _: &Motion<T>) -> Load<T> {
        Load { mu: *mu, position_share: *position, inertia_share: *inertia, ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_grows_with_what_pushes_whichever_way_it_pushes() {
        for press in [-2.0, 2.0] {
            let motion = Motion::exact(0.0, 0.0, -1.0, 0.0);
            let load = Load::position(press).plus(LoadFriction::load(&[0.1, 1.0, 1.0], &motion));
            assert!((load.sliding(&motion) - (press - 0.2)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_weight_that_is_let_down_gently_presses_less_than_one_that_hangs() {
        let friction = |share: f64, alpha: f64| {
            let motion = Motion::exact(0.0, 0.0, 1.0, alpha);
            let body = Load { inertia: 0.5, ..Load::detent(2.0) };
            body.plus(LoadFriction::load(&[0.1, 1.0, share], &motion)).friction(1.0, alpha)
        };
        assert!((friction(1.0, -2.0) - 0.1).abs() < 1e-15 && (friction(1.0, 2.0) - 0.3).abs() < 1e-15);
        assert!((friction(0.0, -2.0) - 0.2).abs() < 1e-15 && (friction(1.0, -8.0) - 0.2).abs() < 1e-15);
    }
}
