//! Bindings of models and of the catalogue.
use super::convert::{Column, Floats, array, input_error};
use super::names::{axis, ids, own_id};
use super::signals::PySignals;
use super::watched::watched;
use knobcore::carry::carrier;
use knobcore::chain::{self, Hand};
use knobcore::effects::{Base, Id, Section};
use knobcore::error::Result;
use knobcore::fit::begun::begun;
use knobcore::fit::knocks;
use knobcore::forward::forward as forward_core;
use knobcore::model::{Model, Role};
use knobcore::motion::{Channel, Load, Motion};
use knobcore::param::{Axis, Given, Kind, Param, Usual};
use knobcore::predict::{Columns, Seeds, raw};
use knobcore::prepare::Prepared;

use knobcore::{model_file, predict};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An immutable model.
#[pyclass(frozen, name = "Model", module = "knobcam._core")]
#[derive(Clone)]
pub struct PyModel(pub Model);

impl PyModel {
    fn changed(&self, change: impl FnOnce(&mut Model) -> Result<()>) -> PyResult<Self> {
        let mut model = self.0.clone();
        change(&mut model).map_err(input_error)?;
        Ok(Self(model))
    }
}

#[pymethods]
impl PyModel {
    #[new]
    #[pyo3(signature = (effects, axis_name="rotary", name="", torque_unit=""))]
    fn new(effects: Vec<String>, axis_name: &str, name: &str, torque_unit: &str) -> PyResult<Self> {
        let ids = ids(&effects)?;
        let mut model = Model::new(&ids, axis(axis_name));
        model.name = name.to_owned();
        model.given = Given::ALL.into_iter().find(|given| given.unit() == torque_unit);
        Ok(Self(model))
    }

    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        model_file::parse(text).map(Self).map_err(input_error)
    }

    fn text(&self) -> String {
        model_file::write(&self.0)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn axis(&self) -> &'static str {
        if self.0.axis == Axis::Linear { "linear" } else { "rotary" }
    }

    /// What its torques are in.
    #[getter]
    fn torque_unit(&self) -> &'static str {
        self.0.units()[0]
    }

    fn as_torque(&self, factor: f64, back_emf: f64) -> PyResult<Self> {
        self.0.as_torque(factor, back_emf).map(Self).map_err(input_error)
    }

    #[getter]
    fn effects(&self) -> Vec<&'static str> {
        self.0.effects().map(|id| id.info().id).collect()
    }

    /// Rows of (name, value, unit, role), the role `free`, `fixed` or the name that it is tied to; without those that
    /// say nothing at present.
    fn rows(&self) -> Vec<(String, f64, String, String)> {
        let role = |role: Role| match role {
            Role::Free => "free".to_owned(),
            Role::Fixed => "fixed".to_owned(),
            Role::Tied(to) => self.0.slots()[to].name(),
        };
        self.0
            .slots()
            .iter()
            .enumerate()
            .filter(|(at, _)| !self.0.is_idle(*at))
            .map(|(_, s)| (s.name(), s.value, self.0.unit(s), role(s.role)))
            .collect()
    }

    /// Rows of [`catalogue`] of the effects that the catalogue does not have, or has otherwise.
    fn own_rows<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let own = self.0.effects().filter(|id| matches!(id, Id::User(_)));
        own.map(|id| row(py, id, self.0.axis)).collect()
    }

    fn renamed(&self, name: String) -> Self {
        let mut model = self.0.clone();
        model.name = name;
        Self(model)
    }

    /// The captures that its values come from, by name and fingerprint.
    #[getter]
    fn fitted_to(&self) -> Vec<String> {
        self.0.fitted_to.clone()
    }

    fn with_fitted_to(&self, captures: Vec<String>) -> Self {
        let mut model = self.0.clone();
        model.fitted_to = captures;
        Self(model)
    }

    /// How far and how fast it is turned, where somebody said.
    #[getter]
    fn reach(&self) -> Option<[f64; 2]> {
        self.0.reach
    }

    fn with_reach(&self, reach: Option<[f64; 2]>) -> PyResult<Self> {
        self.changed(|model| {
            model.reach = reach.map(model_file::checked_reach).transpose()?;
            Ok(())
        })
    }

    fn with_value(&self, name: &str, value: f64) -> PyResult<Self> {
        self.changed(|model| {
            // A value that was set was fitted to nothing.
            model.fitted_to.clear();
            model.set(name, value)
        })
    }

    fn with_fixed(&self, name: &str, fixed: bool) -> PyResult<Self> {
        self.changed(|model| model.set_role(name, if fixed { Role::Fixed } else { Role::Free }))
    }

    fn with_tie(&self, name: &str, to: &str) -> PyResult<Self> {
        self.changed(|model| model.tie(name, to))
    }

    fn with_effect(&self, id: &str) -> PyResult<Self> {
        Id::parse(id).and_then(|id| self.0.with(id)).map(Self).map_err(input_error)
    }

    /// The effects that load the shaft and not the knob behind a joint.
    #[getter]
    fn at_shaft(&self) -> Vec<&'static str> {
        self.0.shafts().iter().map(|id| id.info().id).collect()
    }

    fn with_at_shaft(&self, id: &str) -> PyResult<Self> {
        own_id(&self.0, id).and_then(|id| self.0.with_at_shaft(id)).map(Self).map_err(input_error)
    }

    /// Period of its detents over 2 pi, rad, if it has some.
    #[getter]
    fn period(&self) -> Option<f64> {
        self.0.period().map(|at| self.0.slots()[at].value)
    }

    /// Over which distance its friction builds up after a reversal, rad or m, if it does.
    #[getter]
    fn builds_up_over(&self) -> Option<f64> {
        self.0.builds_up_over()
    }

    /// What it is at rest: stored inertia, the dry friction backward and forward, the torques that hold it, and the
    /// speed below which they do.
    fn at_rest(&self) -> (f64, [f64; 2], [f64; 2], f64) {
        let mut state = vec![0.0; self.0.states()];
        let rest = self.0.load(&self.0.values(), &mut state, &Motion::exact(0.0, 0.0, 0.0, 0.0));
        (rest.inertia, rest.resist, rest.hold, rest.band)
    }

    /// What one of its effects asks of the rig at instants (columns of t, theta, omega, alpha): drive, stored inertia, dry
    /// friction and static friction, each backward and forward; and whether it remembers, calls a function of the user's
    /// own, presses the sliding surfaces together, or rubs by what presses them.
    fn loads<'py>(
        &self,
        py: Python<'py>,
        id: &str,
        columns: [Column<'py>; 4],
    ) -> PyResult<([Floats<'py>; 6], [bool; 4])> {
        let id = own_id(&self.0, id).map_err(input_error)?;
        let [t, theta, omega, alpha] = &columns;
        let at = [t.as_slice()?, theta.as_slice()?, omega.as_slice()?, alpha.as_slice()?];
        let loads = self.0.loads_of(id, at);
        let column = |of: fn(&Load<f64>) -> f64| array(py, &loads.iter().map(of).collect::<Vec<_>>());
        let rows = [
            column(|load| load.drive),
            column(|load| load.inertia),
            column(|load| load.resist[0]),
            column(|load| load.resist[1]),
            column(|load| load.hold[0]),
            column(|load| load.hold[1]),
        ];
        let info = id.info();
        let rubs_by_load = info.touches.contains(&Channel::Mu);
        Ok((rows, [id.law().remembers(), id.calls_out(), info.presses, rubs_by_load]))
    }

    /// Parameter values of an effect of ordinary size on this knob, on the motion of prepared signals, in the order
    /// of the catalogue. `noise` and `limit` are those of the torque sensor, N m.
    fn typical(
        &self,
        py: Python<'_>,
        id: &str,
        signals: &PySignals,
        noise: f64,
        limit: f64,
    ) -> PyResult<Vec<f64>> {
        let id = own_id(&self.0, id).map_err(input_error)?;
        let signals = &signals.prepared.signals;
        watched(py, &self.0, || id.law().typical(&carrier(&self.0, signals, noise, limit)))
    }

    /// What an effect with such values would cost who does not know of it, RMS beside the noise; what the noise leaves;
    /// and the largest torque; N m. None where the knob cannot have the effect.
    fn cost(
        &self,
        py: Python<'_>,
        id: &str,
        values: Vec<f64>,
        signals: &PySignals,
        noise: f64,
    ) -> PyResult<Option<[f64; 3]>> {
        let id = own_id(&self.0, id).map_err(input_error)?;
        let signals = &signals.prepared.signals;
        watched(py, &self.0, || {
            let here = carrier(&self.0, signals, noise, f64::INFINITY);
            here.cost(id, &values).map(|[cost, peak]| [cost, here.floor, peak])
        })
    }

    /// The same parameters, of these effects only.
    fn only(&self, effects: Vec<String>) -> PyResult<Self> {
        let ids = effects.iter().map(|name| own_id(&self.0, name));
        let ids = ids.collect::<Result<Vec<_>>>().map_err(input_error)?;
        self.0.only(&ids).map(Self).map_err(input_error)
    }

    /// Signals without the stretches in which its knob knocks beside which noise leaves `floor`, N m; None where it does
    /// not.
    fn without_knocks(&self, signals: &PySignals, floor: f64) -> Option<PySignals> {
        let all = &signals.prepared;
        let knocks = knocks(&all.signals, &self.0, floor);
        let signals = (!knocks.is_empty()).then(|| all.signals.without_knocks(knocks))?;
        Some(PySignals { prepared: Prepared { signals, ..all.clone() } })
    }

    /// Signals whose knob begins as their first torques say, where `rms` is left of them, N m; None where they say nothing
    /// new.
    fn begun(&self, py: Python<'_>, signals: &PySignals, rms: f64) -> PyResult<Option<PySignals>> {
        let all = &signals.prepared;
        let found = watched(py, &self.0, || begun(&all.signals, &self.0, rms))?;
        Ok(found.map(|signals| PySignals { prepared: Prepared { signals, ..all.clone() } }))
    }

    /// Torque on the motion of prepared signals, through their filter or raw; N m.
    #[pyo3(signature = (signals, filtered=true))]
    fn torque<'py>(&self, py: Python<'py>, signals: &PySignals, filtered: bool) -> PyResult<Floats<'py>> {
        let of = if filtered { predict::torque } else { predict::torque_raw };
        watched(py, &self.0, || of(&self.0, &signals.prepared.signals)).map(|tau| array(py, &tau))
    }

    /// Raw torque on the motion of prepared signals, N m, and its derivative to each free parameter, in the order
    /// of `rows`.
    fn sensitivities<'py>(
        &self,
        py: Python<'py>,
        signals: &PySignals,
    ) -> PyResult<(Floats<'py>, Vec<Floats<'py>>)> {
        let signals = &signals.prepared.signals;
        let slots = self.0.slots().iter().enumerate();
        let free: Vec<usize> = slots.filter(|(_, slot)| slot.role == Role::Free).map(|(i, _)| i).collect();
        let mut columns = Columns::default();
        watched(py, &self.0, || {
            let seeds = Seeds::of(&self.0, &free);
            raw(&self.0, &self.0.values(), &seeds, signals, 0..signals.t.len(), &mut columns);
        })?;
        let mut columns = columns.into_all().into_iter().map(|column| PyArray1::from_vec(py, column));
        let torque = columns.next().unwrap_or_else(|| array(py, &[]));
        Ok((torque, columns.collect()))
    }
}

