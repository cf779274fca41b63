//! Pure error: by how much the torque differs where the same motion was made again.
//!
//! What a model lacks returns with the motion, noise does not: half the mean square of the differences is noise alone,
//! whatever its colour and however wrong the model (the lack-of-fit test with near replicates: C. Daniel & F. S. Wood,
//! *Fitting Equations to Data*, 1971; R. Christensen, *Annals of Statistics* 17, 1989). A motion is never quite the same
//! again; the model takes off what that makes of the torque. Pairs where it makes much count only where there are too few
//! others: what the model lacks differs there too, and noise is no louder than what they tell.

use super::spectral::{autoregression, falls, measured};
use crate::noise::Noise;
use crate::periodogram::Periodogram;
use crate::rule::rule;
use crate::signals::Signals;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::iter::repeat;
use std::sync::{Arc, Mutex, PoisonError};

/// Samples of the stretches that are looked for again: as many of these as leave enough pairs.
const WINDOWS: [usize; 5] = [512, 256, 128, 64, 32];
/// Pairs below which their mean tells nothing.
const ENOUGH: usize = 12;
/// Stretches of a capture that are looked for, evenly spread where there are more.
const MOST: usize = 128;
/// Samples before and after a stretch (of another capture its place) in which it is looked for.
const SPAN: usize = 1 << 16;
/// Points of a stretch by which it is looked for.
const POINTS: usize = 16;
/// Steps of a stretch's length in which it is looked for, before single samples.
const STEPS: usize = 64;
/// Sets of captures, with a length of stretches each, that are remembered as looked through: a search has a few views of
/// the same ones.
const LOOKED_THROUGH: usize = 64;
/// Share of a stretch's samples that must count.
const COUNTED: f64 = 0.9;
/// What repeats say of the noise of a capture.
pub(super) struct Pure {
    /// Variance behind the measurement filter, (N m)^2.
    pub variance: f64,
    /// Its standard error, as a share.
    pub error: f64,
    /// The noise of the raw torque.
    pub noise: Noise,
    /// Whether the noise may be quieter: the model's torque differs too, and so does what it lacks.
    pub most: bool,
}

impl Pure {
    /// The variance behind the filter that noise surely stays below, (N m)^2.
    pub fn surely(&self) -> f64 {
        self.variance * rule().explained * (1.0 + rule().steady * self.error)
    }
}

/// A stretch, and where the same motion was made again: captures and rows.
#[derive(Clone, Copy)]
struct Pair {
    at: [(usize, usize); 2],
}

/// What is left of captures beside a model, raw and behind the filter.
struct Rests<'a> {
    data: &'a [&'a Signals],
    raw: &'a [Vec<f64>],
    filtered: Vec<Vec<f64>>,
    /// RMS of the measured torque.
    torque: f64,
}

/// Of each capture, where repeats of its motion, or those of all captures, tell anything.
pub(super) fn pure(data: &[&Signals], raw: &[Vec<f64>]) -> Vec<Option<Pure>> {
    let filtered = data.iter().zip(raw).map(|(signals, rest)| measured(signals, rest)).collect();
    let squares = |signals: &&Signals| -> f64 {
        signals.tau.iter().zip(&signals.weight).map(|(tau, weight)| weight * tau * tau).sum()
    };
    let used: usize = data.iter().map(|signals| signals.used()).sum();
    let torque = (data.iter().map(squares).sum::<f64>() / used.max(1) as f64).sqrt();
    let rests = Rests { data, raw, filtered, torque };
    let told = |most: bool| {
        WINDOWS.into_iter().find_map(|window| {
            let mut pairs = rests.pairs(window);
            pairs.retain(|pair| most || rests.is_same(pair, window));
            rests.told_by(&pairs, window, most)
        })
    };
    let none = || data.iter().map(|_| None).collect::<Vec<_>>();
    let least = |(same, near): (Option<Pure>, Option<Pure>)| match (same, near) {
        (Some(same), Some(near)) if near.surely() < same.variance => Some(near),
        (same, near) => same.or(near),
    };
    told(false).unwrap_or_else(none).into_iter().zip(told(true).unwrap_or_else(none)).map(least).collect()
}

