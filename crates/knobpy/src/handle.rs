//! Bindings of the emulated handle as a device of the loop.
use super::convert::{Column, input_error};
use super::render::{DeviceRow, device};
use knobcore::error::Error;
use knobrender::Device;
use knobrig::emulate::{Hand, Held, Shown, Track};
use knobrig::realtime::Clock;
use pyo3::prelude::*;
use std::sync::Arc;

/// An emulated handle that a loop turns: it keeps its place, its speed and the work of its hand from loop to loop.
#[pyclass(frozen, name = "EmulatedHandle", module = "knobcam._core", subclass)]
pub struct PyEmulatedHandle {
    device: Device,
    hand: Option<Hand>,
    shown: Arc<Shown>,
}

impl PyEmulatedHandle {
    /// The handle on a clock, for a loop with such a period, ns.
    pub fn held<K: Clock>(&self, period: u64, clock: K) -> Held<K> {
        Held::new(self.device, period, self.hand.clone(), Arc::clone(&self.shown), clock)
    }
}

#[pymethods]
impl PyEmulatedHandle {
    /// `hand`: theta, omega and alpha of the motion that it follows, samples per second.
    #[new]
    fn new(
        device_row: DeviceRow,
        theta: f64,
        hand: Option<(Column<'_>, Column<'_>, Column<'_>, f64)>,
        measured: bool,
    ) -> PyResult<Self> {
        let device = device(device_row).checked().map_err(input_error)?;
        let hand = hand.map(|hand| followed(&hand, measured)).transpose()?;
        Ok(Self { device, hand, shown: Arc::new(Shown::at(theta)) })
    }

    /// Angle, rad, speed, rad/s, and the work that the hand has done so far, J.
    #[getter]
    fn shown(&self) -> (f64, f64, f64) {
        self.shown.get().into()
    }
}

fn followed(
    (theta, omega, alpha, rate_hz): &(Column<'_>, Column<'_>, Column<'_>, f64),
    measured: bool,
) -> PyResult<Hand> {
    let track = Track {
        theta: theta.as_slice()?.to_vec(),
        omega: omega.as_slice()?.to_vec(),
        alpha: alpha.as_slice()?.to_vec(),
    };
    let finite = [&track.theta, &track.omega].into_iter().flatten().all(|x| x.is_finite());
    if track.is_empty() || track.omega.len() != track.len() || !finite || rate_hz.is_nan() || *rate_hz <= 0.0
    {
        let why = "is no motion; give one finite angle and speed a sample, and a rate above 0";
        return Err(input_error(Error::invalid("hand", why)));
    }
    Ok(Hand { track: Arc::new(track), rate_hz: *rate_hz, measured })
}
