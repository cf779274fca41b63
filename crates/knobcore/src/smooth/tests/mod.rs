//! The smoother against motions that are known.

mod simulated;
