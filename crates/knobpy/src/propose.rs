//! Bindings of proposals.
use super::convert::array;
use super::model::PyModel;
use super::progress::Progress;
use super::signals::PySignals;
use super::user::watched;
use knobcore::propose::propose as propose_core;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A law as it goes out: formula, parameters, variables, gain, whether it explains as much as the best,
/// complexity.
type LawRow = (String, Vec<(String, f64)>, Vec<&'static str>, f64, bool, usize);

/// Laws for what a fitted model leaves, best first, the chance of the first where nothing is missing, and the curve of what
/// is left (a dict with the fields of `Curve`), if there is one. `progress` as of `diagnose`.
#[pyfunction]
#[pyo3(signature = (data, model, progress=None))]
pub fn propose<'py>(
    py: Python<'py>,
    data: Vec<PyRef<'py, PySignals>>,
    model: &PyModel,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<LawRow>, f64, Option<Bound<'py, PyDict>>)> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || propose_core(signals, model, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    let laws = found
        .laws
        .into_iter()
        .map(|law| (law.text, law.params, law.variables, law.gain, law.alike, law.complexity));
    let curve = found.curve.map(|curve| {
        let row = PyDict::new(py);
        row.set_item("over", curve.over)?;
        row.set_item("times", curve.times)?;
        for (name, column) in [("x", &curve.x), ("value", &curve.value), ("band", &curve.band)] {
            row.set_item(name, array(py, column))?;
        }
        row.set_item("laws", curve.laws.iter().map(|law| array(py, law)).collect::<Vec<_>>())?;
        Ok::<_, PyErr>(row)
    });
    Ok((laws.collect(), found.p_value, curve.transpose()?))
}