impl Rests<'_> {
    /// Stretches of all captures whose motion was made again.
    fn pairs(&self, window: usize) -> Vec<Pair> {
        closest(self.data, window).iter().filter(|pair| self.is_near(pair, window)).copied().collect()
    }

    /// Of each capture what such pairs say, if there are enough: its own ones, or those of all.
    fn told_by(&self, pairs: &[Pair], window: usize, most: bool) -> Option<Vec<Option<Pure>>> {
        if pairs.len() < ENOUGH {
            return None;
        }
        let of = |(capture, signals): (usize, &&Signals)| {
            let own: Vec<&Pair> = pairs.iter().filter(|pair| pair.at[0].0 == capture).collect();
            let pairs = if own.len() < ENOUGH { pairs.iter().collect() } else { own };
            self.told(&pairs, window, signals).map(|pure| Pure { most, ..pure })
        };
        Some(self.data.iter().enumerate().map(of).collect())
    }

    /// Whether the motion of two stretches is the same, as far as a filter that passes its torque asks.
    fn is_near(&self, Pair { at: [one, other] }: &Pair, window: usize) -> bool {
        let signals = self.data[one.0];
        let squares = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>();
        let rows = |at: usize| at..at + window;
        let way =
            apart(&signals.theta[rows(one.1)], &self.data[other.0].theta[rows(other.1)], 1, f64::INFINITY);
        let speed = squares(&signals.omega[rows(one.1)]);
        let late = (way / speed).sqrt();
        let weight = &self.data[other.0].weight[rows(other.1)];
        counts(weight) && 2.0 * PI * signals.passes_hz() * late < rule().same_way
    }

    /// Whether the model's torque is the same in both as well.
    fn is_same(&self, Pair { at: [one, other] }: &Pair, window: usize) -> bool {
        let torque = |(capture, row): (usize, usize)| -> Vec<f64> {
            let tau = &self.data[capture].tau[row..row + window];
            tau.iter().zip(&self.filtered[capture][row..]).map(|(tau, rest)| tau - rest).collect()
        };
        let differs = apart(&torque(*one), &torque(*other), 1, f64::INFINITY) / window as f64;
        differs.sqrt() < rule().same_torque * self.torque
    }

    /// What pairs say of the noise of a capture like this.
    fn told(&self, pairs: &[&Pair], window: usize, like: &Signals) -> Option<Pure> {
        let (mut halves, mut raw) = (Vec::new(), Vec::new());
        for Pair { at: [(a, i), (b, j)] } in pairs {
            let (mut squares, mut rows) = (0.0, 0.0);
            for k in 0..window {
                if self.data[*a].weight[i + k] > 0.0 && self.data[*b].weight[j + k] > 0.0 {
                    squares += (self.filtered[*a][i + k] - self.filtered[*b][j + k]).powi(2);
                    rows += 1.0;
                }
                raw.push((self.raw[*a][i + k] - self.raw[*b][j + k]) * 0.5_f64.sqrt());
            }
            halves.push(0.5 * squares / f64::max(rows, 1.0));
        }
        let many = halves.len() as f64;
        let variance = halves.iter().sum::<f64>() / many;
        let spread = halves.iter().map(|half| (half - variance).powi(2)).sum::<f64>() / (many - 1.0);
        // Two stretches may be each other's repeats, and tell the same then.
        let error = (2.0 * spread / many).sqrt() / variance;
        let starts: Vec<usize> = (0..raw.len()).step_by(window).collect();
        let periodogram = Periodogram::of(window);
        let level = periodogram.powers(&raw, &starts, periodogram.bins()).mean(repeat(1.0));
        let colour = if falls(&level) {
            autoregression(level, window, raw.len(), like.rate_hz)
        } else {
            Noise::white(1.0)
        };
        let scale = variance / colour.behind(like.filter.as_ref());
        let noise = Noise { innovation: scale * colour.innovation, ..colour };
        (variance > 0.0 && error.is_finite()).then_some(Pure { variance, error, noise, most: false })
    }
}

