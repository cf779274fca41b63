//! Position polynomial: any smooth torque over position.

use super::{Carrier, Effect, Id, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// p1 theta + p2 theta^2 + p3 theta^3.
///
/// The constant P0 of the paper is `offset`.
pub struct PositionPolynomial;

impl Effect<3> for PositionPolynomial {
    const ID: &'static str = "position_polynomial";
    const LAW: &'static str = "p1 theta + p2 theta^2 + p3 theta^3";
    const SOURCE: &'static str = "the polynomials named beside Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "over position, smoothly";
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "smooth torque over position",
        name: "a torque varies smoothly over position",
        about: "Some smooth torque depends on where the knob is and on nothing else, without returning after \
                a turn.",
        causes: &[
            "cables or hoses that wind up",
            "a spring that grows stiffer with its travel",
            "magnets or a sensor bracket that pull from one side",
        ],
        remedies: &[
            "lay cables in a loose loop around the axis",
            "look for what touches or pulls over the range",
            "turn the knob to another range and see whether it moves along",
        ],
        latex: r"p_1\,\theta + p_2\,\theta^2 + p_3\,\theta^3",
    };
    const OVER: Over = Over::Position;
    const PARAMS: [Param; 3] = [
        Param::linear("p1", Unit::of(1, -1, 0), "slope"),
        Param::linear("p2", Unit::of(1, -2, 0), "curvature"),
        Param::linear("p3", Unit::of(1, -3, 0), "cubic term"),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        // By the torque of each term where the way ends.
        let reach = carrier.reach().max(carrier.middle().abs());
        carrier.sized(Id::PositionPolynomial, [carrier.floor, 100.0 * carrier.floor], |torque| {
            [0.4 * torque / reach, torque / (reach * reach), -0.8 * torque / (reach * reach * reach)]
        })
    }
}

impl LoadEffect<3> for PositionPolynomial {
    #[inline(always)]
    fn load<T: Scalar>([p1, p2, p3]: &[T; 3], motion: &Motion<T>) -> Load<T> {
        let x = motion.theta;
        Load::position(x * (*p1 + x * (*p2 + x * *p3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_has_its_values_by_hand() {
        let torque = |theta: f64| {
            PositionPolynomial::load(&[1.0, -2.0, 0.5], &Motion::exact(0.0, theta, 0.0, 0.0)).drive
        };
        assert_eq!((torque(0.0), torque(2.0), torque(-1.0)), (0.0, -2.0, -3.5));
    }
}
