//! Detents: evenly spaced valleys that the knob falls into.

use super::{Base, Carrier, Context, Effect, LoadEffect, Over, Survey, Wave, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;
use core::f64::consts::TAU;

/// Times the way: of a longer one less than a half was seen, and a bent line is no wave.
const LONGEST: f64 = 2.0;

/// A sin(theta / P + S); one detent is 2 pi P.
pub struct Detent;

impl Effect<3> for Detent {
    const ID: &'static str = "detent";
    const LAW: &'static str = "A sin(theta/P + S)";
    const SOURCE: &'static str = "position part of Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "over position, repeating every 2 pi P";
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::NormalLoad];
    const WORDS: Words = Words {
        title: "detent",
        name: "there are detents",
        about: "The knob falls into evenly spaced valleys and has to be pushed out of each.",
        causes: &[
            "a ball or spring that rides over a toothed wheel",
            "magnets that attract each other at certain angles",
            "cogging of a motor",
        ],
        remedies: &[
            "a stiffer or softer spring changes the depth",
            "another wheel changes the number per turn",
            "skewed magnets or slots take cogging away",
        ],
        latex: r"A \sin\!\left(\frac{\theta}{P} + S\right)",
    };
    const OVER: Over = Over::Position;
    const BASE: Option<Base> = Some(Base::WhereShown);
    const SCAN: Option<Wave> = Some(Wave::Torque);
    const PARAMS: [Param; 3] = [
        Param::linear("A", Unit::of(1, 0, 0), "amplitude"),
        Param::shape("P", Unit::of(0, 1, 0), [1e-9, 1e6], 0.1, "period over 2 pi"),
        Param::phase("S", 0, "phase"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        survey.waves.clone().unwrap_or_else(|| vec![Self::PARAMS.map(|param| param.neutral)])
    }

    fn implausible(&[_, p, _]: &[f64; 3], context: &Context) -> Vec<String> {
        let pitch = TAU * p.abs();
        if pitch <= LONGEST * context.travel() {
            return Vec::new();
        }
        vec![format!("a detent is {} long, more than twice the way: it is a spring", context.way(pitch))]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        let [a, p] = carrier.detent.unwrap_or([0.005, 0.08]);
        [a, p, 0.5]
    }
}

impl LoadEffect<3> for Detent {
    #[inline(always)]
    fn load<T: Scalar>([a, p, s]: &[T; 3], motion: &Motion<T>) -> Load<T> {
        Load::detent(*a * (motion.theta / *p + *s).sin_cos().0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_repeats_at_the_next_detent_and_the_work_over_one_is_nothing() {
        let torque = |theta: f64| Detent::load(&[1.3, 0.2, 0.9], &Motion::exact(0.0, theta, 1.0, 0.0)).drive;
        let n = 1000;
        let pitch = TAU * 0.2;
        let work: f64 = (0..n).map(|i| torque(pitch * f64::from(i) / f64::from(n))).sum();
        assert!(work.abs() < 1e-11);
        assert!((torque(0.37) - torque(0.37 + pitch)).abs() < 1e-12);
    }

    #[test]
    fn one_of_which_less_than_half_was_seen_is_a_spring() {
        let context = Context { theta: vec![-1.0, 2.0], revolution: Some(1.0), ..Context::default() };
        assert!(Detent::implausible(&[0.1, 0.9, 0.0], &context).is_empty());
        let said = Detent::implausible(&[0.1, -1.0, 0.0], &context);
        assert_eq!(said, ["a detent is 6.3 rad long, more than twice the way: it is a spring"]);
    }
}