/// A knob that a hand pushes through a spring and a damper: theta, omega, alpha and the hand's torque.
#[pyfunction]
pub fn push<'py>(
    py: Python<'py>,
    model: &PyModel,
    reference: Column<'py>,
    dt: f64,
    stiffness: f64,
    damping: f64,
) -> PyResult<[Floats<'py>; 4]> {
    let reference = reference.as_slice()?;
    let pushed = watched(py, &model.0, || chain::push(&model.0, reference, dt, Hand { stiffness, damping }))?
        .map_err(input_error)?;
    Ok([&pushed.theta, &pushed.omega, &pushed.alpha, &pushed.tau].map(|x| array(py, x)))
}

/// The motion that the measured torque of prepared signals makes, rad, at each of their samples, and the samples at
/// which it began from the measured state.
#[pyfunction]
#[pyo3(signature = (model, signals, horizon_s=None))]
pub fn forward<'py>(
    py: Python<'py>,
    model: &PyModel,
    signals: &PySignals,
    horizon_s: Option<f64>,
) -> PyResult<(Floats<'py>, Vec<usize>)> {
    let signals = &signals.prepared.signals;
    let made = watched(py, &model.0, || forward_core(&model.0, signals, horizon_s))?.map_err(input_error)?;
    Ok((array(py, &made.theta), made.starts))
}

