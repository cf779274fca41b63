//! Detents as they show through a joint that a rigid model lacks.
//!
//! The shaft feels what a detent asks of the knob through the joint's resonance: below it all of it, above it next to
//! nothing, and turned over, so that over the shaft's position a soft joint's detents are no wave. Held against the
//! error that went backward through the joint (the matched filter of Turin 1960, IRE Trans. Inf. Theory 6) they are:
//! one transform over position serves all periods, as in a scan of a rigid knob. The knob's position is the shaft's
//! less what the measured torque winds the joint up by, so that no load has to be known.

use super::moments::evaluate;
use super::scan::{Grid, Peak, Scan};
use crate::algebra::{dot, orthonormal, project};
use crate::effects::Joint;
use crate::filter::ZeroPhase;
use crate::model::Model;
use crate::predict::Seeds;
use crate::scalar::WIDE;
use crate::signals::Signals;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::ops::Range;

/// Stiffnesses that are looked at around one: as many as a transform has lanes, from a half to the double of it.
const AROUND: f64 = 4.0;
/// The least damping of a joint's resonance: a wide one is met by a stiffness that is a little off.
const DAMPED: f64 = 0.2;
/// Speeds that a motion is told by.
const SPEEDS: usize = 24;
/// A wave is looked at where at least this share of it passes joint and filter.
const PASSES: f64 = 1e-3;

/// Captures, and what a model leaves of their torque at best.
pub struct Through<'a> {
    data: &'a [&'a Signals],
    grid: Grid,
    /// The error of each capture, once more behind the measurement filter, N m.
    residuals: Vec<Vec<f64>>,
    /// Its sum of squares before, (N m)^2.
    pub squares: f64,
    /// How many samples go so fast, rad/s, and the share of power of each frequency that then passes the filter.
    speeds: Vec<(f64, f64, Vec<f64>)>,
}

/// Detents that show through a joint.
#[derive(Debug, Clone, Copy)]
pub struct Shown {
    /// In which times its stiffness.
    pub stiffness: f64,
    /// Which.
    pub peak: Peak,
    /// What a period without detents takes off, (N m)^2.
    pub background: f64,
}

impl<'a> Through<'a> {
    /// Of a model without a joint and without detents; none where nothing moves.
    pub fn of(data: &'a [&'a Signals], model: &Model) -> Option<Self> {
        let grid = Grid::over(data)?;
        let free: Vec<usize> = model.free().collect();
        let starts: Vec<usize> = data
            .iter()
            .scan(0, |from, signals| {
                *from += signals.len();
                Some(*from - signals.len())
            })
            .collect();
        let rows = data.iter().map(|signals| signals.len()).sum();
        let mut columns = vec![vec![0.0; rows]; free.len() + 1];
        evaluate(data, model, &model.values(), &Seeds::of(model, &free), |evaluated| {
            let core = evaluated.rows.clone();
            let from = starts[evaluated.capture] + core.start;
            for (column, part) in columns.iter_mut().zip(evaluated.columns) {
                column[from..from + core.len()].copy_from_slice(&part[..core.len()]);
            }
        });
        let mut left = columns.pop()?;
        project(&mut left, &orthonormal(&columns, rows), rows);
        let squares = dot(&left, &left);
        let of = |(signals, from): (&&Signals, &usize)| {
            let mut own = left[*from..from + signals.len()].to_vec();
            for segment in &signals.segments {
                signals.measure(&mut [&mut own[segment.clone()]]);
            }
            own
        };
        let residuals = data.iter().zip(&starts).map(of).collect();
        let speeds = speeds(data, &grid);
        Some(Self { data, grid, residuals, squares, speeds })
    }

    /// The detents that show best through a joint with about this stiffness, before so much inertia, kg m^2.
    pub fn shown(&self, joint: &Joint<f64>, inertia: f64) -> Option<Shown> {
        let times: [f64; WIDE] = std::array::from_fn(|lane| AROUND.powf(lane as f64 / WIDE as f64 - 0.5));
        let resonances = times.map(|times| Resonance::of(times * joint.stiffness, joint.damping, inertia));
        let mut cells = self.grid.empty();
        for (signals, residual) in self.data.iter().zip(&self.residuals) {
            for segment in &signals.segments {
                let theta = knob(signals, segment.clone(), joint, inertia);
                let back =
                    resonances.each_ref().map(|own| own.back(&residual[segment.clone()], signals.rate_hz));
                self.grid.spread(&theta, &back.each_ref().map(Vec::as_slice), &mut cells);
            }
        }
        let [re, im] = self.grid.spectra(&cells, self.grid.last);
        let count: f64 = self.speeds.iter().map(|(_, count, _)| count).sum();
        let lane = |lane: usize| {
            let mut scan = Scan { without: self.squares, ..Scan::default() };
            for (index, at) in (self.grid.first..=self.grid.last).enumerate() {
                let (k, own) = (self.grid.frequency(at), &resonances[lane]);
                let part = |(speed, count, passes): &(f64, f64, Vec<f64>)| {
                    count * passes[index] * own.power(k * speed)
                };
                let passed: f64 = self.speeds.iter().map(part).sum();
                let [re, im] = [&re, &im].map(|x| x[at * WIDE + lane]);
                // Counted from position zero.
                let turn = Complex64::from_polar(1.0, k * self.grid.first_cell);
                let along = Complex64::new(re, -im) * turn;
                let (gain, wave) = if passed > PASSES * count {
                    (2.0 * along.norm_sqr() / passed, [2.0 * along.im / passed, 2.0 * along.re / passed])
                } else {
                    (0.0, [0.0; 2])
                };
                scan.inverse_period.push(k);
                scan.gain.push(gain);
                scan.wave.push(wave);
            }
            let peak = scan.peaks().into_iter().next()?;
            Some(Shown { stiffness: times[lane], peak, background: scan.background() })
        };
        (0..WIDE).filter_map(lane).max_by(|a, b| a.peak.gain.total_cmp(&b.peak.gain))
    }
}

