//! Regional: a force-displacement line of its own in each region of the way.

use super::{Carrier, Effect, LoadEffect, Over, Survey, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// f_i + k_i (theta - c) in region i of four, which the borders b1 <= b2 <= b3 cut; c is the middle border.
///
/// The lines need not meet: a button that clicks has a step between two of them.
pub struct Regional;

const fn level(name: &'static str) -> Param {
    Param::linear(name, Unit::of(1, 0, 0), "torque of the region's line at the middle border")
}

const fn slope(name: &'static str) -> Param {
    Param::linear(name, Unit::of(1, -1, 0), "slope of the region's line")
}

const fn border(name: &'static str, meaning: &'static str) -> Param {
    Param::shape(name, Unit::of(0, 1, 0), [-1e6, 1e6], 0.0, meaning)
}

impl Effect<11> for Regional {
    const ID: &'static str = "regional";
    const LAW: &'static str = "f_i + k_i (theta - b2) in region i, between the borders b1, b2, b3";
    const SOURCE: &'static str =
        "MacLean 1996, \"The haptic camera\": force-displacement curves segmented by region";
    const SHOWS: &'static str = "over position, by region; a description, not a cause";
    const CONFUSED: &'static [&'static str] = &["wavelet", "position_polynomial", "end_stop"];
    const DESCRIBES: bool = true;
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "torque by region",
        name: "the torque has a straight line of its own in each region",
        about: "A description of any torque over position by four straight lines; it names no cause.",
        causes: &[
            "a button that clicks, or a switch that snaps over",
            "several springs that come into play one after the other",
        ],
        remedies: &["look at the curve, and name its parts by effects that have a cause"],
        latex: r"f_i + k_i\,(\theta - b_2) \quad \text{in region } i",
    };
    const OVER: Over = Over::Position;
    const PARAMS: [Param; 11] = [
        border("b1", "first border"),
        border("b2", "middle border"),
        border("b3", "last border"),
        level("f1"),
        slope("k1"),
        level("f2"),
        slope("k2"),
        level("f3"),
        slope("k3"),
        level("f4"),
        slope("k4"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 11]> {
        let low = Survey::quantile(&survey.theta, 0.0);
        let at = |share: f64| low + share * survey.range();
        let borders = [[0.25, 0.5, 0.75], [0.1, 0.5, 0.9], [0.1, 0.2, 0.5], [0.5, 0.8, 0.9]];
        borders.map(|b| core::array::from_fn(|i| b.get(i).map_or(0.0, |share| at(*share)))).into()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 11] {
        let (at, torque) = (|share: f64| carrier.middle() + share * carrier.reach(), 6.0 * carrier.floor);
        let k = torque / carrier.reach();
        let [f1, f2, f3, f4] = [0.8, -0.6, 0.4, -0.4].map(|share| share * torque);
        [at(-0.5), at(0.1), at(0.6), f1, 0.4 * k, f2, 2.0 * k, f3, -2.0 * k, f4, 0.6 * k]
    }
}

impl LoadEffect<11> for Regional {
    #[inline(always)]
    fn load<T: Scalar>(p: &[T; 11], motion: &Motion<T>) -> Load<T> {
        let [b1, b2, b3, f1, k1, f2, k2, f3, k3, f4, k4] = *p;
        let x = motion.theta - b2;
        let line = |f: T, k: T| f + k * x;
        let upper = (motion.theta - b3).where_positive(line(f4, k4), line(f3, k3));
        let lower = (motion.theta - b1).where_positive(line(f2, k2), line(f1, k1));
        Load::position(x.where_positive(upper, lower))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_region_has_its_own_line() {
        let p = [-1.0, 0.0, 1.0, 1.0, 0.0, 2.0, 0.0, 3.0, 0.5, 4.0, 0.0];
        let torque = |theta: f64| Regional::load(&p, &Motion::exact(0.0, theta, 0.0, 0.0)).drive;
        assert_eq!((torque(-2.0), torque(-0.5), torque(0.5), torque(2.0)), (1.0, 2.0, 3.25, 4.0));
    }
}
