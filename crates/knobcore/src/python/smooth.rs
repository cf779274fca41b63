//! `smooth`: the motion from its sensors.
use super::convert::input_error;
use crate::smooth::{Noise, Sensors, noise_from_capture, smooth as smooth_motion};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Column<'py> = PyReadonlyArray1<'py, f64>;

/// Smooth theta, omega, alpha of a capture; a dict of arrays (SI) and of the noise found.
#[pyfunction]
#[pyo3(signature = (t, theta, omega=None, alpha=None))]
pub fn smooth<'py>(
    py: Python<'py>,
    t: Column<'py>,
    theta: Column<'py>,
    omega: Option<Column<'py>>,
    alpha: Option<Column<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let sensors = Sensors {
        t: t.as_slice()?,
        theta: theta.as_slice()?,
        omega: omega.as_ref().map(|column| column.as_slice()).transpose()?,
        alpha: alpha.as_ref().map(|column| column.as_slice()).transpose()?,
    };
    let motion =
        py.detach(|| smooth_motion(&sensors, &noise_from_capture(&sensors)?)).map_err(input_error)?;
    let result = PyDict::new(py);
    let columns = [
        ("theta", motion.theta),
        ("omega", motion.omega),
        ("alpha", motion.alpha),
        ("theta_sd", motion.theta_sd),
        ("omega_sd", motion.omega_sd),
        ("alpha_sd", motion.alpha_sd),
    ];
    for (name, column) in columns {
        result.set_item(name, PyArray1::from_vec(py, column))?;
    }
    result.set_item("noise", levels(py, &motion.noise)?)?;
    Ok(result)
}

fn levels<'py>(py: Python<'py>, noise: &Noise) -> PyResult<Bound<'py, PyDict>> {
    let levels = PyDict::new(py);
    for (name, level) in
        [("theta", noise.theta), ("omega", noise.omega), ("alpha", noise.alpha), ("jerk", noise.jerk)]
    {
        levels.set_item(name, level)?;
    }
    Ok(levels)
}
