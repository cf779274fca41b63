//! The smoother against motions that are known.

mod degenerate;
mod laws;
mod motion;
mod noisy;
pub mod normal;
