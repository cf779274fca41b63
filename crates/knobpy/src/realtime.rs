//! Bindings of the render loop, and Python objects that take part in it.
use super::convert::{Floats, array, input_error};
use super::handle::PyEmulatedHandle;
use super::render::PyRenderer;
use knobcore::error::{Error, Result};
use knobrender::{Renderer, Sensed};
use knobrig::realtime::{
    Controller, Histogram, Plan, Plant, Realtime, Row, Running, Standing, SystemClock, Tally, Ticks,
    VirtualClock, real_time_priority, start,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Duration;

const NS: f64 = 1e-9;
/// Rates that are closer than this share are the same.
const SAME_RATE: f64 = 1e-6;

/// A Python object with `read() -> (theta, omega, alpha, hand or None)` and `write(tau)`. Each call takes the GIL,
/// and waits for it while other Python code holds it.
struct PyDevice {
    read: Py<PyAny>,
    write: Py<PyAny>,
}

impl Plant for PyDevice {
    fn read(&mut self) -> Result<Sensed> {
        attached("device.read", |py| {
            let (theta, omega, alpha, hand) = self.read.bind(py).call0()?.extract()?;
            Ok(Sensed { theta, omega, alpha, hand })
        })
    }

    fn write(&mut self, tau: f64) -> Result<()> {
        attached("device.write", |py| self.write.bind(py).call1((tau,)).map(drop))
    }
}

/// A Python object with `step(theta, omega, alpha, hand or None) -> tau`; what it raises is its fault.
struct PyController {
    step: Py<PyAny>,
    fault: Option<Error>,
}

impl Controller for PyController {
    fn step(&mut self, sensed: Sensed) -> f64 {
        let state = (sensed.theta, sensed.omega, sensed.alpha, sensed.hand);
        let answer = attached("controller.step", |py| self.step.bind(py).call1(state)?.extract());
        answer.unwrap_or_else(|error| {
            self.fault = Some(error);
            0.0
        })
    }

    fn fault(&self) -> Option<Error> {
        self.fault.clone()
    }
}

/// Calls into Python from the thread of the loop; what is raised becomes an error of `name`.
fn attached<R>(name: &str, call: impl FnOnce(Python<'_>) -> PyResult<R>) -> Result<R> {
    let done = Python::try_attach(|py| call(py).map_err(|error| Error::invalid(name, error.to_string())));
    done.unwrap_or_else(|| Err(Error::invalid(name, "Python is ending")))
}

/// A renderer as it is, without Python; one with effects of a user's own calls them, and what fails is its fault.
struct Rendering {
    renderer: Renderer,
    failed: Option<Error>,
}

impl Controller for Rendering {
    fn step(&mut self, sensed: Sensed) -> f64 {
        if !self.renderer.calls_out() {
            return self.renderer.step(sensed);
        }
        let model = self.renderer.model().clone();
        model.watched(|| self.renderer.step(sensed)).unwrap_or_else(|error| {
            self.failed = Some(error);
            0.0
        })
    }

    fn fault(&self) -> Option<Error> {
        self.failed.clone().or_else(|| Controller::fault(&self.renderer))
    }

    fn missed(&mut self, periods: u64) {
        self.renderer.missed(periods);
    }
}

/// A handle of the core, or whatever Python object can be read and written.
fn device(object: &Bound<'_, PyAny>, plan: &Plan, ticks: Option<&Ticks>) -> PyResult<Box<dyn Plant + Send>> {
    if let Ok(handle) = object.cast::<PyEmulatedHandle>() {
        let handle = handle.borrow();
        return Ok(match ticks {
            Some(ticks) => Box::new(handle.held(plan.period(), VirtualClock::new(ticks.clone()))),
            None => Box::new(handle.held(plan.period(), SystemClock::default())),
        });
    }
    let (read, write) = (object.getattr("read")?.unbind(), object.getattr("write")?.unbind());
    Ok(Box::new(PyDevice { read, write }))
}

/// A copy of a renderer, as it is now, unless its step is a user's own; or whatever Python object can step.
fn controller(object: &Bound<'_, PyAny>, plan: &Plan) -> PyResult<Box<dyn Controller + Send>> {
    if let Ok(knob) = object.cast::<PyRenderer>()
        && object.get_type().getattr("step")?.is(&object.py().get_type::<PyRenderer>().getattr("step")?)
    {
        let renderer = knob.borrow().renderer.clone();
        let rate = renderer.rate_hz();
        if (rate / plan.rate_hz - 1.0).abs() > SAME_RATE {
            let why = format!(
                "renders at {rate} Hz and the loop runs at {} Hz; give both the same rate",
                plan.rate_hz
            );
            return Err(input_error(Error::invalid("controller", why)));
        }
        return Ok(Box::new(Rendering { renderer, failed: None }));
    }
    Ok(Box::new(PyController { step: object.getattr("step")?.unbind(), fault: None }))
}

/// A loop that was started.
#[pyclass(frozen, name = "Loop", module = "knobcam._core")]
pub struct PyLoop(Running);

/// Starts a loop on a thread of its own. In virtual time nothing is waited for, and no priority is asked for.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn start_loop(
    py: Python<'_>,
    controller_object: &Bound<'_, PyAny>,
    device_object: &Bound<'_, PyAny>,
    rate_hz: f64,
    seconds: Option<f64>,
    rt: &str,
    virtual_time: bool,
    watchdog_s: f64,
    missed_share: f64,
    missed_run: Option<u64>,
) -> PyResult<PyLoop> {
    let plan = Plan { rate_hz, seconds, watchdog_s, missed_share, missed_run };
    let plan = plan.checked().map_err(input_error)?;
    let ticks = Ticks::default();
    let controller = controller(controller_object, &plan)?;
    let device = device(device_object, &plan, virtual_time.then_some(&ticks))?;
    let rt = Realtime::parse(rt).map_err(input_error)?;
    let running = py.detach(|| {
        if virtual_time {
            let clock = VirtualClock::new(ticks);
            start(plan, Realtime::Off, real_time_priority, controller, device, clock)
        } else {
            start(plan, rt, real_time_priority, controller, device, SystemClock::default())
        }
    });
    Ok(PyLoop(running.map_err(input_error)?))
}

#[pymethods]
impl PyLoop {
    /// Why the loop has no real-time priority; None where it has it.
    #[getter]
    fn why_not_realtime(&self) -> Option<&str> {
        match self.0.standing() {
            Standing::Realtime => None,
            Standing::Ordinary(why) => Some(why),
        }
    }

    /// Asks it to stop; it does so in its next period.
    fn stop(&self) {
        self.0.stop();
    }

    /// Waits for its end, but no longer than this, s; whether it ended.
    fn wait(&self, py: Python<'_>, longest_s: f64) -> PyResult<bool> {
        let longest = Duration::try_from_secs_f64(longest_s)
            .map_err(|error| input_error(Error::invalid("longest_s", error.to_string())))?;
        Ok(py.detach(|| self.0.wait(longest)).is_some())
    }

    /// Counts and durations, s; after the end also why it ended, whether the device took the zero torque, and
    /// the last second; before, the newest step alone.
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let report = PyDict::new(py);
        if let Some(ended) = py.detach(|| self.0.wait(Duration::ZERO)) {
            counts(&report, &ended.tally)?;
            report.set_item("last", columns(py, &ended.last))?;
            report.set_item("ending", ended.ending.word())?;
            report.set_item("why", ended.ending.to_string())?;
            report.set_item("not_relieved", ended.relieved.as_ref().err().map(ToString::to_string))?;
        } else {
            let snapshot = py.detach(|| self.0.snapshot());
            counts(&report, &snapshot.tally)?;
            report.set_item("last", columns(py, snapshot.newest.as_slice()))?;
        }
        Ok(report)
    }
}

