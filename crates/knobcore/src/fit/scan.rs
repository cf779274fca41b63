//! The detent period, from the data alone: a scan over spatial frequency.
//!
//! The least-squares periodogram of Lomb (1976) over position instead of time, with the columns of the rest
//! of the model projected off. All products that it needs are Fourier transforms over position; samples are
//! spread over a grid of positions by a cubic spline (piecewise cubic; Hockney & Eastwood 1981), so that one FFT
//! per column serves every frequency.

use super::moments::evaluate;
use super::solve::{Normal, independent};
use crate::effects::Wave;
use crate::fourier::Transform;
use crate::isa;
use crate::model::Model;
use crate::order::{descending, nth};
use crate::param::Axis;
use crate::predict::Seeds;
use crate::scalar::{LANES, Pack, Scalar, WIDE, Wide};
use crate::signals::Signals;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A detent must turn by this many radians of its own phase within the capture to show at all.
pub const LEAST_PHASE: f64 = 3.5;
/// Most detents per turn that are looked for, and per range on a linear axis.
const MOST: f64 = 300.0;
/// Most cells of the grid of positions: half a million points to transform, whatever the range.
const MOST_CELLS: f64 = 65_536.0;
/// Cells per wave at twice the highest frequency, which the products need.
const CELLS: f64 = 4.0;
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
    pub(super) wave: Vec<[f64; 2]>,
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
        peaks.sort_by_cached_key(|peak| descending(peak.gain));
        peaks
    }

    /// Median gain over all frequencies: what a frequency without detent takes off.
    pub fn background(&self) -> f64 {
        nth(&mut self.gain.clone(), self.gain.len() / 2).unwrap_or(0.0)
    }
}

/// Lowest and highest position that counts.
fn extremes(data: &[&Signals]) -> (f64, f64) {
    let ends = |signals: &&Signals| isa::dispatch(Extremes(&signals.theta, &signals.weight));
    let wider = |(low, high): (f64, f64), (x, y): (f64, f64)| (low.min(x), high.max(y));
    data.iter().map(ends).fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}

/// Of positions with weights.
struct Extremes<'a>(&'a [f64], &'a [f64]);

impl pulp::NullaryFnOnce for Extremes<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn call(self) -> (f64, f64) {
        let (mut low, mut high) = (Pack::of(f64::INFINITY), Pack::of(f64::NEG_INFINITY));
        // Lanes beyond the end repeat the last sample.
        for at in (0..self.0.len()).step_by(LANES) {
            let (x, w) = (Pack::load(self.0, at), Pack::load(self.1, at));
            low = low.min(w.where_positive(x, Pack::of(f64::INFINITY)));
            high = high.max(w.where_positive(x, Pack::of(f64::NEG_INFINITY)));
        }
        (
            low.0.into_iter().fold(f64::INFINITY, f64::min),
            high.0.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

/// Range of positions that count.
pub fn range(data: &[&Signals]) -> f64 {
    let (low, high) = extremes(data);
    high - low
}

/// Lowest and highest spatial angular frequency that a scan looks at, 1/rad, and how many independent ones lie between them
/// (one cycle over the range apart); None where there is no motion.
pub fn band(data: &[&Signals]) -> Option<([f64; 2], f64)> {
    let grid = Grid::over(data)?;
    let between = (grid.last - grid.first) as f64 / OVERSAMPLING as f64;
    Some(([grid.frequency(grid.first), grid.frequency(grid.last)], between))
}

/// What samples leave in a cell of the grid, of a pack of columns.
// Vectors of eight that lie across two lines of the cache take several times as long to be written and read again.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Cell(Wide);

/// Grid of positions shared by all captures.
pub(super) struct Grid {
    /// The first cell, one before the lowest position.
    pub first_cell: f64,
    width: f64,
    cells: usize,
    transform: usize,
    /// Index of the first and the last frequency of the transform that is looked at.
    pub first: usize,
    pub last: usize,
}

impl Grid {
    pub fn over(data: &[&Signals]) -> Option<Self> {
        let (low, high) = extremes(data);
        let range = high - low;
        if !(range.is_finite() && range > 0.0) {
            return None;
        }
        let highest = match data.first()?.axis {
            Axis::Rotary => MOST.max(4.0 * TAU / range),
            Axis::Linear => MOST * TAU / range,
        };
        let cells = (highest * 2.0 * range / TAU * CELLS).ceil().clamp(32.0, MOST_CELLS) as usize;
        let width = range / cells as f64;
        let transform = (cells * OVERSAMPLING).next_power_of_two();
        let spacing = TAU / (transform as f64 * width);
        let first = (LEAST_PHASE / range / spacing).ceil() as usize;
        // Over very long ranges the cells run out before the frequencies do.
        let highest = highest.min(cells as f64 * TAU / (2.0 * CELLS * range));
        let last = ((highest / spacing) as usize).min(transform / 4 - 1);
        (first <= last).then_some(Self { first_cell: low - width, width, cells, transform, first, last })
    }

    /// Cells that nothing was spread over yet.
    pub fn empty(&self) -> Vec<Cell> {
        vec![Cell(Wide::of(0.0)); self.cells + 4]
    }

    pub fn frequency(&self, index: usize) -> f64 {
        TAU * index as f64 / (self.transform as f64 * self.width)
    }

    /// Spreads rows of up to a pack of columns over the four cells around each position.
    pub fn spread(&self, theta: &[f64], columns: &[&[f64]], cells: &mut [Cell]) {
        isa::dispatch_wide(Spread { grid: self, theta, columns, cells });
    }

    /// Sum over the samples of value * exp(-i k theta), up to a common phase, for every frequency k up to the `last` of a
    /// pack of columns, side by side: real and imaginary parts.
    pub fn spectra(&self, cells: &[Cell], last: usize) -> [Vec<f64>; 2] {
        let transform = Transform::of(self.transform);
        let mut rows = transform.rows(WIDE);
        for (at, cell) in cells.iter().enumerate() {
            cell.0.into_packs(&mut rows[at % 2], at / 2 * WIDE);
        }
        let mut spectra = transform.forward(WIDE, &mut rows, 0..last + 1);
        for index in 0..=last {
            // What the spreading takes off each frequency.
            let half = 0.5 * self.frequency(index) * self.width;
            let restore = if half > 0.0 { (half / half.sin()).powi(4) } else { 1.0 };
            for part in &mut spectra {
                part[index * WIDE..(index + 1) * WIDE].iter_mut().for_each(|value| *value *= restore);
            }
        }
        spectra
    }
}

/// Work of [`Grid::spread`].
struct Spread<'a> {
    grid: &'a Grid,
    theta: &'a [f64],
    columns: &'a [&'a [f64]],
    cells: &'a mut [Cell],
}

