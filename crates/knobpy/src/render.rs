//! Bindings of the render step and of the emulated handle.
use super::convert::{Column, Floats, input_error, number};
use super::model::PyModel;
use super::watched::watched;
use knobcore::error::Error;
use knobrender::{
    Contact, Device, Fault, Limits, Renderer, Sensed, State, check_passive as passive,
    check_stability as check,
};
use knobrig::emulate::Handle;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Inertia, damping, delay, torque limit, torque-rate limit, encoder step, held.
pub type DeviceRow = (f64, f64, usize, f64, f64, f64, bool);

pub fn device(row: DeviceRow) -> Device {
    let (inertia, damping, delay, torque_limit, torque_rate_limit, encoder_step, held) = row;
    Device { inertia, damping, delay, torque_limit, torque_rate_limit, encoder_step, held }
}

/// The render step. One sample after another goes in, and torque comes out.
#[pyclass(name = "Renderer", module = "knobcam._core", subclass)]
pub struct PyRenderer {
    pub renderer: Renderer,
}

#[pymethods]
impl PyRenderer {
    #[new]
    fn new(
        model: &PyModel,
        rate_hz: f64,
        device_row: Option<DeviceRow>,
        torque_limit: f64,
        torque_rate_limit: f64,
        speed_limit: f64,
        forced: bool,
    ) -> PyResult<Self> {
        let limits = Limits { torque: torque_limit, torque_rate: torque_rate_limit, speed: speed_limit };
        let device = device_row.map(device);
        let make = if forced { Renderer::forced } else { Renderer::new };
        Ok(Self { renderer: make(&model.0, rate_hz, device, limits).map_err(input_error)? })
    }

    /// The torque by which the knob answers, N m (the motor applies its negative). Angle rad, velocity rad/s,
    /// acceleration rad/s^2, and the torque that the hand applies, N m, where it is measured.
    #[pyo3(signature = (theta, omega, alpha=None, tau_other=None))]
    fn step(
        &mut self,
        py: Python<'_>,
        theta: &Bound<'_, PyAny>,
        omega: &Bound<'_, PyAny>,
        alpha: Option<&Bound<'_, PyAny>>,
        tau_other: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<f64> {
        let sensed = Sensed {
            theta: number("theta", theta)?,
            omega: number("omega", omega)?,
            alpha: alpha.map_or(Ok(0.0), |alpha| number("alpha", alpha))?,
            hand: tau_other.map(|hand| number("tau_other", hand)).transpose()?,
        };
        if !self.renderer.calls_out() {
            return Ok(self.renderer.step(sensed));
        }
        let model = self.renderer.model().clone();
        watched(py, &model, || self.renderer.step(sensed))
    }

    /// The torque along a motion, N m, as single steps would give it, to the last bit; columns of equal length,
    /// NaN in tau_other where the hand is not measured.
    #[pyo3(signature = (theta, omega, alpha, tau_other=None))]
    fn along<'py>(
        &mut self,
        py: Python<'py>,
        theta: Column<'py>,
        omega: Column<'py>,
        alpha: Column<'py>,
        tau_other: Option<Column<'py>>,
    ) -> PyResult<Floats<'py>> {
        let motion = [theta.as_slice()?, omega.as_slice()?, alpha.as_slice()?];
        let hand = tau_other.as_ref().map(|column| column.as_slice()).transpose()?;
        let lengths = motion.iter().copied().chain(hand).map(<[f64]>::len);
        if lengths.into_iter().any(|n| n != motion[0].len()) {
            let why = "differ in length; give one value a sample in each";
            return Err(input_error(Error::invalid("theta, omega, alpha, tau_other", why)));
        }
        let tau = PyArray1::zeros(py, motion[0].len(), false);
        let model = self.renderer.model().clone();
        let mut out = tau.readwrite();
        let out = out.as_slice_mut()?;
        watched(py, &model, || self.renderer.render(motion, hand, out))?;
        Ok(tau)
    }

    /// Periods went by without a step: the next one stands for all of them, so that what the handle moved
    /// meanwhile is no jump. A loop says so by itself.
    fn missed(&mut self, periods: u64) {
        self.renderer.missed(periods);
    }

    /// Forgets everything, faults too.
    fn reset(&mut self) {
        self.renderer.reset();
    }

    /// Why it renders nothing any more, if so.
    #[getter]
    fn fault(&self) -> Option<&'static str> {
        self.renderer.fault().map(Fault::text)
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.renderer.rate_hz()
    }

    /// All that it remembers, as numbers that JSON can keep.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.renderer.state();
        let row = PyDict::new(py);
        row.set_item("samples", state.samples)?;
        row.set_item("missed", state.missed)?;
        row.set_item("before", (state.before[0], state.before[1]))?;
        row.set_item("between", state.between)?;
        row.set_item("alpha", state.alpha)?;
        row.set_item("tau", state.tau)?;
        row.set_item("strain", state.contact.strain)?;
        row.set_item("slipping", state.contact.slipping)?;
        row.set_item("rest", state.contact.rest)?;
        row.set_item("knob", (state.knob[0], state.knob[1]))?;
        row.set_item("memory", state.memory.clone())?;
        row.set_item("tank_J", state.tank)?;
        row.set_item("fault", state.fault.map(Fault::name))?;
        Ok(row)
    }

    /// Goes on from a state of the same model.
    fn set_state(&mut self, row: &Bound<'_, PyDict>) -> PyResult<()> {
        let bad = |name: &str, why: &str| input_error(Error::invalid(format!("state '{name}'"), why));
        let get =
            |name: &str| row.get_item(name)?.ok_or_else(|| bad(name, "is missing; give all of a state"));
        let fault: Option<String> = get("fault")?.extract()?;
        let named = |name: String| {
            let known = Fault::ALL.into_iter().find(|fault| fault.name() == name);
            known.ok_or_else(|| bad("fault", "is none that this version knows"))
        };
        let pair = |name: &str| get(name)?.extract::<[f64; 2]>();
        let state = State {
            samples: get("samples")?.extract()?,
            missed: get("missed")?.extract()?,
            before: pair("before")?,
            between: get("between")?.extract()?,
            alpha: get("alpha")?.extract()?,
            tau: get("tau")?.extract()?,
            contact: Contact {
                strain: get("strain")?.extract()?,
                slipping: get("slipping")?.extract()?,
                rest: get("rest")?.extract()?,
            },
            knob: pair("knob")?,
            memory: get("memory")?.extract()?,
            tank: row.get_item("tank_J")?.map_or(Ok(self.renderer.state().tank), |tank| tank.extract())?,
            fault: fault.map(named).transpose()?,
        };
        self.renderer.set_state(state).map_err(input_error)
    }
}

