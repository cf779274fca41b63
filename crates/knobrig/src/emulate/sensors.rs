//! From what happens to the raw numbers that the rig sends.

use crate::wire::{Channel, Descriptor, Sample};
use knobcore::random::Noise;

/// What the sensors add to the truth: standard deviations, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Of the angular velocity, rad/s.
    pub omega_sd: f64,
    /// Of the acceleration, rad/s^2.
    pub alpha_sd: f64,
    /// Of the torque, N m.
    pub tau_sd: f64,
    /// Sensitivity of the accelerometer, (rad/s^2)/V: what a calibration should find.
    pub c_cal: f64,
}

impl Sensors {
    /// The raw sample of an angle, a speed, an acceleration and a torque.
    pub(super) fn sample(
        &self,
        descriptor: &Descriptor,
        noise: &mut Noise,
        [theta, omega, alpha, tau]: [f64; 4],
    ) -> Sample {
        Sample {
            // Saturating: an encoder that has run over its range stays there.
            count: (theta * descriptor.counts_per_rad).round() as i32,
            omega: raw(&descriptor.omega, omega + self.omega_sd * noise.normal()),
            alpha: raw(&descriptor.alpha, (alpha + self.alpha_sd * noise.normal()) / self.c_cal),
            tau: raw(&descriptor.tau, tau + self.tau_sd * noise.normal()),
        }
    }
}

/// The step of the converter that is nearest, within its limits.
fn raw(channel: &Channel, value: f64) -> i16 {
    let steps = ((value - f64::from(channel.offset)) / f64::from(channel.scale)).round();
    (steps as i16).clamp(channel.lower, channel.upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Unit;

    #[test]
    fn a_value_becomes_the_nearest_step_and_stops_at_the_limits() {
        let channel = Channel { scale: 0.5, offset: 1.0, unit: Unit::NewtonMetre, lower: -100, upper: 100 };
        assert_eq!(raw(&channel, 3.2), 4);
        assert_eq!((raw(&channel, 1e9), raw(&channel, -1e9)), (100, -100));
    }
}
