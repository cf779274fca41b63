//! Work during which laws that are functions in Python may fail, or be interrupted.
use super::convert::input_error;
use knobcore::model::Model;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// What ended a law and is no failure of it, such as Ctrl-C; it is raised when the work is over.
static INTERRUPT: Mutex<Option<PyErr>> = Mutex::new(None);

/// Keeps what ended a law, or nothing, for the work that it was part of; answers what was kept.
pub fn interrupt(error: Option<PyErr>) -> Option<PyErr> {
    std::mem::replace(&mut *INTERRUPT.lock().unwrap_or_else(PoisonError::into_inner), error)
}

/// Does work that evaluates a model, while Python may do other things; an effect of the model that fails in it is
/// raised, and so is what ended any law and is no failure of it.
pub fn watched<R: Send>(py: Python<'_>, model: &Model, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    interrupt(None);
    let done = py.detach(|| model.watched(work));
    interrupt(None).map_or_else(|| done.map_err(input_error), Err)
}
