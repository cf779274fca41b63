//! What the spectrum of a raw torque tells of its noise.

use crate::model::Model;
use crate::noise::{self, Noise};
use crate::periodogram::{Periodogram, Powers, windows};
use crate::predict::torque_raw;
use crate::rule::rule;
use crate::scalar::LANES;
use crate::signals::Signals;
use std::f64::consts::PI;
use std::iter::repeat;
use std::ops::Range;

/// Samples of one periodogram: as many of these as leave enough periodograms.
const WINDOWS: [usize; 4] = [512, 256, 128, 64];
/// Periodograms below which their mean tells nothing.
const ENOUGH: usize = 4;
/// Share of readings that are the largest of all, from which on the sensor is at its limit.
const LIMITED: f64 = 0.02;
/// The band that is taken for noise alone, as shares of the Nyquist frequency.
const BAND: [f64; 2] = [0.5, 0.95];
/// The band below, which noise that is not white fills more.
const BELOW: [f64; 2] = [0.25, 0.5];
/// Samples of a periodogram down to the slowest frequencies, as many as leave [`MANY`].
const LONG: [usize; 4] = [2048, 1024, 512, 256];
/// See [`LONG`].
const MANY: usize = 25;
/// The quantile of the stretches that counts as noise alone.
const QUIET: f64 = 0.35;
/// Of many exponential variables that quantile, as an estimate of their mean, has so many times the variance of their
/// mean: p / (1 - p) / ln(1 - p)^2.
const QUANTILES_ERROR: f64 = 2.9;
/// Samples of stretches so short that something that comes again and again leaves some of them out, and the quantile
/// of these that does not have it.
const SHORT: usize = 128;
const QUIETEST: f64 = 0.1;
/// Below this frequency machines make torque that is no noise, as gears do that turn fast.
const MECHANICAL_HZ: f64 = 200.0;
/// Rows of the longest line whose noise is told from that of shorter ones.
const LINES: usize = 8;
/// Frequencies at which the noise of lines is summed.
const SHARES: u32 = 256;
/// Times the other column's noise by which one has noise of its own.
const LOUDER: f64 = 1.1;
/// Slowest frequencies of a periodogram, which its taper and its mean take off.
const TAKEN_OFF: usize = 2;
/// Times the usual level of the octave above that noise stays below: twice what a filter of second order makes of it.
const LINE: f64 = 10.0;
/// Share of the frequencies that are lines at most.
const FEW_LINES: f64 = 0.1;
/// Frequencies of the slowest octave, which has too few of its own.
const FEWEST: usize = 4;
/// Times that what these hold is expected of the rest: where noise is slower than a window shows, each adds to what is a
/// guess.
const ROUNDS: usize = 4;
/// What is slower is a drift.
const DRIFT_HZ: f64 = 5.0;

/// What the spectrum of a raw torque tells of its noise.
pub(super) struct Heard {
    pub noise: Option<Noise>,
    /// How far that is to be believed.
    pub told: Told,
    /// What is left of the raw torque beside the model.
    pub rest: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Told {
    /// Its level above the motion, and that it is as loud below.
    Level,
    /// The same, at frequencies at which gears and couplings still make torque.
    Near,
    /// Its level above the motion alone: the stretches are too short to tell more.
    Above,
    /// That it is louder below, where the motion is too.
    Coloured,
    /// Nothing, for this reason.
    Nothing(Unheard),
}

/// Why the spectrum of a torque does not tell its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unheard {
    /// No stretch is long enough.
    Short,
    /// It was smoothed before it was logged.
    Smoothed,
    /// More than noise is in the band above the motion: less is left than it says.
    Loud,
}

