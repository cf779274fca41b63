//! Quadratic drag: a fluid that the knob stirs.

use super::{Carrier, Effect, Id, LoadEffect, Over, Section, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::scalar::Scalar;

/// d |omega|^n sgn(omega), n = 2 until the data pay for another.
pub struct QuadraticDrag;

/// Speeds below this are as good as rest, rad/s.
const REST: f64 = 1e-9;

impl Effect<2> for QuadraticDrag {
    const ID: &'static str = "quadratic_drag";
    const LAW: &'static str = "d |omega|^n sgn(omega), n = 2 unless the data tell otherwise";
    const SOURCE: &'static str = "Rayleigh 1876; Olsson, Astrom, Canudas de Wit, Gafvert & Lischinsky 1998; \
                                  n of a disc that turns in a fluid: 1.5 to 1.8, von Karman 1921";
    const SHOWS: &'static str = "at high speed";
    const CONFUSED: &'static [&'static str] = &["stribeck", "viscous"];
    const TOUCHES: &'static [Channel] = &[Channel::Drive];
    const WORDS: Words = Words {
        title: "quadratic drag",
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
        latex: r"d\,|\omega|^{\,n}\operatorname{sgn}\omega",
    };
    const OVER: Over = Over::Velocity;
    const SECTION: Option<Section> = Some(Section::Fluid);
    const PARAMS: [Param; 2] = [
        Param::linear("d", Unit::of(1, -2, 2), "drag; where n is not 2, that at 1 rad/s")
            .plausibly(0.0, f64::INFINITY),
        Param::shape("n", Unit::NUMBER, [1.0, 4.0], 2.0, "power of the speed")
            .plausibly(1.4, 2.6)
            .usually(Usual::WherePaid(0.1)),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        // By its torque at the fastest.
        let square = carrier.fastest() * carrier.fastest();
        carrier
            .sized(Id::QuadraticDrag, [carrier.floor, 100.0 * carrier.floor], |torque| [torque / square, 2.0])
    }
}

impl LoadEffect<2> for QuadraticDrag {
    #[inline(always)]
    fn load<T: Scalar>([d, n]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        let torque = *d * motion.omega.abs().max(T::of(REST)).powf(*n);
        Load::drive(motion.omega.where_positive(torque, -torque))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drag_grows_with_the_square_of_the_speed_and_opposes_it() {
        let torque =
            |n: f64, omega: f64| QuadraticDrag::load(&[2.0, n], &Motion::exact(0.0, 0.0, omega, 0.0)).drive;
        assert_eq!((torque(2.0, 3.0), torque(2.0, -3.0), torque(2.0, 6.0)), (18.0, -18.0, 72.0));
        assert!(
            (torque(1.8, -4.0) + 2.0 * 4.0_f64.powf(1.8)).abs() < 1e-12 && torque(1.5, 0.0).abs() < 1e-12
        );
    }
}