/// How many samples go how fast, and what of a wave of each frequency of a grid then passes the filter.
fn speeds(data: &[&Signals], grid: &Grid) -> Vec<(f64, f64, Vec<f64>)> {
    let mut told = Vec::new();
    for signals in data {
        let counted = signals.omega.iter().zip(&signals.weight).filter(|(_, w)| **w > 0.0);
        let speeds: Vec<f64> = counted.map(|(x, _)| x.abs()).collect();
        let most = speeds.iter().copied().fold(0.0, f64::max) * (1.0 + 1e-9);
        let mut counts = [0.0; SPEEDS];
        speeds.iter().for_each(|speed| counts[(speed / most * SPEEDS as f64) as usize] += 1.0);
        for (at, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0.0) {
            let speed = most * (at as f64 + 0.5) / SPEEDS as f64;
            let passes = |at: usize| {
                let hz = grid.frequency(at) * speed / TAU;
                let own = |filter: &ZeroPhase| filter.sos().power_gain(hz).powi(2);
                // What is too fast for the samples is told by none.
                if hz < 0.5 * signals.rate_hz { signals.filter.as_ref().map_or(1.0, own) } else { 0.0 }
            };
            told.push((speed, count, (grid.first..=grid.last).map(passes).collect()));
        }
    }
    told
}

/// Where the knob is: behind the shaft by what the torque winds the joint up by, after half of its play.
fn knob(signals: &Signals, segment: Range<usize>, joint: &Joint<f64>, inertia: f64) -> Vec<f64> {
    let shafts = (1.0 / joint.share - 1.0) * inertia;
    segment
        .map(|at| {
            let pushed = signals.tau[at] - shafts * signals.alpha[at];
            signals.theta[at] - pushed / joint.stiffness - 0.5 * joint.gap * pushed.signum()
        })
        .collect()
}

/// What a shaft that is held feels of a torque on the knob: (k + d s) / (m s^2 + d s + k).
struct Resonance {
    stiffness: f64,
    damping: f64,
    inertia: f64,
}

impl Resonance {
    fn of(stiffness: f64, damping: f64, inertia: f64) -> Self {
        Self { stiffness, damping: damping.max(2.0 * DAMPED * (stiffness * inertia).sqrt()), inertia }
    }

    /// The share of power that passes at an angular frequency, rad/s.
    fn power(&self, w: f64) -> f64 {
        let damped = (self.damping * w).powi(2);
        (self.stiffness.powi(2) + damped) / ((self.stiffness - self.inertia * w * w).powi(2) + damped)
    }

    /// A column that went through it backward in time (the bilinear transform).
    fn back(&self, column: &[f64], rate_hz: f64) -> Vec<f64> {
        let (k, d, m) =
            (self.stiffness, 2.0 * rate_hz * self.damping, 4.0 * rate_hz * rate_hz * self.inertia);
        let a0 = m + d + k;
        let (b, a) = ([(k + d) / a0, 2.0 * k / a0, (k - d) / a0], [2.0 * (k - m) / a0, (m - d + k) / a0]);
        let mut state = [0.0; 2];
        let mut out = vec![0.0; column.len()];
        for (y, x) in out.iter_mut().zip(column).rev() {
            *y = b[0] * x + state[0];
            state = [b[1] * x - a[0] * *y + state[1], b[2] * x - a[1] * *y];
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_backward_through_a_resonance_is_its_transpose() {
        let own = Resonance::of(0.3, 2e-3, 7e-5);
        let pulse = |at: usize| (0..4000).map(|i| f64::from(u8::from(i == at))).collect::<Vec<f64>>();
        let back = own.back(&pulse(3000), 1000.0);
        assert!(back[3001..].iter().all(|x| *x == 0.0));
        // What a constant asks for passes whole.
        assert!((back.iter().sum::<f64>() - own.power(0.0).sqrt()).abs() < 1e-3);
        let w: f64 = 100.0;
        let along: Complex64 =
            back.iter().enumerate().map(|(i, x)| x * Complex64::from_polar(1.0, w * i as f64 * 1e-3)).sum();
        assert!((along.norm_sqr() / own.power(w) - 1.0).abs() < 0.02);
    }
}
