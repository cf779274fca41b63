//! Bindings of preparation.
use super::convert::{Column, Floats, array, input_error};
use super::names::axis;
use knobcore::diagnose::since_reversal;
use knobcore::error::Error;
use knobcore::model::Run;
use knobcore::param::Axis;
use knobcore::prepare::{
    LowPass, Preparation, Prepared, Recording, Ripple, Source, Trusted, prepare as prepare_core, taken_off,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::HashMap;

/// Prepared signals of one capture.
#[pyclass(frozen, name = "Signals", module = "knobcam._core")]
pub struct PySignals {
    pub prepared: Prepared,
}

#[pymethods]
impl PySignals {
    /// One column by name: t, theta, omega, alpha, forward, tau, tau_raw, weight, or a standard deviation
    /// omega_sd, theta_sd, alpha_sd (None where it is not known), or history, the distance since the last reversal.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Floats<'py>>> {
        let s = &self.prepared.signals;
        let sd = self.prepared.uncertainty.as_ref();
        let column = match name {
            "t" => &s.t,
            "theta" => &s.theta,
            "omega" => &s.omega,
            "alpha" => &s.alpha,
            "forward" => &s.forward,
            "tau" => &s.tau,
            "tau_raw" => &s.tau_raw,
            "weight" => &s.weight,
            "history" => &since_reversal(s),
            "omega_sd" if sd.is_some() => &s.omega_sd,
            "theta_sd" | "alpha_sd" | "omega_sd" => match sd {
                Some([theta, alpha]) => {
                    if name == "theta_sd" {
                        theta
                    } else {
                        alpha
                    }
                }
                None => return Ok(None),
            },
            _ => return Err(input_error(Error::invalid(format!("column '{name}'"), "does not exist"))),
        };
        Ok(Some(array(py, column)))
    }

    #[getter]
    fn axis(&self) -> &'static str {
        if self.prepared.signals.axis == Axis::Linear { "linear" } else { "rotary" }
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.prepared.signals.rate_hz
    }

    #[getter]
    fn used(&self) -> usize {
        self.prepared.signals.used()
    }

    /// Edge of the torque's filter, Hz, where that is the paper's.
    #[getter]
    fn edge_hz(&self) -> Option<f64> {
        self.prepared.edge.map(|edge| edge.hz)
    }

    /// The fastest wave of the torque over position that the edge as given takes off: 2 pi over its length, its
    /// frequency (Hz) at the highest speed, its share of all that is taken off.
    #[getter]
    fn ripple(&self) -> Option<(f64, f64, f64)> {
        self.prepared.edge?.ripple.map(in_numbers)
    }

    /// Whether the filter still takes it off.
    #[getter]
    fn lost(&self) -> bool {
        self.prepared.edge.is_some_and(|edge| edge.lost)
    }

    /// Above which frequency (Hz) the torque has nothing to do with the motion, the edge (Hz) that there was, and how
    /// many times the torque that was recorded above it the motion would take (RMS).
    #[getter]
    fn incoherent(&self) -> Option<(f64, f64, f64)> {
        self.prepared.edge?.incoherent.map(|found| (found.hz, found.edge_hz, found.times))
    }

    /// Readings of theta, omega and alpha that the smoother left out, each with its row (of those kept).
    #[getter]
    fn strays(&self) -> Vec<(&'static str, usize)> {
        let named = ["theta", "omega", "alpha"].into_iter().zip(&self.prepared.strays);
        named.flat_map(|(name, rows)| rows.iter().map(move |&row| (name, row))).collect()
    }

    /// What `ripple` is, of what the filter takes off beside this raw torque of a model (samples kept, N m).
    fn taken_off(&self, torque: Column<'_>) -> PyResult<Option<(f64, f64, f64)>> {
        Ok(taken_off(&self.prepared.signals, torque.as_slice()?).map(in_numbers))
    }

    /// The same torque beside the motion so much later, s, up to a row.
    fn later(&self, delay_s: f64) -> Self {
        let signals = self.prepared.signals.later(delay_s);
        Self { prepared: Prepared { signals, ..self.prepared.clone() } }
    }

    /// Noise levels of the motion sensors and the jerk, where they were estimated.
    #[getter]
    fn noise(&self) -> Option<HashMap<&'static str, f64>> {
        let noise = self.prepared.noise.as_ref()?;
        Some(HashMap::from([
            ("theta", noise.theta),
            ("omega", noise.omega),
            ("alpha", noise.alpha),
            ("jerk", noise.jerk),
        ]))
    }
}

