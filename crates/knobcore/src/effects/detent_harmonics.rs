//! Detent harmonics: valleys that are no pure sine.

use super::{Carrier, Effect, Id, LoadEffect, Over, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::scalar::Scalar;

/// A_n sin(n theta/P + S_n) for n = 2 to 5, P that of the detents.
pub struct DetentHarmonics;

impl Effect<9> for DetentHarmonics {
    const ID: &'static str = "detent_harmonics";
    const LAW: &'static str = "sum of A_n sin(n theta/P + S_n), n = 2 to 5";
    const SOURCE: &'static str = "Fourier 1822; torque of a toothed or magnetic detent over its period";
    const SHOWS: &'static str = "over position, two to five times per detent";
    const CONFUSED: &'static [&'static str] = &["load_friction", "directional_detent"];
    const NEEDS: Option<&'static str> = Some("detent");
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::NormalLoad];
    const WORDS: Words = Words {
        title: "detent harmonics",
        name: "the detent is not a pure sine",
        about: "The valleys of the detents have another shape than a sine: sharper, flatter or leaning to \
                one side.",
        causes: &[
            "the profile of the detent wheel: sharp teeth, flat tops",
            "a ball that is small or large for its groove",
            "magnets with sharp edges",
        ],
        remedies: &[
            "change the profile of the teeth or the radius of the ball",
            "skew or round the magnets",
            "keep it, if the shape is meant to be felt",
        ],
        latex: r"\sum_{n=2}^{5} A_n \sin\!\left(\frac{n\,\theta}{P} + S_n\right)",
    };
    const OVER: Over = Over::Position;
    const SLOWER: &'static [f64] = &[2.0, 3.0];
    const PARAMS: [Param; 9] = [
        Param::linear("A2", Unit::of(1, 0, 0), "amplitude at twice per detent"),
        Param::phase("S2", 0, "phase at twice per detent"),
        Param::linear("A3", Unit::of(1, 0, 0), "amplitude at three times per detent"),
        Param::phase("S3", 2, "phase at three times per detent"),
        Param::linear("A4", Unit::of(1, 0, 0), "amplitude at four times per detent"),
        Param::phase("S4", 4, "phase at four times per detent"),
        Param::linear("A5", Unit::of(1, 0, 0), "amplitude at five times per detent"),
        Param::phase("S5", 6, "phase at five times per detent"),
        Param::shape("P", Unit::of(0, 1, 0), [1e-9, 1e6], 0.1, "period of the detents over 2 pi")
            .usually(Usual::Follows("detent.P")),
    ];

    fn typical(carrier: &Carrier<'_>) -> [f64; 9] {
        let [a, p] = carrier.detent.unwrap_or([0.005, 0.08]);
        carrier.sized(Id::DetentHarmonics, [0.01 * a, a], |a| {
            [a, 0.8, 0.5 * a, -0.5, 0.25 * a, 1.9, 0.12 * a, -1.2, p]
        })
    }
}

impl LoadEffect<9> for DetentHarmonics {
    #[inline(always)]
    fn load<T: Scalar>([a2, s2, a3, s3, a4, s4, a5, s5, p]: &[T; 9], motion: &Motion<T>) -> Load<T> {
        let x = motion.theta / *p;
        Load::detent(
            wave(2.0, x, a2, s2) + wave(3.0, x, a3, s3) + wave(4.0, x, a4, s4) + wave(5.0, x, a5, s5),
        )
    }
}

#[inline(always)]
fn wave<T: Scalar>(n: f64, x: T, a: &T, s: &T) -> T {
    *a * (T::of(n) * x + *s).sin_cos().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{PI, TAU};

    #[test]
    fn harmonics_repeat_within_one_detent() {
        let torque =
            |p: [f64; 9], theta: f64| DetentHarmonics::load(&p, &Motion::exact(0.0, theta, 1.0, 0.0)).drive;
        let second = [1.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2];
        assert!((torque(second, 0.1) - torque(second, 0.1 + PI * 0.2)).abs() < 1e-12);
        let third = [0.0, 0.0, 2.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.2];
        assert!((torque(third, 0.1) - torque(third, 0.1 + TAU * 0.2 / 3.0)).abs() < 1e-12);
    }
}
