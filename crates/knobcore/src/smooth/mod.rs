//! The motion (theta, omega, alpha) from whatever sensors saw it.
//!
//! A fixed-interval smoother: at every sample the estimate uses the whole capture, past and future, so it
//! has no lag. The state is driven by white jerk; each sensor counts by its noise, and an absent sensor or
//! sample (NaN) not at all. Uneven times and gaps need no special case.
//!
//! Sources: H. E. Rauch, F. Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic
//! systems", AIAA Journal 3(8), 1965 (the smoother); Y. Bar-Shalom, X. R. Li and T. Kirubarajan, "Estimation
//! with Applications to Tracking and Navigation", Wiley 2001, section 6.2.3 (the Wiener-process acceleration).
//!
//! ```
//! use knobcore::smooth::{Sensors, noise_from_capture, smooth};
//! let t: Vec<f64> = (0..500).map(|k| f64::from(k) * 1e-3).collect();
//! let theta: Vec<f64> = t.iter().map(|t| (6.0 * t).sin()).collect();
//! let seen = Sensors { t: &t, theta: &theta, omega: None, alpha: None };
//! let motion = smooth(&seen, &noise_from_capture(&seen)?)?;
//! assert!((motion.omega[250] - 6.0 * (6.0 * t[250]).cos()).abs() < 1e-6);
//! # Ok::<(), knobcore::error::Error>(())
//! ```

mod activity;
mod impacts;
mod jerk;
mod kalman;
mod levels;
mod lifts;
mod resolution;
mod rts;
mod sensors;
mod smoothed;
mod staircase;
mod state;
mod strays;
#[cfg(test)]
mod tests;

pub use levels::noise_from_capture;
pub use sensors::{Noise, Sensors};
pub use smoothed::{Smoothed, smooth};
