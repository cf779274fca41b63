//! What a capture offers to a search for starting values: how far, how fast, how hard, how long.

use crate::prelude::*;

/// What varies as a wave over position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wave {
    /// A torque.
    Torque,
    /// A friction: it has the sign of the motion.
    Friction,
    /// Torques together that have whole numbers of waves per revolution, or per pitch of a linear axis.
    Orders,
}

/// Quantiles of the samples that count; SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Survey {
    /// Angle, rad, ascending.
    pub theta: Vec<f64>,
    /// Magnitude of the velocity, rad/s, ascending.
    pub speed: Vec<f64>,
    /// Magnitude of the torque, N m, ascending.
    pub torque: Vec<f64>,
    /// Length, s.
    pub duration_s: f64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Magnitude of the inertia that the base model sees, kg m^2.
    pub inertia: f64,
    /// Dry friction backward and forward that it sees, N m: bent, even below zero, where an effect is missing.
    pub friction: [f64; 2],
    /// Period over 2 pi of a revolution, rad; None on a linear axis.
    pub revolution: Option<f64>,
    /// The strongest waves of the kind that the effect scans for, beside what the model explains: amplitude (N m),
    /// period over 2 pi (rad) and phase (rad); None where none were looked for.
    pub waves: Option<Vec<[f64; 3]>>,
}

/// What resists one way is at least so much of what does the other way.
const APART: f64 = 0.6;

/// Whether what resists one way and the other differs by more than of a knob of which nothing is missing.
pub fn apart(neg: f64, pos: f64) -> bool {
    neg.min(pos) < APART * neg.max(pos)
}

impl Survey {
    /// The value that a share `q` (0 to 1) of an ascending column stays below.
    pub fn quantile(column: &[f64], q: f64) -> f64 {
        let at = (q * column.len().saturating_sub(1) as f64).round() as usize;
        column.get(at).copied().unwrap_or(0.0)
    }

    /// Range of positions, rad.
    pub fn range(&self) -> f64 {
        Self::quantile(&self.theta, 1.0) - Self::quantile(&self.theta, 0.0)
    }
}
