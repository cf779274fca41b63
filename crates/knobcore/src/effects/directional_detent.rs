//! Directional detents: gain and phase differ with the direction of motion.

use super::{Carrier, Effect, Id, LoadEffect, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::scalar::Scalar;

/// sgn(omega) A sin(theta/P + S), P that of the detents.
///
/// Any difference between the detents of the two directions is such a sinusoid: added to `detent` forward and
/// taken from it backward it makes two sinusoids of their own gain and phase.
pub struct DirectionalDetent;

impl Effect<3> for DirectionalDetent {
    const ID: &'static str = "directional_detent";
    const LAW: &'static str = "sgn(omega) A sin(theta/P + S)";
    const SOURCE: &'static str =
        "half the difference of the detents of both directions; hysteresis of sprung detents";
    const SHOWS: &'static str = "over position, differently in each direction";
    const CONFUSED: &'static [&'static str] = &["backlash", "torque_lag", "position_friction"];
    const NEEDS: Option<&'static str> = Some("detent");
    const TOUCHES: &'static [Channel] = &[Channel::Drive];
    const WORDS: Words = Words {
        title: "directional detent",
        name: "the detent differs with the direction of motion",
        about: "Going one way the valleys are deeper, or lie elsewhere, than going the other way.",
        causes: &[
            "a detent spring that bends sideways or has play",
            "teeth that are steeper on one side",
            "friction between ball and wheel",
        ],
        remedies: &["guide the spring without play", "make the teeth symmetric", "grease the detent"],
        latex: r"\operatorname{sgn}(\omega)\, A \sin\!\left(\frac{\theta}{P} + S\right)",
    };
    const PARAMS: [Param; 3] = [
        Param::linear("A", Unit::of(1, 0, 0), "half the difference between the directions"),
        Param::phase("S", 0, "phase of the difference"),
        Param::shape("P", Unit::of(0, 1, 0), [1e-9, 1e6], 0.1, "period of the detents over 2 pi")
            .usually(Usual::Follows("detent.P")),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        let [a, p] = carrier.detent.unwrap_or([0.005, 0.08]);
        carrier.sized(Id::DirectionalDetent, [0.01 * a, a], |a| [a, 0.9, p])
    }
}

impl LoadEffect<3> for DirectionalDetent {
    #[inline(always)]
    fn load<T: Scalar>([a, s, p]: &[T; 3], motion: &Motion<T>) -> Load<T> {
        Load::drive(motion.direction() * *a * (motion.theta / *p + *s).sin_cos().0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_the_detent_it_makes_one_of_its_own_gain_and_phase_in_each_direction() {
        let (gain, shift, period) = (0.2, 0.3, 0.1);
        // Forward sin(x), backward (1 + gain) sin(x + shift): half the sum, and half the difference.
        let half = |sign: f64, x: f64| 0.5 * (x.sin() + sign * (1.0 + gain) * (x + shift).sin());
        let (sine, cosine) = (half(-1.0, core::f64::consts::FRAC_PI_2), half(-1.0, 0.0));
        let p = [sine.hypot(cosine), cosine.atan2(sine), period];
        for x in [0.1_f64, 1.0, 2.5] {
            let at =
                |omega: f64| DirectionalDetent::load(&p, &Motion::exact(0.0, x * period, omega, 0.0)).drive;
            assert!((half(1.0, x) + at(1.0) - x.sin()).abs() < 1e-12);
            assert!((half(1.0, x) + at(-1.0) - (1.0 + gain) * (x + shift).sin()).abs() < 1e-12);
        }
    }
}
