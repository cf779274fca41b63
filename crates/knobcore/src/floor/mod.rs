//! The noise floor: what the torque sensor's noise alone would leave of the error.
//!
//! Above the bandwidth of the model the raw torque holds noise alone. Its level there, with the gain of the
//! measurement filter for white noise, is the floor. Where that noise is not white, its whole spectrum is read off the
//! quieter stretches; where a spectrum does not tell enough, repeats of the motion do.

mod repeats;
mod spectral;

use crate::model::Model;
use crate::noise::Noise;
use crate::rule::rule;
use crate::signals::Signals;
use repeats::Pure;
use spectral::{Heard, Told, above, bridged, least, left};

pub use spectral::Unheard;

/// Times what a model leaves that noise of any colour is taken for at most: quiet stretches tell it to a factor of two.
const LEFT: f64 = 4.0;

/// What is left of the squared error beside a model that is by no more than this larger than what repeats say of the
/// noise is noise, if they tell no better.
const DOUBT: f64 = 0.35;

/// Noise of the raw torque of each capture beside a model; None where it is not known.
pub fn noises(data: &[&Signals], model: &Model) -> Vec<Option<Noise>> {
    repeated(heard(data, model), data)
}

/// Why the spectrum of the first capture's torque does not tell its noise, if it does not.
pub fn unheard(data: &[&Signals], model: &Model) -> Option<Unheard> {
    match heard(data, model).first()?.told {
        Told::Nothing(why) => Some(why),
        _ => None,
    }
}

fn heard(data: &[&Signals], model: &Model) -> Vec<Heard> {
    let of = |(raw, signals): (f64, &&Signals)| Heard::of(raw, signals, model).unless_too_loud(signals);
    loudest(data).into_iter().zip(data).map(of).collect()
}

/// The same with what repeats of the motion tell where a spectrum does not tell enough.
///
/// Noise of a colour is told from what the model lacks by its being there always, and so may be a part of that: where
/// repeats leave less, that returned with the motion. What the level above the motion says of noise below is a guess.
fn repeated(heard: Vec<Heard>, data: &[&Signals]) -> Vec<Option<Noise>> {
    if heard.iter().all(|heard| heard.told == Told::Level) {
        return heard.into_iter().map(|heard| heard.noise).collect();
    }
    let (spectral, rests): (Vec<_>, Vec<_>) =
        heard.into_iter().map(|heard| ((heard.noise, heard.told), heard.rest)).unzip();
    let pure = repeats::pure(data, &rests);
    let better =
        |((own, told), pure): ((Option<Noise>, Told), Option<Pure>), signals: &Signals, rest: &[f64]| {
            let Some(pure) = pure else { return own };
            let variance = own.as_ref().map(|noise| noise.behind(signals.filter.as_ref()));
            let less = |own: f64| told != Told::Level && pure.surely() < own;
            // Noise of the motion is in repeats as well, but is faster, not slower, than a sensor's.
            let slow = !pure.noise.coefficients.is_empty();
            let apart = pure.surely() / pure.variance;
            let more = |own: f64| told == Told::Above && slow && !pure.most && pure.variance > own * apart;
            if variance.map_or(pure.most, |own| !less(own) && !more(own)) {
                return own;
            }
            let louder = left(signals, rest) / pure.variance;
            let doubt = (rule().steady * pure.error).min(DOUBT);
            let scale = if louder <= 1.0 + doubt { louder } else { 1.0 };
            Some(Noise { innovation: scale * pure.noise.innovation, ..pure.noise })
        };
    let of = |(((spectral, pure), signals), rest): (((_, _), &&Signals), &Vec<f64>)| {
        better((spectral, pure), signals, rest)
    };
    spectral.into_iter().zip(pure).zip(data).zip(&rests).map(of).collect()
}

/// Standard error of the variance of all captures' noise together, as a share of it.
///
/// What is white is read before the measurement filter, where all samples are independent.
pub fn doubt(data: &[&Signals], noises: &[Noise]) -> f64 {
    let (mut rows, mut squares) = (0.0, 0.0);
    for (signals, noise) in data.iter().zip(noises) {
        let own = signals.used() as f64;
        let alike = if noise.coefficients.is_empty() { 1.0 } else { noise.alike(signals.filter.as_ref()) };
        rows += own;
        squares += (own * spectral::error(alike, own)).powi(2);
    }
    squares.sqrt() / rows
}

