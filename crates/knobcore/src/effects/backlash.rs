//! Backlash: free play between shaft and knob.

use super::{Bends, CouplingEffect, Effect, Joint, Survey};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// A joint that is stiff (k, d) beyond a free play of `gap`; the knob's side holds `share` of the inertia and
/// every other load. The surfaces push and never pull.
pub struct Backlash;

impl Effect<4> for Backlash {
    const ID: &'static str = "backlash";
    const LAW: &'static str =
        "no torque within the gap; beyond it k (twist - gap/2) + d twist', pushing only";
    const SOURCE: &'static str = "Nordin & Gutman 2002, Equation 4; Nordin, Galic' & Gutman 1997";
    const SHOWS: &'static str = "after each reversal: the torque of the free side only";
    const CONFUSED: &'static [&'static str] = &["presliding", "directional_detent", "compliance"];
    const BENDS: Option<Bends> = Some(Bends::Everything);
    const PARAMS: [Param; 4] = [
        Param::shape("gap", Unit::of(0, 1, 0), [0.0, 10.0], 0.0, "free play, from one side to the other"),
        Param::shape("k", Unit::of(1, -1, 0), [1e-3, 1e5], 30.0, "stiffness of the contact"),
        Param::shape("d", Unit::of(1, -1, 1), [0.0, 1e2], 0.02, "damping of the contact"),
        Param::shape("share", Unit::NUMBER, [0.01, 1.0], 0.7, "share of the inertia behind the joint"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 4]> {
        let inertia = survey.inertia.max(1e-12);
        // Contact that rings at a fraction of the sampling rate, damped to a half.
        let rings = |hz: f64, share: f64| {
            let omega = std::f64::consts::TAU * hz;
            [share * inertia * omega * omega, share * inertia * omega]
        };
        let mut starts = Vec::new();
        let mut gap = 0.003 * survey.range().clamp(0.1, 2.0);
        for _ in 0..9 {
            let [k, d] = rings(0.03 * survey.rate_hz, 0.7);
            starts.push([gap, k.clamp(1e-3, 1e5), d.min(1e2), 0.7]);
            gap *= 1.6;
        }
        starts
    }
}

impl CouplingEffect<4> for Backlash {
    #[inline(always)]
    fn joint<T: Scalar>([gap, k, d, share]: &[T; 4]) -> Joint<T> {
        Joint { gap: *gap, stiffness: *k, damping: *d, share: *share, welded: false }
    }
}
