//! The model file: TOML that a person can read and edit, exact to the last bit.
//!
//! ```toml
//! schema = "knobcam.model/1"
//! name = "knob 4"
//! axis = "rotary"
//! reach = [1.5, 5.0] # rad to both sides of zero and rad/s in which it is turned
//!
//! [effects.coulomb]
//! neg = "coulomb.pos" # tied: always equal to that one
//! pos = { value = 0.02, fixed = true } # not fitted
//!
//! [effects.offset]
//! tau0 = 0.001
//! "tau0@second.npz 0f1e2d" = 0.003 # what one of several captures has for itself: its name and its fingerprint
//!
//! [effects.quadratic_drag]
//! at = "shaft" # before the joint of shaft and knob, not behind it
//! d = 1e-5
//! ```

mod laws;
mod read;

pub use read::parse;

use crate::effects::{Id, Place};
use crate::error::{Error, Result};
use crate::model::{Model, Role};
use crate::param::{Axis, Usual};
use crate::prelude::*;
use core::fmt::Write;
use toml::{Table, Value};

/// The version of the file that is written and read.
pub const SCHEMA: &str = "knobcam.model/1";

/// Where a load acts that does not act on the knob.
const SHAFT: &str = "shaft";

/// The furthest and the fastest that a model may be declared for; rad and rad/s, m and m/s.
pub const MOST_REACH: [f64; 2] = [200.0, 100.0];

/// Says to a device that a person wants a model rendered that nobody vouches for.
const FORCED: &str = "forced";

/// Whether a model file is to be rendered though it may feed a hand; it is no part of the model.
pub fn is_forced(text: &str) -> bool {
    let file = text.parse::<Table>();
    file.is_ok_and(|file| file.get(FORCED).and_then(Value::as_bool) == Some(true))
}

/// Refuses an angle and a speed in which no knob is turned.
///
/// # Errors
/// Says what they may be.
pub fn checked_reach(reach: [f64; 2]) -> Result<[f64; 2]> {
    if reach.iter().zip(MOST_REACH).all(|(own, most)| *own > 0.0 && *own <= most) {
        return Ok(reach);
    }
    let [angle, speed] = MOST_REACH;
    let why = format!(
        "must be an angle above 0 and up to {angle} rad (m) and a speed up to {speed} rad/s (m/s), as [6.3, 5.0]"
    );
    Err(Error::invalid("reach", why))
}

/// What a plain number makes of a parameter: one that is usually fixed, or beside such effects, needs no mark.
fn of_number(model: &Model, at: usize) -> Role {
    match model.slots()[at].param.usual {
        Usual::Fixed | Usual::WherePaid(_) => Role::Fixed,
        Usual::Weighs(_) => model.usual(at),
        _ => Role::Free,
    }
}

/// A key of any text, which no key may have over several lines.
fn quoted(key: &str) -> String {
    let line = Table::from_iter([(key.to_owned(), Value::Boolean(true))]).to_string();
    line.trim_end().trim_end_matches(" = true").to_owned()
}

