//! Return spring: the ramp of the paper, K theta about a rest angle.

use super::{Carrier, Effect, Id, LoadEffect, Over, Section, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// k (theta - theta0).
///
/// The rest torque k theta0 is a constant, and a constant is also what a difference between `coulomb` neg
/// and pos makes; so theta0 is determined only where those two are tied.
/// A spring pulls back. What pushes away from a position is none: a weight above its axis, which is an unbalance.
pub struct ReturnSpring;

impl Effect<2> for ReturnSpring {
    const ID: &'static str = "return_spring";
    const LAW: &'static str = "k (theta - theta0)";
    const SOURCE: &'static str = "Hooke 1678; the ramp named beside Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "over position, as a straight line";
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "return spring",
        name: "a spring pulls the knob back to a rest position",
        about: "The torque grows in proportion to the distance from a rest position.",
        causes: &[
            "a return spring that is meant to be there",
            "a cable or a flexure that is wound up",
            "a magnet that centres",
        ],
        remedies: &[
            "choose a softer spring, or one of more coils",
            "lay cables free of the axis",
            "keep it, if it is meant to be felt",
        ],
        latex: r"k\,(\theta - \theta_0)",
    };
    const OVER: Over = Over::Position;
    const SECTION: Option<Section> = Some(Section::Spring);
    const PARAMS: [Param; 2] = [
        Param::linear("k", Unit::of(1, -1, 0), "stiffness").plausibly(0.0, f64::INFINITY),
        Param::shape("theta0", Unit::of(0, 1, 0), [-1e6, 1e6], 0.0, "rest angle"),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        // By its torque where the way ends; it rests beside the middle.
        let reach = carrier.reach();
        carrier.sized(Id::ReturnSpring, [carrier.floor, 100.0 * carrier.floor], |torque| {
            [torque / reach, carrier.middle() + 0.1 * reach]
        })
    }
}

impl LoadEffect<2> for ReturnSpring {
    #[inline(always)]
    fn load<T: Scalar>([k, theta0]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        Load::position(*k * (motion.theta - *theta0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spring_pulls_back_to_its_rest_angle_from_either_side() {
        let torque = |theta: f64| ReturnSpring::load(&[2.0, 0.5], &Motion::exact(0.0, theta, 0.0, 0.0)).drive;
        assert_eq!((torque(0.0), torque(0.5), torque(1.0)), (-1.0, 0.0, 1.0));
    }
}