impl pulp::NullaryFnOnce for Spread<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { grid, theta, columns, cells } = self;
        let (per_cell, most) = (1.0 / grid.width, (grid.cells + 1) as f64);
        // Of a pack that is not full the last column fills the other lanes, which nobody reads.
        let columns: [&[f64]; WIDE] =
            std::array::from_fn(|lane| &columns[lane.min(columns.len() - 1)][..theta.len()]);
        for (row, x) in theta.iter().enumerate() {
            let at = ((x - grid.first_cell) * per_cell).clamp(1.0, most);
            let cell = at as usize;
            let Some(around) = cells.get_mut(cell - 1..cell + 3) else { continue };
            let mut values = Wide::of(0.0);
            for (value, column) in values.0.iter_mut().zip(&columns) {
                *value = column[row];
            }
            let beyond = at - cell as f64;
            let short = 1.0 - beyond;
            let (near, far) = (short * short * short / 6.0, beyond * beyond * beyond / 6.0);
            // The four pieces of the spline; they add up to one.
            let weights = [near, short + far - 2.0 * near, beyond + near - 2.0 * far, far];
            for (cell, weight) in around.iter_mut().zip(weights) {
                cell.0 = cell.0 + values * Wide::of(weight);
            }
        }
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
    let mut spread = vec![grid.empty(); (k + 2).div_ceil(WIDE)];
    let mut sum = super::moments::Moments::empty(k);
    evaluate(data, model, p, &seeds, |evaluated| {
        sum.add_columns(evaluated.columns);
        let core = evaluated.rows.clone();
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
        for (cells, few) in spread.iter_mut().zip(columns.chunks(WIDE)) {
            grid.spread(&evaluated.signals.theta[core.clone()], few, cells);
        }
    });
    let kept = independent(|i, j| sum.gram(i, j), &(0..k).collect::<Vec<_>>());
    let normal = Normal::of(|i, j| sum.gram(i, j), &kept)?;
    let solved = normal.solve(|i| sum.slope(kept[i]));
    let without = sum.squares() - kept.iter().zip(&solved).map(|(&i, c)| c * sum.slope(i)).sum::<f64>();
    let inverse = normal.inverse();
    // The count of samples is the last column; its products are those of twice the frequencies.
    let last = |pack: usize| if pack == (k + 1) / WIDE { 2 * grid.last } else { grid.last };
    let spectra: Vec<[Vec<f64>; 2]> =
        spread.iter().enumerate().map(|(pack, cells)| grid.spectra(cells, last(pack))).collect();
    let spectrum = |column: usize, at: usize| {
        let [re, im] = &spectra[column / WIDE];
        let at = at * WIDE + column % WIDE;
        Complex64::new(re[at], im[at])
    };
    // Gain, and the sine and cosine coefficient counted from position zero.
    let mut columns = vec![Complex64::default(); kept.len()];
    let detent = |at: usize| -> (f64, [f64; 2]) {
        // Cosine and sine products with the kept columns, the residual, and each other.
        columns.iter_mut().zip(&kept).for_each(|(column, &i)| *column = spectrum(i, at).conj());
        let residual =
            spectrum(k, at).conj() - columns.iter().zip(&solved).map(|(b, c)| b * c).sum::<Complex64>();
        let (total, double) = (spectrum(k + 1, 0).re, spectrum(k + 1, 2 * at).conj());
        let (mut cc, mut cs, mut ss) =
            (0.5 * (total + double.re), 0.5 * double.im, 0.5 * (total - double.re));
        for (i, a) in columns.iter().enumerate() {
            // The column times that of the inverse.
            let b = columns.iter().zip(inverse.column(i).iter()).map(|(b, g)| b * g).sum::<Complex64>();
            cc -= a.re * b.re;
            cs -= a.re * b.im;
            ss -= a.im * b.im;
        }
        let (c, s) = (residual.re, residual.im);
        let determinant = cc * ss - cs * cs;
        if determinant > 1e-6 * total * total * 0.25 {
            let (on_cos, on_sin) = ((ss * c - cs * s) / determinant, (cc * s - cs * c) / determinant);
            let (sin_low, cos_low) = (grid.frequency(at) * grid.first_cell).sin_cos();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::layout::Layout;
    use crate::fit::tests::{gain, turned};

    fn scanned(data: &Signals, wave: Wave) -> Scan {
        let model = Model::equation_1(Axis::Rotary, false);
        let linear = Layout::of(&model).linear();
        scan(&[data], &model, &model.values(), &linear, wave).unwrap().0
    }

    #[test]
    fn at_every_frequency_the_scan_is_the_fit_of_a_wave_there() {
        let data = turned(0.9, 1e-3, |theta, _| 0.02 * (theta / 0.11 + 0.4).sin());
        for wave in [Wave::Torque, Wave::Friction] {
            let scan = scanned(&data, wave);
            let most = scan.gain.iter().copied().fold(0.0, f64::max);
            for (at, k) in scan.inverse_period.iter().enumerate().step_by(23) {
                let exact = gain(&data, *k, wave == Wave::Friction);
                assert!(
                    (scan.gain[at] - exact).abs() < 2e-4 * most,
                    "{wave:?} {k}: {} {exact}",
                    scan.gain[at]
                );
            }
        }
    }

    #[test]
    fn the_highest_peak_is_the_detent_that_is_there() {
        let data = turned(0.9, 1e-4, |theta, _| 0.02 * (theta / 0.11 + 0.4).sin());
        let scan = scanned(&data, Wave::Torque);
        let peaks = scan.peaks();
        let best = peaks[0];
        assert!((best.period / 0.11 - 1.0).abs() < 1e-3, "{best:?}");
        assert!((best.amplitude / 0.02 - 1.0).abs() < 0.03 && (best.phase - 0.4).abs() < 0.15, "{best:?}");
        assert!(peaks.windows(2).all(|pair| pair[0].gain >= pair[1].gain));
        assert!(best.gain > 0.9 * scan.without && scan.background() < 0.05 * best.gain);
    }

    #[test]
    fn periods_from_half_the_motion_to_a_three_hundredth_of_a_turn_are_looked_at() {
        let data = turned(0.9, 1e-3, |_, _| 0.0);
        let scan = scanned(&data, Wave::Torque);
        let range = super::range(&[&data]);
        let (first, last) = (scan.inverse_period[0], scan.inverse_period[scan.inverse_period.len() - 1]);
        let step = scan.inverse_period[1] - first;
        assert!(LEAST_PHASE / range <= first && first < LEAST_PHASE / range + step);
        assert!(last <= MOST && MOST < last + step);
        // At least so fine that no peak, a cycle over the range wide, falls between two.
        assert!(step <= TAU / range / OVERSAMPLING as f64 * 1.001, "{step}");
    }

    #[test]
    fn a_knob_that_does_not_move_is_not_scanned() {
        let mut data = turned(0.9, 1e-3, |_, _| 0.0);
        data.theta.fill(0.3);
        assert!(Grid::over(&[&data]).is_none());
    }
}
