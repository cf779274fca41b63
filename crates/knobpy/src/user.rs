//! Bindings of effects of the user's own.
use super::convert::{Column, array, input_error};
use super::model::PyModel;
use super::names::own_id;
use super::watched::interrupt;
use knobcore::effects::formula::{catalogued, written};
use knobcore::effects::{Does, Function, Id, Info, Nonlinear, Place, User};
use knobcore::error::{Error, Result};
use knobcore::motion::Channel;
use knobcore::param::{Axis, Kind, Param, Unit};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// A parameter as it comes in: name, unit, lower, upper, neutral, meaning, linear.
type Row = (String, String, f64, f64, f64, String, bool);

/// Registers an effect that acts as a `load`, as `friction`, on the `sensor` or as `coupling`. `function` gets the
/// parameter values and the columns of [`Function`], and answers as that says; `starts` has one value per parameter in
/// each row.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn register_effect(
    id: String,
    acts: &str,
    law: String,
    source: String,
    shows: String,
    params: Vec<Row>,
    remembers: bool,
    starts: Vec<Vec<f64>>,
    function: Py<PyAny>,
) -> PyResult<()> {
    let params = params.into_iter().map(|row| param(&id, row));
    let params = params.collect::<Result<Vec<_>>>().map_err(input_error)?;
    let (place, touches, makes_nonlinear): (_, &[Channel], _) = match acts {
        "friction" => (Place::Load, &[Channel::FrictionScale], None),
        "sensor" => (Place::Sensor, &[], Some(Nonlinear::Everything)),
        "coupling" => (Place::Coupling, &[], Some(Nonlinear::Everything)),
        _ => (Place::Load, &[Channel::Drive], None),
    };
    let (id, law): (&'static str, &'static str) = (id.leak(), law.leak());
    let own = Info::own(id, place, law, params.leak(), touches);
    let info = Info { source: source.leak(), shows: shows.leak(), makes_nonlinear, ..own };
    User::register(info, remembers, starts, Does::Call(called(function))).map_err(input_error)?;
    Ok(())
}

/// Registers a law that is written as a formula, a `load`, a factor on `friction` or what a `sensor` adds; of its
/// parameters units (text) and bounds may be given by name. Answers the names, units, bounds and neutral values of all,
/// and whether the law is proportional to them.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn register_law(
    id: &str,
    acts: &str,
    law: &str,
    units: HashMap<String, String>,
    bounds: HashMap<String, (f64, f64)>,
) -> PyResult<Vec<(&'static str, String, f64, f64, f64, bool)>> {
    let mut asked: BTreeMap<String, written::Asked> = BTreeMap::new();
    for (name, unit) in units {
        let unit = unit_of(id, &name, &unit).map_err(input_error)?;
        asked.entry(name).or_default().unit = Some(unit);
    }
    for (name, (lower, upper)) in bounds {
        asked.entry(name).or_default().bounds = [lower, upper];
    }
    let user = written::register(id, acts, law, &asked).map_err(input_error)?;
    let row = |param: &Param| {
        let unit = param.unit.text(Axis::Rotary);
        (param.name, unit, param.lower, param.upper, param.neutral, param.kind == Kind::Linear)
    };
    Ok(user.info.params.iter().map(row).collect())
}

fn param(id: &str, (name, unit, lower, upper, neutral, meaning, linear): Row) -> Result<Param> {
    let unit = unit_of(id, &name, &unit)?;
    let kind = if linear { Kind::Linear } else { Kind::Nonlinear };
    let (name, meaning) = (name.leak(), meaning.leak());
    let shape = Param::shape(name, unit, [lower, upper], neutral, meaning);
    Ok(Param { kind, ..shape })
}

fn unit_of(id: &str, name: &str, text: &str) -> Result<Unit> {
    Unit::parse(text).map_err(|error| Error::invalid(format!("parameter '{id}.{name}'"), error.to_string()))
}

fn called(function: Py<PyAny>) -> Function {
    Box::new(move |p, columns| {
        Python::attach(|py| {
            let columns: Vec<_> = columns.iter().map(|column| array(py, column)).collect();
            let told = function.bind(py).call1((p.to_vec(), columns)).and_then(|tau| {
                let tau: Column<'_> = tau.extract()?;
                Ok(tau.as_slice()?.to_vec())
            });
            told.map_err(|error| {
                let why = error.value(py).to_string();
                if !error.is_instance_of::<PyException>(py) {
                    interrupt(Some(error));
                }
                why
            })
        })
    })
}

/// The effect of a model that is stated as a formula as the effect `name` of the catalogue: the text of its Rust file, its
/// line in the registry, and the list there that it belongs to.
#[pyfunction]
pub fn effect_source(model: &PyModel, effect: &str, name: &str) -> PyResult<(String, String, &'static str)> {
    let model = &model.0;
    let id = own_id(model, effect).map_err(input_error)?;
    let values = model.values();
    let p = model.chain(&values).find(|(own, _)| *own == id).map_or_else(Vec::new, |(_, p)| p.to_vec());
    let Id::User(user) = id else {
        let why = "is in the catalogue already; name one that the model has as a formula";
        return Err(input_error(Error::invalid(format!("effect '{effect}'"), why)));
    };
    let written = catalogued::source(user, name, &p).map_err(input_error)?;
    Ok((written.text, written.line, written.list))
}

/// Takes an effect out of the catalogue; models that have it keep it. Whether it was there.
#[pyfunction]
pub fn forget_effect(id: &str) -> bool {
    User::forget(id)
}

/// What went wrong in an effect of the user's own on this thread since this was last asked.
#[pyfunction]
pub fn effect_failure(id: &str) -> PyResult<Option<String>> {
    match Id::parse(id).map_err(input_error)? {
        Id::User(user) => Ok(user.failure()),
        _ => Ok(None),
    }
}