impl Heard {
    /// Of a torque that has the power of white noise of this variance, beside a model.
    ///
    /// The model's torque is taken off, so that steps at reversals do not count as noise. But what it has of the
    /// noise of the motion does not count either: the quieter of both is nearer to the truth, which neither is below.
    pub fn of(raw: f64, signals: &Signals, model: &Model) -> Self {
        let mut rest = torque_raw(model, signals);
        rest.iter_mut().zip(&signals.tau_raw).for_each(|(rest, measured)| *rest = measured - *rest);
        let (left, level) = above(signals, &rest);
        let white = left.min(raw);
        let quieter = || if left < raw { level } else { above(signals, &signals.tau_raw).1 };
        if white.is_nan() {
            return Self { noise: None, told: Told::Nothing(Unheard::Short), rest };
        }
        if smoothed(&quieter()) {
            return Self { noise: None, told: Told::Nothing(Unheard::Smoothed), rest };
        }
        let level = || Noise::white(white * bridged(signals));
        let Some(window) = LONG.into_iter().find(|window| heard(signals, *window).len() >= MANY) else {
            return Self { noise: Some(level()), told: Told::Above, rest };
        };
        match coloured(signals, &rest, window) {
            Some(noise) => Self { noise: Some(as_left(noise, signals, &rest)), told: Told::Coloured, rest },
            None => {
                let near = 0.5 * BAND[0] * signals.rate_hz < MECHANICAL_HZ;
                Self { noise: Some(level()), told: if near { Told::Near } else { Told::Level }, rest }
            }
        }
    }

    /// Nothing is told where less is left than such noise would leave; see [`super::Floor::if_left`].
    pub fn unless_too_loud(self, signals: &Signals) -> Self {
        let filter = signals.filter.as_ref();
        let left = left(signals, &self.rest);
        let loud =
            |noise: &Noise| left < least(noise.behind(filter), signals.used() as f64, noise.alike(filter));
        if !self.noise.as_ref().is_some_and(loud) {
            return self;
        }
        Self { noise: None, told: Told::Nothing(Unheard::Loud), ..self }
    }
}

/// Whether the torque was smoothed before it was logged, by its level in the band above: next to no noise is left there,
/// and how much there was below nobody can tell.
fn smoothed(level: &[f64]) -> bool {
    let third = level.len() / 3;
    median(level[..third].to_vec()) > rule().smoothed * median(level[level.len() - third..].to_vec())
}

/// Coloured noise as loud as what is left, where that is no more than its level in the quieter stretches lets expect.
///
/// Slow noise has few independent samples, and its level by a spectrum is known to some percent; nor is there more of
/// it than what is left.
fn as_left(noise: Noise, signals: &Signals, rest: &[f64]) -> Noise {
    let rows = signals.used().max(1) as f64;
    let filter = signals.filter.as_ref();
    let louder = left(signals, rest) / noise.behind(filter);
    let error = error(noise.alike(filter), rows);
    if louder.is_finite() && louder <= 1.0 + rule().steady * error {
        return Noise { innovation: noise.innovation * louder, ..noise };
    }
    noise
}

/// What the measurement filter leaves of a rest.
pub(super) fn measured(signals: &Signals, rest: &[f64]) -> Vec<f64> {
    let mut rest = rest.to_vec();
    for segment in &signals.segments {
        signals.measure(&mut [&mut rest[segment.clone()]]);
    }
    rest
}

/// Its mean square where samples count, (N m)^2.
pub(super) fn left(signals: &Signals, rest: &[f64]) -> f64 {
    let rest = measured(signals, rest);
    // Between segments there is no rest: it is NaN.
    let counted = rest.iter().zip(&signals.weight).filter(|(_, weight)| **weight > 0.0);
    counted.map(|(rest, weight)| weight * rest * rest).sum::<f64>() / signals.used().max(1) as f64
}

/// The least that noise which leaves so much, of so many rows of which some are `alike`, surely leaves.
pub(super) fn least(noise: f64, rows: f64, alike: f64) -> f64 {
    noise / (rule().explained * (1.0 + rule().steady * error(alike, rows)))
}

