//! Laws of one's own in a model file: formulas, with what is known of their parameters.
//!
//! ```toml
//! [effects.eddy_brake]
//! law = "2 a (omega/w) / (1 + (omega/w)^2)" # N m; with acts = "friction" a factor on the dry friction, with
//! # acts = "sensor" what is measured beside the torque
//! a = 0.01 # what is not said of its unit follows from the law
//! w = { value = 3.0, unit = "rad/s", lower = 0.1, upper = 100.0, meaning = "speed at which it brakes most" }
//! ```

use crate::effects::formula::written::{Acts, Asked, made};
use crate::effects::{Id, User};
use crate::error::{Error, Result};
use crate::param::{Axis, Param, Unit};
use crate::prelude::*;
use alloc::collections::BTreeMap;
use core::fmt::Write;
use toml::{Table, Value};

/// Effects of a file by their names, those with a law of its own before those of the catalogue.
pub(super) struct Own(BTreeMap<String, Id>);

impl Own {
    /// The effect of this name.
    pub fn id(&self, name: &str) -> Result<Id> {
        self.0.get(name).copied().map_or_else(|| Id::parse(name), Ok)
    }
}

/// Makes the laws of a file's effects, which only its model has; what is left of them is as of any effect.
///
/// # Errors
/// Names the law and the character, or the parameter, that is wrong.
pub(super) fn own(effects: &Table) -> Result<(Table, Own)> {
    let (mut effects, mut own) = (effects.clone(), BTreeMap::new());
    for (id, table) in effects.iter_mut() {
        let Some(table) = table.as_table_mut().filter(|table| table.contains_key("law")) else { continue };
        let bad = |key: &str, why: &str| Error::invalid(format!("'{key}' of effect '{id}'"), why);
        let word = |table: &mut Table, key: &str| match table.remove(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(_) => Err(bad(key, "must be a text in quotes")),
        };
        if !named(id) {
            return Err(Error::invalid(format!("effect '{id}'"), "must be named by letters, digits and _"));
        }
        let law = word(table, "law")?.unwrap_or_default();
        let acts = word(table, "acts")?.unwrap_or_else(|| "load".into());
        let mut asked = BTreeMap::new();
        for (name, value) in table.iter_mut() {
            let mut one = Asked::default();
            if let Some(row) = value.as_table_mut() {
                let bad = |key: &str, why: &str| {
                    Err(Error::invalid(format!("'{key}' of parameter '{id}.{name}'"), why))
                };
                match row.remove("unit") {
                    None => {}
                    Some(Value::String(text)) => one.unit = Some(Unit::parse(&text)?),
                    Some(_) => return bad("unit", "must be a text such as \"N m/rad\""),
                }
                match row.remove("meaning") {
                    None => {}
                    Some(Value::String(text)) => {
                        one.meaning = text.split_whitespace().collect::<Vec<_>>().join(" ");
                    }
                    Some(_) => return bad("meaning", "must be a text in quotes"),
                }
                for (key, bound) in ["lower", "upper"].into_iter().zip(&mut one.bounds) {
                    match row.remove(key) {
                        None => {}
                        Some(Value::Float(x)) => *bound = x,
                        Some(Value::Integer(x)) => *bound = x as f64,
                        Some(_) => return bad(key, "must be a number"),
                    }
                }
                let plain = row.get("value").filter(|_| row.len() == 1).cloned();
                *value = plain.unwrap_or_else(|| value.clone());
            }
            asked.insert(name.clone(), one);
        }
        asked.remove("at");
        own.insert(id.clone(), Id::User(made(id, &acts, &law, &asked)?));
    }
    Ok((effects, Own(own)))
}

