//! Axes cut into bins, and which sample falls into which.

use super::rest::Rest;
use crate::model::Model;
use crate::order::quantiles;
use crate::signals::Signals;
use std::f64::consts::TAU;

/// Bins of an axis, per direction where it has two.
const BINS: usize = 60;
/// Most bins over position, where detents ask for finer ones.
const MOST: usize = 600;
/// Bins within one detent.
const PER_DETENT: f64 = 16.0;
/// Bins over time: short enough to show a warm-up, long against everything else.
const OVER_TIME: usize = 30;
/// The finest history looks at this share of the range of motion.
const FINEST: f64 = 1e-4;

/// One axis: its bins, and which stretches of every capture fall into which.
pub struct Bins {
    pub axis: &'static str,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub direction: Vec<i8>,
    /// Samples that count in each bin.
    pub count: Vec<f64>,
    /// Of every capture, stretches of neighbouring samples that share a bin.
    pub(super) runs: Vec<Vec<Stretch>>,
}

/// Neighbouring samples from one to before another, that share a bin.
pub(super) struct Stretch {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) bin: usize,
}

/// Running totals of a value of every sample of captures. The sum over a stretch is then the difference of two of
/// them: captures stay in a bin for many samples, and many axes are summed over the same values.
pub struct Totals(Vec<Vec<f64>>);

impl Totals {
    /// Of the values of each capture.
    pub fn of(mut values: Vec<Vec<f64>>) -> Self {
        for column in &mut values {
            let mut total = 0.0;
            for value in column {
                total += *value;
                *value = total;
            }
        }
        Self(values)
    }
}

/// A coordinate of every sample, and the direction of motion that its bin belongs to.
struct Coordinate {
    axis: &'static str,
    values: Vec<Vec<f64>>,
    by_direction: bool,
}

impl Bins {
    /// Number of bins.
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Sum of the samples' values per bin.
    pub fn sums(&self, values: &Totals) -> Vec<f64> {
        let mut sums = vec![0.0; self.len()];
        for (runs, totals) in self.runs.iter().zip(&values.0) {
            for run in runs {
                let before = if run.from > 0 { totals[run.from - 1] } else { 0.0 };
                sums[run.bin] += totals[run.to - 1] - before;
            }
        }
        sums
    }

    /// Bins between `borders` (ascending), for each direction apart if the coordinate asks for it.
    fn new(data: &[&Signals], coordinate: &Coordinate, borders: &[f64]) -> Self {
        let cells = borders.len().saturating_sub(1);
        let directions: &[i8] = if coordinate.by_direction { &[1, -1] } else { &[0] };
        let stretches = |(signals, values): (&&Signals, &Vec<f64>)| {
            let mut runs: Vec<Stretch> = Vec::new();
            let mut cell = 0;
            for (at, value) in values.iter().enumerate() {
                if signals.weight[at] <= 0.0 || !value.is_finite() || cells == 0 {
                    continue;
                }
                // Most samples lie where the one before did.
                if !(borders[cell]..borders[cell + 1]).contains(value) {
                    let above = borders.partition_point(|border| *border <= *value);
                    cell = above.saturating_sub(1).min(cells - 1);
                }
                let side = usize::from(coordinate.by_direction && signals.omega[at] < 0.0);
                let bin = side * cells + cell;
                match runs.last_mut().filter(|run| run.to == at && run.bin == bin) {
                    Some(run) => run.to = at + 1,
                    None => runs.push(Stretch { from: at, to: at + 1, bin }),
                }
            }
            runs
        };
        let runs: Vec<Vec<Stretch>> = data.iter().zip(&coordinate.values).map(stretches).collect();
        let mut count = vec![0.0; directions.len() * cells];
        for run in runs.iter().flatten() {
            count[run.bin] += (run.to - run.from) as f64;
        }
        Self {
            axis: coordinate.axis,
            low: directions.iter().flat_map(|_| borders[..cells].iter().copied()).collect(),
            high: directions.iter().flat_map(|_| borders[borders.len() - cells..].iter().copied()).collect(),
            direction: directions.iter().flat_map(|d| vec![*d; cells]).collect(),
            count,
            runs,
        }
    }
}

