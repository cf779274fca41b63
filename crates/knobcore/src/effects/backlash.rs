//! Backlash: free play between shaft and knob.

use super::{Carrier, Context, CouplingEffect, Effect, Id, Joint, Nonlinear, Section, Survey, Words};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// A joint that is stiff (k, d) beyond a free play of `gap`; the knob's side holds `share` of the inertia and
/// every other load. The surfaces push and never pull.
///
/// A knock may be shorter than a sample: what passes through is told as its mean over one, so that the impulse is whole.
/// No finite contact is rigid. The neutral one, without gap and as stiff as it may be, leaves the torque as it is
/// to a fiftieth of its size, which the samples next to a reversal make.
pub struct Backlash;

impl Effect<4> for Backlash {
    const ID: &'static str = "backlash";
    const LAW: &'static str =
        "no torque within the gap; beyond it k (twist - gap/2) + d twist', pushing only";
    const SOURCE: &'static str = "Nordin & Gutman 2002, Equation 4; Nordin, Galic & Gutman 1997";
    const SHOWS: &'static str = "after each reversal: the torque of the free side only";
    const CONFUSED: &'static [&'static str] = &["presliding", "directional_detent", "compliance"];
    const SECTION: Option<Section> = Some(Section::Gap);
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::Everything);
    const WORDS: Words = Words {
        title: "backlash",
        name: "there is free play between shaft and knob",
        about: "After each reversal the shaft turns through a gap before it takes the knob along, and meets \
                it with a knock.",
        causes: &[
            "worn or wide gear teeth, splines or keyways",
            "a loose set screw, hub or coupling",
            "clearance in a joint that was made to slide together",
        ],
        remedies: &[
            "tighten or pin the joint",
            "take the play out with a preload spring or a clamping hub",
            "replace worn parts, or choose a tighter fit",
        ],
        latex: concat!(
            r"\tau = \begin{cases} k\,(\delta \mp \tfrac{g}{2}) + d\,\dot\delta & |\delta| > ",
            r"\tfrac{g}{2},\ \text{pushing} \\ 0 & \text{otherwise} \end{cases}",
        ),
    };
    const PARAMS: [Param; 4] = [
        Param::shape("gap", Unit::of(0, 1, 0), [0.0, 10.0], 0.0, "free play, from one side to the other"),
        Param::shape("k", Unit::of(1, -1, 0), [1e-3, 1e5], 1e5, "stiffness of the contact"),
        Param::shape("d", Unit::of(1, -1, 1), [1e-9, 1e2], 1e2, "damping of the contact"),
        Param::shape("share", Unit::NUMBER, [0.01, 1.0], 0.7, "share of the inertia behind the joint")
            .plausibly(0.02, 0.999),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 4]> {
        let inertia = survey.inertia.max(1e-12);
        // Contact that is damped to a half and rings at a fraction of the sampling rate: through the coarse filter that the
        // search begins with a harder one is all edges, from most of which no slope leads on.
        let rings = |share_of_rate: f64, share: f64| {
            let omega = core::f64::consts::TAU * share_of_rate * survey.rate_hz;
            [(share * inertia * omega * omega).clamp(1e-3, 1e5), (share * inertia * omega).clamp(1e-9, 1e2)]
        };
        let mut starts = Vec::new();
        let mut gap = 0.001 * survey.range().clamp(0.1, 2.0);
        for _ in 0..7 {
            for share_of_rate in [0.008, 0.015, 0.03] {
                let [k, d] = rings(share_of_rate, 0.7);
                starts.push([gap, k, d, 0.7]);
            }
            gap *= 2.0;
        }
        starts
    }

    /// Backlash without play is compliance.
    fn implausible(&[gap, k, _, _]: &[f64; 4], context: &Context) -> Vec<String> {
        // What the spring winds up by under the torque of the noise is no play.
        if gap > context.unsure(0).max(context.noise_floor / k) {
            return Vec::new();
        }
        vec!["its gap is nothing: it is compliance".into()]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 4] {
        // Surfaces that hardly give under the largest torque, and ring well below the sampling rate, damped to a half.
        let (inertia, share) = (carrier.inertia(), 0.7);
        let omega = core::f64::consts::TAU * 0.03 * carrier.survey.rate_hz;
        let k = (share * inertia * omega * omega).max(carrier.peak() / 0.02);
        let d = (share * inertia * k).sqrt() + carrier.pushes;
        let widest = 0.08_f64.min(0.2 * carrier.survey.range());
        carrier.sized(Id::Backlash, [0.01 * widest, widest], |gap| [gap, k, d, share])
    }
}

impl CouplingEffect<4> for Backlash {
    #[inline(always)]
    fn joint<T: Scalar>([gap, k, d, share]: &[T; 4]) -> Joint<T> {
        Joint { gap: *gap, stiffness: *k, damping: *d, share: *share, welded: false }
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::Id;
    use crate::model::Model;
    use crate::param::Axis;
    use crate::predict;
    use crate::signals::Signals;

    #[test]
    fn after_a_reversal_the_shaft_turns_through_the_gap_with_its_own_inertia_alone() {
        let (gap, share, inertia, rate_hz) = (0.05, 0.6, 1e-4, 5000.0);
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        for (name, value) in [
            ("inertia.M", inertia),
            ("coulomb.neg", 0.05),
            ("coulomb.pos", 0.05),
            ("backlash.gap", gap),
            ("backlash.k", 100.0),
            ("backlash.d", 0.05),
            ("backlash.share", share),
        ] {
            model.set(name, value).unwrap();
        }
        // Half a cycle and a bit: it reverses once, and dry friction then holds the knob where it is.
        let w = 4.0_f64;
        let over =
            |f: &dyn Fn(f64) -> f64| (0..5000).map(|i| f(f64::from(i) / rate_hz)).collect::<Vec<f64>>();
        let signals = Signals {
            rate_hz,
            substeps: 4,
            t: over(&|t| t),
            theta: over(&|t| (w * t).sin()),
            omega: over(&|t| w * (w * t).cos()),
            alpha: over(&|t| -w * w * (w * t).sin()),
            forward: over(&|t| f64::from(u8::from((w * t).cos() > 0.0))),
            segments: vec![0..5000; 1],
            ..Signals::default()
        };
        let tau = predict::torque_raw(&model, &signals);
        let free = |i: &usize| (tau[*i] - (1.0 - share) * inertia * signals.alpha[*i]).abs() < 1e-9;
        let reversal = (core::f64::consts::FRAC_PI_2 / w * rate_hz) as usize;
        let flight: Vec<usize> = (reversal..5000).filter(free).collect();
        let ends = |i: usize| signals.theta[flight[i]];
        let travel = ends(0) - ends(flight.len() - 1);
        assert!((travel - gap).abs() < 0.03 * gap, "{travel}");
        assert!((tau[4500] + 0.05 - inertia * signals.alpha[4500]).abs() < 1e-4, "{}", tau[4500]);
    }
}
