//! Bindings of the emulated rig.
use super::convert::{Column, input_error};
use super::model::PyModel;
use super::wire::message;
use knobcore::error::Error;
use knobrig::emulate::{Fixture, Rig, Sensors, Setup, Track};
use knobrig::wire::{Message, State};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::{Mutex, PoisonError};

/// An emulated rig: hears bytes, lets time go by, speaks bytes.
///
/// Behind a lock, for it lives in a thread of its own beside those that ask for its state: while time goes by,
/// Python's other threads run, and whoever asks meanwhile waits for the end of the step.
#[pyclass(name = "Rig", module = "knobcam._core", frozen)]
pub struct PyRig(Mutex<Rig>);

impl PyRig {
    /// What `work` says of the rig. Who waits for it holds nothing of the interpreter's, or the one that has it
    /// could not come back.
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Rig) -> T + Send) -> T {
        py.detach(|| work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

#[pymethods]
impl PyRig {
    /// `descriptor` as in a DESCRIPTOR message; a knob, an anchor of some stiffness (N m/rad) or nothing in the
    /// gripper; standard deviations of velocity, acceleration and torque and the sensitivity of the accelerometer;
    /// the motion of a hand, which is repeated.
    #[new]
    #[pyo3(signature = (descriptor, knob, anchor, sensors, hand, seed))]
    fn new<'py>(
        descriptor: &Bound<'py, PyDict>,
        knob: Option<&PyModel>,
        anchor: Option<f64>,
        sensors: (f64, f64, f64, f64),
        hand: [Column<'py>; 3],
        seed: u64,
    ) -> PyResult<Self> {
        let Message::Descriptor { device } = message(descriptor)? else {
            return Err(input_error(Error::invalid("descriptor", "is another message; give a DESCRIPTOR")));
        };
        device.check().map_err(input_error)?;
        let [theta, omega, alpha] = &hand;
        let column = |of: &Column<'py>| of.as_slice().map(<[f64]>::to_vec);
        let (omega_sd, alpha_sd, tau_sd, c_cal) = sensors;
        Ok(Self(Mutex::new(Rig::new(Setup {
            descriptor: device,
            fixture: match (knob, anchor) {
                (Some(knob), _) => Fixture::Knob(Box::new(knob.0.clone())),
                (None, Some(stiffness)) => Fixture::Anchor(stiffness),
                (None, None) => Fixture::Free,
            },
            sensors: Sensors { omega_sd, alpha_sd, tau_sd, c_cal },
            hand: Track { theta: column(theta)?, omega: column(omega)?, alpha: column(alpha)? },
            seed,
        }))))
    }

    /// Bytes from the host.
    fn hear(&self, py: Python<'_>, stream: &[u8]) {
        self.with(py, |rig| rig.hear(stream));
    }

    /// Time goes by until so many microseconds since it was switched on.
    fn advance(&self, py: Python<'_>, until_us: u64) {
        self.with(py, |rig| rig.advance(until_us));
    }

    /// What it has to say, at most so many bytes.
    fn speak<'py>(&self, py: Python<'py>, most: usize) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.with(py, |rig| rig.speak(most)))
    }

    /// The host has closed the port.
    fn unplugged(&self, py: Python<'_>) {
        self.with(py, Rig::unplugged);
    }

    /// Torque of its motor, N m.
    #[getter]
    fn motor_torque(&self, py: Python<'_>) -> f64 {
        self.with(py, |rig| rig.motor_torque())
    }

    /// idle, recording, armed, rendering or fault.
    #[getter]
    fn state(&self, py: Python<'_>) -> &'static str {
        match self.with(py, |rig| rig.state()) {
            State::Idle => "idle",
            State::Recording => "recording",
            State::Armed => "armed",
            State::Rendering => "rendering",
            State::Fault => "fault",
        }
    }
}
