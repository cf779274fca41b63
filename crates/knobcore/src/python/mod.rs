//! Bindings: convert, delegate, convert. Nothing is computed here.
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::Error;

mod filter;

#[pymodule]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    filter::register(m)?;
    Ok(())
}

/// A wrong call or input, as Python knows it.
fn value_error(error: Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}
