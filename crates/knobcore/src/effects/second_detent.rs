//! A second series of detents, with a period of its own.

use super::detent::Detent;
use super::{Carrier, Context, Effect, Id, LoadEffect, Over, Survey, Wave, Words, rate};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;
use core::f64::consts::TAU;

/// A sin(theta / P + S) beside the detents, P no fraction of theirs.
pub struct SecondDetent;

/// Waves that a motion must cross: fewer are a map of position, which anything smooth draws.
const LEAST_WAVES: f64 = 4.0;
/// Two series of nearly one period are told apart by this many waves within the motion.
const RESOLVED: f64 = 1.0;
/// The highest harmonic that a detent is given, and of how many times slower ones those that were found may be one.
const HARMONICS: u8 = 5;
const SLOWER: u8 = 3;
/// Revolutions that a motion must cover for whole orders to be told from others.
const TURNS: f64 = 0.95;

impl Effect<3> for SecondDetent {
    const ID: &'static str = "second_detent";
    const LAW: &'static str = "A sin(theta/P + S), P no fraction of the detents'";
    const SOURCE: &'static str = "position part of Equation 1 of the haptic-camera paper, a second time";
    const SHOWS: &'static str = "over position, repeating at another distance than the detents";
    const CONFUSED: &'static [&'static str] = &["detent_harmonics", "cogging", "position_friction"];
    const NEEDS: Option<&'static str> = Some("detent");
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::NormalLoad];
    const WORDS: Words = Words {
        title: "second detent",
        name: "there is a second series of detents",
        about: "Beside the detents the knob falls into other valleys, evenly spaced too, but at another distance.",
        causes: &[
            "two toothed wheels or rings of magnets in one knob",
            "the cogging of a motor behind a gear, beside the detents",
            "teeth of a gear, balls of a bearing",
        ],
        remedies: &[
            "take one of the wheels out and see which series goes",
            "give both the same number of teeth, or one a multiple of the other's",
            "command the series that is not wanted, with the other sign",
        ],
        latex: r"A \sin\!\left(\frac{\theta}{P} + S\right),\quad P \neq P_{\text{detent}}",
    };
    const OVER: Over = Over::Position;
    const SCAN: Option<Wave> = Some(Wave::Torque);
    const PARAMS: [Param; 3] = [
        Param::linear("A", Unit::of(1, 0, 0), "amplitude"),
        Param::shape("P", Unit::of(0, 1, 0), [1e-9, 1e6], 0.07, "period over 2 pi"),
        Param::phase("S", 0, "phase"),
    ];

    /// The waves that were found, of those that can be its own; where none were looked for, a few of which one is near
    /// any of middling length.
    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        let range = survey.range().max(1e-6);
        let Some(mut waves) = survey.waves.clone() else {
            return (8..24).map(|half| [0.0, range / (TAU * 0.5 * f64::from(half)), 0.0]).collect();
        };
        waves.retain(|[_, period, _]| range >= LEAST_WAVES * TAU * period);
        waves
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        let [a, p] = carrier.detent.unwrap_or([0.005, 0.08]);
        carrier.sized(Id::SecondDetent, [0.01 * a, a], |a| [a, 0.72 * p, 0.9])
    }

    fn implausible([_, period, _]: &[f64; 3], context: &Context) -> Vec<String> {
        let waves = |period: f64| context.travel() / (TAU * period);
        let own = waves(*period);
        if own < LEAST_WAVES {
            return vec![format!("only {own:.1} of its waves were crossed: any smooth torque looks so")];
        }
        let alike = context.alike();
        let rate = rate(*period, context.errors.get(1).copied().flatten().unwrap_or(0.0));
        if let Some(turn) = context.revolution.filter(|turn| waves(*turn) >= TURNS) {
            let order = (turn / period).round();
            if alike(rate, [order / turn, 0.0]) {
                return vec![format!("it comes {order} times per turn: {{cogging}} would, by nature")];
            }
        }
        let Some(detents) = context.detents() else { return Vec::new() };
        if (own - waves(1.0 / detents[0])).abs() < RESOLVED {
            return vec!["it is too near the detents to be told from them".into()];
        }
        let series = |slower: u8| (1..=HARMONICS).map(move |n| f64::from(n) / f64::from(slower));
        if (1..=SLOWER).flat_map(series).any(|n| alike(rate, detents.map(|of| n * of))) {
            return vec!["it repeats with the detents: {detent_harmonics} would, by nature".into()];
        }
        Vec::new()
    }
}

impl LoadEffect<3> for SecondDetent {
    #[inline(always)]
    fn load<T: Scalar>(params: &[T; 3], motion: &Motion<T>) -> Load<T> {
        Detent::load(params, motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_valleys_return_at_their_own_distance() {
        let torque =
            |theta: f64| SecondDetent::load(&[1.3, 0.2, 0.9], &Motion::exact(0.0, theta, 1.0, 0.0)).drive;
        assert!((torque(0.37) - torque(0.37 + TAU * 0.2)).abs() < 1e-12);
        assert!((torque(0.0) - 1.3 * 0.9_f64.sin()).abs() < 1e-12);
    }
}
