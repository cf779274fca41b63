//! The 5 kHz step: from what the device senses to the torque that it renders.

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
