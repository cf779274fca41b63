//! Emulated hardware: what a newcomer has instead of a rig.

mod handle;

pub use handle::Handle;