/// An emulated handle: an inertia in somebody's hand, a motor that acts late.
#[pyclass(name = "Handle", module = "knobcam._core")]
pub struct PyHandle(pub Handle);

#[pymethods]
impl PyHandle {
    #[new]
    fn new(device_row: DeviceRow, rate_hz: f64, theta: f64) -> PyResult<Self> {
        let device = device(device_row).checked().map_err(input_error)?;
        Ok(Self(Handle::new(device, 1.0 / rate_hz, theta)))
    }

    /// Angle, speed and acceleration as its sensors say.
    fn sensed(&self) -> (f64, f64, f64) {
        let sensed = self.0.sensed(None);
        (sensed.theta, sensed.omega, sensed.alpha)
    }

    /// True angle and speed.
    #[getter]
    fn motion(&self) -> (f64, f64) {
        let [theta, omega, _] = self.0.motion();
        (theta, omega)
    }

    /// One sample goes by under the torque of the motor and the hand's, which goes from one value to another; the
    /// work of the hand, J.
    fn push(&mut self, motor: f64, from: f64, to: f64) -> f64 {
        self.0.push(motor, [from, to])
    }

    /// Gives it a speed, rad/s.
    fn kick(&mut self, omega: f64) {
        self.0.kick(omega);
    }
}

/// Why a model is not to be rendered, on a device or on any: the term that feeds a hand or makes it ring; None where
/// there is none.
#[pyfunction]
pub fn check_passive(
    model: &PyModel,
    device_row: Option<DeviceRow>,
    rate_hz: f64,
) -> PyResult<Option<String>> {
    let device = device_row.map(device).map(Device::checked).transpose().map_err(input_error)?;
    Ok(passive(&model.0, device, rate_hz).err().map(|error| error.to_string()))
}

/// How stably a device renders a model: a dict of figures, SI.
#[pyfunction]
pub fn check_stability<'py>(
    py: Python<'py>,
    model: &PyModel,
    device_row: DeviceRow,
    rate_hz: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let found = check(&model.0, device(device_row), rate_hz).map_err(input_error)?;
    let row = PyDict::new(py);
    row.set_item("delay_s", found.delay_s)?;
    row.set_item("stiffness_Nm_rad", found.stiffness)?;
    row.set_item("damping_Nms_rad", found.damping)?;
    row.set_item("inertia_ratio", found.inertia_ratio)?;
    row.set_item("allowed_stiffness_Nm_rad", found.allowed_stiffness)?;
    row.set_item("passive_stiffness_Nm_rad", found.passive_stiffness)?;
    row.set_item("passivity_margin_Nms_rad", found.passivity_margin)?;
    row.set_item("anchor_stiffness_Nm_rad", found.anchor_stiffness)?;
    row.set_item("sliding_margin_rad", found.sliding_margin)?;
    row.set_item("sticking_margin_rad", found.sticking_margin)?;
    row.set_item("stable", found.is_stable())?;
    Ok(row)
}
