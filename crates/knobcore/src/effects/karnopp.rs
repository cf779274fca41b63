//! Stiction: below a speed the knob counts as stuck, and friction answers whatever would move it.

use super::{Carrier, Effect, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::scalar::Scalar;

/// For |omega| <= dv: friction = clamp(tau_other, -D_neg, +D_pos).
///
/// While the knob moves faster than dv, stiction is silent; so a prediction from the motion alone, which
/// has no tau_other, does not change by it. It acts where torque makes motion: simulation and rendering.
pub struct Karnopp;

impl Effect<3> for Karnopp {
    const ID: &'static str = "karnopp";
    const LAW: &'static str = "clamp(tau_other, -D_neg, D_pos) for |omega| <= dv";
    const SOURCE: &'static str =
        "Karnopp 1985; Equation 2 of the haptic-camera paper, with D in the stick branch";
    const SHOWS: &'static str = "while the knob stands still under torque";
    const TOUCHES: &'static [Channel] = &[Channel::Stick];
    const STEADY: bool = true;
    const WORDS: Words = Words {
        title: "sticking at standstill",
        name: "the knob sticks when it stands still",
        about: "Below a small speed friction holds the knob against any push up to a breakaway torque.",
        causes: &[
            "static friction above sliding friction, as of dry or long rested contacts",
            "grease that sets at rest",
            "tight seals",
        ],
        remedies: &[
            "use a lubricant with additives against stick-slip",
            "lower the preload of seals and bearings",
            "choose materials whose static and sliding friction are alike, such as PTFE on steel",
        ],
        latex: concat!(
            r"\operatorname{clamp}(\tau_{\text{other}},\,-D_{-},\,D_{+}) \quad |\omega| \le ",
            r"\Delta v",
        ),
    };
    const OVER: Over = Over::Velocity;
    const UNSEARCHED: Option<&'static str> = Some("it does not show in a prediction from motion");
    const PARAMS: [Param; 3] = [
        Param::shape("D_neg", Unit::of(1, 0, 0), [0.0, 1e9], 0.0, "breakaway friction backward, a magnitude")
            .usually(Usual::Fixed),
        Param::shape("D_pos", Unit::of(1, 0, 0), [0.0, 1e9], 0.0, "breakaway friction forward, a magnitude")
            .usually(Usual::Fixed),
        Param::shape("dv", Unit::of(0, 1, -1), [0.0, 1e9], 0.0, "speed below which the knob is stuck")
            .usually(Usual::Fixed),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        // It holds more than it rubs.
        let holds = if carrier.dry > 0.0 { 2.0 * carrier.dry } else { 0.01 };
        [holds, holds, 0.01 * carrier.fastest()]
    }
}

impl LoadEffect<3> for Karnopp {
    #[inline(always)]
    fn load<T: Scalar>([d_neg, d_pos, dv]: &[T; 3], _: &Motion<T>) -> Load<T> {
        Load { hold: [*d_neg, *d_pos], band: *dv, ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stuck_knob_answers_any_torque_up_to_the_breakaway_of_that_direction() {
        let load = Karnopp::load(&[0.010, 0.012, 0.01], &Motion::exact(0.0, 0.0, 0.0, 0.0));
        for tau in [-0.010, -0.004, 0.0, 0.003, 0.012] {
            assert_eq!(load.sticking(tau), tau);
        }
        assert_eq!((load.sticking(-1.0), load.sticking(1.0)), (-0.010, 0.012));
    }

    #[test]
    fn a_moving_knob_feels_no_stiction() {
        let motion = Motion::exact(0.0, 0.0, 0.5, 3.0);
        assert_eq!(Karnopp::load(&[0.010, 0.012, 0.01], &motion).sliding(&motion), 0.0);
    }
}
