//! The edge of the torque's filter: where the motion makes waves of the torque that it would take off, it goes up.

use super::Recording;
use super::incoherent::Incoherent;
use super::motion::Moving;
use crate::filter::ZeroPhase;
use crate::fourier::Transform;
use crate::order::nth;
use crate::signals::Signals;
use std::f64::consts::{LN_2, PI, TAU};
use std::ops::Range;

/// The highest edge that follows the torque, as a share of the rate: noise has to be left above it.
const HIGHEST: f64 = 0.4;
/// A filter lets through what it leaves this much of, forward and backward.
const PASSES: f64 = 0.7;
/// Frequencies at which that is asked.
const STEPS: usize = 400;
/// The speed that counts as the highest: this quantile of all.
const TOP: f64 = 0.98;
/// Slower than this share of it, waves are slow too.
const FAST: f64 = 0.5;
/// Samples that are looked at.
const ENOUGH: usize = 60_000;
/// Cells of the grid of positions per shortest wave; the cells' width takes off a tenth of that one at most.
const CELLS: f64 = 4.0;
/// Neighbours by whose median a wave is judged, so that coloured noise makes none.
const NEIGHBOURS: usize = 128;
/// Frequencies, a fourth of what tells two waves apart or a half, within which they are one.
const SKIRT: usize = 32;
/// Chance of a wave where there is none.
const CHANCE: f64 = 1e-3;
/// Less than this share of all that the filter takes off is not worth a wider one.
const WORTH: f64 = 0.03;

/// A wave of the torque over position that a filter takes off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// 2 pi over its length, 1/rad: waves per turn.
    pub per_turn: f64,
    /// Its frequency at the highest speed, Hz.
    pub hz: f64,
    /// Its share of the variance of all that the filter takes off.
    pub share: f64,
}

/// The edge of the torque's filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The stopband edge, Hz.
    pub hz: f64,
    /// The fastest wave that a filter with the edge as it was given takes off.
    pub ripple: Option<Ripple>,
    /// Whether the filter still does.
    pub lost: bool,
    /// Why it is lower than it was.
    pub incoherent: Option<Incoherent>,
}

impl Edge {
    /// Of a filter with an edge at `hz`, which may go up if it `follows`.
    pub(super) fn of(
        recording: &Recording<'_>,
        moving: &Moving,
        stretches: &[Range<usize>],
        filter: &ZeroPhase,
        hz: f64,
        follows: bool,
    ) -> Self {
        let columns = [&moving.theta, &moving.omega, recording.tau];
        let ripple = fastest(columns, recording.measured, stretches, filter);
        let most = HIGHEST * recording.rate_hz;
        let Some(found) = ripple.filter(|_| follows && hz < most) else {
            return Self { hz, ripple, lost: ripple.is_some(), incoherent: None };
        };
        let wider = edge_for(found.hz, filter, hz, most);
        Self { hz: wider, ripple, lost: wider >= most, incoherent: None }
    }

    /// The edge below which the torque has to do with the motion.
    pub(super) fn lowered(self, to: Incoherent) -> Self {
        Self { hz: to.hz, lost: self.ripple.is_some(), incoherent: Some(to), ..self }
    }
}

/// The highest frequency that passes forward and backward, Hz.
fn passes(filter: &ZeroPhase) -> f64 {
    let rate = filter.sos().rate_hz();
    let at = |step: usize| 0.5 * rate * step as f64 / STEPS as f64;
    at((1..STEPS).take_while(|step| filter.sos().power_gain(at(*step)) >= PASSES).count())
}

/// The stopband edge with which a filter of the same kind lets a frequency through, at `most` Hz: its response is one
/// of tan(pi f / rate) over that of its edge (the bilinear transform).
fn edge_for(hz: f64, filter: &ZeroPhase, edge_hz: f64, most: f64) -> f64 {
    let rate = filter.sos().rate_hz();
    let warped = |hz: f64| (PI * hz / rate).tan();
    let wider = (warped(hz.min(most)) * warped(edge_hz) / warped(passes(filter))).atan() * rate / PI;
    wider.max(edge_hz).min(most)
}

