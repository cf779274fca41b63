//! Long work that Python follows, and may end.
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Whom to tell, and what ended the work.
pub struct Progress {
    told: Option<Py<PyAny>>,
    raised: Mutex<Option<PyErr>>,
}

impl Progress {
    /// `told` is called with the share that is done, 0 to 1; None tells nobody, and Ctrl-C still ends the work.
    pub fn of(told: Option<Py<PyAny>>) -> Self {
        Self { told, raised: Mutex::new(None) }
    }

    /// Tells from any thread; whether the work is still wanted.
    pub fn tell(&self, share: f64) -> bool {
        let answer = Python::attach(|py| {
            py.check_signals()?;
            self.told.as_ref().map_or(Ok(()), |told| told.call1(py, (share,)).map(drop))
        });
        let Err(error) = answer else { return true };
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        false
    }

    /// What ended the work, if anything did.
    pub fn raised(self) -> PyResult<()> {
        let raised = self.raised.into_inner().unwrap_or_else(PoisonError::into_inner);
        raised.map_or(Ok(()), Err)
    }

    /// What the work found, or what ended it.
    pub fn ended<T>(self, found: Option<T>) -> PyResult<T> {
        found.map_or_else(
            || {
                self.raised()?;
                Err(pyo3::exceptions::PyRuntimeError::new_err("the work was ended"))
            },
            Ok,
        )
    }
}
