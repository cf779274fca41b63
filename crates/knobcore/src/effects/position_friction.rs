//! Position-dependent friction: the level of dry friction varies along the way.

use super::{Carrier, Context, Effect, Id, LoadEffect, Survey, Wave, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Dry friction times 1 + sum of a_n sin(n theta/P) + b_n cos(n theta/P), n = 1 to 4; never below zero.
pub struct PositionFriction;

/// The least that is left of dry friction: friction never pushes.
const LEAST: f64 = 1e-3;
/// Periods that a motion must cross.
const CYCLES: f64 = 0.8;
/// Or this part of one, if it holds so many of the strongest waves.
const LEAST_CYCLES: f64 = 0.5;
/// See [`LEAST_CYCLES`].
const WAVES: f64 = 1.6;
/// Times the dry friction: what its series may add up to.
const LARGEST: f64 = 2.0;
/// A period this many times that of the detents belongs to them,
const LOCKED: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 0.5];
/// up to this share.
const CLOSE: f64 = 0.01;
/// Times the friction one way: what the other way has at least of what varies both ways.
const BOTH_WAYS: f64 = 0.1;
/// Share of its squares that waves have which return with each detent, at least, if it belongs to them.
const RETURNS: f64 = 0.5;

const fn wave(name: &'static str, meaning: &'static str) -> Param {
    Param::shape(name, Unit::NUMBER, [-10.0, 10.0], 0.0, meaning)
}