/// The fastest wave of the torque of a capture beside that of a model, `torque`, that the measurement filter takes off.
pub fn taken_off(signals: &Signals, torque: &[f64]) -> Option<Ripple> {
    let rest: Vec<f64> = signals.tau_raw.iter().zip(torque).map(|(tau, model)| tau - model).collect();
    let counts: Vec<bool> = signals.weight.iter().map(|weight| *weight > 0.0).collect();
    fastest([&signals.theta, &signals.omega, &rest], &counts, &signals.segments, signals.filter.as_ref()?)
}

/// The fastest wave of the last of position, velocity and torque that a filter takes off and that stands out of what
/// else it takes off while the motion is fast.
///
/// Summed over position, waves add up whatever the speed does, and noise, of any colour in time, and impacts do not.
fn fastest(
    [theta, omega, tau]: [&[f64]; 3],
    counts: &[bool],
    stretches: &[Range<usize>],
    filter: &ZeroPhase,
) -> Option<Ripple> {
    let ends = filter.sos().settle() / 4;
    let mut rows: Vec<[f64; 3]> = Vec::new();
    for stretch in stretches.iter().filter(|s| s.len() > filter.padding().max(2 * ends)) {
        let mut slow = tau[stretch.clone()].to_vec();
        filter.filter_in_place(&mut slow).ok()?;
        let inside = stretch.start + ends..stretch.end - ends;
        let counted = inside.filter(|row| counts[*row]);
        rows.extend(counted.map(|row| [omega[row].abs(), theta[row], tau[row] - slow[row - stretch.start]]));
    }
    let mut speeds: Vec<f64> = rows.iter().map(|[speed, ..]| *speed).collect();
    let top = (TOP * speeds.len() as f64) as usize;
    let top = nth(&mut speeds, top).filter(|top| *top > 0.0)?;
    rows.retain(|[speed, ..]| *speed >= FAST * top);
    rows.truncate(ENOUGH);
    let power = rows.iter().map(|[.., x]| x * x).sum::<f64>() / rows.len() as f64;
    // A wave that is sampled twice at the slowest of these speeds.
    let slowest = rows.iter().fold(top, |slowest, [speed, ..]| slowest.min(*speed));
    let (step, spectrum) = over_position(&rows, PI * filter.sos().rate_hz() / slowest)?;
    let lowest = (TAU * passes(filter) / top / step).ceil() as usize;
    let sampled = ((PI * filter.sos().rate_hz() / top / step) as usize).min(spectrum.len());
    let square = (rows.len() as f64).powi(2) * power / 2.0;
    // Faster than twice a sample at the highest speed is also the image of what is slower.
    let found = highest(spectrum.get(lowest..sampled)?, square).map(|(at, share)| (lowest + at, share));
    let beyond = || highest(&spectrum[sampled..], square).map(|(at, share)| (sampled + at, share));
    let (at, share) = found.or_else(beyond)?;
    let per_turn = at as f64 * step;
    Some(Ripple { per_turn, hz: per_turn * top / TAU, share })
}

/// The last of squared sums that stands out of its neighbours and has a share of `square` that is worth it, and that
/// share.
fn highest(sums: &[f64], square: f64) -> Option<(usize, f64)> {
    let likely = (sums.len() as f64 / CHANCE).ln();
    let mut found: Option<(usize, f64)> = None;
    let mut last = 0;
    for block in (0..sums.len()).step_by(NEIGHBOURS).filter(|_| sums.len() >= NEIGHBOURS / 2) {
        let near = block.min(sums.len().saturating_sub(NEIGHBOURS));
        let mut level: Vec<f64> = sums[near..].iter().take(NEIGHBOURS).copied().collect();
        let middle = level.len() / 2;
        let level = nth(&mut level, middle).unwrap_or(0.0) / LN_2;
        for (at, sum) in sums.iter().enumerate().skip(block).take(NEIGHBOURS) {
            let share = sum / square;
            if *sum > likely * level && share > WORTH {
                // What stands close to another is its skirt: the highest of them counts.
                if found.is_none_or(|(_, best)| at > last + SKIRT || share > best) {
                    found = Some((at, share));
                }
                last = at;
            }
        }
    }
    found
}

