//! The motion of a recording: smoothed from its sensors, filtered column by column, or as given.

use super::Recording;
use crate::error::Result;
use crate::filter::{ZeroPhase, butter};
use crate::smooth::{Noise, Sensors, noise_from_capture, smooth};
use crate::special::normal_cdf;
use std::mem::take;
use std::ops::Range;

/// Order of the filters that part the bands, forward and backward.
const ORDER: usize = 4;
/// A direction less probable than this does not happen: it is three standard deviations away.
const CERTAIN: f64 = 1.35e-3;
/// Noise below this share of a column's largest value is rounding.
const ROUNDING: f64 = 1e-13;
/// Looks for readings that are none: large ones hide others.
const LOOKS: usize = 2;

/// The filter that keeps what is below a frequency.
///
/// # Errors
/// The rate does not have the frequency.
pub(super) fn below(hz: f64, rate_hz: f64) -> Result<ZeroPhase> {
    Ok(ZeroPhase::new(butter(ORDER, hz, rate_hz)?))
}

/// A motion with what is known of its uncertainty.
pub(super) struct Moving {
    pub theta: Vec<f64>,
    pub omega: Vec<f64>,
    pub alpha: Vec<f64>,
    pub omega_sd: Vec<f64>,
    pub uncertainty: Option<[Vec<f64>; 2]>,
    pub noise: Option<Noise>,
    /// Readings of theta, omega and alpha, by row, that were left out.
    pub strays: [Vec<usize>; 3],
}

impl Moving {
    /// Keeps what of the motion is slower than a frequency, inside of these ranges. Errors of a speed grow with
    /// frequency: below it lies no more of their squares than its share of the band.
    pub(super) fn keep_below(
        &mut self,
        hz: f64,
        recording: &Recording<'_>,
        inside: &[Range<usize>],
    ) -> Result<()> {
        let filter = below(hz, recording.rate_hz)?;
        for range in inside {
            filter.filter_in_place(&mut self.theta[range.clone()])?;
        }
        self.omega = differences(recording.t, &self.theta, inside);
        self.alpha = differences(recording.t, &self.omega, inside);
        let share = (2.0 * hz / recording.rate_hz).sqrt();
        let alpha_sd = self.uncertainty.iter_mut().flat_map(|[_, alpha]| alpha);
        self.omega_sd.iter_mut().chain(alpha_sd).for_each(|sd| *sd *= share);
        Ok(())
    }
}

/// From one smoother over all sensors; of those that are `trusted` every reading counts.
pub(super) fn smoothed(
    recording: &Recording<'_>,
    stretches: &[Range<usize>],
    trusted: [bool; 3],
) -> Result<Moving> {
    let sensors =
        Sensors { t: recording.t, theta: recording.theta, omega: recording.omega, alpha: recording.alpha };
    let noise = noise_from_capture(&sensors)?;
    // A motion that was computed, not measured, is exact as it is, and so is the sign of its velocity.
    let exact = |column: Option<&[f64]>, level: f64| {
        column.is_some_and(|column| level <= ROUNDING * column.iter().fold(0.0, |m, x| f64::max(m, x.abs())))
    };
    if exact(Some(recording.theta), noise.theta)
        && exact(recording.omega, noise.omega)
        && exact(recording.alpha, noise.alpha)
    {
        let given = columns(recording, stretches, [None, None, None])?;
        return Ok(Moving { noise: Some(noise), ..given });
    }
    let mut motion = smooth(&sensors, &noise)?;
    let mut strays: [Vec<usize>; 3] = Default::default();
    for _ in 0..LOOKS {
        let found = take(&mut motion.strays);
        let rest = found.iter().zip(trusted).all(|(found, trusted)| trusted || found.is_empty());
        for (strays, found) in strays.iter_mut().zip(found) {
            let told: Vec<usize> = found.into_iter().filter(|row| !strays.contains(row)).collect();
            strays.extend(told);
        }
        if rest {
            break;
        }
        // All anew: where the motion is liveliest its jerk is read, and there they were.
        let [theta, omega, alpha] = [0, 1, 2].map(|i| {
            let mut column = [Some(recording.theta), recording.omega, recording.alpha][i]?.to_vec();
            if !trusted[i] {
                strays[i].iter().for_each(|&row| column[row] = f64::NAN);
            }
            Some(column)
        });
        let theta = theta.as_deref().unwrap_or(recording.theta);
        let without = Sensors { theta, omega: omega.as_deref(), alpha: alpha.as_deref(), ..sensors };
        motion = smooth(&without, &noise_from_capture(&without)?)?;
    }
    Ok(Moving {
        strays,
        theta: motion.theta,
        omega: motion.omega,
        alpha: motion.alpha,
        omega_sd: motion.omega_sd,
        uncertainty: Some([motion.theta_sd, motion.alpha_sd]),
        noise: Some(motion.noise),
    })
}

