//! Stribeck friction: dry friction rises towards zero speed.

use super::{Carrier, Context, Effect, Id, LoadEffect, Over, Survey, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Dry friction times 1 + rise exp(-(|omega| / vs)^delta).
///
/// `rise` is a share of the Coulomb level of each direction; -1 would leave no friction at rest.
pub struct Stribeck;

/// Speeds below this share of `vs` are as good as rest.
const REST: f64 = 1e-9;
/// Friction at rest is at most about three times that in motion (Armstrong-Helouvry, Dupont & Canudas de Wit 1994); far
/// beyond it nothing rises towards rest: with hardly any Coulomb friction left the law is a drag that bends.
const MOST: f64 = 10.0;

impl Effect<3> for Stribeck {
    const ID: &'static str = "stribeck";
    const LAW: &'static str = "coulomb (1 + rise exp(-(|omega|/vs)^delta))";
    const SOURCE: &'static str =
        "Stribeck 1902; Bo & Pavelescu 1982; Armstrong-Helouvry, Dupont & Canudas de Wit 1994, Equation 4";
    const SHOWS: &'static str = "at low speed, on both sides of every reversal";
    const CONFUSED: &'static [&'static str] = &["presliding", "quadratic_drag", "viscous"];
    const TOUCHES: &'static [Channel] = &[Channel::FrictionScale];
    const WORDS: Words = Words {
        title: "Stribeck friction",
        name: "friction rises towards standstill",
        about: "As the knob slows down the film of lubricant between the surfaces thins out, they touch, and \
                friction rises.",
        causes: &[
            "mixed lubrication: grease or oil that carries only at speed",
            "rough or new surfaces that are not run in",
            "too little lubricant, or one that is too thin",
        ],
        remedies: &[
            "use a more viscous lubricant, or one with additives against stick-slip",
            "polish or run in the surfaces",
            "use rolling bearings or a low-friction liner",
        ],
        latex: r"C_{\pm} \left(1 + r\,e^{-(|\omega|/v_s)^{\delta}}\right) \operatorname{sgn}\omega",
    };
    const OVER: Over = Over::Velocity;
    const PARAMS: [Param; 3] = [
        Param::shape(
            "rise",
            Unit::NUMBER,
            [-0.99, 100.0],
            0.0,
            "rise towards rest, a share of the dry friction",
        )
        .plausibly(0.0, f64::INFINITY),
        Param::shape("vs", Unit::of(0, 1, -1), [1e-6, 1e6], 1.0, "Stribeck speed"),
        Param::shape("delta", Unit::NUMBER, [0.25, 4.0], 1.0, "sharpness of the fall"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        let speed = |q| Survey::quantile(&survey.speed, q).max(1e-6);
        let speeds = [0.05, 0.15, 0.35, 0.7];
        speeds.iter().flat_map(|q| [[0.0, speed(*q), 1.0], [0.0, speed(*q), 2.0]]).collect()
    }

    fn implausible(&[rise, ..]: &[f64; 3], _: &Context) -> Vec<String> {
        let said =
            format!("friction at rest is {:.0} times that in motion: it is a drag that bends", 1.0 + rise);
        if rise > MOST { vec![said] } else { Vec::new() }
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        let vs = Survey::quantile(&carrier.survey.speed, 0.2).max(1e-6);
        carrier.sized(Id::Stribeck, [0.2, 5.0], |rise| [rise, vs, 1.0])
    }
}

impl LoadEffect<3> for Stribeck {
    #[inline(always)]
    fn load<T: Scalar>([rise, vs, delta]: &[T; 3], motion: &Motion<T>) -> Load<T> {
        let speed = (motion.omega.abs() / *vs).max(T::of(REST));
        Load::friction_scale(T::of(1.0) + *rise * (-speed.powf(*delta)).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rises_beyond_all_friction_is_a_drag() {
        let context = Context::default();
        assert!(Stribeck::implausible(&[2.0, 0.2, 1.0], &context).is_empty());
        let said = Stribeck::implausible(&[99.0, 9.5, 1.05], &context);
        assert!(said.len() == 1 && said[0].contains("100 times"), "{said:?}");
    }

    #[test]
    fn friction_at_rest_is_higher_by_the_rise_and_falls_to_coulomb() {
        let level = |omega: f64| {
            Stribeck::load(&[0.5, 0.2, 2.0], &Motion::exact(0.0, 0.0, omega, 0.0)).friction_scale
        };
        assert!((level(0.0) - 1.5).abs() < 1e-12 && (level(-100.0) - 1.0).abs() < 1e-12);
        assert!((level(0.2) - (1.0 + 0.5 * (-1.0_f64).exp())).abs() < 1e-12);
        assert_eq!(level(0.1), level(-0.1));
    }
}
