//! Why a fit stopped, for programs and for people.

/// Why the fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// No parameter is free.
    Fixed,
    /// All parameters are linear: solved in one go.
    Linear,
    /// No step lowers the error any more.
    Converged,
    /// What is left is rounding.
    Exact,
    /// The damping grew until no step was left: the surface is rough here.
    Stalled,
    /// Out of trials.
    Limit,
}

impl Status {
    /// One word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Linear => "linear",
            Self::Converged => "converged",
            Self::Exact => "exact",
            Self::Stalled => "stalled",
            Self::Limit => "limit",
        }
    }

    /// A sentence, with what to try.
    pub fn message(self) -> &'static str {
        match self {
            Self::Fixed => "No parameter is free: nothing was fitted.",
            Self::Linear => "All parameters are linear: solved directly.",
            Self::Converged => "Converged: no step lowers the error any more.",
            Self::Exact => "Exact: what is left of the error is rounding.",
            Self::Stalled => {
                "Stalled: no step lowers the error, though the slope is not zero. Fix a parameter that the \
                 capture hardly determines, or start from other values."
            }
            Self::Limit => {
                "Stopped after the largest number of trials. Fix a parameter that the capture hardly \
                 determines, or record a motion that shows it."
            }
        }
    }
}
