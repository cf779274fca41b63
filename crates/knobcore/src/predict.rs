//! From the motion to the torque, and to its exact derivatives.

use crate::chain;
use crate::effects::law::Response;
use crate::model::{Model, Role};
use crate::signals::{Chunk, Signals};
use std::ops::Range;

/// Which parameters are differentiated by, and which column each derivative goes to.
#[derive(Debug, Clone, Default)]
pub struct Seeds {
    /// For each parameter of the model its column, if it has one; tied parameters share one.
    column: Vec<Option<usize>>,
    columns: usize,
}

impl Seeds {
    /// No derivatives.
    pub fn none(model: &Model) -> Self {
        Self { column: vec![None; model.slots().len()], columns: 0 }
    }

    /// One column for each of the given parameters (indices into [`Model::slots`]).
    pub fn of(model: &Model, params: &[usize]) -> Self {
        let column = (0..model.slots().len())
            .map(|i| {
                let own = if let Role::Tied(to) = model.slots()[i].role { to } else { i };
                params.iter().position(|p| *p == own)
            })
            .collect();
        Self { column, columns: params.len() }
    }

    /// Number of derivative columns.
    pub fn columns(&self) -> usize {
        self.columns
    }
}

/// Torque and derivatives over one chunk, column by column; column 0 is the torque.
#[derive(Debug, Default)]
pub struct Columns {
    data: Vec<Vec<f64>>,
}

impl Columns {
    /// The torque, and the derivative columns.
    pub fn split(&mut self) -> (&mut [f64], &mut [Vec<f64>]) {
        match self.data.split_first_mut() {
            Some((torque, derivatives)) => (torque, derivatives),
            None => (&mut [], &mut []),
        }
    }

    /// The torque and the derivative columns, to keep.
    pub fn into_all(self) -> Vec<Vec<f64>> {
        self.data
    }

    fn clear(&mut self, columns: usize, rows: usize) {
        self.data.resize_with(columns, Vec::new);
        for column in &mut self.data {
            column.clear();
            column.resize(rows, 0.0);
        }
    }
}

/// Model torque and derivatives over a chunk, through the measurement filter.
pub fn measured(
    model: &Model,
    p: &[f64],
    seeds: &Seeds,
    signals: &Signals,
    chunk: &Chunk,
    out: &mut Columns,
) {
    raw(model, p, seeds, signals, chunk.whole.clone(), out);
    let mut columns: Vec<&mut [f64]> = out.data.iter_mut().map(Vec::as_mut_slice).collect();
    signals.measure_over(&chunk.whole, &mut columns);
}

/// Model torque and derivatives over a range of samples, before any filter.
pub fn raw(
    model: &Model,
    p: &[f64],
    seeds: &Seeds,
    signals: &Signals,
    range: Range<usize>,
    out: &mut Columns,
) {
    out.clear(1 + seeds.columns, range.len());
    let (motion, follow) = (signals.motion_columns(range.clone()), signals.follow(range.start));
    let (torque, slopes) = out.split();
    let mut over = Response { motion, dt: 1.0 / signals.rate_hz, torque, slopes };
    let (p, columns) = model.in_run(&signals.run, p, &seeds.column);
    chain::along(model, &p, &columns, follow, &mut over);
}

/// Model torque with several sets of parameters over a chunk through the measurement filter, a column each.
pub fn several(model: &Model, sets: &[Vec<f64>], signals: &Signals, chunk: &Chunk, out: &mut Vec<Vec<f64>>) {
    out.resize_with(sets.len(), Vec::new);
    out.iter_mut().for_each(|column| column.resize(chunk.whole.len(), 0.0));
    let motion = signals.motion_columns(chunk.whole.clone());
    let sets: Vec<Vec<f64>> = sets.iter().map(|p| model.of_run(&signals.run, p).into_owned()).collect();
    let follow = signals.follow(chunk.whole.start);
    chain::several(model, &sets, follow, motion, 1.0 / signals.rate_hz, out);
    let mut columns: Vec<&mut [f64]> = out.iter_mut().map(Vec::as_mut_slice).collect();
    signals.measure_over(&chunk.whole, &mut columns);
}

/// Model torque at every sample of a capture through the measurement filter, N m; samples outside of
/// every segment are NaN.
pub fn torque(model: &Model, signals: &Signals) -> Vec<f64> {
    over_capture(model, signals, |chunk, columns| {
        measured(model, &model.values(), &Seeds::none(model), signals, chunk, columns);
    })
}

/// Model torque at every sample without filter, N m; see [`torque`].
pub fn torque_raw(model: &Model, signals: &Signals) -> Vec<f64> {
    over_capture(model, signals, |chunk, columns| {
        raw(model, &model.values(), &Seeds::none(model), signals, chunk.whole.clone(), columns);
    })
}

fn over_capture(model: &Model, signals: &Signals, mut fill: impl FnMut(&Chunk, &mut Columns)) -> Vec<f64> {
    let mut columns = Columns::default();
    let mut tau = vec![f64::NAN; signals.len()];
    for chunk in signals.chunks(model.remembers()) {
        fill(&chunk, &mut columns);
        if let Some(column) = columns.data.first() {
            for rows in signals.parts(&chunk.core) {
                tau[rows.clone()].copy_from_slice(&column[chunk.within(&rows)]);
            }
        }
    }
    tau
}
