//! Bindings of the emulated rig.
use super::convert::{Column, input_error};
use super::model::PyModel;
use super::wire::message;
use knobcore::error::Error;
use knobrig::emulate::{Fixture, Rig, Sensors, Setup, Track};
use knobrig::wire::{Message, State};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// An emulated rig: hears bytes, lets time go by, speaks bytes.
#[pyclass(name = "Rig", module = "knobcam._core")]
pub struct PyRig(Rig);

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
        Ok(Self(Rig::new(Setup {
            descriptor: device,
            fixture: match (knob, anchor) {
                (Some(knob), _) => Fixture::Knob(Box::new(knob.0.clone())),
                (None, Some(stiffness)) => Fixture::Anchor(stiffness),
                (None, None) => Fixture::Free,
            },
            sensors: Sensors { omega_sd, alpha_sd, tau_sd, c_cal },
            hand: Track { theta: column(theta)?, omega: column(omega)?, alpha: column(alpha)? },
            seed,
        })))
    }

    /// Bytes from the host.
    fn hear(&mut self, stream: &[u8]) {
        self.0.hear(stream);
    }

    /// Time goes by until so many microseconds since it was switched on.
    fn advance(&mut self, py: Python<'_>, until_us: u64) {
        py.detach(|| self.0.advance(until_us));
    }

    /// What it has to say, at most so many bytes.
    fn speak<'py>(&mut self, py: Python<'py>, most: usize) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.speak(most))
    }

    /// The host has closed the port.
    fn unplugged(&mut self) {
        self.0.unplugged();
    }

    /// Torque of its motor, N m.
    #[getter]
    fn motor_torque(&self) -> f64 {
        self.0.motor_torque()
    }

    /// idle, recording, armed, rendering or fault.
    #[getter]
    fn state(&self) -> &'static str {
        match self.0.state() {
            State::Idle => "idle",
            State::Recording => "recording",
            State::Armed => "armed",
            State::Rendering => "rendering",
            State::Fault => "fault",
        }
    }
}
