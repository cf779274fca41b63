//! Viscous friction: proportional to the speed, with a coefficient per direction.

use super::{Base, Carrier, Effect, LoadEffect, Over, Section, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// B omega.
///
/// It pushes rather than resists: it vanishes at rest and so holds nothing, and a fitted coefficient may
/// be negative (knobs 1 to 3 of the paper), which says that an effect is missing.
pub struct Viscous;

impl Effect<2> for Viscous {
    const ID: &'static str = "viscous";
    const LAW: &'static str = "neg omega for omega < 0, pos omega for omega > 0";
    const SOURCE: &'static str = "Reynolds 1886; B_vel of Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "in proportion to speed";
    const TOUCHES: &'static [Channel] = &[Channel::Drive];
    const WORDS: Words = Words {
        title: "viscous friction",
        name: "there is viscous friction",
        about: "Grease or oil that is sheared resists motion in proportion to its speed.",
        causes: &[
            "damping grease between shaft and bush",
            "oil in the bearings",
            "eddy currents in a magnetic encoder or motor",
        ],
        remedies: &[
            "choose a grease of another viscosity, or less of it",
            "widen the gap or shorten the length over which it is sheared",
            "keep the temperature steady: it sets the viscosity",
        ],
        latex: concat!(
            r"\tau = \begin{cases} B_{+}\,\omega & \omega > 0 \\ B_{-}\,\omega & \omega < 0 ",
            r"\end{cases}",
        ),
    };
    const OVER: Over = Over::Velocity;
    const SECTION: Option<Section> = Some(Section::Fluid);
    const BASE: Option<Base> = Some(Base::Always);
    const PARAMS: [Param; 2] = [
        Param::linear("neg", Unit::of(1, -1, 1), "viscous coefficient moving backward"),
        Param::linear("pos", Unit::of(1, -1, 1), "viscous coefficient moving forward"),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        // At the fastest as much as dry friction of a small knob.
        let b = 0.004 / carrier.fastest();
        [b, 1.2 * b]
    }
}

impl LoadEffect<2> for Viscous {
    #[inline(always)]
    fn load<T: Scalar>([neg, pos]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        let [back, forth] = motion.directions();
        Load::drive(motion.omega * (*neg * back + *pos * forth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viscous_drag_opposes_motion_and_vanishes_at_rest() {
        let torque = |omega: f64| Viscous::load(&[1.0, 1.5], &Motion::exact(0.0, 0.0, omega, 0.0)).drive;
        assert_eq!((torque(-2.0), torque(0.0), torque(2.0)), (-2.0, 0.0, 3.0));
    }
}