/// Standard error of a noise's variance, as a share of it, that was read of so many rows of which some are `alike`.
pub(super) fn error(alike: f64, rows: f64) -> f64 {
    ((1.0 + QUANTILES_ERROR) * 2.0 * alike / rows).sqrt()
}

/// Variance behind the filter of white noise with straight lines in it, over what its power in the band above lets
/// expect: a line between two readings has their slow noise twice and no fast one.
pub(super) fn bridged(signals: &Signals) -> f64 {
    let Some(filter) = signals.filter.as_ref().filter(|_| !signals.bridges.is_empty()) else { return 1.0 };
    let rows = signals.segments.iter().map(ExactSizeIterator::len).sum::<usize>() as f64;
    let mut lines = [0.0; LINES];
    for bridge in &signals.bridges {
        lines[bridge.len().min(LINES) - 1] += 1.0 / rows;
    }
    let power = |share: f64| 1.0 + (1..).zip(lines).map(|(n, often)| often * line(n, share)).sum::<f64>();
    let (mut within, mut passed, mut above, mut bins) = (0.0, 0.0, 0.0, 0.0);
    for share in (0..SHARES).map(|k| (f64::from(k) + 0.5) / f64::from(SHARES)) {
        let gain = filter.sos().power_gain(0.5 * share * signals.rate_hz).powi(2);
        (within, passed) = (within + gain * power(share), passed + gain);
        if (BAND[0]..BAND[1]).contains(&share) {
            (above, bins) = (above + power(share), bins + 1.0);
        }
    }
    within / passed / (above / bins)
}

/// What a straight line over `n` rows adds to the energy of white noise at this share of the Nyquist frequency.
///
/// With c_i = 1 - i / (n + 1), row i holds c_i of the reading before and the rest of the one after, not its own: of
/// the sum over i of the squared differences, its own noise and the products with what stayed.
fn line(n: u32, share: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for i in 1..=n {
        let (sin, cos) = (PI * share * f64::from(i)).sin_cos();
        let part = 1.0 - f64::from(i) / f64::from(n + 1);
        (re, im) = (re + part * cos, im + part * sin);
    }
    2.0 * (re * re + im * im) + 4.0 * re - f64::from(n)
}

/// Noise that is louder the slower it is, if the spectrum above the motion falls; None where it is level.
///
/// Below, motion and model share the band with it. What the model gets wrong comes and goes with the motion, noise is
/// always there: at each frequency the level is that of the quieter stretches. And of the quieter column: fast, the
/// model has noise of the motion in it, which hides how the torque's own falls.
fn coloured(signals: &Signals, rest: &[f64], window: usize) -> Option<Noise> {
    let spectra = |column: &[f64], window: usize| {
        let periodogram = Periodogram::of(window);
        periodogram.powers(column, &heard(signals, window), periodogram.bins())
    };
    // Most noise is white, which the raw torque alone tells.
    let raw = Some(steady(&spectra(&signals.tau_raw, window))).filter(|raw| falls(raw))?;
    let level = without_lines(quieter(steady(&spectra(rest, window)), &raw));
    let level = Some(level).filter(|level| falls(level) && !plunges(level, window))?;
    // What rings after each of many contacts fills all long stretches, and falls too; but no noise ever pauses.
    let paused = |column: &[f64]| quiet(&spectra(column, SHORT), QUIETEST);
    let raw = paused(&signals.tau_raw);
    if !falls(&raw) || !falls(&quieter(paused(rest), &raw)) {
        return None;
    }
    Some(autoregression(level, window, signals.used(), signals.rate_hz))
}

/// Whether noise with this level from nought to the Nyquist frequency is louder the slower it is.
pub(super) fn falls(level: &[f64]) -> bool {
    mean(level, BELOW) > rule().falls * mean(level, BAND)
}

