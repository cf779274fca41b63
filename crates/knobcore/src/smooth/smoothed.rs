//! The smoother as it is called: readings that are none are told from impacts, which the motion then follows.

use super::impacts::with_impacts;
use super::lifts::Lifts;
use super::rts::{Motion, smooth_rows};
use super::sensors::{Noise, Sensors};
use super::staircase::one_reading_per_step;
use super::state::Model;
use super::strays::strays;
use crate::error::Result;

/// The motion, its standard deviations, and the noise that they rest on. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Angle, rad.
    pub theta: Vec<f64>,
    /// Velocity, rad/s.
    pub omega: Vec<f64>,
    /// Acceleration, rad/s^2.
    pub alpha: Vec<f64>,
    /// Standard deviation of `theta`, rad.
    pub theta_sd: Vec<f64>,
    /// Standard deviation of `omega`, rad/s.
    pub omega_sd: Vec<f64>,
    /// Standard deviation of `alpha`, rad/s^2.
    pub alpha_sd: Vec<f64>,
    /// What was taken for the sensors' noise and the jerk.
    pub noise: Noise,
    /// Readings of theta, omega and alpha, by row, without which there would be no impact: they count still.
    pub strays: [Vec<usize>; 3],
}

/// The motion that `sensors` saw, given their `noise`. Times need not be even; linear in time and memory.
///
/// # Errors
/// Lengths that differ, times that do not increase, fewer than three finite angles, noise that is no level.
pub fn smooth(sensors: &Sensors<'_>, noise: &Noise) -> Result<Smoothed> {
    sensors.check()?;
    noise.check()?;
    let readings = one_reading_per_step(sensors.theta);
    let sensors = Sensors { theta: readings.as_deref().unwrap_or(sensors.theta), ..*sensors };
    let model = Model::new(noise, sensors.step());
    let first = smooth_rows(&sensors, &model, &Lifts::default());
    Ok(match strays(&sensors, &model, &first) {
        None => finished(first, *noise, Default::default()),
        Some(strays) => finished(with_impacts(&sensors, &model, first), *noise, strays),
    })
}

fn finished(motion: Motion, noise: Noise, strays: [Vec<usize>; 3]) -> Smoothed {
    let [theta, omega, alpha] = motion.values;
    let [theta_sd, omega_sd, alpha_sd] = motion.sds;
    Smoothed { theta, omega, alpha, theta_sd, omega_sd, alpha_sd, noise, strays }
}
