//! Where a model fails, and how much of that is chance.

mod floor;

pub use floor::{noise_floor, white_variance};
