//! An effect at other values.
use super::convert::input_error;
use super::fit::PyFit;
use super::names::own_id;
use super::progress::Progress;
use super::signals::PySignals;
use super::watched::watched;
use knobcore::diagnose::elsewhere as elsewhere_core;
use pyo3::prelude::*;

/// A fit with one of its effects at values that can be its own, beside all others as they are; None where there are none.
/// `progress` as of all that takes long.
#[pyfunction]
#[pyo3(signature = (data, fit, effect, progress=None))]
pub fn elsewhere(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    fit: &PyFit,
    effect: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Option<PyFit>> {
    let id = own_id(&fit.0.model, effect).map_err(input_error)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (fit, signals) = (&fit.0, &signals[..]);
    let progress = Progress::of(progress);
    let work = || elsewhere_core(signals, fit, id, &|share| progress.tell(share));
    let found = watched(py, &fit.model, work)?;
    progress.raised()?;
    Ok(found.map(PyFit))
}
