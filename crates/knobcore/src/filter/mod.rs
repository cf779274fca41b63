//! The measurement filter: low-pass designs, and their application forward and backward in time.
//!
//! A force and a motion can only be compared after the same filter. Filtering forward and backward
//! leaves no phase lag, so torque, speed and acceleration stay aligned in time.
//!
//! ```
//! use knobcore::filter::{ZeroPhase, cheby2};
//!
//! let filter = ZeroPhase::new(cheby2(3, 20.0, 500.0, 5000.0)?);
//! let mut torque = vec![0.02; 200];
//! filter.filter_in_place(&mut torque)?;
//! assert!(torque.iter().all(|t| (t - 0.02).abs() < 1e-12)); // a constant passes unchanged
//! # Ok::<(), knobcore::error::Error>(())
//! ```

mod cascade;
mod design;
mod interleave;
mod pairing;
mod pieces;
mod registers;
mod sos;
mod zero_phase;

pub use design::{butter, cheby1, cheby2};
pub use sos::{Section, Sos};
pub use zero_phase::ZeroPhase;
