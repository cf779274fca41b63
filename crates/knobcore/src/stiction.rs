//! Static friction from a capture that sticks: breakaway torques and the width of the stick band.
//!
//! The haptic-camera paper reads D and dv off a density plot (its last figure): points are dense while the
//! knob sticks and thin out beyond. Here the same argument is an estimator. Over speed, the density of the
//! samples has one level inside the band and a lower one outside; the border that makes the samples most
//! likely is dv (and where a stuck knob does not creep, that is the resolution of the velocity). In torque, what counts is the last moment before each slip: friction answers the push up to
//! D, and there the knob breaks away.

use crate::effects::{Id, Over};
use crate::model::Model;
use crate::predict::torque;
use crate::random::Noise;
use crate::signals::Signals;
use crate::special::Z95;
use std::ops::Range;

/// Breakaways that an interval needs.
const FEWEST: usize = 3;
/// The density inside the band must be this many times the density outside.
const DENSER: f64 = 3.0;
/// Speeds looked at, as a multiple of the median speed of the moving knob.
const REACH: f64 = 0.5;
/// Candidate borders of the band.
const BORDERS: usize = 200;
/// Resamples for the interval of dv.
const DRAWS: usize = 200;
/// Blocks of samples that are resampled.
const BLOCKS: usize = 50;
/// A slip is faster than this many standard deviations of the velocity within this time, s.
const SLIP_SD: f64 = 40.0;
/// See [`SLIP_SD`].
const SLIP_S: f64 = 0.02;
/// The filter smears a slip over less than this, s.
const SMEAR_S: f64 = 0.003;
/// The push before a slip is read over this long, s.
const WINDOW_S: f64 = 0.015;

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// SI.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// What a capture says about sticking.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiction {
    /// Breakaway friction backward, N m, a magnitude; None with fewer than three breakaways.
    pub d_neg: Option<Estimate>,
    /// Breakaway friction forward, N m, a magnitude.
    pub d_pos: Option<Estimate>,
    /// Half-width of the stick band, rad/s; None where the density of speeds has no edge.
    pub dv: Option<Estimate>,
    /// Breakaways seen, backward and forward.
    pub breakaways: [usize; 2],
}

/// Estimates static friction; `model` is fitted to the sliding parts of the same captures.
pub fn stiction(data: &[&Signals], model: &Model) -> Stiction {
    let others: Vec<Id> = model.effects().filter(|id| id.info().over != Over::Velocity).collect();
    let mut peaks = [Vec::new(), Vec::new()];
    for signals in data {
        let rest = model.only(&others).map(|rest| torque(&rest, signals)).unwrap_or_default();
        let friction: Vec<f64> = signals.tau.iter().zip(&rest).map(|(tau, other)| tau - other).collect();
        let reach = (SLIP_S * signals.rate_hz) as usize;
        // A stick that ends where the record does (or where its torque is clipped) is no breakaway.
        let inside = |stuck: &&Range<usize>| {
            signals.segments.iter().any(|s| s.contains(&(stuck.end + reach)) && s.start <= stuck.start)
        };
        for stuck in signals.stuck.iter().filter(inside) {
            let (slip, held) = (slip(signals, stuck.end), last_hold(&friction, stuck, signals.rate_hz));
            if let (Some(direction), Some(held)) = (slip, held) {
                peaks[usize::from(direction > 0.0)].push(direction * held);
            }
        }
    }
    let [backward, forward] = &peaks;
    Stiction {
        d_neg: mean(backward),
        d_pos: mean(forward),
        dv: band(data),
        breakaways: [backward.len(), forward.len()],
    }
}

/// Direction in which the knob slips from sample `at` on; None where it only seems to move.
fn slip(signals: &Signals, at: usize) -> Option<f64> {
    let after = at..(at + (SLIP_S * signals.rate_hz) as usize).min(signals.len());
    let fastest = after.max_by(|a, b| signals.omega[*a].abs().total_cmp(&signals.omega[*b].abs()))?;
    let (omega, sd) = (signals.omega[fastest], signals.omega_sd[fastest]);
    (omega.abs() > SLIP_SD * sd).then(|| omega.signum())
}

/// Friction torque at the end of a stick: a line through its last moments, without those that the filter has
/// smeared the slip over, carried on to its end.
fn last_hold(friction: &[f64], stuck: &Range<usize>, rate_hz: f64) -> Option<f64> {
    let (smear, window) = ((SMEAR_S * rate_hz) as usize, (WINDOW_S * rate_hz) as usize);
    let end = stuck.end.checked_sub(smear)?;
    let start = end.saturating_sub(window).max(stuck.start);
    let y = friction.get(start..end).filter(|y| y.len() > 2)?;
    let n = y.len() as f64;
    let (middle, level) = (0.5 * (n - 1.0), y.iter().sum::<f64>() / n);
    let x = |i: usize| i as f64 - middle;
    let slope = y.iter().enumerate().map(|(i, y)| x(i) * y).sum::<f64>() * 12.0 / (n * (n * n - 1.0));
    Some(level + slope * x(stuck.end - start))
}

