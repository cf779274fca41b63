//! From the motion to the torque, and to its exact derivatives.

use crate::model::{Model, Role};
use crate::scalar::{Dual, LANES, Pack};
use crate::signals::{Chunk, Signals, lift};
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

    fn shape(&mut self, columns: usize, rows: usize) {
        self.data.resize_with(columns, Vec::new);
        for column in &mut self.data {
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
    signals.measure(&mut columns);
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
    out.shape(1 + seeds.columns, range.len());
    let arch = pulp::Arch::new();
    let mut first = 0;
    loop {
        let lanes = (seeds.columns - first).min(8);
        let pass = Pass { model, p, seeds, signals, range: range.clone(), first };
        match lanes {
            0 => arch.dispatch(|| pass.run::<0>(out)),
            1 => arch.dispatch(|| pass.run::<1>(out)),
            2 => arch.dispatch(|| pass.run::<2>(out)),
            3 | 4 => arch.dispatch(|| pass.run::<4>(out)),
            _ => arch.dispatch(|| pass.run::<8>(out)),
        }
        first += lanes;
        if first >= seeds.columns {
            return;
        }
    }
}

/// One sweep over the samples with up to `L` derivatives, from column `first` on.
struct Pass<'a> {
    model: &'a Model,
    p: &'a [f64],
    seeds: &'a Seeds,
    signals: &'a Signals,
    range: Range<usize>,
    first: usize,
}

impl Pass<'_> {
    #[inline(always)]
    fn run<const L: usize>(&self, out: &mut Columns) {
        let p: Vec<Dual<Pack, L>> = self
            .p
            .iter()
            .zip(&self.seeds.column)
            .map(|(value, column)| Dual::seeded(*value, column.and_then(|c| c.checked_sub(self.first))))
            .collect();
        let Some((torque, derivatives)) = out.data.split_first_mut() else { return };
        let derivatives = derivatives.get_mut(self.first..).unwrap_or_default();
        for at in (0..self.range.len()).step_by(LANES) {
            let motion = lift::<Pack, L>(self.signals.motion_pack(self.range.start + at));
            let tau = self.model.torque(&p, &motion);
            tau.v.store(torque, at);
            for (column, d) in derivatives.iter_mut().zip(tau.d) {
                d.store(column, at);
            }
        }
    }
}

/// Model torque at every sample of a capture through the measurement filter, N m; samples outside of
/// every segment are NaN.
pub fn torque(model: &Model, signals: &Signals) -> Vec<f64> {
    over_capture(signals, |chunk, columns| {
        measured(model, &model.values(), &Seeds::none(model), signals, chunk, columns);
    })
}

/// Model torque at every sample without filter, N m; see [`torque`].
pub fn torque_raw(model: &Model, signals: &Signals) -> Vec<f64> {
    over_capture(signals, |chunk, columns| {
        raw(model, &model.values(), &Seeds::none(model), signals, chunk.whole.clone(), columns);
    })
}

fn over_capture(signals: &Signals, mut fill: impl FnMut(&Chunk, &mut Columns)) -> Vec<f64> {
    let mut columns = Columns::default();
    let mut tau = vec![f64::NAN; signals.len()];
    for chunk in signals.chunks() {
        fill(&chunk, &mut columns);
        if let Some(column) = columns.data.first() {
            tau[chunk.core.clone()].copy_from_slice(&column[chunk.inner()]);
        }
    }
    tau
}
