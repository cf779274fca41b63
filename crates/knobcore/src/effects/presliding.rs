//! Presliding: friction builds up over a distance after each reversal.

use super::{Carrier, Context, Effect, Id, MemoryEffect, Over, Survey, Words, apart};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Elastoplastic elements in parallel (Maxwell slip), element i carrying the share `w_i` of the dry friction and
/// slipping after s / 2^(i-1); what no element carries follows the sign of the motion at once.
///
/// Distances a factor of two apart draw any friction curve that rises ever more slowly (Masing 1926) to about a
/// hundredth.
pub struct Presliding;

/// Share of the range: presliding is over by then.
const FAR: f64 = 0.2;
/// Samples after a reversal that it takes at least.
const NEAR: f64 = 2.0;
/// By so much shares may add up to more than all for how they are written down.
const ROUNDED: f64 = 1e-6;
/// Shares of friction all of which builds up, most of it late.
const ALL: [f64; 6] = [0.35, 0.25, 0.2, 0.1, 0.05, 0.05];

const fn share(name: &'static str, meaning: &'static str) -> Param {
    Param::shape(name, Unit::NUMBER, [0.0, 1.0], 0.0, meaning)
}

impl Effect<7> for Presliding {
    const ID: &'static str = "presliding";
    const LAW: &'static str =
        "coulomb ((1 - sum w_i) sgn(omega) + sum w_i z_i), dz_i = dtheta 2^(i-1)/s, |z_i| <= 1";
    const SOURCE: &'static str = "Iwan 1966; Al-Bender, Lampaert & Swevers 2005 (generalized Maxwell slip); cf. LuGre, \
                                  Canudas de Wit, Olsson, Astrom & Lischinsky 1995";
    const SHOWS: &'static str = "over the first few hundredths of a radian after each reversal";
    const CONFUSED: &'static [&'static str] = &["torque_lag", "backlash", "compliance", "stribeck"];
    const TOUCHES: &'static [Channel] = &[Channel::Hysteresis];
    const WORDS: Words = Words {
        title: "presliding",
        name: "friction builds up over a distance after each reversal",
        about: "Before surfaces slip they give a little like a spring, so that friction turns round over a \
                distance and not at once.",
        causes: &[
            "asperities of the surfaces that bend before they slip",
            "a seal or rubber part that is sheared before it slides",
            "grease that creeps",
        ],
        remedies: &[
            "use stiffer seals or lower their preload",
            "choose harder or smoother surfaces",
            "use rolling bearings with little preload",
        ],
        latex: concat!(
            r"C_{\pm} \Bigl(\bigl(1 - \textstyle\sum_i w_i\bigr) \operatorname{sgn}\omega + ",
            r"\textstyle\sum_i w_i z_i\Bigr),\quad \dot z_i = \frac{2^{i-1}}{s}\,\omega,\ |z_i| ",
            r"\le 1",
        ),
    };
    const OVER: Over = Over::Reversal;
    /// More than all of the friction would push the knob on after a reversal.
    const SHARES: &'static [usize] = &[1, 2, 3, 4, 5, 6];
    const PARAMS: [Param; 7] = [
        Param::shape("s", Unit::of(0, 1, 0), [1e-7, 1e3], 0.1, "longest presliding distance"),
        share("w1", "share of friction that builds up over s"),
        share("w2", "share over s/2"),
        share("w3", "share over s/4"),
        share("w4", "share over s/8"),
        share("w5", "share over s/16"),
        share("w6", "share over s/32"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 7]> {
        let longest = 0.3 * survey.range();
        let lengths = [1.0, 0.4, 0.16, 0.064, 0.025, 0.01].map(|share| share * longest.min(1.0));
        let start =
            |[w1, w2, w3, w4, w5, w6]: [f64; 6]| lengths.map(|s| [s.max(1e-7), w1, w2, w3, w4, w5, w6]);
        let mut starts = start([0.0; 6]).to_vec();
        // Friction that builds up over most of the way looks like a spring and like none, and of none no share builds up.
        let [neg, pos] = survey.friction;
        if apart(neg, pos) {
            starts.extend(start(ALL));
        }
        starts
    }

    /// It ends within a small part of the way, and takes longer than the sensors' step.
    fn implausible(p: &[f64; 7], context: &Context) -> Vec<String> {
        let [_, shares @ ..] = p;
        let sum: f64 = shares.iter().sum();
        if sum > 1.0 + ROUNDED {
            return vec![format!("{sum:.3} of the friction builds up: more than all of it")];
        }
        let Some(mean) = Self::builds_up_over(p) else { return Vec::new() };
        let over = context.way(mean);
        if mean > FAR * context.travel() {
            return vec![format!("it takes {over} to slip, a good part of the way: it is a spring")];
        }
        // From rest: where it turns a knob is slow, and even a short distance lasts.
        if (2.0 * mean / context.turning).sqrt() * context.rate_hz < NEAR {
            let why = "less than two samples: a lag of the torque does the same";
            return vec![format!("it slips within {over}, {why}")];
        }
        Vec::new()
    }

    fn builds_up_over([s, shares @ ..]: &[f64; 7]) -> Option<f64> {
        let reach = (0..).map(|i| s / 2.0_f64.powi(i));
        let sum: f64 = shares.iter().sum();
        Some(shares.iter().zip(reach).map(|(w, s)| w * s).sum::<f64>() / sum.max(1e-12))
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 7] {
        // By the share of the friction that builds up; where nine tenths are not enough, by the distance too.
        let range = carrier.survey.range().max(1e-6);
        carrier.sized(Id::Presliding, [0.03, 12.0], |size| {
            let [w1, w2, w4] = [0.25, 0.2, 0.1].map(|share| share * size.min(1.0));
            [0.02 * range * size.max(1.0), w1, w2, w2, w4, w4, 0.5 * w4]
        })
    }
}

