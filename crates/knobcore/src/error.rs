//! One error enum for the whole core; each variant names the offending thing and the way out.

use crate::prelude::*;

/// Everything that can be wrong with a call or its input.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter, option or column is outside of what it may be.
    #[error("{name}: {why}")]
    Invalid {
        /// The parameter, option or column.
        name: String,
        /// What is wrong with it, and the way out.
        why: String,
    },
}

impl Error {
    /// `name` is at fault; `why` says what is wrong and what to do.
    pub fn invalid(name: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Invalid { name: name.into(), why: why.into() }
    }
}

/// Result of the core.
pub type Result<T> = core::result::Result<T, Error>;