/// The level of noise without the lines that stand in it, as loud there as at the frequencies above.
///
/// What is wrong over position comes always and at the same frequencies where a knob turns evenly, and no quiet stretch is
/// without it. But it stands alone: noise of a filter of second order rises by 1.5^4 in three quarters of an octave, and
/// no line's flank rises as little. From above, as it is there that noise is alone. Where so many would be lines they are
/// a slope, and the level is as it was.
fn without_lines(level: Vec<f64>) -> Vec<f64> {
    let half = level.len() - 1;
    let mut alone = level.clone();
    let mut lines = 0.0;
    for bin in (TAKEN_OFF..half / 2).rev() {
        let usual = median(alone[bin + 1..=(2 * bin).max(bin + FEWEST)].to_vec());
        if alone[bin] > LINE * usual {
            alone[bin] = usual;
            lines += 1.0;
        }
    }
    if lines > FEW_LINES * (half / 2) as f64 { level } else { alone }
}

/// Whether a level falls further than that of any noise.
///
/// A random walk, the slowest, is (w / pi k)^2 times as loud in bin k of a window of w rows as at the Nyquist frequency:
/// in the slowest that is read a quarter of what is allowed. Beside a torque that was commanded, with next to no noise,
/// what a model leaves is far above.
fn plunges(level: &[f64], window: usize) -> bool {
    let loudest = level[TAKEN_OFF..].iter().copied().fold(0.0, f64::max);
    loudest > (window as f64 / PI).powi(2) * mean(level, BAND)
}

/// Noise with the level of periodograms of such a window, read of so many samples.
///
/// A window's mean is taken off it, and with it its slowest frequencies. Noise that still rises there goes on as the
/// rest of it does (what is not seen is expected of what is: Dempster, Laird & Rubin 1977). Not where that is as slow as
/// a drift, which is no noise: what a model misses of a slow motion rises there too.
pub(super) fn autoregression(mut level: Vec<f64>, window: usize, samples: usize, rate_hz: f64) -> Noise {
    let slowest = level[TAKEN_OFF];
    level[..TAKEN_OFF].fill(slowest);
    let mut noise = with_level(&level, window, samples);
    for _ in 0..if rate_hz > DRIFT_HZ * window as f64 { ROUNDS } else { 0 } {
        for (bin, unseen) in level[..TAKEN_OFF].iter_mut().enumerate() {
            *unseen = noise.power(bin as f64 / window as f64);
        }
        noise = with_level(&level, window, samples);
    }
    noise
}

fn with_level(level: &[f64], window: usize, samples: usize) -> Noise {
    let covariance: Vec<f64> = (0..=noise::MOST.min(window / 2))
        .map(|lag| {
            let wave = |bin: usize| level[bin] * (2.0 * PI * (bin * lag) as f64 / window as f64).cos();
            let ends = 0.5 * (wave(0) + wave(window / 2));
            (ends + (1..window / 2).map(wave).sum::<f64>()) / (window / 2) as f64
        })
        .collect();
    Noise::autoregressive(&covariance, samples as f64)
}

/// The mean level of a band.
fn mean(level: &[f64], [from, to]: [f64; 2]) -> f64 {
    let half = (level.len() - 1) as f64;
    let bins = (from * half) as usize..(to * half) as usize;
    level[bins.clone()].iter().sum::<f64>() / bins.len() as f64
}

/// The lesser at each frequency, of a level that is louder than the other one where noise is alone.
fn quieter(mut level: Vec<f64>, other: &[f64]) -> Vec<f64> {
    if mean(&level, BAND) > LOUDER * mean(other, BAND) {
        level.iter_mut().zip(other).for_each(|(level, other)| *level = level.min(*other));
    }
    level
}

/// The level of noise at each frequency, of its powers in all stretches: their mean where that is what the quiet
/// ones let expect, which it estimates three times as well; else what the quiet ones say.
fn steady(powers: &Powers) -> Vec<f64> {
    let quiet = quiet(powers, QUIET);
    let means = powers.mean(repeat(1.0));
    let windows = powers.windows().count() as f64;
    let total = quiet.iter().sum::<f64>();
    let error =
        ((QUANTILES_ERROR - 1.0) * quiet.iter().map(|level| level * level).sum::<f64>() / windows).sqrt();
    if (means.iter().sum::<f64>() - total).abs() <= rule().steady * error { means } else { quiet }
}

