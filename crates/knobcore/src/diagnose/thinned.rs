//! Columns over captures, thinned to what tells all that they hold.
//!
//! Behind the measurement filter a column has no more than the filter's bandwidth: every few samples tell all of it.

use crate::algebra::dot;
use crate::fit::{evaluate, residuals};
use crate::model::Model;
use crate::predict::Seeds;
use crate::signals::Signals;
use std::ops::Range;

/// Which samples of captures are kept.
pub struct Thinned {
    /// For each capture which of its samples, ascending.
    rows: Vec<Vec<usize>>,
    /// For each capture the root of how many samples one stands for.
    scale: Vec<f64>,
}

impl Thinned {
    /// Of captures.
    pub fn of(data: &[&Signals]) -> Self {
        let rows = |signals: &&Signals| -> Vec<usize> {
            let every = signals.spacing();
            signals.segments.iter().flat_map(|segment| segment.clone().step_by(every)).collect()
        };
        let scale = |signals: &&Signals| (signals.spacing() as f64).sqrt();
        Self { rows: data.iter().map(rows).collect(), scale: data.iter().map(scale).collect() }
    }

    /// How many are kept.
    pub fn rows(&self) -> usize {
        self.rows.iter().map(Vec::len).sum()
    }

    /// The rows of each segment, with its capture.
    pub fn segments(&self, data: &[&Signals]) -> Vec<(usize, Range<usize>)> {
        let mut end = 0;
        let of_capture = |(capture, signals): (usize, &&Signals)| {
            let rows = |segment| {
                end += self.kept(capture, segment).count();
                (capture, end)
            };
            signals.segments.iter().map(rows).collect::<Vec<_>>()
        };
        let ends: Vec<(usize, usize)> = data.iter().enumerate().flat_map(of_capture).collect();
        let starts = std::iter::once(0).chain(ends.iter().map(|(_, end)| *end));
        ends.iter().zip(starts).map(|((capture, end), start)| (*capture, start..*end)).collect()
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