/// What the measurement filter leaves of white noise.
fn gain(signals: &Signals) -> f64 {
    signals.filter.as_ref().map_or(1.0, |filter| filter.sos().mean_power())
}

/// Of each capture the variance of white noise as loud as its raw torque, whatever the model; see [`noises`].
pub fn loudest(data: &[&Signals]) -> Vec<f64> {
    data.iter().map(|signals| above(signals, &signals.tau_raw).0).collect()
}

/// What noise alone would leave of a fit.
#[derive(Debug, Clone, Copy)]
pub struct Floor {
    /// Variance of white noise of the raw torque that would leave as much, (N m)^2, the mean over the captures.
    pub white: f64,
    /// Sum of squares over the samples that count, after the measurement filter, (N m)^2.
    pub squares: f64,
    /// Samples that count.
    pub rows: f64,
}

impl Floor {
    /// Of captures beside a model; see [`Floor::with`].
    pub fn of(data: &[&Signals], model: &Model) -> Self {
        Self::below(&loudest(data), data, model)
    }

    /// The same where it is known how [`loud`](loudest) the captures are at most.
    pub fn below(loudest: &[f64], data: &[&Signals], model: &Model) -> Self {
        let heard = loudest.iter().zip(data).map(|(raw, signals)| Heard::of(*raw, signals, model)).collect();
        Self::with(data, &repeated(heard, data))
    }

    /// Of captures with these [`noises`]; NaN where that of none is known. A capture that is too short by itself has the
    /// noise of the others: it was the same sensor.
    pub fn with(data: &[&Signals], noises: &[Option<Noise>]) -> Self {
        let mut floor = Self { white: 0.0, squares: 0.0, rows: 0.0 };
        // What the noise of each leaves, per sample, and as white noise.
        let left = |(signals, noise): (&&Signals, &Option<Noise>)| {
            noise.as_ref().map(|noise| noise.behind(signals.filter.as_ref()) / gain(signals))
        };
        let whites: Vec<Option<f64>> = data.iter().zip(noises).map(left).collect();
        let known = || {
            data.iter().zip(&whites).filter_map(|(signals, white)| Some((signals.used() as f64, (*white)?)))
        };
        let heard: f64 = known().map(|(used, _)| used).sum();
        let usual = known().map(|(used, white)| white * used).sum::<f64>() / heard;
        for (signals, white) in data.iter().zip(whites) {
            let (white, used) = (white.unwrap_or(usual), signals.used() as f64);
            floor.white += white * used;
            floor.squares += white * gain(signals) * used;
            floor.rows += used;
        }
        Self { white: floor.white / floor.rows, ..floor }
    }

    /// What `white` stays below beside a model that leaves such a sum of squares: white noise is no louder than the raw
    /// torque, any other is part of what is left.
    pub fn whitest(loudest: &[f64], data: &[&Signals], cost: f64) -> f64 {
        let most = |most: f64, (raw, signals): (&f64, &&Signals)| most.max(raw * bridged(signals));
        let white = loudest.iter().zip(data).fold(0.0, most);
        let passed: f64 = data.iter().map(|signals| gain(signals) * signals.used() as f64).sum();
        white.max(LEFT * cost / passed)
    }

    /// The same beside a model that leaves such a sum of squares of these captures; where that is surely less, what
    /// repeats of the motion tell.
    ///
    /// Then the band it was read in holds more than a sensor's noise, as the ripple of gears does that turn fast, and
    /// what there is of it below its spectrum does not tell.
    pub fn if_left(self, cost: f64, data: &[&Signals], model: &Model) -> Self {
        let white = Noise::white(1.0);
        let alike = data.iter().map(|signals| white.alike(signals.filter.as_ref())).fold(1.0, f64::max);
        if cost >= least(self.squares, self.rows, alike) || self.squares.is_nan() {
            return self;
        }
        Self::with(data, &noises(data, model))
    }

    /// Root mean square, N m.
    pub fn rms(&self) -> f64 {
        (self.squares / self.rows).sqrt()
    }
}
