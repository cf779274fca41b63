//! The rig of knobcam: what goes over the wire, how it is recorded, a rig that is emulated, and the loop that renders
//! in real time.
#![forbid(unsafe_code)]

pub mod wire;

pub mod realtime;

pub mod record;

pub mod emulate;
