//! Where a model fails, and how much of that is chance.

mod bins;
mod locate;
mod spectrum;

pub use locate::{Region, Split, locate};