/// Writes a model; [`parse`] gives the same one back.
pub fn write(model: &Model) -> String {
    let axis = if model.axis == Axis::Linear { "linear" } else { "rotary" };
    let mut out = format!("schema = \"{SCHEMA}\"\n");
    if !model.name.is_empty() {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(out, "name = {}", Value::String(model.name.clone()));
    }
    let _ = writeln!(out, "axis = \"{axis}\"");
    if let Some(given) = model.given {
        let _ = writeln!(out, "torque_unit = \"{}\"", given.unit());
    }
    if let Some([angle, speed]) = model.reach {
        let units = if model.axis == Axis::Linear { "m, m/s" } else { "rad, rad/s" };
        let _ = writeln!(out, "reach = [{angle:?}, {speed:?}] # {units}: how far to both sides, how fast");
    }
    if !model.fitted_to.is_empty() {
        let names = model.fitted_to.iter().cloned().map(Value::String).collect();
        let _ = writeln!(out, "fitted_to = {}", Value::Array(names));
    }
    for place in [Place::Coupling, Place::Load, Place::Sensor] {
        for id in model.at(place) {
            let info = id.info();
            let law = if let Id::User(user) = id { laws::written(user) } else { None };
            // A law of its own has a line.
            let said = if law.is_none() { format!(" # {}", info.law) } else { String::new() };
            let _ = write!(out, "\n[effects.{}]{said}\n", info.id);
            if model.at_shaft(id) {
                let _ = writeln!(out, "at = {SHAFT:?} # not on the knob behind the joint");
            }
            out.push_str(law.as_deref().unwrap_or_default());
            let own = model.slots().iter().enumerate().filter(|(_, slot)| slot.effect == id);
            for (at, slot) in own.filter(|(at, _)| !model.is_idle(*at)) {
                let value = match slot.role {
                    Role::Tied(to) => format!("{:?}", model.slots()[to].name()),
                    _ => format!("{:?}", slot.value),
                };
                let value = match slot.role {
                    role if law.is_some() => {
                        // A held one says so though it usually is.
                        let fixed = role == Role::Fixed;
                        let said = fixed || of_number(model, at) == Role::Fixed;
                        laws::with_its_own(&value, said.then_some(fixed), slot.param, model.axis)
                    }
                    Role::Tied(_) => value,
                    role if role == of_number(model, at) => value,
                    role => format!("{{ value = {value}, fixed = {} }}", role == Role::Fixed),
                };
                let (name, unit) = (slot.param.name, model.unit(slot));
                let _ = match &slot.run {
                    Some(run) => {
                        let key = quoted(&format!("{name}@{} {}", run.name, run.fingerprint));
                        writeln!(out, "{key} = {value} # {unit}, of this capture alone")
                    }
                    None => writeln!(out, "{name} = {value} # {unit}, {}", slot.param.meaning),
                };
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Run;
    use crate::param::Given;

    fn example() -> Model {
        let mut model = Model::new(Id::BUILT_IN, Axis::Linear);
        model.name = "a \"quoted\" name\nof two lines".into();
        model.given = Some(Given::Voltage);
        model.reach = Some([0.1 + 0.2, 3.0]);
        model.fitted_to = vec!["one.npz 0f".into(), "a \"b\", c\n.csv 1a".into()];
        model.set("inertia.M", 0.1 + 0.2).unwrap();
        model.set("detent.P", 1.0 / 3.0).unwrap();
        model.set("coulomb.pos", 5e-324).unwrap();
        model.set_role("detent.P", Role::Fixed).unwrap();
        model.set_role("karnopp.D_pos", Role::Free).unwrap();
        model.set_role("directional_detent.P", Role::Free).unwrap();
        model.set("directional_detent.P", 0.3).unwrap();
        model.tie("coulomb.neg", "coulomb.pos").unwrap();
        let run = |name: &str, fingerprint: &str| Run { name: name.into(), fingerprint: fingerprint.into() };
        let (first, second) = (run("one.npz", "0f"), run("a \"b\", c\n@ 2.csv", "1a"));
        let mut model = model.apart(Id::Offset, &[&first, &second]).unwrap();
        model.set(&format!("offset.tau0@{}", second.name), 0.1 + 0.7).unwrap();
        model
    }

    #[test]
    fn a_model_comes_back_exactly() {
        let model = example();
        let back = parse(&write(&model)).unwrap();
        assert_eq!(back.name, model.name);
        assert_eq!((back.axis, back.given, &back.fitted_to), (model.axis, model.given, &model.fitted_to));
        assert_eq!(back.reach, model.reach);
        for (a, b) in model.slots().iter().zip(back.slots()) {
            assert_eq!((a.name(), a.value.to_bits(), a.role), (b.name(), b.value.to_bits(), b.role));
        }
        assert_eq!(write(&back), write(&model));
    }

    #[test]
    fn a_model_without_a_name_has_none_in_its_file() {
        let mut model = example();
        model.name.clear();
        let text = write(&model);
        assert!(!text.contains("name ="), "{text}");
        assert_eq!(parse(&text).unwrap().name, "");
    }

    #[test]
    fn every_mistake_is_named_with_the_way_out() {
        let head = format!("schema = \"{SCHEMA}\"\n");
        for (text, name, way) in [
            ("[effects", "line 1", "TOML"),
            ("name = \"x\"", "schema", "write schema"),
            ("schema = \"knobcam.model/99\"", "knobcam.model/99", "update"),
            (&format!("{head}[effects.warp]\nx = 1"), "warp", "inertia"),
            (&format!("{head}[effects.inertia]\nN = 1"), "inertia.N", "inertia.M"),
            (&format!("{head}[effects.inertia]\nM = true"), "inertia.M", "number"),
            (&format!("{head}[effects.detent]\nP = -1"), "detent.P", "bounds"),
            (&format!("{head}[effects.detent]\nP = nan"), "detent.P", "bounds"),
            (&format!("{head}[effects.coulomb]\nneg = \"coulomb.up\""), "coulomb.neg", "coulomb.up"),
            (&format!("{head}[effects.coulomb]\nneg = \"coulomb.neg\""), "coulomb.neg", "itself"),
            (&format!("{head}speed = 1\n[effects.inertia]"), "speed", "axis"),
            (&format!("{head}fitted_to = 3\n[effects.inertia]"), "fitted_to", "leave it out"),
            (&format!("{head}fitted_to = [3]\n[effects.inertia]"), "fitted_to", "list of texts"),
            (&format!("{head}reach = 3\n[effects.inertia]"), "reach", "[6.3, 5.0]"),
            (&format!("{head}reach = [inf, 5]\n[effects.inertia]"), "reach", "above 0"),
            (&format!("{head}axis = \"round\"\n[effects.inertia]"), "axis", "rotary"),
            (&format!("{head}torque_unit = \"N cm\"\n[effects.inertia]"), "torque_unit", "leave it out"),
            (&format!("{head}[effects.viscous]\n\"pos@a.npz 0f\" = 1"), "viscous.pos", "leave out"),
            (&format!("{head}[effects.offset]\n\"tau0@a.npz\" = 1"), "tau0@a.npz", "FINGERPRINT"),
            (&head, "effects", "[effects.inertia]"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(
                error.contains(name) && error.contains(way) && !error.contains('\n'),
                "{text} -> {error}"
            );
        }
    }
}
