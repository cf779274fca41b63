//! Where a model fails, and how much of that is chance.

mod bins;
mod floor;
mod locate;
mod spectrum;

pub use floor::{noise_floor, white_variance};
pub use locate::{Region, Split, locate};
