//! What a model gets wrong comes back wherever the motion is the same: samples at one position, velocity or
//! acceleration err together, however far apart they were recorded.
//!
//! Captures are cut into parts along each of these axes, and a fit is made without each part in turn. How far the
//! parameters go from part to part is their variance, whatever the correlation within a part (the delete-one
//! jackknife over clusters: Bell & McCaffrey 2002, CR3; Cameron, Gelbach & Miller 2011 for several ways to cluster).
//! Errors that last, but come back nowhere, do so too: what they do is seen with the same parts at another time of the
//! same capture, and taken off. A refit costs a small solve: a part enters the normal equations by its products alone.

use super::moments::{Evaluated, Moments};
use super::solve::least_squares;
use crate::random::Noise;
use crate::signals::Signals;

/// Parts along each axis: enough to tell how much they vary, and each of many samples.
const PARTS: usize = 20;
/// Axes: position, velocity, acceleration.
const AXES: usize = 3;
/// Parts in place, and twice elsewhere.
const PLACES: usize = 3;
/// Samples that parts are moved by together, by an amount of their own, so that they meet other phases of a motion that
/// is periodic.
const TOGETHER: usize = 1024;
/// Samples that go into one part together: short beside what any part is wide.
const PIECE: usize = 32;
/// Samples of each capture that show where quantiles are.
const LOOKED_AT: usize = 4000;

/// Normal equations of the parts along every axis, in place and moved.
pub struct Parts {
    k: usize,
    edges: [Vec<f64>; AXES],
    parts: [[Vec<Moments>; PLACES]; AXES],
}

impl Parts {
    /// Of nothing yet, for `k` columns.
    pub fn of(data: &[&Signals], k: usize) -> Self {
        let edges = std::array::from_fn(|axis| {
            let mut seen: Vec<f64> = Vec::new();
            for signals in data {
                let every = signals.len().div_ceil(LOOKED_AT).max(1);
                let used = (0..signals.len()).step_by(every).filter(|&at| signals.weight[at] > 0.0);
                seen.extend(used.map(|at| place(signals, at)[axis]));
            }
            seen.sort_by(f64::total_cmp);
            (1..PARTS).filter_map(|part| seen.get(part * seen.len() / PARTS).copied()).collect()
        });
        let empty = |_| std::array::from_fn(|_| vec![Moments::empty(k); PARTS]);
        Self { k, edges, parts: std::array::from_fn(empty) }
    }

    /// Takes one chunk of a pass.
    pub fn add(&mut self, evaluated: &Evaluated<'_>) {
        let (signals, core) = (evaluated.signals, &evaluated.rows);
        for from in core.clone().step_by(PIECE) {
            let to = (from + PIECE).min(core.end);
            let views: Vec<&[f64]> =
                evaluated.columns.iter().map(|column| &column[from - core.start..to - core.start]).collect();
            let mut piece = Moments::empty(self.k);
            piece.add_columns(&views);
            piece.rows = signals.weight[from..to].iter().sum();
            for elsewhere in 0..PLACES {
                let later = if elsewhere == 0 {
                    0
                } else {
                    later(from / TOGETHER * PLACES + elsewhere, signals.len())
                };
                let at = place(signals, (usize::midpoint(from, to) + later) % signals.len());
                for ((parts, edges), at) in self.parts.iter_mut().zip(&self.edges).zip(at) {
                    parts[elsewhere][edges.partition_point(|edge| *edge < at)].add(&piece);
                }
            }
        }
    }

    /// Variance of each column's parameter by errors that come back along the axes.
    pub fn variances(&self, kept: &[usize]) -> Vec<f64> {
        let mut sum = vec![0.0; self.k];
        for axis in &self.parts {
            let [place, elsewhere @ ..] = axis.each_ref().map(|parts| jackknife(parts, self.k, kept));
            for (column, sum) in sum.iter_mut().enumerate() {
                let lasting: f64 = elsewhere.iter().map(|all| all[column]).sum();
                *sum += (place[column] - lasting / elsewhere.len() as f64).max(0.0);
            }
        }
        sum
    }
}

/// Variance of the fits without one part each, for every column.
fn jackknife(parts: &[Moments], k: usize, kept: &[usize]) -> Vec<f64> {
    let all = Moments::of_all(k, parts);
    let without = |part: &Moments| {
        let mut others = all.clone();
        others.add_scaled(part, -1.0);
        least_squares(&others, kept)
    };
    let steps: Vec<Vec<f64>> = parts.iter().filter(|part| part.rows > 0.0).filter_map(without).collect();
    let n = steps.len().max(1) as f64;
    let variance = |column: usize| {
        let mean = steps.iter().map(|step| step[column]).sum::<f64>() / n;
        steps.iter().map(|step| (step[column] - mean).powi(2)).sum::<f64>() * (n - 1.0) / n
    };
    (0..k).map(variance).collect()
}

/// Some number of samples below `n`, another one for each seed.
fn later(seed: usize, n: usize) -> usize {
    (Noise::new(seed as u64).bits() >> 16) as usize % n
}

/// Where a sample is along every axis.
fn place(signals: &Signals, at: usize) -> [f64; AXES] {
    [signals.theta[at], signals.omega[at], signals.alpha[at]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How uncertain a level is that is fitted to samples which go over a turn ten times, with errors of position and
    /// of time, both in turns.
    fn level(error: impl Fn(f64, f64) -> f64) -> f64 {
        let n = 16_000;
        let mut noise = Noise::new(5);
        let turns: Vec<f64> = (0..n).map(|i| i as f64 / 1600.0).collect();
        let theta: Vec<f64> = turns.iter().map(|x| x.fract()).collect();
        let column: Vec<f64> = turns.iter().map(|x| error(x.fract(), *x) + 0.1 * noise.normal()).collect();
        let mean = column.iter().sum::<f64>() / n as f64;
        let rest: Vec<f64> = column.iter().map(|x| x - mean).collect();
        let signals = Signals {
            omega: vec![1.0; n],
            alpha: vec![0.0; n],
            weight: vec![1.0; n],
            t: turns,
            theta,
            ..Signals::default()
        };
        let mut parts = Parts::of(&[&signals], 1);
        let ones = vec![1.0; n];
        let columns = [&ones[..], &rest[..]];
        parts.add(&Evaluated { capture: 0, signals: &signals, rows: 0..n, columns: &columns });
        parts.variances(&[0])[0].sqrt()
    }

    #[test]
    fn an_error_that_comes_back_with_the_position_is_not_averaged_away_by_passing_again() {
        let sine = |turns: f64| (std::f64::consts::TAU * turns).sin();
        let noise = level(|_, _| 0.0);
        assert!(noise < 2e-3, "{noise}");
        // A wave over position of amplitude 1: the mean of 20 parts of a turn has the error 0.7 / sqrt(20).
        let wave = level(|x, _| sine(x));
        assert!(wave > 0.12 && wave < 0.25, "{wave}");
        // A rhythm of its own comes back at other positions each time.
        let rhythm = level(|_, t| sine(7.3 * t));
        assert!(rhythm < 0.03, "{rhythm}");
    }

    #[test]
    fn without_one_part_each_the_variance_of_a_mean_is_that_of_the_textbook() {
        let values = [0.3, -1.0, 2.5, 0.9, -0.2];
        let parts: Vec<Moments> = values
            .iter()
            .map(|value| {
                let mut part = Moments::empty(1);
                part.add_columns(&[&[1.0], &[*value]]);
                part.rows = 1.0;
                part
            })
            .collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let expected = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
        let found = jackknife(&parts, 1, &[0])[0];
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}
