//! Bindings of the measurement filter.
use numpy::{
    PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use super::convert::input_error;
use knobcore::error::Error;
use knobcore::filter::{Section, Sos, ZeroPhase, butter, cheby2};

/// Adds the functions of this file to the module.
pub(super) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(zero_phase, m)?)?;
    m.add_function(wrap_pyfunction!(cheby2_sos, m)?)?;
    m.add_function(wrap_pyfunction!(butter_sos, m)?)
}

/// Filter the last axis of `channels`, shape (n,) or (C, n), forward and backward by the sections
/// `sos`, shape (sections, 6). Returns a new array of the same shape.
#[pyfunction]
fn zero_phase<'py>(
    py: Python<'py>,
    channels: PyReadonlyArrayDyn<'py, f64>,
    sos: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let filter = ZeroPhase::new(sos_from_rows(&sos)?);
    let filtered = PyArrayDyn::zeros(py, channels.shape(), false);
    let length = channels.shape().last().copied().unwrap_or(0);
    if length == 0 {
        return Ok(filtered);
    }
    let mut target = filtered.readwrite();
    let (source, target) = (channels.as_slice()?, target.as_slice_mut()?);
    py.detach(|| {
        let source: Vec<_> = source.chunks(length).collect();
        let mut target: Vec<_> = target.chunks_mut(length).collect();
        filter.filter_into(&source, &mut target)
    })
    .map_err(input_error)?;
    Ok(filtered)
}

/// Sections, shape (sections, 6), of a Chebyshev type II low-pass.
#[pyfunction]
fn cheby2_sos(
    py: Python<'_>,
    order: usize,
    stopband_db: f64,
    edge_hz: f64,
    rate_hz: f64,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    rows_from_sos(py, &cheby2(order, stopband_db, edge_hz, rate_hz).map_err(input_error)?)
}

/// Sections, shape (sections, 6), of a Butterworth low-pass.
#[pyfunction]
fn butter_sos(
    py: Python<'_>,
    order: usize,
    cutoff_hz: f64,
    rate_hz: f64,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    rows_from_sos(py, &butter(order, cutoff_hz, rate_hz).map_err(input_error)?)
}

/// Rows `b0, b1, b2, a0, a1, a2`; the rate does not matter to filtering and is taken as 1 Hz.
fn sos_from_rows(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Sos> {
    if rows.shape()[1] != 6 {
        let why = format!("rows of {} values must be b0, b1, b2, a0, a1, a2", rows.shape()[1]);
        return Err(input_error(Error::invalid("sos", why)));
    }
    let rows = rows.as_array();
    let sections = rows.rows().into_iter().map(|row| {
        let a0 = row[3];
        Section { b: [row[0] / a0, row[1] / a0, row[2] / a0], a: [row[4] / a0, row[5] / a0] }
    });
    Sos::new(sections.collect(), 1.0).map_err(input_error)
}

fn rows_from_sos<'py>(py: Python<'py>, sos: &Sos) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = sos.sections().iter().map(|Section { b, a }| vec![b[0], b[1], b[2], 1.0, a[0], a[1]]);
    Ok(PyArray2::from_vec2(py, &rows.collect::<Vec<_>>())?)
}
