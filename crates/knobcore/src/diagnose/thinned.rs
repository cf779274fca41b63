//! Columns over captures, thinned to what tells all that they hold.
//!
//! Behind the measurement filter a column has no more than the filter's bandwidth: every few samples tell all of it.

use crate::algebra::dot;
use crate::fit::{evaluate, residuals};
use crate::model::Model;
use crate::predict::Seeds;
use crate::signals::Signals;
use std::ops::Range;

/// Stretches that stand for a capture of more samples than are to be looked at.
const STRETCHES: usize = 12;

/// Which samples of captures are kept.
pub struct Thinned {
    /// For each capture which of its samples, ascending.
    rows: Vec<Vec<usize>>,
    /// For each capture the root of how many samples one stands for.
    scale: Vec<f64>,
}

impl Thinned {
    /// Of captures, from stretches of about `most` samples together.
    pub fn of(data: &[&Signals], most: usize) -> Self {
        let samples: usize =
            data.iter().flat_map(|signals| &signals.segments).map(ExactSizeIterator::len).sum();
        let share = (most as f64 / samples.max(1) as f64).min(1.0);
        let rows = |signals: &&Signals| -> Vec<usize> {
            let every = signals.spacing();
            let stretches = signals.segments.iter().flat_map(|segment| stretches(segment, share));
            stretches.flat_map(|stretch| stretch.step_by(every)).collect()
        };
        let scale = |signals: &&Signals| (signals.spacing() as f64).sqrt();
        Self { rows: data.iter().map(rows).collect(), scale: data.iter().map(scale).collect() }
    }

    /// How many are kept.
    pub fn rows(&self) -> usize {
        self.rows.iter().map(Vec::len).sum()
    }

    /// The kept ones of consecutive samples of a capture, the first of which is `from`.
    fn kept<'a>(&'a self, capture: usize, samples: &Range<usize>) -> impl Iterator<Item = usize> + 'a {
        let rows = &self.rows[capture];
        let [first, end] = [samples.start, samples.end].map(|at| rows.partition_point(|row| *row < at));
        let start = samples.start;
        rows[first..end].iter().map(move |row| row - start)
    }

    /// Derivative columns of a model by these parameters, and its residual, thinned; zero where a sample does not
    /// count. Then the sum of squares of the whole residual.
    pub fn columns(
        &self,
        data: &[&Signals],
        model: &Model,
        params: &[usize],
    ) -> (Vec<Vec<f64>>, Vec<f64>, f64) {
        let mut columns = vec![Vec::new(); params.len() + 1];
        let mut squares = 0.0;
        evaluate(data, model, &model.values(), &Seeds::of(model, params), |evaluated| {
            let scale = self.scale[evaluated.capture];
            for (column, part) in columns.iter_mut().zip(evaluated.columns) {
                let kept = self.kept(evaluated.capture, &evaluated.rows);
                column.extend(kept.map(|at| scale * part[at]));
            }
            squares += evaluated.columns.last().map_or(0.0, |residual| dot(residual, residual));
        });
        let residual = columns.pop().unwrap_or_default();
        (columns, residual, squares)
    }

    /// Of each of these sets of parameters the residual, thinned, and the sum of squares of all of it.
    pub fn residuals(&self, data: &[&Signals], model: &Model, sets: &[Vec<f64>]) -> Vec<(Vec<f64>, f64)> {
        let mut all = vec![(Vec::with_capacity(self.rows()), 0.0); sets.len()];
        residuals(data, model, sets, |evaluated| {
            let scale = self.scale[evaluated.capture];
            for ((residual, squares), part) in all.iter_mut().zip(evaluated.columns) {
                let kept = self.kept(evaluated.capture, &evaluated.rows);
                residual.extend(kept.map(|at| scale * part[at]));
                *squares += dot(part, part);
            }
        });
        all
    }

    /// A column over all samples of all segments, thinned.
    pub fn pick(&self, data: &[&Signals], column: &[f64]) -> Vec<f64> {
        let mut picked = Vec::new();
        let mut from = 0;
        for (capture, signals) in data.iter().enumerate() {
            for segment in &signals.segments {
                let part = &column[from..from + segment.len()];
                picked.extend(self.kept(capture, segment).map(|at| self.scale[capture] * part[at]));
                from += segment.len();
            }
        }
        picked
    }
}

/// Derivative columns of a model by these parameters over all samples of all segments.
pub fn whole(data: &[&Signals], model: &Model, params: &[usize]) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); params.len()];
    evaluate(data, model, &model.values(), &Seeds::of(model, params), |evaluated| {
        for (column, part) in columns.iter_mut().zip(evaluated.columns) {
            column.extend_from_slice(part);
        }
    });
    columns
}

/// Stretches of a segment that are this share of it, evenly.
fn stretches(segment: &Range<usize>, share: f64) -> impl Iterator<Item = Range<usize>> {
    let pieces = if share < 1.0 { STRETCHES } else { 1 };
    let piece = segment.len() as f64 / pieces as f64;
    let start = segment.start;
    (0..pieces).map(move |k| {
        let from = k as f64 * piece;
        start + from as usize..start + (from + share * piece) as usize
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_spread_over_a_segment() {
        assert!(stretches(&(5..10), 1.0).eq(std::iter::once(5..10)));
        let few: Vec<_> = stretches(&(1000..2200), 0.1).collect();
        assert_eq!((few.len(), few[0].clone(), few[11].clone()), (12, 1000..1010, 2100..2110));
    }
}
