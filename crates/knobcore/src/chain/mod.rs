//! The chain, composed once: coupling, loads, friction, sensor.
//!
//! ```text
//! shaft --> coupling --> knob --> loads --> friction budget --> sum --> sensor --> torque
//! ```
//!
//! Whatever moves a knob goes through here. A motion that is prescribed is followed by inverse dynamics over whole
//! columns ([`along`](fn@along): predictions, fits, captures from a model, the emulated rig) or sample by sample (the render
//! step), behind a joint through the [`Hidden`] knob in both; a force makes a motion through [`Driven`]. There is one
//! law of dry friction ([`Load::friction`](crate::motion::Load::friction) and
//! [`Load::sticking`](crate::motion::Load::sticking)) and one [stepper](Body).

mod contact;
mod hidden;
mod stepper;

// Whole columns and what pushes a knob are for those who measure: a renderer follows samples.
#[cfg(feature = "std")]
mod along;
#[cfg(feature = "std")]
mod pushed;

#[cfg(feature = "std")]
pub use along::{Block, along, go_together, knob, loads, sensors, several};
pub use hidden::{Begins, Beside, Follow, Hidden, Instant};
#[cfg(feature = "std")]
pub use pushed::{Drive, Driven, Hand, Pushed, push, steps};
pub use stepper::{Acts, Body};

/// Steps of a hidden knob from one sample to the next.
pub const SUBSTEPS: usize = 4;
