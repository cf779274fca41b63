//! Emulated hardware: what a newcomer has instead of a rig.
//!
//! A [`Rig`] speaks the wire protocol and has the physics of the simulator. It is told how late it is and does no
//! input, output or waiting of its own, so that the same rig serves behind a port in real time and in a test in no
//! time at all.

mod handle;
mod held;
mod obey;
mod rig;
mod scene;
mod sensors;
mod servo;
mod stage;

pub use handle::Handle;
pub use held::{Hand, Held, Shown};
pub use rig::{Fixture, Rig, Setup};
pub use scene::Track;
pub use sensors::Sensors;
