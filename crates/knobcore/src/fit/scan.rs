//! The detent period, from the data alone: a scan over spatial frequency.
//!
//! The least-squares periodogram of Lomb (1976) over position instead of time, with the columns of the rest
//! of the model projected off. All products that it needs are Fourier transforms over position; samples are
//! spread over a fine grid of positions (cloud in cell; Hockney & Eastwood 1981), so that one FFT per column
//! serves every frequency.

use super::moments::evaluate;
use super::solve::{Normal, independent};
use crate::effects::Wave;
use crate::fourier::Transform;
use crate::model::Model;
use crate::param::Axis;
use crate::predict::Seeds;
use crate::scalar::{LANES, Pack, Packed, Scalar};
use crate::signals::Signals;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// A detent must turn by this many radians of its own phase within the capture to show at all.
pub const LEAST_PHASE: f64 = 3.5;
/// Most detents per turn that are looked for, and per range on a linear axis.
const MOST: f64 = 300.0;
/// Most cells of the grid of positions: a million points to transform, whatever the range.
const MOST_CELLS: f64 = 131_072.0;
/// Frequencies per independent frequency (one cycle over the range).
const OVERSAMPLING: usize = 8;

/// The scan.
#[derive(Debug, Clone, Default)]
pub struct Scan {
    /// Spatial angular frequencies 1/P, 1/rad.
    pub inverse_period: Vec<f64>,
    /// How much a detent of that period takes off the sum of squares, (N m)^2.
    pub gain: Vec<f64>,
    /// Sum of squares without detent, (N m)^2.
    pub without: f64,
    /// The detent of each period: its sine and cosine coefficient, N m.
    wave: Vec<[f64; 2]>,
}

/// A local maximum of the scan: a detent to start a descent from.
#[derive(Debug, Clone, Copy)]
pub struct Peak {
    /// P, rad.
    pub period: f64,
    /// What it takes off the sum of squares, (N m)^2.
    pub gain: f64,
    /// A, N m.
    pub amplitude: f64,
    /// S, rad.
    pub phase: f64,
}

impl Scan {
    /// Local maxima, best first, each at the top of the parabola through its three points.
    pub fn peaks(&self) -> Vec<Peak> {
        let mut peaks: Vec<Peak> = Vec::new();
        let peak = |at: usize, inverse_period: f64| {
            let [sin, cos] = self.wave.get(at).copied().unwrap_or_default();
            let gain = self.gain.get(at).copied().unwrap_or(0.0);
            Peak { period: 1.0 / inverse_period, gain, amplitude: sin.hypot(cos), phase: cos.atan2(sin) }
        };
        for (at, (gains, k)) in self.gain.windows(3).zip(self.inverse_period.windows(3)).enumerate() {
            let &[before, top, after] = gains else { continue };
            if top > 0.0 && top >= before && top > after {
                let shift = 0.5 * (before - after) / (before - 2.0 * top + after);
                peaks.push(peak(at + 1, k[1] + shift * (k[2] - k[1])));
            }
        }
        if let (Some(first), Some(k)) = (self.gain.first(), self.inverse_period.first())
            && self.gain.get(1).is_none_or(|next| next < first)
        {
            peaks.push(peak(0, *k));
        }
        peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        peaks
    }

    /// Median gain over all frequencies: what a frequency without detent takes off.
    pub fn background(&self) -> f64 {
        let mut gains = self.gain.clone();
        gains.sort_by(f64::total_cmp);
        gains.get(gains.len() / 2).copied().unwrap_or(0.0)
    }
}

/// Lowest and highest position that counts.
fn extremes(data: &[&Signals]) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for signals in data {
        for (x, w) in signals.theta.iter().zip(&signals.weight) {
            if *w > 0.0 {
                (low, high) = (low.min(*x), high.max(*x));
            }
        }
    }
    (low, high)
}

/// Range of positions that count.
pub fn range(data: &[&Signals]) -> f64 {
    let (low, high) = extremes(data);
    high - low
}

/// Grid of positions shared by all captures.
struct Grid {
    low: f64,
    width: f64,
    cells: usize,
    transform: usize,
    /// Index of the first and the last frequency of the transform that is looked at.
    first: usize,
    last: usize,
}

impl Grid {
    fn over(data: &[&Signals]) -> Option<Self> {
        let (low, high) = extremes(data);
        let range = high - low;
        if !(range.is_finite() && range > 0.0) {
            return None;
        }
        let highest = match data.first()?.axis {
            Axis::Rotary => MOST.max(4.0 * TAU / range),
            Axis::Linear => MOST * TAU / range,
        };
        // Eight cells to the shortest period at twice the highest frequency, which the products need.
        let cells = (highest * 2.0 * range / TAU * 8.0).ceil().clamp(64.0, MOST_CELLS) as usize;
        let width = range / cells as f64;
        let transform = (cells * OVERSAMPLING).next_power_of_two();
        let spacing = TAU / (transform as f64 * width);
        let first = (LEAST_PHASE / range / spacing).ceil() as usize;
        // Over very long ranges the cells run out before the frequencies do.
        let highest = highest.min(cells as f64 * TAU / (16.0 * range));
        let last = ((highest / spacing) as usize).min(transform / 4 - 1);
        (first <= last).then_some(Self { low, width, cells, transform, first, last })
    }

    fn frequency(&self, index: usize) -> f64 {
        TAU * index as f64 / (self.transform as f64 * self.width)
    }

