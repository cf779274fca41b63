//! knobcore: the physics, filters, fitter and diagnosis of knobcam.
//!
//! One direction: motion and parameters -> effects -> model -> signals -> prediction -> fit -> diagnosis.
//! A module imports only from those above it.
#![forbid(unsafe_code)]

pub mod error;
pub mod isa;
pub mod random;
pub mod scalar;
pub mod special;

pub mod threads;

mod algebra;
mod fourier;
mod order;
mod periodogram;

pub mod motion;
pub mod param;

pub mod effects;
pub mod model;
pub mod model_file;

pub mod chain;

pub mod filter;
pub mod signals;
pub mod smooth;

pub mod prepare;

pub mod predict;

pub mod forward;

pub mod carry;

pub mod noise;
pub mod rule;

pub mod floor;

pub mod fit;
pub mod stiction;

pub mod diagnose;

pub mod propose;

#[cfg(test)]
mod tests;