impl Effect<9> for PositionFriction {
    const ID: &'static str = "position_friction";
    const LAW: &'static str = "coulomb (1 + sum of a_n sin(n theta/P) + b_n cos(n theta/P)), n = 1 to 4";
    const SOURCE: &'static str = "Popovic & Goldenberg 1998 (friction over position by its spectrum)";
    const SHOWS: &'static str = "over position, with the sign of the motion";
    const CONFUSED: &'static [&'static str] = &["friction_drift", "load_friction", "directional_detent"];
    const TOUCHES: &'static [Channel] = &[Channel::FrictionScale];
    const WORDS: Words = Words {
        title: "friction over position",
        name: "friction varies along the way",
        about: "The knob rubs harder at some positions than at others.",
        causes: &[
            "a bent shaft or an oval bearing",
            "a seal or a brush that presses unevenly",
            "dirt or wear at certain places",
        ],
        remedies: &[
            "straighten the shaft, align the bearings",
            "clean and grease evenly",
            "turn shaft against bearing and see with which of them the pattern moves",
        ],
        latex: concat!(
            r"C_{\pm} \left(1 + \sum_{n=1}^{4} a_n \sin\frac{n\,\theta}{P} + b_n ",
            r"\cos\frac{n\,\theta}{P}\right) \operatorname{sgn}\omega",
        ),
    };
    const SCAN: Option<Wave> = Some(Wave::Friction);
    const PARAMS: [Param; 9] = [
        Param::shape("P", Unit::of(0, 1, 0), [1e-6, 1e6], 1.0, "period over 2 pi"),
        wave("a1", "sine once per period, a share of the dry friction"),
        wave("b1", "cosine once per period"),
        wave("a2", "sine twice per period"),
        wave("b2", "cosine twice per period"),
        wave("a3", "sine three times per period"),
        wave("b3", "cosine three times per period"),
        wave("a4", "sine four times per period"),
        wave("b4", "cosine four times per period"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 9]> {
        if let Some(waves) = &survey.waves {
            // Each of the strongest waves may be the first, second or third of its series.
            let series = waves.iter().flat_map(|[_, p, _]| [*p, 2.0 * p, 3.0 * p]);
            return series.map(|p| [p, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        }
        // From half a cycle over the range to forty, each close enough to the next to be followed.
        let range = survey.range().max(1e-6);
        let mut cycles = 0.5;
        let mut starts = Vec::new();
        while cycles < 40.0 && starts.len() < 40 {
            let period = range / (core::f64::consts::TAU * cycles);
            let mut start = [0.0; 9];
            start[0] = period.clamp(1e-6, 1e6);
            starts.push(start);
            cycles += f64::max(0.3, 0.06 * cycles);
        }
        starts
    }

    /// Friction that varies along the way stays friction, and goes through a period of its own.
    fn implausible(p: &[f64; 9], context: &Context) -> Vec<String> {
        let [period, series @ ..] = p;
        let cycles = context.travel() / (core::f64::consts::TAU * period);
        let size_of = |wave: &[f64]| wave.iter().copied().fold(0.0, f64::hypot);
        let sizes: Vec<f64> = series.chunks(2).map(size_of).collect();
        // A series whose higher waves are its strongest goes up and down within a part of its period.
        let squares: f64 = sizes.iter().map(|size| size * size).sum();
        let weighted: f64 = sizes.iter().zip(1..).map(|(size, n)| f64::from(n) * size * size).sum();
        let strongest = weighted / squares.max(1e-300);
        if cycles < CYCLES && !(cycles >= LEAST_CYCLES && cycles * strongest >= WAVES) {
            return vec![format!("only {cycles:.1} of its periods were crossed: it is a trend")];
        }
        let size: f64 = sizes.iter().sum();
        if size > LARGEST {
            return vec![format!("it varies by {size:.1} times the friction there is")];
        }
        let ratio = context.period.map_or(f64::NAN, |detents| period / detents);
        let returns = |times: f64| -> f64 {
            let with_each = |&(n, _): &(i32, &f64)| (f64::from(n) / times).fract() == 0.0;
            (1..).zip(&sizes).filter(with_each).map(|(_, size)| size * size).sum()
        };
        let locked = |times: f64| (ratio / times - 1.0).abs() < CLOSE && returns(times) >= RETURNS * squares;
        if LOCKED.into_iter().any(locked) {
            let others = "{load_friction} or {directional_detent} would, by nature";
            return vec![format!("it repeats with the detents: {others}")];
        }
        let [back, forth] = context.friction;
        if back * forth < 0.0 {
            // More of it is a constant torque than friction, and with that it draws any map of position.
            return vec!["what varies pushes one way, there and back: it is a torque over position".into()];
        }
        let both_ways = context.turning > 0.0; // else what the other way has is not known
        if both_ways && back.abs().min(forth.abs()) < BOTH_WAYS * back.abs().max(forth.abs()) {
            // Less of it is a constant torque, but as good as all that there is one way.
            return vec!["what varies rubs one way alone, as a pawl does and no friction".into()];
        }
        Vec::new()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 9] {
        let period = carrier.survey.range().max(1e-6) / (1.5 * core::f64::consts::TAU);
        carrier.sized(Id::PositionFriction, [0.1, 1.1], |s| {
            [period, 0.5 * s, 0.1 * s, 0.2 * s, 0.1 * s, 0.1 * s, -0.05 * s, 0.03 * s, 0.03 * s]
        })
    }
}

impl LoadEffect<9> for PositionFriction {
    #[inline(always)]
    fn load<T: Scalar>([p, a1, b1, a2, b2, a3, b3, a4, b4]: &[T; 9], motion: &Motion<T>) -> Load<T> {
        let (s, c) = (motion.theta / *p).sin_cos();
        let two = T::of(2.0);
        let (s2, c2) = (two * s * c, c * c - s * s);
        let (s3, c3) = (s2 * c + c2 * s, c2 * c - s2 * s);
        let (s4, c4) = (two * s2 * c2, c2 * c2 - s2 * s2);
        let level =
            T::of(1.0) + *a1 * s + *b1 * c + *a2 * s2 + *b2 * c2 + *a3 * s3 + *b3 * c3 + *a4 * s4 + *b4 * c4;
        Load::friction_scale(level.max(T::of(LEAST)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pushes_or_rubs_one_way_alone_is_no_friction() {
        let p = [0.1, 0.3, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0];
        let theta = (0..100).map(|i| 0.02 * f64::from(i)).collect();
        let context = Context { theta, turning: 1.0, ..Context::default() };
        let said = |friction| PositionFriction::implausible(&p, &Context { friction, ..context.clone() });
        assert!(said([0.0, 0.0]).is_empty() && said([2e-3, 9e-3]).is_empty());
        let forward = Context { friction: [0.0, 9e-3], turning: 0.0, ..context.clone() };
        assert!(PositionFriction::implausible(&p, &forward).is_empty());
        assert!(said([-2e-3, 9e-3])[0].contains("there and back"));
        assert!(said([8e-4, 9e-3])[0].contains("one way alone") && said([9e-3, 0.0]).len() == 1);
    }

    #[test]
    fn friction_varies_along_the_way_and_never_pushes() {
        let p = [0.5, 0.3, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0];
        let level = |p: &[f64; 9], theta: f64| {
            PositionFriction::load(p, &Motion::exact(0.0, theta, 1.0, 0.0)).friction_scale
        };
        let x = 0.7_f64;
        assert!((level(&p, 0.5 * x) - (1.0 + 0.3 * x.sin() + 0.2 * (2.0 * x).cos())).abs() < 1e-12);
        let wild = [0.5, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!((0..100).all(|i| level(&wild, f64::from(i) * 0.05) > 0.0));
    }
}
