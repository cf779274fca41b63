//! A model of what its file says.

use super::{FORCED, SCHEMA, SHAFT, checked_reach, laws, of_number};
use crate::error::{Error, Result};
use crate::model::{Model, Role, Run};
use crate::param::{Axis, Given, Usual};
use crate::prelude::*;
use alloc::sync::Arc;
use toml::{Table, Value};

const KEYS: [&str; 8] = ["schema", FORCED, "name", "axis", "torque_unit", "fitted_to", "reach", "effects"];

/// A parameter and the one that it is always equal to, by their names.
type Tie = (String, String);

/// Reads a model.
///
/// # Errors
/// Names the line, the effect or the parameter that is wrong.
pub fn parse(text: &str) -> Result<Model> {
    let file = read_file(text)?;
    let axis = read_axis(file.get("axis"))?;
    let given = file.get("torque_unit").map(read_given).transpose()?;
    let effects = file.get("effects").and_then(Value::as_table).filter(|table| !table.is_empty());
    let effects =
        effects.ok_or_else(|| bad("effects", "are missing; add a table such as [effects.inertia]"))?;
    let (effects, own) = &laws::own(effects)?;
    let ids = effects.keys().map(|id| own.id(id)).collect::<Result<Vec<_>>>()?;
    let mut model = Model::new(&ids, axis);
    model.check_joined()?;
    model.given = given;
    model.name = file.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    if let Some(captures) = file.get("fitted_to") {
        model.fitted_to = read_captures(captures)?;
    }
    model.reach = file.get("reach").map(read_reach).transpose()?;
    let mut ties = Vec::new();
    for (id, params) in effects {
        if let Some(at) = params.get("at") {
            let why = "must be \"shaft\"; leave it out where the effect acts on the knob";
            at.as_str()
                .filter(|at| *at == SHAFT)
                .ok_or_else(|| bad(&format!("'at' of effect '{id}'"), why))?;
            model = model.with_at_shaft(own.id(id)?)?;
        }
        ties.extend(read_params(&mut model, id, params)?);
    }
    for (name, target) in ties {
        if model.index(&target).is_err() {
            let why = format!(
                "is tied to '{target}', which is no parameter of this model; write a number or one of its names"
            );
            return Err(bad(&format!("parameter '{name}'"), &why));
        }
        model.tie(&name, &target)?;
    }
    Ok(model)
}

fn bad(name: &str, why: &str) -> Error {
    Error::invalid(name, why)
}

/// The text as a table of this version, in which nothing is unknown.
fn read_file(text: &str) -> Result<Table> {
    let file: Table = text.parse().map_err(|e: toml::de::Error| {
        let line = e.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
        bad(&format!("line {line}"), &format!("is no TOML: {}", e.message().replace('\n', " ")))
    })?;
    match file.get("schema").and_then(Value::as_str) {
        Some(SCHEMA) => {}
        Some(other) => {
            let kind = SCHEMA.split('/').next().unwrap_or(SCHEMA);
            let newer = other.split('/').next() == Some(kind);
            let way_out = if newer { "update knobcam" } else { "name a model file" };
            return Err(bad(
                "schema",
                &format!("is '{other}', and this version reads '{SCHEMA}'; {way_out}"),
            ));
        }
        None => {
            let why = format!("is missing, so this is no model file; write schema = \"{SCHEMA}\" on top");
            return Err(bad("schema", &why));
        }
    }
    if let Some(unknown) = file.keys().find(|key| !KEYS.contains(&key.as_str())) {
        let why =
            "is no key of a model file; it has schema, name, axis, torque_unit, fitted_to, reach and effects";
        return Err(bad(&format!("'{unknown}'"), why));
    }
    if file.get(FORCED).is_some_and(|forced| forced.as_bool().is_none()) {
        return Err(bad(FORCED, "must be true or false; leave it out of what you write by hand"));
    }
    Ok(file)
}

fn read_axis(value: Option<&Value>) -> Result<Axis> {
    match value.map(Value::as_str) {
        None | Some(Some("rotary")) => Ok(Axis::Rotary),
        Some(Some("linear")) => Ok(Axis::Linear),
        Some(other) => {
            let other = other.unwrap_or("no text");
            Err(bad("axis", &format!("is '{other}'; it must be \"rotary\" or \"linear\"")))
        }
    }
}