/// Stretches of all captures, each with the one whose motion is closest. A model has no part in that, and it takes longer
/// than all else here: captures that were looked through lately are not again.
fn closest(data: &[&Signals], window: usize) -> Arc<Vec<Pair>> {
    static LATELY: Mutex<VecDeque<(u64, Arc<Vec<Pair>>)>> = Mutex::new(VecDeque::new());
    let starts: Vec<Vec<usize>> = data.iter().map(|signals| stretches(signals, window)).collect();
    let key = fingerprint(data, &starts, window);
    // Whoever stopped in the middle of this has at worst left one entry less.
    let lately = || LATELY.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pairs)) = lately().iter().find(|(known, _)| *known == key) {
        return Arc::clone(pairs);
    }
    let looked_for = |capture: usize| {
        let every = starts[capture].len().div_ceil(MOST).max(1);
        starts[capture].iter().step_by(every).map(move |row| (capture, *row))
    };
    let all = (0..data.len()).flat_map(looked_for);
    let pairs: Arc<Vec<Pair>> =
        Arc::new(all.filter_map(|at| Some(Pair { at: [at, again(data, at, window)?] })).collect());
    let mut lately = lately();
    lately.truncate(LOOKED_THROUGH - 1);
    lately.push_front((key, Arc::clone(&pairs)));
    pairs
}

/// What all depends on that [`again`] looks at.
fn fingerprint(data: &[&Signals], starts: &[Vec<usize>], window: usize) -> u64 {
    let mut hasher = DefaultHasher::new();
    (window, starts).hash(&mut hasher);
    for signals in data {
        signals.rate_hz.to_bits().hash(&mut hasher);
        signals.segments.hash(&mut hasher);
        signals.theta.iter().for_each(|theta| hasher.write_u64(theta.to_bits()));
    }
    hasher.finish()
}

/// Where the motion of a stretch came closest to itself.
fn again(data: &[&Signals], (capture, row): (usize, usize), window: usize) -> Option<(usize, usize)> {
    let stretch = &data[capture].theta[row..row + window];
    let step = (window / STEPS).max(1);
    let mut best = (f64::INFINITY, (0, 0));
    for (other, signals) in data.iter().enumerate() {
        if signals.rate_hz != data[capture].rate_hz {
            continue;
        }
        let near = row.saturating_sub(SPAN)..row + SPAN;
        for segment in signals.segments.iter().filter(|segment| segment.len() >= window) {
            let last = segment.end - window;
            for at in (segment.start.max(near.start)..=last.min(near.end)).step_by(step) {
                if other == capture && at.abs_diff(row) < window {
                    continue;
                }
                let apart = apart(stretch, &signals.theta[at..at + window], window / POINTS, best.0);
                if apart < best.0 {
                    best = (apart, (other, at));
                }
            }
        }
    }
    let (other, coarse) = Some(best.1).filter(|_| best.0.is_finite())?;
    let signals = data[other];
    let segment = signals.segments.iter().find(|segment| segment.contains(&coarse))?;
    let near = coarse.saturating_sub(step).max(segment.start)..=(coarse + step).min(segment.end - window);
    let closeness = |at: &usize| apart(stretch, &signals.theta[*at..at + window], 1, f64::INFINITY);
    let at = near
        .filter(|at| other != capture || at.abs_diff(row) >= window)
        .min_by(|a, b| closeness(a).total_cmp(&closeness(b)))?;
    Some((other, at))
}

