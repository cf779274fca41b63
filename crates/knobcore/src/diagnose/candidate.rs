//! What is known of an effect that was weighed.

use crate::effects::Id;
use crate::fit::Fit;
use crate::rule::rule;

/// An effect that the model lacks, and what it would do.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Which.
    pub id: Id,
    /// The model with it, fitted; None where it could not be.
    pub fit: Option<Fit>,
    /// What it takes off the sum of squares, in variances of the raw torque's white noise.
    pub gain: f64,
    /// How many parameters it adds.
    pub parameters: usize,
    /// Chance of such a gain of any effect of the catalogue where nothing is missing.
    pub p_value: f64,
    /// Why it could not be fitted.
    pub note: String,
}

impl Candidate {
    /// What it takes off, less the price of its parameters, in variances of the raw torque's white noise.
    pub(super) fn worth(&self) -> f64 {
        self.gain - rule().price * self.parameters as f64
    }

    /// The same where what it explains is too little for it to be named.
    pub(super) fn unnamed(self) -> Self {
        let note =
            if self.fit.is_some() { "explains too little of it to be named".into() } else { self.note };
        Self { fit: None, gain: 0.0, note, ..self }
    }
}
