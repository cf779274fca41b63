//! The noise floor: what the torque sensor's noise alone would leave of the error.
//!
//! Above the bandwidth of the model the raw torque holds noise alone. Its level there, with the gain of the
//! measurement filter for white noise, is the floor.

use crate::fourier::Transform;
use crate::model::Model;
use crate::predict::torque_raw;
use crate::signals::Signals;
use std::f64::consts::PI;
use std::sync::Arc;

/// Samples of one periodogram: as many of these as leave enough periodograms.
const WINDOWS: [usize; 4] = [512, 256, 128, 64];
/// Periodograms below which their mean tells nothing.
const ENOUGH: usize = 4;
/// A window this many times as loud as the middle one holds an impact: five deviations of noise alone.
const LOUD: f64 = 1.5;
/// The band that is taken for noise alone, as shares of the Nyquist frequency.
const BAND: [f64; 2] = [0.5, 0.95];

/// Variance of the raw torque's white noise, (N m)^2, per capture; NaN where no stretch is long enough.
///
/// The model's torque is taken off, so that steps at reversals do not count as noise. But what it has of the
/// noise of the motion does not count either: the quieter of both is nearer to the truth, which neither is below.
fn white_variance(signals: &Signals, model: &Model) -> f64 {
    let torque = torque_raw(model, signals);
    let rest: Vec<f64> =
        signals.tau_raw.iter().zip(torque).map(|(measured, model)| measured - model).collect();
    variance_above(signals, &rest).min(variance_above(signals, &signals.tau_raw))
}

/// Variance of white noise with the power of `rest` in the band; the median over frequencies keeps a line (mains,
/// a resonance) out.
fn variance_above(signals: &Signals, rest: &[f64]) -> f64 {
    let count = |window: usize| {
        signals.segments.iter().map(|s| (2 * s.len() / window).saturating_sub(1)).sum::<usize>()
    };
    let Some(window) = WINDOWS.into_iter().find(|window| count(*window) >= ENOUGH) else { return f64::NAN };
    let periodogram = Periodogram::new(window);
    let bin = |share: f64| (share * (window / 2) as f64) as usize;
    let band = bin(BAND[0])..bin(BAND[1]);
    let mut powers: Vec<(f64, Vec<f64>)> = Vec::new();
    for segment in &signals.segments {
        for start in segment.clone().step_by(window / 2) {
            if start + window <= segment.end {
                let power = periodogram.of(&rest[start..start + window])[band.clone()].to_vec();
                powers.push((power.iter().sum(), power));
            }
        }
    }
    // An impact is heard at all frequencies, but only while it lasts.
    powers.sort_by(|a, b| a.0.total_cmp(&b.0));
    let loudest = LOUD * powers.get(powers.len() / 2).map_or(0.0, |(total, _)| *total);
    powers.retain(|(total, _)| *total <= loudest);
    let windows = powers.len() as f64;
    let mut band: Vec<f64> =
        (0..band.len()).map(|i| powers.iter().map(|(_, p)| p[i]).sum::<f64>() / windows).collect();
    band.sort_by(f64::total_cmp);
    // The median of an average of K exponential variables, by Wilson & Hilferty 1931; half-overlapping
    // windows count as about 0.95 each under a Hann taper (Welch 1967), no matter at this accuracy.
    let bias = (1.0 - 1.0 / (9.0 * windows)).powi(3);
    band[band.len() / 2] / bias
}

/// What noise alone would leave of a fit.
#[derive(Debug, Clone, Copy)]
pub struct Floor {
    /// Variance of the raw torque's white noise, (N m)^2, the mean over the captures.
    pub white: f64,
    /// Sum of squares over the samples that count, after the measurement filter, (N m)^2.
    pub squares: f64,
    /// Samples that count.
    pub rows: f64,
}

impl Floor {
    /// Of captures beside a model; NaN where no stretch of any is long enough to know the noise. A capture that is
    /// too short by itself has the noise of the others: it was the same sensor.
    pub fn of(data: &[&Signals], model: &Model) -> Self {
        let mut floor = Self { white: 0.0, squares: 0.0, rows: 0.0 };
        let whites: Vec<f64> = data.iter().map(|signals| white_variance(signals, model)).collect();
        let known = || data.iter().zip(&whites).filter(|(_, white)| white.is_finite());
        let heard: f64 = known().map(|(signals, _)| signals.used() as f64).sum();
        let usual = known().map(|(signals, white)| white * signals.used() as f64).sum::<f64>() / heard;
        for (signals, white) in data.iter().zip(whites) {
            let gain = signals.filter.as_ref().map_or(1.0, |filter| filter.sos().mean_power());
            let (white, used) = (if white.is_finite() { white } else { usual }, signals.used() as f64);
            floor.white += white * used;
            floor.squares += white * gain * used;
            floor.rows += used;
        }
        Self { white: floor.white / floor.rows, ..floor }
    }

    /// Root mean square, N m.
    pub fn rms(&self) -> f64 {
        (self.squares / self.rows).sqrt()
    }
}

/// Hann-tapered periodograms of one length, a power of two.
pub(crate) struct Periodogram {
    transform: Arc<Transform>,
    taper: Vec<f64>,
    energy: f64,
}

impl Periodogram {
    pub fn new(n: usize) -> Self {
        let taper: Vec<f64> =
            (0..n).map(|i| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / n as f64).cos()).collect();
        let energy = taper.iter().map(|w| w * w).sum();
        Self { transform: Transform::of(n), taper, energy }
    }

    /// Power per bin; the mean over the bins of white noise is its variance.
    pub fn of(&self, x: &[f64]) -> Vec<f64> {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let tapered: Vec<f64> = x.iter().zip(&self.taper).map(|(x, w)| (x - mean) * w).collect();
        self.transform.forward(&tapered).iter().map(|c| c.norm_sqr() / self.energy).collect()
    }
}
