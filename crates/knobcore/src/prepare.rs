//! From a capture to prepared signals: the motion from its sensors, the torque through its filter.

use crate::error::{Error, Result};
use crate::filter::{ZeroPhase, butter, cheby1, cheby2};
use crate::param::Axis;
use crate::signals::Signals;
use crate::smooth::{Noise, Sensors, noise_from_capture, smooth};
use crate::special::normal_cdf;
use std::ops::Range;

/// The sampling rate of the paper, Hz; its filter edges (Table 6) belong to it.
const PAPER_RATE_HZ: f64 = 5000.0;
/// Shortest stretch that is worth fitting, samples.
const SHORTEST: usize = 32;

/// A knob stands still when its speed stays below this many standard deviations of it for this long.
const STILL_SD: f64 = 4.0;
/// See [`STILL_SD`].
const STILL_S: f64 = 0.02;
/// Below this many standard deviations the sign of the velocity is not certain: a reversal may lie a sample
/// earlier or later than it seems. A step of dry friction that is a sample off looks like an effect of its own
/// once the filter has smeared it, so what it reaches does not count.
const UNSURE_SD: f64 = 3.0;
/// As long as this share of the samples stays.
const MOSTLY_SURE: f64 = 0.75;
/// Samples at each end where the smoother knows the acceleration badly.
const SMOOTHER_ENDS: usize = 50;

/// A low-pass filter by its design; it runs forward and backward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowPass {
    /// Chebyshev type II, 3rd order, 20 dB: the paper's, by its stopband edge in Hz.
    Paper(f64),
    /// Butterworth of this order with this cutoff in Hz, padded by three times its order as Matlab does.
    Butterworth(usize, f64),
    /// Chebyshev type I, 8th order, 0.05 dB, cutoff at 0.8 of the Nyquist frequency after decimation by this
    /// factor: the filter of Matlab's `decimate`.
    Decimation(usize),
}

impl LowPass {
    fn design(self, rate_hz: f64) -> Result<ZeroPhase> {
        match self {
            Self::Paper(edge) => Ok(ZeroPhase::new(cheby2(3, 20.0, edge, rate_hz)?)),
            Self::Butterworth(order, edge) => {
                Ok(ZeroPhase::new(butter(order, edge, rate_hz)?).padded_by(3 * order))
            }
            Self::Decimation(factor) => {
                let edge = 0.8 * 0.5 * rate_hz / factor as f64;
                Ok(ZeroPhase::new(cheby1(8, 0.05, edge, rate_hz)?).padded_by(24))
            }
        }
    }
}

/// Where theta, omega and alpha come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// One fixed-interval smoother over all motion sensors, with its uncertainty.
    Smoother,
    /// The columns, each through its own filter; omega and alpha that were not recorded are central
    /// differences of the filtered angle.
    Filtered {
        /// For theta.
        theta: LowPass,
        /// For omega, if recorded.
        omega: LowPass,
        /// For alpha, if recorded.
        alpha: LowPass,
    },
    /// The columns as they are; what was not recorded, by central differences.
    AsGiven,
}

/// How a capture is prepared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preparation {
    /// Where the motion comes from.
    pub source: Source,
    /// The measurement filter of the torque; the model's torque takes it too.
    pub torque: Option<LowPass>,
    /// Samples at the start that are left out before the torque is filtered.
    pub skip: usize,
    /// Samples at each end of a stretch that do not count; None: as long as the filter takes to settle.
    pub trim: Option<usize>,
    /// Of the filtered samples only every so many count.
    pub every: usize,
}

impl Preparation {
    /// The default: the motion from the smoother, the torque through the paper's filter. Edges of Table 6
    /// belong to 5 kHz; at a lower rate they keep their share of it.
    pub fn smooth(rate_hz: f64) -> Self {
        Self {
            source: Source::Smoother,
            torque: Some(LowPass::Paper(500.0 * slower(rate_hz))),
            skip: 0,
            trim: None,
            every: 1,
        }
    }

    /// The paper's own: a filter per channel, the edges of Table 6.
    pub fn paper(rate_hz: f64) -> Self {
        let [fast, slow] = [1000.0, 500.0].map(|edge| LowPass::Paper(edge * slower(rate_hz)));
        let source = Source::Filtered { theta: fast, omega: fast, alpha: slow };
        Self { source, torque: Some(slow), skip: 0, trim: None, every: 1 }
    }