fn in_numbers(ripple: Ripple) -> (f64, f64, f64) {
    (ripple.per_turn, ripple.hz, ripple.share)
}

fn positive(options: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<f64>> {
    match options.get_item(name)? {
        None => Ok(None),
        Some(value) if value.is_none() => Ok(None),
        Some(value) => value.extract().map(Some),
    }
}

/// Prepares a recording (`run` is its name and its fingerprint) by method `smooth`, `paper`, `none` or `differences`; see
/// `knobcam.prepare`. Or `exact`, as it is, and the torque at samples that do not count too.
/// Of what is `trusted`, `theta`, `omega`, `alpha` or `bands`, what is found is told and left as it is.
#[pyfunction]
#[pyo3(signature = (axis_name, rate_hz, t, theta, omega, alpha, tau, after_gap, measured, method, options, run=None, trusted=vec![]))]
#[allow(clippy::too_many_arguments)]
pub fn prepare(
    py: Python<'_>,
    axis_name: &str,
    rate_hz: f64,
    t: Column<'_>,
    theta: Column<'_>,
    omega: Option<Column<'_>>,
    alpha: Option<Column<'_>>,
    tau: Column<'_>,
    after_gap: PyReadonlyArray1<'_, bool>,
    measured: PyReadonlyArray1<'_, bool>,
    method: &str,
    options: &Bound<'_, PyDict>,
    run: Option<(String, String)>,
    trusted: Vec<String>,
) -> PyResult<PySignals> {
    let mut how = match method {
        "smooth" => Preparation::smooth(rate_hz),
        "paper" => Preparation::paper(rate_hz),
        "none" => Preparation::none(),
        "exact" => Preparation { bridged: false, ..Preparation::none() },
        "differences" => {
            let cutoff = positive(options, "cutoff_hz")?.unwrap_or(0.1 * rate_hz);
            Preparation::differences(cutoff, positive(options, "decimate")?.map_or(1, |d| d as usize))
        }
        other => {
            let why = "is none; choose smooth, paper, none or differences";
            return Err(input_error(Error::invalid(format!("prepare '{other}'"), why)));
        }
    };
    if let Some(edge) = positive(options, "torque_edge_hz")? {
        (how.torque, how.follows) = (Some(LowPass::Paper(edge)), false);
    }
    if let (Some(edge), Source::Filtered { theta, omega, alpha }) =
        (positive(options, "motion_edge_hz")?, &mut how.source)
    {
        (*theta, *omega, *alpha) = (LowPass::Paper(edge), LowPass::Paper(edge), LowPass::Paper(0.5 * edge));
    }
    let trusts = |what: &str| trusted.iter().any(|one| one == what);
    how.trusted = Trusted { readings: ["theta", "omega", "alpha"].map(trusts), bands: trusts("bands") };
    let (name, fingerprint) = run.unwrap_or_default();
    let recording = Recording {
        run: &Run { name, fingerprint },
        axis: axis(axis_name),
        rate_hz,
        t: t.as_slice()?,
        theta: theta.as_slice()?,
        omega: omega.as_ref().map(|c| c.as_slice()).transpose()?,
        alpha: alpha.as_ref().map(|c| c.as_slice()).transpose()?,
        tau: tau.as_slice()?,
        after_gap: after_gap.as_slice()?,
        measured: measured.as_slice()?,
    };
    let prepared = py.detach(|| prepare_core(&recording, &how)).map_err(input_error)?;
    Ok(PySignals { prepared })
}
