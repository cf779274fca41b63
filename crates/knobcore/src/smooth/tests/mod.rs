//! The smoother against motions that are known.

mod degenerate;
mod impacts;
mod laws;
mod motion;
mod noisy;