fn counts(report: &Bound<'_, PyDict>, tally: &Tally) -> PyResult<()> {
    let py = report.py();
    report.set_item("steps", tally.steps)?;
    report.set_item("missed", tally.missed)?;
    report.set_item("longest_run", tally.longest_run)?;
    report.set_item("late", durations(py, &tally.late)?)?;
    report.set_item("busy", durations(py, &tally.busy)?)
}

fn durations<'py>(py: Python<'py>, histogram: &Histogram) -> PyResult<Bound<'py, PyDict>> {
    let figures = PyDict::new(py);
    figures.set_item("min", histogram.min() as f64 * NS)?;
    for (name, share) in [("median", 0.5), ("p99", 0.99), ("p999", 0.999)] {
        figures.set_item(name, histogram.quantile(share) as f64 * NS)?;
    }
    figures.set_item("max", histogram.max() as f64 * NS)?;
    figures.set_item("mean", histogram.mean() * NS)?;
    let edges: Vec<f64> = Histogram::edges().map(|ns| ns as f64 * NS).collect();
    figures.set_item("edges", array(py, &edges))?;
    figures.set_item("counts", PyArray1::from_slice(py, histogram.counts()))?;
    Ok(figures)
}

/// The columns t, theta, omega, alpha, hand, tau and late; a hand that is not measured is NaN.
fn columns<'py>(py: Python<'py>, rows: &[Row]) -> [Floats<'py>; 7] {
    let column = |value: fn(&Row) -> f64| array(py, &rows.iter().map(value).collect::<Vec<_>>());
    [
        column(|row| row.t),
        column(|row| row.sensed.theta),
        column(|row| row.sensed.omega),
        column(|row| row.sensed.alpha),
        column(|row| row.sensed.hand.unwrap_or(f64::NAN)),
        column(|row| row.tau),
        column(|row| row.late),
    ]
}
