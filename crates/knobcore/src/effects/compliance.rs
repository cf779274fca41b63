//! Compliance: an elastic shaft between rig and knob.

use super::{Carrier, Context, CouplingEffect, Effect, Id, Joint, Nonlinear, Survey, Words};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// k twist + d twist'; the knob's side holds `share` of the inertia and every other load.
///
/// No finite shaft is rigid. The neutral one, as stiff as it may be, leaves the torque as it is to a hundredth of
/// its size, which the samples next to a reversal make.
pub struct Compliance;

impl Effect<3> for Compliance {
    const ID: &'static str = "compliance";
    const LAW: &'static str =
        "k twist + d twist' between the shaft and the knob, which has share M of the inertia";
    const SOURCE: &'static str = "two-mass drive; Nordin & Gutman 2002, Equation 1";
    const SHOWS: &'static str = "at fast accelerations, ringing at one frequency";
    const CONFUSED: &'static [&'static str] = &["torque_lag", "inertia", "presliding", "backlash"];
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::Everything);
    const WORDS: Words = Words {
        title: "elastic joint",
        name: "the joint between shaft and knob is elastic",
        about: "Shaft and knob are joined by a spring, so that the knob swings behind the shaft and rings at \
                one frequency.",
        causes: &[
            "a long or thin shaft",
            "a soft coupling or belt",
            "a knob of rubber, or one pressed on with little grip",
        ],
        remedies: &[
            "shorten or thicken the shaft",
            "use a stiffer coupling",
            "make the knob lighter, which moves the ringing to a higher frequency",
        ],
        latex: r"\tau = k\,\delta + d\,\dot\delta",
    };
    const PARAMS: [Param; 3] = [
        Param::shape("k", Unit::of(1, -1, 0), [1e-3, 1e5], 1e5, "stiffness"),
        Param::shape("d", Unit::of(1, -1, 1), [1e-9, 1e2], 1e2, "damping"),
        Param::shape("share", Unit::NUMBER, [0.01, 1.0], 0.7, "share of the inertia behind the shaft")
            .plausibly(0.02, 0.999),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        let inertia = survey.inertia.max(1e-12);
        let mut starts = Vec::new();
        for share_of_rate in [0.003, 0.006, 0.012, 0.024, 0.048] {
            for share in [0.8, 0.5] {
                let omega = core::f64::consts::TAU * share_of_rate * survey.rate_hz;
                let k = (share * inertia * omega * omega).clamp(1e-3, 1e5);
                starts.push([k, (0.05 * share * inertia * omega).clamp(1e-9, 1e2), share]);
            }
        }
        starts
    }

    /// What is joined by no spring is only dragged along, as a load is that another motor makes too late.
    fn implausible(&[k, _, _]: &[f64; 3], context: &Context) -> Vec<String> {
        if k > context.unsure(0) {
            return Vec::new();
        }
        vec!["its stiffness is not told from none: it is no elastic joint".into()]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 3] {
        // By how slowly the knob rings behind the shaft: twenty samples a period at the least, and damped
        // so that it has rung out before the next reversal.
        let inertia = carrier.inertia();
        carrier.sized(Id::Compliance, [20.0 / carrier.survey.rate_hz, 1.0 / 15.0], |period| {
            let omega = core::f64::consts::TAU / period;
            let k = 0.7 * inertia * omega * omega;
            [k, 0.3 * k / omega + carrier.pushes, 0.7]
        })
    }
}

impl CouplingEffect<3> for Compliance {
    #[inline(always)]
    fn joint<T: Scalar>([k, d, share]: &[T; 3]) -> Joint<T> {
        Joint { gap: T::of(0.0), stiffness: *k, damping: *d, share: *share, welded: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::param::Axis;
    use crate::predict;
    use crate::signals::Signals;

    #[test]
    fn a_joint_whose_stiffness_may_be_nothing_is_none() {
        let said = |error: &[Option<f64>]| {
            let context = Context { errors: error.to_vec(), ..Context::default() };
            Compliance::implausible(&[0.15, 9e-3, 0.75], &context).len()
        };
        assert_eq!([said(&[]), said(&[Some(0.07)]), said(&[Some(0.25)]), said(&[None])], [0, 0, 1, 0]);
    }

    #[test]
    fn below_resonance_the_inertia_behind_the_shaft_weighs_more_and_above_it_less() {
        let (share, inertia, rate_hz) = (0.6, 1e-4, 5000.0);
        let resonance = core::f64::consts::TAU * 40.0;
        let stiffness = share * inertia * resonance * resonance;
        for ratio in [0.2_f64, 0.5, 2.0] {
            let mut model = Model::new(&[Id::Inertia, Id::Compliance], Axis::Rotary);
            for (name, value) in [
                ("inertia.M", inertia),
                ("compliance.k", stiffness),
                ("compliance.d", 0.03 * stiffness / resonance),
                ("compliance.share", share),
            ] {
                model.set(name, value).unwrap();
            }
            let w = ratio * resonance;
            let over = |f: &dyn Fn(f64) -> f64| {
                (0..10_000).map(|i| f(w * f64::from(i) / rate_hz)).collect::<Vec<f64>>()
            };
            let signals = Signals {
                rate_hz,
                substeps: 4,
                t: over(&|x| x / w),
                theta: over(&|x| 0.01 * x.sin()),
                omega: over(&|x| 0.01 * w * x.cos()),
                alpha: over(&|x| -0.01 * w * w * x.sin()),
                forward: over(&|x| f64::from(u8::from(x.cos() > 0.0))),
                segments: vec![0..10_000; 1],
                ..Signals::default()
            };
            // Once the start has rung out: the torque along the acceleration is the apparent inertia.
            let tau = predict::torque_raw(&model, &signals);
            let along = |x: &[f64]| x.iter().zip(&signals.alpha).skip(5000).map(|(x, a)| x * a).sum::<f64>();
            let apparent = along(&tau) / along(&signals.alpha);
            let expected = inertia * (1.0 - share + share / (1.0 - ratio * ratio));
            assert!((apparent - expected).abs() < 0.01 * inertia, "{ratio}: {apparent} {expected}");
        }
    }
}