    /// Spreads a row of up to a pack of columns over the two cells around each position.
    fn spread(&self, theta: &[f64], columns: &[&[f64]], cells: &mut [Pack]) {
        let per_cell = 1.0 / self.width;
        for (row, x) in theta.iter().enumerate() {
            let at = ((x - self.low) * per_cell).clamp(0.0, self.cells as f64);
            let cell = at as usize;
            let mut values = [0.0; LANES];
            for (value, column) in values.iter_mut().zip(columns) {
                *value = column[row];
            }
            if let Some([here, next]) = cells.get_mut(cell..cell + 2) {
                let far = Packed(values) * Pack::of(at - cell as f64);
                *here = *here + (Packed(values) - far);
                *next = *next + far;
            }
        }
    }

    /// Sum over the samples of value * exp(-i k theta), up to a common phase, for every frequency k.
    fn spectra(&self, cells: &[Vec<Pack>], columns: usize) -> Vec<Vec<Complex64>> {
        let transform = Transform::of(self.transform);
        // What the spreading takes off each frequency.
        let spread = |index: usize| {
            let half = 0.5 * self.frequency(index) * self.width;
            if half > 0.0 { (half.sin() / half).powi(2) } else { 1.0 }
        };
        let restore: Vec<f64> = (0..=2 * self.last).map(|index| 1.0 / spread(index)).collect();
        let spectrum = |column: usize| {
            let column: Vec<f64> = cells[column / LANES].iter().map(|cell| cell.0[column % LANES]).collect();
            let mut out = transform.forward(&column);
            out.truncate(restore.len());
            out.iter_mut().zip(&restore).for_each(|(value, restore)| *value *= restore);
            out
        };
        (0..columns).map(spectrum).collect()
    }
}

/// Scans for a sinusoid over position beside the linear columns of `model` (which has no detent), evaluated
/// at `p`; the step in those columns that is best without detent comes with it. None where there is no motion.
pub fn scan(
    data: &[&Signals],
    model: &Model,
    p: &[f64],
    linear: &[usize],
    wave: Wave,
) -> Option<(Scan, Vec<f64>)> {
    let grid = Grid::over(data)?;
    let seeds = Seeds::of(model, linear);
    let k = linear.len();
    // The k columns, the residual, and the count of samples, packed.
    let mut spread = vec![vec![Pack::of(0.0); grid.cells + 2]; (k + 2).div_ceil(LANES)];
    let mut sum = super::moments::Moments::empty(k);
    evaluate(data, model, p, &seeds, |evaluated| {
        sum.add_columns(evaluated.columns);
        let core = evaluated.chunk.core.clone();
        let signed: Vec<Vec<f64>> = match wave {
            Wave::Torque | Wave::Orders => Vec::new(),
            // A product of two signed columns is that of the columns: only the products with the wave change.
            Wave::Friction => {
                let sign = |(x, forward): (&f64, &f64)| if *forward > 0.5 { *x } else { -x };
                let forward = &evaluated.signals.forward[core.clone()];
                evaluated
                    .columns
                    .iter()
                    .map(|column| column.iter().zip(forward).map(sign).collect())
                    .collect()
            }
        };
        let mut columns: Vec<&[f64]> = match wave {
            Wave::Torque | Wave::Orders => evaluated.columns.to_vec(),
            Wave::Friction => signed.iter().map(Vec::as_slice).collect(),
        };
        columns.push(&evaluated.signals.weight[core.clone()]);
        for (cells, few) in spread.iter_mut().zip(columns.chunks(LANES)) {
            grid.spread(&evaluated.signals.theta[core.clone()], few, cells);
        }
    });
    let kept = independent(|i, j| sum.gram(i, j), &(0..k).collect::<Vec<_>>());
    let normal = Normal::of(|i, j| sum.gram(i, j), &kept)?;
    let solved = normal.solve(|i| sum.slope(kept[i]));
    let without = sum.squares() - kept.iter().zip(&solved).map(|(&i, c)| c * sum.slope(i)).sum::<f64>();
    let inverse = normal.inverse();
    let spectra = grid.spectra(&spread, k + 2);
    let count = &spectra[k + 1];
    // Gain, and the sine and cosine coefficient counted from position zero.
    let detent = |at: usize| -> (f64, [f64; 2]) {
        // Cosine and sine products with the kept columns, the residual, and each other.
        let columns: Vec<Complex64> = kept.iter().map(|&i| spectra[i][at].conj()).collect();
        let residual =
            spectra[k][at].conj() - columns.iter().zip(&solved).map(|(b, c)| b * c).sum::<Complex64>();
        let (total, double) = (count[0].re, count[2 * at].conj());
        let (mut cc, mut cs, mut ss) =
            (0.5 * (total + double.re), 0.5 * double.im, 0.5 * (total - double.re));
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let g = inverse[(i, j)];
                cc -= a.re * g * b.re;
                cs -= a.re * g * b.im;
                ss -= a.im * g * b.im;
            }
        }
        let (c, s) = (residual.re, residual.im);
        let determinant = cc * ss - cs * cs;
        if determinant > 1e-6 * total * total * 0.25 {
            let (on_cos, on_sin) = ((ss * c - cs * s) / determinant, (cc * s - cs * c) / determinant);
            let (sin_low, cos_low) = (grid.frequency(at) * grid.low).sin_cos();
            let wave = [on_sin * cos_low + on_cos * sin_low, on_cos * cos_low - on_sin * sin_low];
            (on_cos * c + on_sin * s, wave)
        } else {
            (0.0, [0.0; 2])
        }
    };
    let indices = grid.first..=grid.last;
    let (gain, wave) = indices.clone().map(detent).unzip();
    let scan = Scan { inverse_period: indices.map(|i| grid.frequency(i)).collect(), gain, without, wave };
    let mut step = vec![0.0; k];
    kept.iter().zip(&solved).for_each(|(&i, value)| step[i] = *value);
    Some((scan, step))
}