/// What stands for the torque, by its unit.
fn read_given(unit: &Value) -> Result<Given> {
    Given::ALL.into_iter().find(|given| Some(given.unit()) == unit.as_str()).ok_or_else(|| {
        let why = "must be \"A\", \"V\" or \"duty\"; leave it out where torques are in N m, forces in N";
        Error::invalid("torque_unit", why)
    })
}

/// The captures that a model was fitted to.
fn read_captures(value: &Value) -> Result<Vec<String>> {
    let names = value.as_array().into_iter().flatten().map(|one| one.as_str().map(str::to_owned));
    names.collect::<Option<Vec<_>>>().filter(|names| !names.is_empty()).ok_or_else(|| {
        bad("fitted_to", "must be a list of texts, one for each capture; leave it out if unknown")
    })
}

/// How far and how fast a model is turned.
fn read_reach(value: &Value) -> Result<[f64; 2]> {
    let numbers = value.as_array().into_iter().flatten().map(number).collect::<Option<Vec<_>>>();
    let given: Option<[f64; 2]> = numbers.and_then(|numbers| numbers.try_into().ok());
    given.map_or_else(|| checked_reach([f64::NAN; 2]), checked_reach)
}

/// Reads the parameters of an effect; those that are tied may name one that is not read yet.
fn read_params(model: &mut Model, id: &str, params: &Value) -> Result<Vec<Tie>> {
    let params =
        params.as_table().ok_or_else(|| bad(&format!("effect '{id}'"), "must be a table of parameters"))?;
    let mut params: Vec<_> = params
        .iter()
        .filter(|(key, _)| *key != "at")
        .map(|(param, value)| (format!("{id}.{param}"), value))
        .collect();
    for (name, _) in params.iter_mut().filter(|(name, _)| name.contains('@')) {
        *name = read_own(model, name)?;
    }
    // What they are fitted beside says first whether they are.
    let beside = |name: &str| {
        let at = model.index(name)?;
        Ok(matches!(model.slots()[at].param.usual, Usual::Beside(_)))
    };
    for name in params.iter().map(|(name, _)| name) {
        beside(name)?;
    }
    params.sort_by_key(|(name, _)| beside(name).unwrap_or(false));
    let mut ties = Vec::new();
    for (name, value) in params {
        if let Some(target) = value.as_str() {
            ties.push((name, target.to_owned()));
        } else {
            read_param(model, &name, value)?;
        }
    }
    Ok(ties)
}

/// Gives a capture a parameter for itself, `effect.parameter@NAME FINGERPRINT`; the name that it then has.
fn read_own(model: &mut Model, key: &str) -> Result<String> {
    let bad = |why: &str| Error::invalid(format!("parameter '{key}'"), why);
    let (shared, run) = key.split_once('@').unwrap_or((key, ""));
    let at = model.index(shared)?;
    if !model.slots()[at].param.of_a_run {
        return Err(bad("is one of the knob, the same in every capture; leave out what follows the @"));
    }
    let (name, fingerprint) = run
        .rsplit_once(' ')
        .filter(|(name, fingerprint)| !name.is_empty() && !fingerprint.is_empty())
        .ok_or_else(|| bad("must name its capture as fitted_to does, PARAMETER@NAME FINGERPRINT"))?;
    let run = Arc::new(Run { name: name.to_owned(), fingerprint: fingerprint.to_owned() });
    let like = model.slots()[at].clone();
    model.push_own(&like, &run, like.value, Role::Free);
    Ok(format!("{shared}@{name}"))
}

/// A number, or a table of value and fixed.
fn read_param(model: &mut Model, name: &str, value: &Value) -> Result<()> {
    let bad = || {
        let why =
            "must be a number, the name of another parameter in quotes, or { value = NUMBER, fixed = true }";
        Error::invalid(format!("parameter '{name}'"), why)
    };
    // Whatever is written here is no tie, not even the usual one.
    model.set_role(name, of_number(model, model.index(name)?))?;
    let Some(table) = value.as_table() else { return model.set(name, number(value).ok_or_else(bad)?) };
    for (key, value) in table {
        match (key.as_str(), value) {
            ("value", value) => model.set(name, number(value).ok_or_else(bad)?)?,
            ("fixed", Value::Boolean(fixed)) => {
                model.set_role(name, if *fixed { Role::Fixed } else { Role::Free })?
            }
            _ => return Err(bad()),
        }
    }
    Ok(())
}

/// A number, whole or not.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(*x),
        Value::Integer(x) => Some(*x as f64),
        _ => None,
    }
}
