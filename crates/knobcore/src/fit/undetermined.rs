//! What captures say nothing about, and why.

use super::moments::Moments;
use super::separable::Layout;
use super::solve::Normal;
use crate::model::{Model, Role};
use crate::param::Kind;
use crate::predict::{Columns, Seeds, raw};
use crate::signals::Signals;

/// A parameter that the capture does not determine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Undetermined {
    /// `effect.parameter`.
    pub name: String,
    /// Why, and what to record.
    pub why: String,
}

/// Why a parameter without influence is undetermined.
pub(super) const SILENT: &str = "nothing in this capture depends on it; record a motion that does, or fix it";

/// Linear parameters that the torque of no counted sample depends on. The filter smears a trace of them into
/// counted samples from others, which would let them be fitted, to anything.
pub(super) fn silent(data: &[&Signals], model: &Model) -> Vec<String> {
    let slots = model.slots();
    let linear: Vec<usize> = (0..slots.len())
        .filter(|&i| slots[i].role == Role::Free && model.kind(&slots[i]) == Kind::Linear)
        .collect();
    let seeds = Seeds::of(model, &linear);
    let mut heard = vec![false; linear.len()];
    let mut columns = Columns::default();
    for signals in data {
        for chunk in signals.chunks(model.remembers()) {
            raw(model, &model.values(), &seeds, signals, chunk.core.clone(), &mut columns);
            let weight = &signals.weight[chunk.core];
            for (heard, column) in heard.iter_mut().zip(columns.split().1) {
                *heard = *heard || column.iter().zip(weight).any(|(d, w)| d * w != 0.0);
            }
            if heard.iter().all(|heard| *heard) {
                return Vec::new();
            }
        }
    }
    linear.iter().zip(heard).filter(|(_, heard)| !heard).map(|(&i, _)| slots[i].name()).collect()
}

/// Says why a column is not determined: it is silent, or a combination of others.
pub(super) fn undetermined(
    model: &Model,
    layout: &Layout,
    at: &Moments,
    kept: &[usize],
    column: usize,
) -> Undetermined {
    let name = |column: usize| model.slots()[layout.free[column]].name();
    let length = at.gram(column, column);
    let why = if length > 0.0 {
        let along = Normal::of(|i, j| at.gram(i, j), kept)
            .map(|normal| normal.solve(|i| at.gram(kept[i], column)))
            .unwrap_or_default();
        let parts = kept.iter().zip(&along).filter(|(i, x)| (*x * *x) * at.gram(**i, **i) > 1e-4 * length);
        let others: Vec<String> = parts.map(|(&i, _)| name(i)).collect();
        format!(
            "this capture cannot tell it from {}; record a motion that does, or fix or tie one of them",
            others.join(", ")
        )
    } else {
        SILENT.into()
    };
    Undetermined { name: name(column), why }
}
