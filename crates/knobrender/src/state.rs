//! What the step takes in, and what it remembers.

use super::contact::Contact;
use super::limits::Fault;
use knobcore::prelude::*;

/// What a force-feedback device senses at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Angle, rad.
    pub theta: f64,
    /// Angular velocity, rad/s.
    pub omega: f64,
    /// Angular acceleration, rad/s^2.
    pub alpha: f64,
    /// Torque that the hand applies, N m, where the device measures it.
    pub hand: Option<f64>,
}

/// All that the step remembers; with the model it decides everything that comes.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Periods since the reset, also those that were missed.
    pub samples: u64,
    /// Periods that were missed since the last step.
    pub missed: u64,
    /// Angle and speed at the sample before.
    pub before: [f64; 2],
    /// Angle between the counts of the encoder at the sample before, rad.
    pub between: f64,
    /// Filtered acceleration, rad/s^2.
    pub alpha: f64,
    /// Torque of the sample before, N m.
    pub tau: f64,
    /// Between sticking and sliding.
    pub contact: Contact,
    /// Angle and speed of a knob behind a joint.
    pub knob: [f64; 2],
    /// What the model's effects remember.
    pub memory: Vec<f64>,
    /// Energy that it may still give out, J, where that is watched.
    pub tank: f64,
    /// Why it renders nothing any more.
    pub fault: Option<Fault>,
}

/// Energy that a model may give out beyond what it took and its places hold, J: what 100 g have that fell by 10 cm.
pub const TANK_J: f64 = 0.1;
