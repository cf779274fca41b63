//! Compliance: an elastic shaft between rig and knob.

use super::{Bends, CouplingEffect, Effect, Joint, Survey};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// k twist + d twist'; the knob's side holds `share` of the inertia and every other load.
pub struct Compliance;

impl Effect<3> for Compliance {
    const ID: &'static str = "compliance";
    const LAW: &'static str =
        "k twist + d twist' between the shaft and the knob, which has share M of the inertia";
    const SOURCE: &'static str = "two-mass drive; Nordin & Gutman 2002, Equation 1";
    const SHOWS: &'static str = "at fast accelerations, ringing at one frequency";
    const CONFUSED: &'static [&'static str] = &["torque_lag", "inertia", "presliding", "backlash"];
    const BENDS: Option<Bends> = Some(Bends::Everything);
    const PARAMS: [Param; 3] = [
        Param::shape("k", Unit::of(1, -1, 0), [1e-3, 1e5], 1e5, "stiffness"),
        Param::shape("d", Unit::of(1, -1, 1), [0.0, 1e2], 0.02, "damping"),
        Param::shape("share", Unit::NUMBER, [0.01, 1.0], 0.7, "share of the inertia behind the shaft")
            .plausibly(0.02, 0.999),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        let inertia = survey.inertia.max(1e-12);
        let mut starts = Vec::new();
        for share_of_rate in [0.003, 0.006, 0.012, 0.024, 0.048] {
            for share in [0.8, 0.5] {
                let omega = std::f64::consts::TAU * share_of_rate * survey.rate_hz;
                let k = (share * inertia * omega * omega).clamp(1e-3, 1e5);
                starts.push([k, (0.05 * share * inertia * omega).min(1e2), share]);
            }
        }
        starts
    }
}

impl CouplingEffect<3> for Compliance {
    #[inline(always)]
    fn joint<T: Scalar>([k, d, share]: &[T; 3]) -> Joint<T> {
        Joint { gap: T::of(0.0), stiffness: *k, damping: *d, share: *share, welded: true }
    }
}