/// The mean at each frequency of exponential variables of which most are alike and some are too large, by a low quantile.
fn quiet(powers: &Powers, quantile: f64) -> Vec<f64> {
    powers.quantile(quantile).iter().map(|power| power / -(1.0 - quantile).ln()).collect()
}

/// Variance of white noise with the power of `rest` in the band above, and its level there; the median over frequencies
/// keeps a line (mains, a resonance) out.
pub(super) fn above(signals: &Signals, rest: &[f64]) -> (f64, Vec<f64>) {
    let knocking = !signals.knocks.is_empty();
    let wanted = |window: usize| if knocking { ENOUGH.max(signals.used() / (2 * window)) } else { ENOUGH };
    let some = || WINDOWS.into_iter().rfind(|window| heard(signals, *window).len() >= ENOUGH);
    let found = WINDOWS.into_iter().find(|window| heard(signals, *window).len() >= wanted(*window));
    let Some(window) = found.or_else(some) else {
        return (f64::NAN, Vec::new());
    };
    let bin = |share: f64| (share * (window / 2) as f64) as usize;
    let band = bin(BAND[0])..bin(BAND[1]);
    let starts = heard(signals, window);
    let powers = Periodogram::of(window).powers(rest, &starts, band);
    let totals: Vec<f64> = powers.windows().map(|window| window.iter().sum()).collect();
    // An impact is heard at all frequencies, but only while it lasts. A sensor at its limit is quiet: beside that the
    // noise itself would be loud.
    let free = unlimited(&signals.tau_raw, &starts, window);
    let usual: Vec<f64> =
        totals.iter().zip(&free).filter(|(_, free)| **free).map(|(total, _)| *total).collect();
    let loudest = rule().loud * median(if usual.len() < ENOUGH { totals.clone() } else { usual });
    let weights = totals.iter().map(|total| f64::from(*total <= loudest));
    let windows = weights.clone().sum::<f64>();
    // The median of an average of K exponential variables, by Wilson & Hilferty 1931; half-overlapping
    // windows count as about 0.95 each under a Hann taper (Welch 1967), no matter at this accuracy.
    let bias = (1.0 - 1.0 / (9.0 * windows)).powi(3);
    let level = powers.mean(weights);
    (median(level.clone()) / bias, level)
}

/// Where windows begin in which the sensor says anything of noise: a motor that is off has a torque of nought, and where a
/// knob knocks all else is louder.
fn heard(signals: &Signals, window: usize) -> Vec<usize> {
    let mut starts = windows(&signals.segments, window);
    starts.retain(|start| {
        let torque = &signals.tau_raw[*start..start + window];
        let knocks = |knock: &Range<usize>| knock.start < start + window && *start < knock.end;
        torque.iter().any(|x| *x != torque[0]) && !signals.knocks.iter().any(knocks)
    });
    starts
}

/// Whether readings in each of the windows, by their starts, are hardly ever the largest of all.
fn unlimited(torque: &[f64], starts: &[usize], window: usize) -> Vec<bool> {
    let of = |start: &usize| &torque[*start..start + window];
    let limit = starts.iter().map(|start| largest(of(start))).fold(0.0, f64::max);
    let at_limit = |start: &usize| of(start).iter().filter(|x| x.abs() >= limit).count() as f64;
    starts.iter().map(|start| at_limit(start) <= LIMITED * window as f64).collect()
}

/// The largest size among the readings of a window, several side by side: they need not wait for each other.
fn largest(torque: &[f64]) -> f64 {
    let most = |most: [f64; LANES], few: &[f64; LANES]| std::array::from_fn(|i| most[i].max(few[i].abs()));
    torque.as_chunks().0.iter().fold([0.0; LANES], most).into_iter().fold(0.0, f64::max)
}

/// The middle one.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