/// Each element remembers z_i.
impl MemoryEffect<7, 1, 6> for Presliding {
    /// 2^(i-1).
    const ELEMENTS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

    #[inline(always)]
    fn remember<T: Scalar>([s]: &[T; 1], element: T, z: T, by: T) -> T {
        let one = T::of(1.0);
        (z + by * (element / *s)).min(one).max(-one)
    }

    #[inline(always)]
    fn load<T: Scalar>(share: T, z: T, motion: &Motion<T>) -> Load<T> {
        Load { hysteresis: share * (z - motion.direction()), builds_up: share, ..Load::none() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction of unit Coulomb level along a path.
    fn friction(path: &[f64]) -> Vec<f64> {
        let law = Id::Presliding.law();
        let mut state = vec![0.0; law.states()];
        let mut before = path[0];
        path.iter()
            .map(|theta| {
                let motion = Motion::exact(0.0, *theta, theta - before, 0.0);
                before = *theta;
                let mut load = Load { resist: [1.0, 1.0], ..Load::none() };
                law.load(&[0.1, 0.5, 0.3, 0.0, 0.0, 0.0, 0.2], &mut state, &motion, &mut load);
                load.friction(motion.forward, 0.0)
            })
            .collect()
    }

    #[test]
    fn friction_rises_with_distance_to_the_coulomb_level_and_no_further() {
        let path: Vec<f64> = (0..400).map(|i| f64::from(i) * 1e-3).collect();
        let f = friction(&path);
        assert!(f.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12));
        assert!((f[399] - 1.0).abs() < 1e-12 && f[20] < 0.7);
    }

    #[test]
    fn after_a_reversal_the_curve_is_twice_the_first_one_turned_round() {
        // Masing 1926: f(reversal + 2 x) = f_max - 2 f(x).
        let up = (0..400).map(|i| f64::from(i) * 1e-3);
        let path: Vec<f64> = up.chain((0..300).map(|i| 0.399 - f64::from(i) * 1e-3)).collect();
        let f = friction(&path);
        for i in [5_usize, 20, 40, 90] {
            assert!((f[400 + 2 * i] - (1.0 - 2.0 * f[i])).abs() < 1e-9, "{i}: {} {}", f[400 + 2 * i], f[i]);
        }
    }

    #[test]
    fn friction_that_looks_like_none_is_looked_for_as_building_up_altogether_too() {
        let survey = |friction| {
            let torque = vec![0.0, 0.05];
            Survey { friction, theta: vec![-1.0, 1.0], speed: torque.clone(), torque, ..Survey::default() }
        };
        let builds_up = |friction| {
            let starts = Presliding::starts(&survey(friction));
            starts.iter().filter(|[_, shares @ ..]| (shares.iter().sum::<f64>() - 1.0).abs() < 1e-12).count()
        };
        assert_eq!([[5e-3, 6e-3], [2e-3, 5e-3], [-3e-3, 2e-3], [-3e-3, -2e-3]].map(builds_up), [0, 6, 6, 6]);
    }

    #[test]
    fn it_builds_up_over_twice_what_it_lacks_from_rest() {
        let path: Vec<f64> = (0..20_000).map(|i| f64::from(i) * 1e-5).collect();
        let lacks: f64 = friction(&path).iter().map(|f| (1.0 - f) * 1e-5).sum();
        let over = Presliding::builds_up_over(&[0.1, 0.5, 0.3, 0.0, 0.0, 0.0, 0.2]).unwrap();
        assert!((2.0 * lacks / over - 1.0).abs() < 1e-3, "{over} {lacks}");
    }
}
