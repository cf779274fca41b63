//! Unbalance: once per revolution, by gravity or runout.

use super::{Carrier, Effect, Id, LoadEffect, Over, Section, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// a sin(theta + phi); on a linear axis one cycle per 2 pi metres, which hardly means anything there.
pub struct Unbalance;

impl Effect<2> for Unbalance {
    const ID: &'static str = "unbalance";
    const LAW: &'static str = "a sin(theta + phi)";
    const SOURCE: &'static str = "a mass off the axis under gravity, m g r; runout";
    const SHOWS: &'static str = "over position, once per revolution";
    const CONFUSED: &'static [&'static str] = &["return_spring", "position_polynomial"];
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "unbalance",
        name: "a torque comes once per turn, as of an unbalanced knob",
        about: "The knob's mass lies off its axis, or its axis off the rig's, so that a torque comes and \
                goes once per turn.",
        causes: &[
            "a lever, a pointer or a finger dimple on one side, with a horizontal axis",
            "a bent shaft, or one that is off the axis of the rig",
            "a bore that is not concentric",
        ],
        remedies: &[
            "balance the knob",
            "align the shaft with the rig, or use a coupling that takes up the offset",
            "mount it with the axis upright: gravity then has no lever",
        ],
        latex: r"a \sin(\theta + \varphi)",
    };
    const OVER: Over = Over::Position;
    const SECTION: Option<Section> = Some(Section::Weight);
    const PARAMS: [Param; 2] =
        [Param::linear("a", Unit::of(1, 0, 0), "amplitude"), Param::phase("phi", 0, "phase")];

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        carrier.sized(Id::Unbalance, [carrier.floor, 100.0 * carrier.floor], |a| [a, 0.6])
    }
}

impl LoadEffect<2> for Unbalance {
    #[inline(always)]
    fn load<T: Scalar>([a, phi]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        Load::position(*a * (motion.theta + *phi).sin_cos().0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_off_the_axis_pulls_one_way_and_half_a_turn_on_the_other() {
        let torque = |theta: f64| Unbalance::load(&[3.0, 0.4], &Motion::exact(0.0, theta, 0.0, 0.0)).drive;
        assert!((torque(0.5) + torque(0.5 + core::f64::consts::PI)).abs() < 1e-12);
        assert!((torque(0.5) - 3.0 * 0.9_f64.sin()).abs() < 1e-12);
    }
}