fn named(id: &str) -> bool {
    let mut characters = id.chars();
    let first = characters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    first && characters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The law of an effect that is written as one, as lines of the file.
pub(crate) fn written(user: &User) -> Option<String> {
    let law = user.formula()?;
    let mut out = format!("law = {}\n", Value::String(law.text().to_owned()));
    match Acts::of(user.info) {
        Acts::Load => {}
        // Writing to a String cannot fail.
        acts => _ = writeln!(out, "acts = \"{}\"", acts.name()),
    }
    Some(out)
}

/// A value of a parameter of a law with all that is known of it.
pub(crate) fn with_its_own(value: &str, fixed: Option<bool>, param: &Param, axis: Axis) -> String {
    let mut row = format!("{{ value = {value}, unit = \"{}\"", param.unit.text(axis));
    // Writing to a String cannot fail.
    if let Some(fixed) = fixed {
        let _ = write!(row, ", fixed = {fixed}");
    }
    for (key, bound) in [("lower", param.lower), ("upper", param.upper)] {
        if bound.is_finite() {
            let _ = write!(row, ", {key} = {bound:?}");
        }
    }
    if param.meaning != param.name {
        let _ = write!(row, ", meaning = {}", Value::String(param.meaning.to_owned()));
    }
    row + " }"
}

#[cfg(test)]
mod tests {
    use crate::model_file::{SCHEMA, parse, write};
    use crate::motion::Motion;

    fn file(law: &str) -> String {
        format!(
            "schema = \"{SCHEMA}\"\n[effects.inertia]\nM = 1e-4\n[effects.coulomb]\nneg = 0.01\npos = 0.01\n{law}"
        )
    }

    #[test]
    fn a_law_comes_back_with_its_file_and_acts_as_it_says() {
        let text = file(
            "[effects.filed_brake]\nlaw = \"2 a (omega/w) / (1 + (omega/w)^2)\"\na = 0.5\n\
             w = { value = 3, lower = 0.1, meaning = \"fastest \\\"braking\\\"\", fixed = true }\n\
             [effects.filed_tooth]\nlaw = \"1 + h exp(-((theta - c)/b)^2)\"\nacts = \"friction\"\nh = 2\nc = 0.2\n\
             b = { value = 0.1, lower = 0.01, upper = 1.0 }\n",
        );
        let model = parse(&text).unwrap();
        let again = parse(&write(&model)).unwrap();
        assert_eq!(write(&again), write(&model));
        for model in [&model, &again] {
            let load = |theta: f64, omega: f64| {
                let load = model.load(&model.values(), &mut [], &Motion::exact(0.0, theta, omega, 0.0));
                [load.drive, load.friction_scale]
            };
            assert!((load(0.0, -3.0)[0] + 0.5).abs() < 1e-15);
            assert!((load(0.2, 1.0)[1] - 3.0).abs() < 1e-15 && (load(5.0, 1.0)[1] - 1.0).abs() < 1e-15);
            let slots = model.slots();
            let named = |name: &str| slots.iter().find(|slot| slot.name() == name).unwrap();
            assert_eq!(model.unit(named("filed_brake.w")), "rad/s");
            assert_eq!(model.unit(named("filed_tooth.c")), "rad");
            assert_eq!(named("filed_tooth.b").param.upper, 1.0);
            assert_eq!(named("filed_brake.w").param.meaning, "fastest \"braking\"");
        }
    }

    #[test]
    fn every_mistake_in_a_law_is_named_with_its_place() {
        for (law, said) in [
            (
                "[effects.x_law]\nlaw = \"a * foo(theta)\"\na = 1",
                "character 5, 'foo(theta)': 'foo' is no function",
            ),
            ("[effects.x_law]\nlaw = \"a theta\"\na = { value = 1, unit = \"N m\" }", "another unit"),
            ("[effects.x_law]\nlaw = \"a theta\"\nb = 1", "x_law.b"),
            ("[effects.x_law]\nlaw = \"a theta\"\na = { value = 1, lower = 2.0 }", "x_law.a"),
            ("[effects.x_law]\nlaw = \"a theta\"\na = { value = 1, lower = \"2\" }", "must be a number"),
            ("[effects.x_law]\nlaw = 3", "must be a text"),
            ("[effects.x_law]\nlaw = \"a theta\"\nacts = \"joint\"\na = 1", "choose load, friction, sensor"),
            ("[effects.x_law]\nlaw = \"omega\"", "no parameter"),
            ("[effects.viscous]\nlaw = \"a omega\"\na = 1", "built in"),
            ("[effects.\"x law\"]\nlaw = \"a omega\"\na = 1", "letters"),
        ] {
            let error = parse(&file(law)).unwrap_err().to_string();
            assert!(error.contains(said) && !error.contains('\n'), "{law}: {error}");
        }
    }
}
