//! The 5 kHz step: from what the device senses to the torque that it renders.
//!
//! The step is plain arithmetic on its own state: no allocation, no lock, no panic, no clock, no unbounded loop.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
mod batch;
mod contact;
mod device;
mod limits;
mod nature;
mod passive;
mod sliding;
mod stability;
mod state;
mod step;
mod vouched;

pub use contact::Contact;
pub use device::Device;
pub use limits::{Fault, Limits};
pub use nature::Nature;
pub use passive::{Range, check_passive};
pub use stability::{Stability, check_stability};
pub use state::{Sensed, State, TANK_J};
pub use step::Renderer;