    /// Everything as it is.
    pub fn none() -> Self {
        Self { source: Source::AsGiven, torque: None, skip: 0, trim: Some(0), every: 1 }
    }

    /// The practice of robot identification (Gautier 1997; Janot, Gautier & Brunot 2019): a 4th-order
    /// Butterworth on the position, central differences, everything decimated.
    pub fn differences(cutoff_hz: f64, decimate: usize) -> Self {
        let butterworth = LowPass::Butterworth(4, cutoff_hz);
        let source = Source::Filtered { theta: butterworth, omega: butterworth, alpha: butterworth };
        let torque = (decimate > 1).then_some(LowPass::Decimation(decimate));
        Self { source, torque, skip: 49, trim: Some(0), every: decimate.max(1) }
    }
}

/// The factor by which the paper's filter edges shrink at this rate: none at 5 kHz and above.
pub fn slower(rate_hz: f64) -> f64 {
    (rate_hz / PAPER_RATE_HZ).min(1.0)
}

/// A capture as it was recorded, the rows that cannot be used left out; SI units.
#[derive(Debug, Clone, Copy)]
pub struct Recording<'a> {
    /// Rotary or linear.
    pub axis: Axis,
    /// Nominal sampling rate, Hz.
    pub rate_hz: f64,
    /// Time, s; increasing.
    pub t: &'a [f64],
    /// Angle, rad.
    pub theta: &'a [f64],
    /// Angular velocity, rad/s, if it was recorded.
    pub omega: Option<&'a [f64]>,
    /// Angular acceleration, rad/s^2, if it was recorded.
    pub alpha: Option<&'a [f64]>,
    /// Torque, N m.
    pub tau: &'a [f64],
    /// Whether rows were left out just before this one.
    pub after_gap: &'a [bool],
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// What a fit sees.
    pub signals: Signals,
    /// Standard deviation of theta and alpha where the source knows it.
    pub uncertainty: Option<[Vec<f64>; 2]>,
    /// Noise levels of the motion sensors, where they were estimated.
    pub noise: Option<Noise>,
}

struct Moving {
    theta: Vec<f64>,
    omega: Vec<f64>,
    alpha: Vec<f64>,
    omega_sd: Vec<f64>,
    uncertainty: Option<[Vec<f64>; 2]>,
    noise: Option<Noise>,
}

/// Prepares a recording.
///
/// # Errors
/// A filter edge that the rate does not allow, times that do not increase, no stretch that is long enough.
pub fn prepare(recording: &Recording<'_>, how: &Preparation) -> Result<Prepared> {
    let filter = how.torque.map(|design| design.design(recording.rate_hz)).transpose()?;
    // A quarter of the way to 1e-16 the filter's response is down to 1e-4.
    let settle = filter.as_ref().map_or(0, |filter| filter.sos().settle() / 4);
    let ends = if how.source == Source::Smoother { SMOOTHER_ENDS } else { 0 };
    let trim = how.trim.unwrap_or(settle.max(ends));
    let shortest = SHORTEST.max(2 * trim + 1).max(filter.as_ref().map_or(0, ZeroPhase::padding) + 1);
    let stretches = stretches(recording);
    let segments: Vec<Range<usize>> =
        stretches.iter().map(|s| s.start.max(how.skip)..s.end).filter(|s| s.len() >= shortest).collect();
    if segments.is_empty() {
        let longest = stretches.iter().map(ExactSizeIterator::len).max().unwrap_or(0);
        return Err(Error::invalid(
            "capture",
            format!(
                "its longest stretch without gap has {longest} good samples, and {shortest} are needed; record longer"
            ),
        ));
    }
    let moving = match how.source {
        Source::Smoother => smoothed(recording)?,
        Source::Filtered { theta, omega, alpha } => {
            let design = |low_pass: LowPass| low_pass.design(recording.rate_hz).map(Some);
            columns(recording, &stretches, [design(theta)?, design(omega)?, design(alpha)?])?
        }
        Source::AsGiven => columns(recording, &stretches, [None, None, None])?,
    };
    let mut weight = vec![0.0; recording.t.len()];
    for segment in &segments {
        let counted = segment.start + trim..segment.end - trim;
        let last = counted.end - 1;
        for at in counted {
            weight[at] = if (last - at).is_multiple_of(how.every) { 1.0 } else { 0.0 };
        }
    }
    let stuck = slower_than(STILL_SD, (STILL_S * recording.rate_hz) as usize, &moving, &segments);
    for at in stuck.iter().flat_map(Clone::clone) {
        weight[at] = 0.0;
    }
    let sure = without_unsure(&weight, &slower_than(UNSURE_SD, 0, &moving, &segments), settle / 2);
    weight = sure.unwrap_or(weight);
    let start = recording.t.first().copied().unwrap_or(0.0);
    let mut signals = Signals {
        axis: recording.axis,
        rate_hz: recording.rate_hz,
        t: recording.t.iter().map(|t| t - start).collect(),
        forward: moving.omega.iter().zip(&moving.omega_sd).map(|(omega, sd)| forward(*omega, *sd)).collect(),
        theta: moving.theta,
        omega: moving.omega,
        alpha: moving.alpha,
        omega_sd: moving.omega_sd,
        tau: Vec::new(),
        tau_raw: recording.tau.to_vec(),
        weight,
        segments,
        stuck,
        filter,
    };
    signals.filter_torque();
    Ok(Prepared { signals, uncertainty: moving.uncertainty, noise: moving.noise })
}

