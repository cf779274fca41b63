//! Between NumPy and the core.
use knobcore::error::Error;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A column as it comes in: float64, contiguous.
pub type Column<'py> = PyReadonlyArray1<'py, f64>;

/// A column as it goes out.
pub type Floats<'py> = Bound<'py, PyArray1<f64>>;

/// A wrong call or input, as Python knows it: `knobcam.errors.InputError`, a `ValueError`.
pub fn input_error(error: Error) -> PyErr {
    let message = error.to_string();
    Python::attach(|py| {
        let class = py.import("knobcam.errors").and_then(|module| module.getattr("InputError"));
        match class.and_then(|class| class.call1((message.clone(),))) {
            Ok(error) => PyErr::from_value(error),
            Err(_) => PyValueError::new_err(message),
        }
    })
}

/// A number as it comes in, by its name; NaN is one.
pub fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    value.extract().map_err(|_| no_number(name, value))
}

#[cold] // a render loop asks for numbers 5000 times a second, and gets them
fn no_number(name: &str, value: &Bound<'_, PyAny>) -> PyErr {
    let kind = value.get_type().name().map_or_else(|_| "value".to_owned(), |name| name.to_string());
    let why = format!("is a {kind} and no number that a float holds; give one in SI");
    input_error(Error::invalid(name, why))
}

/// A copy that Python owns.
pub fn array<'py>(py: Python<'py>, column: &[f64]) -> Floats<'py> {
    PyArray1::from_slice(py, column)
}

/// A small matrix as it goes out.
pub fn matrix<'py>(py: Python<'py>, m: &nalgebra::DMatrix<f64>) -> Bound<'py, PyArray2<f64>> {
    PyArray2::from_owned_array(
        py,
        numpy::ndarray::Array2::from_shape_fn((m.nrows(), m.ncols()), |(i, j)| m[(i, j)]),
    )
}
