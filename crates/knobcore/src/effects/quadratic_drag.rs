//! Quadratic drag: a fluid that the knob stirs.

use super::{Carrier, Effect, Id, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// d omega |omega|.
pub struct QuadraticDrag;

impl Effect<1> for QuadraticDrag {
    const ID: &'static str = "quadratic_drag";
    const LAW: &'static str = "d omega |omega|";
    const SOURCE: &'static str = "Rayleigh 1876; Olsson, Astrom, Canudas de Wit, Gafvert & Lischinsky 1998";
    const SHOWS: &'static str = "at high speed";
    const CONFUSED: &'static [&'static str] = &["stribeck", "viscous"];
    const TOUCHES: &'static [Channel] = &[Channel::Drive];
    const WORDS: Words = Words {
        name: "drag grows with the square of the speed",
        about: "Air or liquid that the knob stirs holds it back, four times as much at twice the speed.",
        causes: &[
            "a fan, a vane or a rough rim that stirs air",
            "a knob that turns in oil or water at high speed",
        ],
        remedies: &[
            "smooth or shroud what stirs",
            "lower the level or the density of the fluid",
            "measure at the speeds of a hand, at which drag is small",
        ],
        latex: r"d\,\omega\,|\omega|",
    };
    const OVER: Over = Over::Velocity;
    const PARAMS: [Param; 1] = [Param::linear("d", Unit::of(1, -2, 2), "drag").plausibly(0.0, f64::INFINITY)];

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        // By its torque at the fastest.
        let square = carrier.fastest() * carrier.fastest();
        carrier.sized(Id::QuadraticDrag, [carrier.floor, 100.0 * carrier.floor], |torque| [torque / square])
    }
}

impl LoadEffect<1> for QuadraticDrag {
    #[inline(always)]
    fn load<T: Scalar>([d]: &[T; 1], motion: &Motion<T>) -> Load<T> {
        Load::drive(*d * motion.omega * motion.omega.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drag_grows_with_the_square_of_the_speed_and_opposes_it() {
        let torque = |omega: f64| QuadraticDrag::load(&[2.0], &Motion::exact(0.0, 0.0, omega, 0.0)).drive;
        assert_eq!((torque(3.0), torque(-3.0), torque(6.0)), (18.0, -18.0, 72.0));
    }
}