/// Mean with its interval; the quantile of Student's t is close to that of the normal times n/(n - 2) root.
fn mean(x: &[f64]) -> Option<Estimate> {
    if x.len() < FEWEST {
        return None;
    }
    let n = x.len() as f64;
    let value = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|x| (x - value).powi(2)).sum::<f64>() / (n - 1.0);
    let half = Z95 * (variance / n * (n - 1.0) / (n - 2.0)).sqrt();
    Some(Estimate { value, ci95: [value - half, value + half] })
}

/// The edge in the density of speeds, with a block-bootstrap interval (Kuensch 1989).
fn band(data: &[&Signals]) -> Option<Estimate> {
    let sticking: Vec<&Signals> = data.iter().filter(|signals| !signals.stuck.is_empty()).copied().collect();
    let all =
        sticking.iter().flat_map(|signals| signals.segments.iter().flat_map(|s| &signals.omega[s.clone()]));
    let speeds: Vec<f64> = all.map(|omega| omega.abs()).collect();
    let stuck: usize = sticking.iter().flat_map(|signals| &signals.stuck).map(ExactSizeIterator::len).sum();
    let mut moving = speeds.clone();
    moving.sort_by(f64::total_cmp);
    let reach = REACH * moving.get((stuck + moving.len()) / 2)?;
    let length = speeds.len().div_ceil(BLOCKS);
    let counts: Vec<Vec<f64>> = speeds.chunks(length).map(|block| histogram(block, reach)).collect();
    let total = |pick: &mut dyn FnMut(usize) -> usize| {
        let mut sum = vec![0.0; BORDERS];
        for block in 0..counts.len() {
            sum.iter_mut().zip(&counts[pick(block)]).for_each(|(sum, count)| *sum += count);
        }
        sum
    };
    let value = edge(&total(&mut |block| block))? * reach;
    let mut noise = Noise::new(24);
    let mut draws: Vec<f64> = (0..DRAWS)
        .filter_map(|_| edge(&total(&mut |_| (noise.uniform() * counts.len() as f64) as usize)))
        .map(|share| share * reach)
        .collect();
    draws.sort_by(f64::total_cmp);
    let quantile = |q: f64| draws.get((q * draws.len() as f64) as usize).copied().unwrap_or(value);
    // The border is known to a cell of the histogram at best.
    let cell = reach / BORDERS as f64;
    let low = if quantile(0.025) > 1.5 * cell { quantile(0.025) - cell } else { 0.0 };
    Some(Estimate { value, ci95: [low, quantile(0.975) + cell] })
}

fn histogram(speeds: &[f64], reach: f64) -> Vec<f64> {
    let mut counts = vec![0.0; BORDERS];
    for speed in speeds {
        if let Some(count) = counts.get_mut((speed / reach * BORDERS as f64) as usize) {
            *count += 1.0;
        }
    }
    counts
}

/// The border, as a share of the reach, that makes a density with two levels most likely.
fn edge(counts: &[f64]) -> Option<f64> {
    let all: f64 = counts.iter().sum();
    let mut inside = 0.0;
    let mut best: Option<(f64, f64)> = None;
    for (cell, count) in counts.iter().enumerate().take(counts.len() - 1) {
        inside += count;
        let share = (cell + 1) as f64 / counts.len() as f64;
        let outside = all - inside;
        let level = |n: f64, width: f64| if n > 0.0 { n * (n / width).ln() } else { 0.0 };
        let likelihood = level(inside, share) + level(outside, 1.0 - share);
        let denser = inside / share > DENSER * outside / (1.0 - share);
        if denser && best.is_none_or(|(l, _)| likelihood > l) {
            best = Some((likelihood, share));
        }
    }
    best.map(|(_, share)| share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_of_a_density_is_found_where_it_is() {
        let mut noise = Noise::new(5);
        let speeds: Vec<f64> =
            (0..20_000).map(|i| if i % 2 == 0 { 0.08 * noise.uniform() } else { noise.uniform() }).collect();
        let share = edge(&histogram(&speeds, 1.0)).unwrap();
        assert!((share - 0.08).abs() < 0.006, "{share}");
    }

    #[test]
    fn an_even_density_has_no_edge() {
        let mut noise = Noise::new(6);
        let speeds: Vec<f64> = (0..20_000).map(|_| noise.uniform()).collect();
        assert_eq!(edge(&histogram(&speeds, 1.0)), None);
    }
}
