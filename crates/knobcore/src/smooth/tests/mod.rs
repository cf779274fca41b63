//! The smoother against motions that are known.

pub mod normal;
mod simulated;