/// Where stretches begin that are looked for: one after the other, those that count.
fn stretches(signals: &Signals, window: usize) -> Vec<usize> {
    let of = |segment: &std::ops::Range<usize>| {
        let end = segment.end;
        segment.clone().step_by(window).take_while(move |start| start + window <= end)
    };
    let mut starts: Vec<usize> = signals.segments.iter().flat_map(of).collect();
    starts.retain(|start| counts(&signals.weight[*start..start + window]));
    starts
}

fn counts(weight: &[f64]) -> bool {
    let counted = weight.iter().filter(|weight| **weight > 0.0).count();
    counted as f64 >= COUNTED * weight.len() as f64
}

/// Sum of squared differences of two columns at every so many rows, times as many; of more than `most` no matter what.
fn apart(one: &[f64], other: &[f64], every: usize, most: f64) -> f64 {
    let mut sum = 0.0;
    for (a, b) in one.iter().zip(other).step_by(every) {
        sum += (a - b) * (a - b) * every as f64;
        if sum > most {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion to and fro with this period, in samples.
    fn turned(period: usize) -> Signals {
        let theta: Vec<f64> = (0..4000).map(|k| (2.0 * PI * k as f64 / period as f64).sin()).collect();
        let whole = 0..theta.len();
        Signals {
            rate_hz: 1000.0,
            weight: vec![1.0; theta.len()],
            segments: vec![whole; 1],
            theta,
            ..Signals::default()
        }
    }

    #[test]
    fn where_the_torque_of_a_motion_that_is_made_again_differs_noise_is_no_louder_than_what_is_left_does() {
        let mut noise = crate::random::Noise::new(5);
        let phase: Vec<f64> = (0..6000).map(|k| 2.0 * PI * f64::from(k) / 500.38).collect();
        let speed = 2.0 * PI * 1000.0 / 500.38;
        let of = |f: fn(f64) -> f64| phase.iter().map(|phase| f(*phase)).collect::<Vec<f64>>();
        let rest: Vec<f64> = of(|phase| 0.3 * (2.0 * phase).sin() + 0.2 * phase.cos().signum());
        let rest: Vec<f64> = rest.iter().map(|missing| missing + 0.05 * noise.normal()).collect();
        let detents = of(|phase| (90.0 * phase).sin());
        let signals = Signals {
            theta: of(f64::sin),
            omega: phase.iter().map(|phase| speed * phase.cos()).collect(),
            tau: detents.iter().zip(&rest).map(|(detents, rest)| detents + rest).collect(),
            weight: vec![1.0; phase.len()],
            segments: vec![0..phase.len(); 1],
            ..turned(500)
        };
        let told = pure(&[&signals], std::slice::from_ref(&rest));
        let told = told.first().and_then(Option::as_ref).unwrap();
        assert!(told.most);
        // A reversal that comes a sample later makes a little of it.
        assert!((0.9..1.6).contains(&(told.variance / 0.0025)), "{}", told.variance);
        assert!(told.surely() < 0.1 * rest.iter().map(|x| x * x).sum::<f64>() / rest.len() as f64);
    }

    #[test]
    fn a_stretch_comes_closest_to_itself_a_period_away_whichever_captures_were_looked_through_before() {
        let periods = [500, 800, 500];
        for period in periods {
            let signals = turned(period);
            let pairs = closest(&[&signals], 128);
            assert!(pairs.len() > 20, "{period}");
            for Pair { at: [(_, one), (_, other)] } in pairs.iter() {
                assert_eq!(one.abs_diff(*other) % period, 0, "{period}: {one} {other}");
            }
        }
        let [one, other] = [500, 800].map(turned);
        let starts = vec![stretches(&one, 128)];
        let key = |signals: &Signals, window| fingerprint(&[signals], &starts, window);
        assert_eq!(key(&one, 128), key(&one.clone(), 128));
        assert!(key(&one, 128) != key(&other, 128) && key(&one, 128) != key(&one, 256));
        let gone = Signals { segments: vec![0..3000; 1], ..one.clone() };
        assert!(key(&one, 128) != key(&gone, 128));
    }
}