/// The catalogue: for each effect a dict of what it says of itself.
#[pyfunction]
#[pyo3(signature = (axis_name="rotary"))]
pub fn catalogue<'py>(py: Python<'py>, axis_name: &str) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let axis = axis(axis_name);
    Id::all().into_iter().map(|id| row(py, id, axis)).collect()
}

/// A number that grows whenever the catalogue changes: an effect of one's own entered it, or left.
#[pyfunction]
pub fn catalogue_version() -> usize {
    knobcore::effects::version()
}

/// What an effect says of itself.
fn row(py: Python<'_>, id: Id, axis: Axis) -> PyResult<Bound<'_, PyDict>> {
    let info = id.info();
    let row = PyDict::new(py);
    row.set_item("id", info.id)?;
    row.set_item("place", info.place.text())?;
    row.set_item("law", info.law)?;
    row.set_item("source", info.source)?;
    row.set_item("shows", info.shows)?;
    row.set_item("confused", info.confused)?;
    row.set_item("needs", info.needs)?;
    row.set_item("describes", info.describes)?;
    row.set_item("title", info.words.title)?;
    row.set_item("name", info.words.name)?;
    row.set_item("about", info.words.about)?;
    row.set_item("causes", info.words.causes)?;
    row.set_item("remedies", info.words.remedies)?;
    row.set_item("latex", info.words.latex)?;
    row.set_item("over", info.over.text())?;
    row.set_item("section", info.section.map(Section::text))?;
    row.set_item("friction", info.is_friction())?;
    row.set_item("map", info.is_map())?;
    row.set_item("along", info.is_along())?;
    row.set_item("base", info.base.map(Base::text))?;
    row.set_item("unsearched", info.unsearched)?;
    row.set_item("taken_up", info.taken_up.map(|one| (one.by, one.why)))?;
    row.set_item("given", info.given)?;
    row.set_item("clips", info.clips)?;
    let param = |p: &Param| {
        let row = PyDict::new(py);
        row.set_item("name", p.name)?;
        row.set_item("unit", p.unit.text(axis))?;
        row.set_item("lower", p.lower)?;
        row.set_item("upper", p.upper)?;
        row.set_item("neutral", p.neutral)?;
        row.set_item("plausible", (p.plausible[0], p.plausible[1]))?;
        let spread = if let Usual::WherePaid(spread) = p.usual { Some(spread) } else { None };
        row.set_item("where_paid", spread)?;
        row.set_item("meaning", p.meaning)?;
        row.set_item("phase", matches!(p.kind, Kind::PhaseOf(_)))?;
        PyResult::Ok(row)
    };
    row.set_item("params", info.params.iter().map(param).collect::<PyResult<Vec<_>>>()?)?;
    Ok(row)
}
