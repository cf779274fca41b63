//! A model that is rendered only where it feeds no hand.

use super::device::Device;
use super::limits::Limits;
use super::passive::stored;
use super::state::TANK_J;
use super::step::Renderer;
use knobcore::error::Result;
use knobcore::model::Model;

impl Renderer {
    /// Renders a model at `rate_hz`, on a known device or on any.
    ///
    /// Effects of the sensor are not rendered: they belong to the rig that measured, not to the knob.
    ///
    /// # Errors
    /// A rate that is none, a limit or a device that cannot be, a model that would feed a hand or ring.
    pub fn new(model: &Model, rate_hz: f64, device: Option<Device>, limits: Limits) -> Result<Self> {
        let mut knob = Self::made(model, rate_hz, device, limits)?;
        let energy = stored(model, device, rate_hz)?;
        if knob.limits.torque_rate < f64::INFINITY {
            // A torque that may not change quickly follows a dent late, and gives more than the dent holds.
            knob.tank = energy + TANK_J;
            knob.state.tank = knob.tank;
        }
        Ok(knob)
    }
}
