//! What captures hint at.
use super::model::PyModel;
use super::names::ids;
use super::signals::PySignals;
use super::watched::watched;
use knobcore::diagnose::{Hint, hints as hints_core};
use knobcore::effects::Id;
use pyo3::prelude::*;

/// How much captures speak for effects beside a fitted model, to first order: rows of (kind, effect, value), the kind `lean`
/// with a sign, or `gain` without.
#[pyfunction]
pub fn hints(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    effects: Vec<String>,
) -> PyResult<Vec<(&'static str, &'static str, f64)>> {
    let ids = ids(&effects)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let row = |(id, hint): (Id, Hint)| match hint {
        Hint::Lean(value) => ("lean", id.info().id, value),
        Hint::Gain(value) => ("gain", id.info().id, value),
    };
    Ok(watched(py, model, || hints_core(signals, model, &ids))?.into_iter().map(row).collect())
}
