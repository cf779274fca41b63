//! knobcore: the physics, filters, fitter and diagnosis of knobcam.
#![cfg_attr(not(feature = "python"), forbid(unsafe_code))]

pub mod error;
pub mod smooth;

#[cfg(feature = "python")]
mod python;