/// Every axis but frequency.
pub fn all_axes(rest: &Rest<'_>, model: &Model) -> Vec<Bins> {
    let data = rest.data;
    let each = |of: &dyn Fn(&Signals) -> Vec<f64>| -> Vec<Vec<f64>> { data.iter().map(|s| of(s)).collect() };
    let plain = |axis, values| Coordinate { axis, values, by_direction: false };
    let position = Coordinate { axis: "position", values: each(&|s| s.theta.clone()), by_direction: true };
    let velocity = plain("velocity", each(&|s| s.omega.clone()));
    let acceleration = plain("acceleration", each(&|s| s.alpha.clone()));
    let time = plain("time", each(&|s| s.t.clone()));
    let load = plain("load", rest.torque.clone());
    let history = Coordinate { axis: "history", values: each(&since_reversal), by_direction: true };
    let (low, high) = range(data, &position);
    let detent = model.period().map_or(f64::INFINITY, |at| TAU * model.values()[at] / PER_DETENT);
    let fine = (((high - low) / detent).ceil() as usize).clamp(BINS, MOST);
    vec![
        Bins::new(data, &position, &even(low, high, fine)),
        Bins::new(data, &velocity, &equal_counts(data, &velocity)),
        Bins::new(data, &acceleration, &equal_counts(data, &acceleration)),
        Bins::new(data, &time, &even(0.0, range(data, &time).1, OVER_TIME)),
        Bins::new(data, &load, &equal_counts(data, &load)),
        Bins::new(data, &history, &logarithmic(FINEST * (high - low), high - low)),
    ]
}

/// Values of a coordinate at samples that count.
fn counted<'a>(data: &'a [&Signals], coordinate: &'a Coordinate) -> impl Iterator<Item = f64> + 'a {
    let capture = |(signals, values): (&'a &Signals, &'a Vec<f64>)| {
        signals.weight.iter().zip(values).filter(|(w, x)| **w > 0.0 && x.is_finite()).map(|(_, x)| *x)
    };
    data.iter().zip(&coordinate.values).flat_map(capture)
}

fn range(data: &[&Signals], coordinate: &Coordinate) -> (f64, f64) {
    counted(data, coordinate).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
}

fn even(low: f64, high: f64, cells: usize) -> Vec<f64> {
    (0..=cells).map(|i| low + (high - low) * i as f64 / cells as f64).collect()
}

/// Borders between which the samples fall in equal numbers; equal borders are joined.
fn equal_counts(data: &[&Signals], coordinate: &Coordinate) -> Vec<f64> {
    let mut borders = quantiles(counted(data, coordinate).collect(), BINS);
    borders.dedup();
    borders
}

fn logarithmic(first: f64, last: f64) -> Vec<f64> {
    let cells = BINS / 2;
    let ratio = (last / first).ln();
    let steps = (0..=cells).map(|i| first * (ratio * i as f64 / cells as f64).exp());
    std::iter::once(0.0).chain(steps).collect()
}

/// Distance travelled since the direction last changed, rad; NaN before the first change. A change counts
/// when the new sign of the velocity is certain to three standard deviations.
pub fn since_reversal(signals: &Signals) -> Vec<f64> {
    let mut direction = 0.0;
    let mut turned_at = f64::NAN;
    let mut extreme: Option<f64> = None;
    let mut distance = Vec::with_capacity(signals.len());
    for at in 0..signals.len() {
        let (theta, omega) = (signals.theta[at], signals.omega[at]);
        // The turning point is the farthest position reached, not where the new direction became certain.
        let farthest = extreme.map_or(theta, |e| if direction > 0.0 { theta.max(e) } else { theta.min(e) });
        extreme = Some(farthest);
        if omega.abs() > 3.0 * signals.omega_sd[at] && omega.signum() != direction && omega != 0.0 {
            if direction != 0.0 {
                turned_at = farthest;
            }
            direction = omega.signum();
            extreme = Some(theta);
        }
        distance.push((theta - turned_at).abs());
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_since_reversal_starts_again_at_every_turn() {
        let theta = vec![0.0, 1.0, 2.0, 3.0, 2.5, 1.0, 1.5, 4.0];
        let omega = vec![1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0];
        let n = theta.len();
        let signals = Signals { theta, omega, omega_sd: vec![0.0; n], t: vec![0.0; n], ..Signals::default() };
        let distance = since_reversal(&signals);
        assert!(distance[..4].iter().all(|d| d.is_nan()));
        assert_eq!(distance[4..], [0.5, 2.0, 0.5, 3.0]);
    }

    #[test]
    fn every_counted_sample_falls_into_one_bin() {
        let n = 1000;
        let theta: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.1).sin()).collect();
        let signals = Signals {
            t: vec![0.0; 1000],
            omega: theta.clone(),
            theta: theta.clone(),
            weight: (0..n).map(|i| f64::from(u8::from(i % 3 > 0))).collect(),
            ..Signals::default()
        };
        let coordinate = Coordinate { axis: "position", values: vec![theta], by_direction: true };
        let bins = Bins::new(&[&signals], &coordinate, &even(-1.0, 1.0, 10));
        assert_eq!(bins.len(), 20);
        assert_eq!(bins.count.iter().sum::<f64>(), signals.used() as f64);
        // It goes forward on the one side of zero and backward on the other.
        for bin in (0..bins.len()).filter(|bin| bins.count[*bin] > 0.0) {
            let middle = 0.5 * (bins.low[bin] + bins.high[bin]);
            assert_eq!(f64::from(bins.direction[bin]), middle.signum(), "bin {bin}");
        }
    }
}