/// Weights without what unsure directions reach through the filter; None where that would take away more than
/// it saves: with a velocity so coarse, the expected friction is the better bet.
fn without_unsure(weight: &[f64], unsure: &[Range<usize>], reach: usize) -> Option<Vec<f64>> {
    let mut sure = weight.to_vec();
    for run in unsure {
        sure[run.start.saturating_sub(reach)..(run.end + reach).min(weight.len())].fill(0.0);
    }
    (sure.iter().sum::<f64>() >= MOSTLY_SURE * weight.iter().sum::<f64>()).then_some(sure)
}

/// Stretches within the segments in which the speed stays below so many of its standard deviations for more
/// than `least` samples; a speed that is known exactly is below nothing but zero.
fn slower_than(
    deviations: f64,
    least: usize,
    moving: &Moving,
    segments: &[Range<usize>],
) -> Vec<Range<usize>> {
    let slow = |at: usize| moving.omega[at].abs() <= deviations * moving.omega_sd[at];
    let mut found = Vec::new();
    for segment in segments {
        let mut at = segment.start;
        while at < segment.end {
            let start = at;
            while at < segment.end && slow(at) {
                at += 1;
            }
            if at - start > least {
                found.push(start..at);
            }
            at += 1;
        }
    }
    found
}

/// Runs of rows without gap.
fn stretches(recording: &Recording<'_>) -> Vec<Range<usize>> {
    let n = recording.t.len();
    let mut borders: Vec<usize> = (1..n).filter(|&i| recording.after_gap[i]).collect();
    borders.insert(0, 0);
    borders.push(n);
    borders.windows(2).map(|pair| pair[0]..pair[1]).filter(|s| !s.is_empty()).collect()
}

fn smoothed(recording: &Recording<'_>) -> Result<Moving> {
    let sensors =
        Sensors { t: recording.t, theta: recording.theta, omega: recording.omega, alpha: recording.alpha };
    let noise = noise_from_capture(&sensors)?;
    let motion = smooth(&sensors, &noise)?;
    Ok(Moving {
        theta: motion.theta,
        omega: motion.omega,
        alpha: motion.alpha,
        omega_sd: motion.omega_sd,
        uncertainty: Some([motion.theta_sd, motion.alpha_sd]),
        noise: Some(motion.noise),
    })
}

/// Column by column, each filtered; absent ones by central differences.
fn columns(
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
    Ok(Moving { theta, omega, alpha, omega_sd, uncertainty: None, noise: None })
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
fn forward(omega: f64, sd: f64) -> f64 {
    if sd > 0.0 {
        return normal_cdf(omega / sd);
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

    #[test]
    fn edges_of_the_paper_shrink_below_its_rate_and_stay_above_it() {
        assert_eq!(Preparation::smooth(1000.0).torque, Some(LowPass::Paper(100.0)));
        assert_eq!(Preparation::smooth(20_000.0).torque, Some(LowPass::Paper(500.0)));
    }
}
