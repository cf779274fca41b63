//! What is known of the fit that the values of an effect come from: enough to say whether they can be its own.

use crate::prelude::*;
use core::f64::consts::TAU;

/// Waves within the motion by which a series that is bound to another may seem not to be; standard errors on top.
const BOUND: f64 = 0.02;
const SURE: f64 = 3.0;
/// Standard errors that a value has to be more than, to be more than nothing.
const UNSURE: f64 = 2.0;
/// Powers of ten below which a number is written as it is read.
const PLAIN: i32 = 6;

/// Surroundings of fitted values; SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Context {
    /// Standard errors of the effect's own parameters, in its order; None where the captures do not determine one.
    pub errors: Vec<Option<f64>>,
    /// Times of the samples that count, s.
    pub t: Vec<f64>,
    /// Torques that were read at them, N m.
    pub torque: Vec<f64>,
    /// Positions of the samples that count, rad.
    pub theta: Vec<f64>,
    /// Root mean square of the acceleration where the motion reverses, rad/s^2; 0 where it never does.
    pub turning: f64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// What the torque sensor's noise alone would leave of the error, N m.
    pub noise_floor: f64,
    /// Period of the detents over 2 pi, rad, if the model has some.
    pub period: Option<f64>,
    /// Its standard error, rad; 0 where it has none.
    pub period_error: f64,
    /// Period over 2 pi of a revolution, rad; None on a linear axis.
    pub revolution: Option<f64>,
    /// Dry friction backward and forward, N m; a constant torque is in the difference.
    pub friction: [f64; 2],
    /// Whether the torque sensor was seen at its limit.
    pub clipped: bool,
    /// Whether the effect is the first that is added.
    pub first: bool,
}

impl Context {
    /// What the effect's parameter at this place has to be more than, to be more than nothing; 0 where its error is unknown.
    pub fn unsure(&self, at: usize) -> f64 {
        self.errors.get(at).copied().flatten().map_or(0.0, |error| UNSURE * error)
    }

    /// Waves of the detents in 2 pi rad, and their standard error.
    pub fn detents(&self) -> Option<[f64; 2]> {
        self.period.map(|period| rate(period, self.period_error))
    }

    /// What says whether two series of so many waves in 2 pi rad, with standard errors, are one as far as the motion tells.
    pub fn alike(&self) -> impl Fn([f64; 2], [f64; 2]) -> bool {
        let travel = self.travel();
        move |[one, error], [other, its]| {
            ((one - other).abs() - SURE * error.hypot(its)) * travel < BOUND * TAU
        }
    }

    /// A way along the axis in two digits, with its unit.
    pub fn way(&self, length: f64) -> String {
        let unit = if self.revolution.is_some() { "rad" } else { "m" };
        format!("{} {unit}", short(length, 2))
    }

    /// Range of positions that the samples go through, rad.
    pub fn travel(&self) -> f64 {
        let ends = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
        let (low, high) = self.theta.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        (high - low).max(0.0)
    }

    /// Share of the samples at positions of which this holds.
    pub fn share(&self, holds: impl Fn(f64) -> bool) -> f64 {
        self.theta.iter().filter(|theta| holds(**theta)).count() as f64 / self.theta.len().max(1) as f64
    }
}

/// Waves in 2 pi rad of a period over 2 pi, and their standard error.
pub fn rate(period: f64, error: f64) -> [f64; 2] {
    [1.0 / period, error / (period * period)]
}

/// A number with so many digits that count, as a person writes it.
pub fn short(x: f64, digits: usize) -> String {
    let scientific = format!("{:.*e}", digits.saturating_sub(1), x);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.into()
        }
    };
    if (-4..digits as i32).contains(&power) {
        return trimmed(&format!("{:.*}", (digits as i32 - 1 - power).max(0) as usize, x));
    }
    if (digits as i32..PLAIN).contains(&power) {
        let step = 10_f64.powi(power + 1 - digits as i32);
        return format!("{:.0}", (x / step).round() * step);
    }
    let sign = if power < 0 { '-' } else { '+' };
    format!("{}e{sign}{:02}", trimmed(mantissa), power.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_number_reads_as_people_write_it() {
        let written = [0.01234, 1.0, 0.5, 123.4, -99_600.0, 2.96e6, 2.96e-5, 9.96, -0.25, 0.0];
        let read = ["0.012", "1", "0.5", "120", "-100000", "3e+06", "3e-05", "10", "-0.25", "0"];
        assert_eq!(written.map(|x| short(x, 2)), read);
    }

    #[test]
    fn samples_are_counted_where_they_are() {
        let context =
            Context { t: vec![0.0, 1.0, 2.0, 3.0], theta: vec![-1.0, 0.0, 0.5, 3.0], ..Context::default() };
        assert_eq!((context.travel(), context.share(|theta| theta > 0.0)), (4.0, 0.5));
    }

    #[test]
    fn two_series_are_one_where_the_motion_or_what_is_known_of_them_does_not_tell_them_apart() {
        let short = Context { theta: vec![0.0, TAU], period: Some(0.1), ..Context::default() };
        let long = Context { theta: vec![0.0, 5.0 * TAU], ..short.clone() };
        let [detents, _] = short.detents().unwrap();
        assert_eq!(detents, 10.0);
        assert!(short.alike()([20.01, 0.0], [2.0 * detents, 0.0]));
        assert!(!long.alike()([20.01, 0.0], [2.0 * detents, 0.0]));
        assert!(long.alike()([20.01, 3e-3], [2.0 * detents, 0.0]));
        // A hundredth of a period more is a hundredth of the waves less.
        let unsure = Context { period_error: 1e-3, ..long };
        assert!((unsure.detents().unwrap()[1] - 0.1).abs() < 1e-12);
        assert!(unsure.alike()([10.2, 0.0], unsure.detents().unwrap()));
    }
}
