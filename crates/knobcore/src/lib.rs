//! knobcore: the physics, filters, fitter and diagnosis of knobcam.
#![cfg_attr(not(feature = "python"), forbid(unsafe_code))]

pub mod error;

#[cfg(feature = "python")]
mod python;
