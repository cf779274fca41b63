//! Fourier transforms of real columns; a plan is made once per length and process.

use realfft::{RealFftPlanner, RealToComplex};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The forward transform of this length.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    static PLANNER: LazyLock<Mutex<RealFftPlanner<f64>>> =
        LazyLock::new(|| Mutex::new(RealFftPlanner::new()));
    // A planner that was left in the middle of a plan has at worst one plan less.
    PLANNER.lock().unwrap_or_else(PoisonError::into_inner).plan_fft_forward(length)
}
