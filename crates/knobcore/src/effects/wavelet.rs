//! Wavelet: torque over position without a law, in the spatial-frequency domain.

use super::{Carrier, Effect, LoadEffect, Over, Survey, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit, Usual};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Coefficients: one mean-free hat, then 2, 4, 8 and 16 of half the width each.
const COEFFICIENTS: usize = 31;
/// Borders of the range, and the coefficients.
const COUNT: usize = 2 + COEFFICIENTS;

/// Sum of c_jk psi(2^j x - k) over x = (theta - lo) / (hi - lo), psi a wave of one cycle in its interval, for
/// the levels j = 0 to 4: no segmentation by hand, and each coefficient belongs to one place and one scale.
pub struct Wavelet;

const NAMES: [&str; COEFFICIENTS] = [
    "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "c9", "c10", "c11", "c12", "c13", "c14", "c15", "c16",
    "c17", "c18", "c19", "c20", "c21", "c22", "c23", "c24", "c25", "c26", "c27", "c28", "c29", "c30", "c31",
];

const fn params() -> [Param; COUNT] {
    let mut params =
        [Param::linear("c", Unit::of(1, 0, 0), "torque at one place and scale, coarse to fine"); COUNT];
    params[0] = Param::shape("lo", Unit::of(0, 1, 0), [-1e6, 1e6], 0.0, "lower end of the range")
        .usually(Usual::Fixed);
    params[1] = Param::shape("hi", Unit::of(0, 1, 0), [-1e6, 1e6], 1.0, "upper end of the range")
        .usually(Usual::Fixed);
    let mut i = 0;
    while i < COEFFICIENTS {
        params[2 + i].name = NAMES[i];
        i += 1;
    }
    params
}

impl Effect<COUNT> for Wavelet {
    const ID: &'static str = "wavelet";
    const LAW: &'static str = "sum of c_jk psi(2^j (theta - lo)/(hi - lo) - k), j = 0 to 4";
    const SOURCE: &'static str = "Miller & Colgate 1998 (wavelet network of a haptic environment); Haar 1910";
    const SHOWS: &'static str = "over position, any shape; a description, not a cause";
    const CONFUSED: &'static [&'static str] = &["regional", "position_polynomial"];
    const DESCRIBES: bool = true;
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "free torque over position",
        name: "some torque varies over position",
        about: "A description of any torque over position by small waves, coarse and fine; it names no \
                cause.",
        causes: &["anything that depends on position alone"],
        remedies: &["look at the curve, and name its parts by effects that have a cause"],
        latex: concat!(
            r"\sum_{j=0}^{4} \sum_k c_{jk}\, \psi\!\left(2^j \frac{\theta - ",
            r"\theta_{\text{lo}}}{\theta_{\text{hi}} - \theta_{\text{lo}}} - k\right)",
        ),
    };
    const OVER: Over = Over::Position;
    const PARAMS: [Param; COUNT] = params();

    fn starts(survey: &Survey) -> Vec<[f64; COUNT]> {
        let mut start = [0.0; COUNT];
        start[0] = Survey::quantile(&survey.theta, 0.0);
        start[1] = Survey::quantile(&survey.theta, 1.0).max(start[0] + 1e-9);
        vec![start]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; COUNT] {
        let mut values = [0.0; COUNT];
        let mut c = 6.0 * carrier.floor;
        for value in &mut values[2..] {
            *value = c;
            c *= -0.9;
        }
        values[0] = carrier.middle() - carrier.reach();
        values[1] = carrier.middle() + carrier.reach();
        values
    }
}

impl LoadEffect<COUNT> for Wavelet {
    #[inline(always)]
    fn load<T: Scalar>(p: &[T; COUNT], motion: &Motion<T>) -> Load<T> {
        let x = (motion.theta - p[0]) / (p[1] - p[0]);
        let (one, zero, two) = (T::of(1.0), T::of(0.0), T::of(2.0));
        let mut tau = zero;
        let (mut at, mut scale) = (2, 1);
        while at < COUNT {
            let mut k = 0;
            while k < scale {
                let u = T::of(scale as f64) * x - T::of(k as f64);
                // A hat up over the first half, one down over the second.
                let up = (one - (T::of(4.0) * u - one).abs()).max(zero);
                let down = (one - (T::of(4.0) * u - two - one).abs()).max(zero);
                tau = tau + p[at] * (up - down);
                at += 1;
                k += 1;
            }
            scale *= 2;
        }
        Load::position(tau)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_coefficient_acts_at_its_place_and_nowhere_else() {
        let mut p = Wavelet::PARAMS.map(|param| param.neutral);
        p[2 + 15] = 1.0;
        let torque = |theta: f64| Wavelet::load(&p, &Motion::exact(0.0, theta, 0.0, 0.0)).drive;
        assert!((torque(1.0 / 64.0) - 1.0).abs() < 1e-12 && (torque(3.0 / 64.0) + 1.0).abs() < 1e-12);
        assert!((torque(1.0 / 16.0) == 0.0) && torque(0.5) == 0.0 && torque(-0.1) == 0.0);
    }
}
