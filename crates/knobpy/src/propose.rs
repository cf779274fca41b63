//! Bindings of proposals.
use super::convert::array;
use super::model::PyModel;
use super::progress::Progress;
use super::signals::PySignals;
use super::watched::watched;
use knobcore::propose::{Law, Shapes, propose as propose_core, trace as trace_core};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A law as it goes out: formula, parameters, variables, gain, whether it explains as much as the best,
/// complexity, how many laws are added in it, how many of its parameters are free.
type LawRow = (String, Vec<(String, f64)>, Vec<&'static str>, f64, bool, usize, usize, usize);

/// Variables of a curve or a surface, what it leaves on blocks that it did not see, as a share, and the chance of that.
type NeedRow = (Vec<&'static str>, f64, f64);

/// Which variables what is left needs, what is left as a map, and the curve or surface that is a law with what it leaves.
type Left<'py> = (Vec<NeedRow>, Option<Bound<'py, PyDict>>, Option<(LawRow, f64)>);

/// Laws, the chance of the first, what is left as a curve, and without a formula.
type Answer<'py> = (Vec<LawRow>, f64, Option<Bound<'py, PyDict>>, Left<'py>);

fn row(law: Law) -> LawRow {
    let Law { text, params, variables, gain, alike, count, complexity, terms } = law;
    (text, params, variables, gain, alike, complexity, terms, count)
}

/// Laws for what a fitted model leaves, best first, the chance of the first where nothing is missing, the curve of what is
/// left (a dict with the fields of `Curve`), if there is one, and what is left without a formula: which variables curves and
/// surfaces need, what is left over the best pair of them (a dict with the fields of `Map`), and the curve or surface that
/// explains more than every formula with what it leaves on blocks that it did not see, as a share, if one does. `sums` is
/// whether two laws at once may be proposed; `progress` as of `diagnose`.
#[pyfunction]
#[pyo3(signature = (data, model, sums, progress=None))]
pub fn propose<'py>(
    py: Python<'py>,
    data: Vec<PyRef<'py, PySignals>>,
    model: &PyModel,
    sums: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer<'py>> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || propose_core(signals, model, sums, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    let laws = found.laws.into_iter().map(row);
    let curve = found.curve.map(|curve| {
        let told = PyDict::new(py);
        told.set_item("over", curve.over)?;
        told.set_item("times", curve.times)?;
        for (name, column) in [("x", &curve.x), ("value", &curve.value), ("band", &curve.band)] {
            told.set_item(name, array(py, column))?;
        }
        told.set_item("laws", curve.laws.iter().map(|law| array(py, law)).collect::<Vec<_>>())?;
        Ok::<_, PyErr>(told)
    });
    Ok((laws.collect(), found.p_value, curve.transpose()?, left(py, found.shapes)?))
}

/// Of the law that a scan sees most of in what a fitted model leaves: its variables, what it takes off the sum of squares at
/// least, in variances of the raw noise, and the chance of that where nothing is missing; `progress` as of `diagnose`.
#[pyfunction]
#[pyo3(signature = (data, model, progress=None))]
pub fn trace(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<&'static str>, f64, f64)> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || trace_core(signals, model, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    Ok((found.variables, found.gain, found.p_value))
}

fn left(py: Python<'_>, found: Shapes) -> PyResult<Left<'_>> {
    let needs = found.needs.into_iter().map(|need| (need.variables, need.heldout, need.p_value)).collect();
    let written = found.written.map(|written| (row(written.law), written.heldout));
    let map = found.map.map(|map| {
        let told = PyDict::new(py);
        told.set_item("over", map.over)?;
        told.set_item("times", map.times)?;
        let [x, y] = &map.places;
        for (name, column) in [("x", x), ("y", y), ("value", &map.value), ("band", &map.band)] {
            told.set_item(name, array(py, column))?;
        }
        Ok::<_, PyErr>(told)
    });
    Ok((needs, map.transpose()?, written))
}