/// Squared sum of value times e^(-i k theta) over rows of speed, position and value, for k from nought to at least
/// `highest`, and the step of k; None without motion.
fn over_position(rows: &[[f64; 3]], highest: f64) -> Option<(f64, Vec<f64>)> {
    let ends = |(low, high): (f64, f64), [_, theta, _]: &[f64; 3]| (low.min(*theta), high.max(*theta));
    let (low, high) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let range = high - low;
    let cells = CELLS * highest * range / TAU;
    // A motion has no more waves of one direction than samples; one that goes on for longer has none of these.
    if !(cells >= 1.0 && cells <= (2 * ENOUGH) as f64 * CELLS) {
        return None;
    }
    let width = range / cells;
    let mut grid = vec![0.0; cells as usize + 1];
    for [_, theta, x] in rows {
        if let Some(cell) = grid.get_mut(((theta - low) / width) as usize) {
            *cell += x;
        }
    }
    let length = 2 * grid.len().next_power_of_two();
    let step = TAU / (length as f64 * width);
    let transform = Transform::of(length);
    let mut pairs = transform.rows(1);
    grid.iter().enumerate().for_each(|(at, x)| pairs[at % 2][at / 2] = *x);
    let [re, im] = transform.forward(1, &mut pairs, 0..(highest / step) as usize);
    Some((step, re.iter().zip(&im).map(|(re, im)| re * re + im * im).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::cheby2;
    use crate::random::Noise;

    const RATE: f64 = 1000.0;

    fn filter(edge_hz: f64) -> ZeroPhase {
        ZeroPhase::new(cheby2(3, 20.0, edge_hz, RATE).unwrap())
    }

    /// Ten seconds that reach 50 rad/s, with waves of an amplitude in noise of a deviation of one.
    fn found(waves: f64, amplitude: f64, edge_hz: f64, colour: f64) -> Option<Ripple> {
        let mut noise = Noise::new(3);
        let t: Vec<f64> = (0..10_000).map(|i| f64::from(i) / RATE).collect();
        let omega: Vec<f64> = t.iter().map(|t| 50.0 * (0.9 * t).sin()).collect();
        let theta: Vec<f64> = t.iter().map(|t| 50.0 / 0.9 * (1.0 - (0.9 * t).cos())).collect();
        let mut before = 0.0;
        let tau: Vec<f64> = theta
            .iter()
            .zip(&omega)
            .map(|(theta, omega)| {
                before = colour * before + noise.normal();
                before + amplitude * (waves * theta + 0.3).sin() + 10.0 * omega.signum()
            })
            .collect();
        fastest([&theta, &omega, &tau], &vec![true; t.len()], &[0..5000, 5000..t.len()], &filter(edge_hz))
    }

    #[test]
    fn a_wave_that_the_filter_takes_off_is_found_with_its_frequency() {
        for waves in [12.0, 24.0, 31.7] {
            let ripple = found(waves, 1.0, 100.0, 0.0).unwrap();
            assert!((ripple.per_turn - waves).abs() < 0.1, "{ripple:?}");
            assert!((ripple.hz - waves * 50.0 / TAU).abs() < 0.03 * ripple.hz, "{ripple:?}");
        }
    }

    #[test]
    fn a_wave_that_passes_noise_of_any_colour_and_friction_that_turns_are_none() {
        assert_eq!(found(5.0, 1.0, 100.0, 0.0), None);
        assert_eq!(found(24.0, 1.0, 400.0, 0.0), None);
        for colour in [0.0, 0.9, 0.99] {
            assert_eq!(found(24.0, 0.0, 100.0, colour), None);
        }
    }

    #[test]
    fn the_edge_for_a_frequency_lets_it_through_and_not_much_more() {
        for hz in [80.0, 150.0, 300.0] {
            let wider = filter(edge_for(hz, &filter(100.0), 100.0, 400.0));
            assert!((passes(&wider) / hz - 1.0).abs() < 0.03, "{hz}: {}", passes(&wider));
        }
        assert_eq!(edge_for(20.0, &filter(100.0), 100.0, 400.0), 100.0);
        assert_eq!(edge_for(390.0, &filter(100.0), 100.0, 400.0), 400.0);
    }
}
