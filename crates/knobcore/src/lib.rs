//! knobcore: the physics, filters, fitter and diagnosis of knobcam.
//!
//! One direction: motion and parameters -> effects -> model -> signals -> prediction -> fit -> diagnosis.
//! A module imports only from those above it.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]
#![cfg_attr(
    not(feature = "std"),
    allow(dead_code, unused_imports, reason = "what only those who measure need")
)]

extern crate alloc;

pub mod error;
pub mod isa;
pub mod scalar;

mod local;
pub mod prelude;

pub mod random;
#[cfg(feature = "std")]
pub mod special;
#[cfg(feature = "std")]
pub mod threads;

mod algebra;
#[cfg(feature = "std")]
mod fourier;
#[cfg(feature = "std")]
mod order;
#[cfg(feature = "std")]
mod periodogram;

pub mod motion;
pub mod param;

pub mod effects;
pub mod model;
pub mod model_file;

pub mod chain;

// What measures, fits and diagnoses: a renderer needs none of it.
#[cfg(feature = "std")]
pub mod filter;
#[cfg(feature = "std")]
pub mod signals;
#[cfg(feature = "std")]
pub mod smooth;

#[cfg(feature = "std")]
pub mod prepare;

#[cfg(feature = "std")]
pub mod predict;

#[cfg(feature = "std")]
pub mod forward;

#[cfg(feature = "std")]
pub mod carry;

#[cfg(feature = "std")]
pub mod noise;
#[cfg(feature = "std")]
pub mod rule;

#[cfg(feature = "std")]
pub mod floor;

#[cfg(feature = "std")]
pub mod fit;
#[cfg(feature = "std")]
mod spans;
#[cfg(feature = "std")]
pub mod stiction;

#[cfg(feature = "std")]
pub mod diagnose;

#[cfg(feature = "std")]
pub mod propose;

#[cfg(test)]
mod tests;
