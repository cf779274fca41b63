//! A knob behind a joint (backlash, compliance): the hand holds the shaft, and the knob follows.

use super::device::Tuning;
use crate::coupling::{Dry, Follower, Span};
use crate::model::Model;

/// Steps of the hidden knob per period.
const SUBSTEPS: usize = 4;

/// The hidden knob and the shaft's motion one sample before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hidden {
    follower: Follower<f64>,
    before: [f64; 3],
}

impl Hidden {
    /// A knob that starts with the shaft, at `[t, theta, omega]`.
    pub fn new(model: &Model, p: &[f64], state: &[f64], tuning: &Tuning, at: [f64; 3]) -> Option<Self> {
        let mut follower = Follower::new(model, p, state, at, Dry::Static)?;
        follower.soften(tuning.stiffest);
        Some(Self { follower, before: at })
    }

    /// Torque on the shaft, N m, but for the inertia of the shaft itself, which comes beside it. The mean of the
    /// first and of the last step takes out what the midpoint rule leaves of a stiff spring.
    /// `missed` periods lie between the sample before and this one.
    pub fn follow(
        &mut self,
        model: &Model,
        p: &[f64],
        state: &mut [f64],
        at: [f64; 3],
        missed: u64,
    ) -> (f64, f64) {
        let substeps = SUBSTEPS * (missed as usize + 1);
        let span = Span { from: self.before, to: at, substeps };
        self.before = at;
        let force = self.follower.follow(model, p, state, &span, None);
        (force.map_or(0.0, |[first, last]| 0.5 * (first + last)), self.follower.shafts)
    }

    /// Angle and speed of the knob.
    pub fn knob(&self) -> [f64; 2] {
        self.follower.knob()
    }

    /// Puts shaft and knob there.
    pub fn put(&mut self, before: [f64; 3], knob: [f64; 2]) {
        self.before = before;
        self.follower.put(knob);
    }
}
