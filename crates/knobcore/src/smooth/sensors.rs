//! What was measured, and how noisy each sensor is.

use crate::error::{Error, Result};
use nalgebra::Vector3;

/// Three samples are the least that fix theta, omega and alpha.
const FEWEST: usize = 3;

/// The motion sensors of one capture. A sample that is not finite is missing.
#[derive(Debug, Clone, Copy)]
pub struct Sensors<'a> {
    /// Times of the samples, s, increasing.
    pub t: &'a [f64],
    /// Angle, rad.
    pub theta: &'a [f64],
    /// Velocity, rad/s, if there is such a sensor.
    pub omega: Option<&'a [f64]>,
    /// Acceleration, rad/s^2, if there is such a sensor.
    pub alpha: Option<&'a [f64]>,
}

/// Standard deviation of each sensor's noise, and how strongly the motion is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of the angle, rad.
    pub theta: f64,
    /// Of the velocity, rad/s; infinite if there is no such sensor.
    pub omega: f64,
    /// Of the acceleration, rad/s^2; infinite if there is no such sensor.
    pub alpha: f64,
    /// Square root of the spectral density of the jerk, rad/s^3/sqrt(Hz).
    pub jerk: f64,
}

impl Noise {
    /// Negative or NaN levels, and an infinite theta or jerk, are refused.
    pub fn check(&self) -> Result<()> {
        let levels =
            [("theta", self.theta), ("omega", self.omega), ("alpha", self.alpha), ("jerk", self.jerk)];
        for (name, level) in levels {
            let may_be_absent = matches!(name, "omega" | "alpha");
            if level.is_nan() || level < 0.0 || (level.is_infinite() && !may_be_absent) {
                let why = format!("is {level}; a noise level is zero or more and finite");
                return Err(Error::invalid(format!("noise.{name}"), why));
            }
        }
        Ok(())
    }
}

impl<'a> Sensors<'a> {
    /// Lengths agree, times increase, and three angles at least are finite.
    pub fn check(&self) -> Result<()> {
        let n = self.t.len();
        let columns = [("theta", Some(self.theta)), ("omega", self.omega), ("alpha", self.alpha)];
        for (name, column) in columns {
            if let Some(found) = column.map(<[f64]>::len).filter(|&found| found != n) {
                let why = format!("has {found} samples where t has {n}; give every column the same length");
                return Err(Error::invalid(name, why));
            }
        }
        let stuck = |pair: &[f64]| !(pair[1] > pair[0] && pair[1].is_finite() && pair[0].is_finite());
        if let Some(row) = self.t.windows(2).position(stuck) {
            let (before, after) = (self.t[row], self.t[row + 1]);
            let why = format!(
                "row {}: {after} s does not follow {before} s; sort the rows and drop those with repeated times",
                row + 1
            );
            return Err(Error::invalid("t", why));
        }
        let finite = self.theta.iter().filter(|theta| theta.is_finite()).take(FEWEST).count();
        if finite < FEWEST {
            let why = format!("has {finite} finite samples; a motion needs {FEWEST} at least");
            return Err(Error::invalid("theta", why));
        }
        Ok(())
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Theta, omega, alpha; NaN where there is none.
    pub(super) fn row(&self, k: usize) -> Vector3<f64> {
        let at = |column: Option<&[f64]>| column.map_or(f64::NAN, |column| column[k]);
        Vector3::new(self.theta[k], at(self.omega), at(self.alpha))
    }

    /// Some of the rows.
    pub(super) fn rows(&self, rows: std::ops::Range<usize>) -> Self {
        let of = |column: &'a [f64]| &column[rows.clone()];
        Self { t: of(self.t), theta: of(self.theta), omega: self.omega.map(of), alpha: self.alpha.map(of) }
    }

    /// The usual time between samples, s: the median.
    pub(super) fn step(&self) -> f64 {
        let mut steps: Vec<f64> = self.t.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = steps.len() / 2;
        *steps.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}