/// Column by column, each filtered; absent ones by central differences.
pub(super) fn columns(
    recording: &Recording<'_>,
    stretches: &[Range<usize>],
    filters: [Option<ZeroPhase>; 3],
) -> Result<Moving> {
    let filtered = |column: &[f64], filter: &Option<ZeroPhase>| -> Result<Vec<f64>> {
        let mut column = column.to_vec();
        if let Some(filter) = filter {
            for stretch in stretches.iter().filter(|s| s.len() > filter.padding()) {
                filter.filter_in_place(&mut column[stretch.clone()])?;
            }
        }
        Ok(column)
    };
    let [f_theta, f_omega, f_alpha] = filters;
    let theta = filtered(recording.theta, &f_theta)?;
    let omega = match recording.omega {
        Some(omega) => filtered(omega, &f_omega)?,
        None => differences(recording.t, &theta, stretches),
    };
    let alpha = match recording.alpha {
        Some(alpha) => filtered(alpha, &f_alpha)?,
        None => differences(recording.t, &omega, stretches),
    };
    let omega_sd = vec![0.0; omega.len()];
    Ok(Moving { theta, omega, alpha, omega_sd, uncertainty: None, noise: None, strays: Default::default() })
}

/// Central differences within each stretch, one-sided at its ends.
fn differences(t: &[f64], x: &[f64], stretches: &[Range<usize>]) -> Vec<f64> {
    let mut slope = vec![0.0; x.len()];
    for stretch in stretches.iter().filter(|s| s.len() > 1) {
        for at in stretch.clone() {
            let (before, after) = (at.saturating_sub(1).max(stretch.start), (at + 1).min(stretch.end - 1));
            slope[at] = (x[after] - x[before]) / (t[after] - t[before]);
        }
    }
    slope
}

/// Probability that the velocity is positive, where it is known to `sd`.
pub(super) fn forward(omega: f64, sd: f64) -> f64 {
    if sd > 0.0 {
        let probability = normal_cdf(omega / sd);
        // A direction that is as good as certain is: a trace of the other one would let it be fitted.
        return match probability {
            p if p < CERTAIN => 0.0,
            p if p > 1.0 - CERTAIN => 1.0,
            p => p,
        };
    }
    if omega == 0.0 { 0.5 } else { f64::from(omega > 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_velocity_known_exactly_has_a_direction_and_one_within_its_noise_a_probability() {
        assert_eq!((forward(-1e-12, 0.0), forward(0.0, 0.0), forward(1e-12, 0.0)), (0.0, 0.5, 1.0));
        assert!((forward(0.2, 0.2) - 0.841_344_7).abs() < 1e-6);
    }

    #[test]
    fn differences_of_a_parabola_are_exact_inside_and_never_cross_a_gap() {
        let t: Vec<f64> = (0..10).map(|i| f64::from(i) * 0.1).collect();
        let x: Vec<f64> = t.iter().map(|t| t * t).collect();
        let slope = differences(&t, &x, &[0..5, 5..10]);
        assert!((slope[2] - 0.4).abs() < 1e-12 && (slope[7] - 1.4).abs() < 1e-12);
        assert!((slope[5] - 1.1).abs() < 1e-12, "one-sided at the gap");
    }
}
