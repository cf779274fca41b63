//! The chain, composed once: coupling, loads, friction, sensor.
//!
//! ```text
//! shaft --> coupling --> knob --> loads --> friction budget --> sum --> sensor --> torque
//! ```
//!
//! Whatever moves a knob goes through here. A motion that is prescribed is followed by inverse dynamics over whole
//! columns ([`along`]: predictions, fits, captures from a model, the emulated rig) or sample by sample (the render
//! step), behind a joint through the [`Hidden`] knob in both; a force makes a motion through [`Driven`]. There is one
//! law of dry friction ([`Load::friction`](crate::motion::Load::friction) and
//! [`Load::sticking`](crate::motion::Load::sticking)) and one [stepper](Body).

mod behind;
mod block;
mod driven;
mod hidden;
mod push;
mod rigid;
mod stepper;

pub use behind::knob;
pub use block::Block;
pub use driven::{Drive, Driven, steps};
pub use hidden::{Beside, Hidden, Instant};
pub use push::{Hand, Pushed, push};
pub use stepper::{Acts, Body};

use crate::effects::law::Response;
use crate::model::Model;

/// Steps of a hidden knob from one sample to the next.
pub const SUBSTEPS: usize = 4;

/// Torque on the shaft and its derivatives along a motion: coupling and loads. `columns` says which column each
/// parameter has.
pub fn loads(model: &Model, p: &[f64], columns: &[Option<usize>], substeps: usize, over: &mut Response<'_>) {
    if model.is_coupled() {
        behind::loads(model, p, columns, substeps, over);
    } else {
        rigid::loads(&model.parts(p, columns), over);
    }
}

/// Passes torque and derivatives through the sensors.
pub fn sensors(model: &Model, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
    for (id, p, columns) in model.parts(p, columns) {
        id.law().pass(p, columns, over);
    }
}

/// The recorded torque and its derivatives along a motion: the whole chain.
pub fn along(model: &Model, p: &[f64], columns: &[Option<usize>], substeps: usize, over: &mut Response<'_>) {
    loads(model, p, columns, substeps, over);
    sensors(model, p, columns, over);
}
