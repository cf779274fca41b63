//! A formula as an effect of the catalogue: units found, parameters that it is proportional to told from the others.

use super::{Formula, Mistake};
use crate::effects::user::{Does, User};
use crate::effects::{Info, Place, Survey};
use crate::error::{Error, Result};
use crate::motion::Channel;
use crate::param::{Kind, Param, Unit};
use std::collections::HashMap;

/// What is known of a parameter of a formula before it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Its unit; what is not said follows from the law.
    pub unit: Option<Unit>,
    /// Bounds of its values.
    pub bounds: [f64; 2],
    /// What it is, in a few words.
    pub meaning: String,
}

impl Default for Asked {
    fn default() -> Self {
        Self { unit: None, bounds: [f64::NEG_INFINITY, f64::INFINITY], meaning: String::new() }
    }
}

/// How a formula acts, by its word.
const LOAD: &str = "load";
/// As a factor on the dry friction.
const FRICTION: &str = "friction";
/// Starts of a search at most.
const STARTS: usize = 27;

/// Registers a formula as the effect `id`, a load or a factor on the friction; the same one is registered once.
///
/// # Errors
/// What is wrong with the law and at which character, or with what is said of its parameters.
pub fn register(id: &str, acts: &str, text: &str, asked: &HashMap<String, Asked>) -> Result<&'static User> {
    let (answer, channel): (_, &'static [Channel]) = match acts {
        LOAD => (Unit::of(1, 0, 0), &[Channel::Drive]),
        FRICTION => (Unit::NUMBER, &[Channel::FrictionScale]),
        _ => {
            let why = format!("'{acts}' is no way in which a formula acts; choose {LOAD} or {FRICTION}");
            return Err(Error::invalid(format!("effect '{id}'"), why));
        }
    };
    let bad = |mistake: Mistake| Error::invalid(format!("law of effect '{id}'"), marked(text, &mistake));
    let law = Formula::parse(text).map_err(bad)?;
    if let Some(unknown) = asked.keys().find(|name| !law.params().contains(name)) {
        let why = format!("is no parameter of its law; it has {}", law.params().join(", "));
        return Err(Error::invalid(format!("parameter '{id}.{unknown}'"), why));
    }
    if law.params().is_empty() {
        let why = "has no parameter, so nothing of it could be fitted; give it one";
        return Err(Error::invalid(format!("law of effect '{id}'"), why));
    }
    let known = asked.iter().filter_map(|(name, one)| Some((name.as_str(), one.unit?))).collect();
    let units = law.units(&known, answer).map_err(bad)?;
    let linear = if acts == LOAD { law.linear() } else { Vec::new() };
    let rows: Vec<Row> = law
        .params()
        .iter()
        .zip(units)
        .enumerate()
        .map(|(at, (name, unit))| {
            let one = asked.get(name).cloned().unwrap_or_default();
            let unbounded = one.bounds == Asked::default().bounds;
            Row { name: name.clone(), unit, linear: linear.contains(&at) && unbounded, asked: one }
        })
        .collect();
    if let Some(user) = User::known(id)
        && user.formula() == Some(&law)
        && user.info.touches == channel
        && rows.len() == user.info.params.len()
        && rows.iter().zip(user.info.params).all(|(row, param)| row.is(param))
    {
        return Ok(user);
    }
    let shown = law.text().to_owned().leak();
    let params: Vec<Param> = rows.into_iter().map(Row::param).collect();
    let id: &'static str = id.to_owned().leak();
    let own = Info::own(id, Place::Load, shown, params.leak(), channel);
    let info = Info { source: "a formula of one's own", ..own };
    User::register(info, false, Vec::new(), Does::Formula(law))
}

/// A parameter of a formula.
struct Row {
    name: String,
    unit: Unit,
    linear: bool,
    asked: Asked,
}

impl Row {
    fn kind(&self) -> Kind {
        if self.linear { Kind::Linear } else { Kind::Nonlinear }
    }

    fn meaning(&self) -> &str {
        if self.asked.meaning.is_empty() { &self.name } else { &self.asked.meaning }
    }

    fn is(&self, param: &Param) -> bool {
        let bounds = self.asked.bounds == [param.lower, param.upper];
        let same = self.name == param.name && self.unit == param.unit && self.kind() == param.kind;
        same && bounds && self.meaning() == param.meaning
    }

    fn param(self) -> Param {
        let (kind, meaning) = (self.kind(), self.meaning().to_owned());
        let [lower, upper] = self.asked.bounds;
        let neutral = if self.linear { 0.0 } else { 1.0_f64.clamp(lower, upper) };
        let shape = Param::shape(self.name.leak(), self.unit, [lower, upper], neutral, meaning.leak());
        Param { kind, ..shape }
    }
}

/// What is wrong with a law, with the place marked.
fn marked(text: &str, mistake: &Mistake) -> String {
    let rest: String = text.chars().skip(mistake.at).take(20).collect();
    let place = if rest.is_empty() {
        "at its end".into()
    } else {
        format!("at character {}, '{rest}'", mistake.at + 1)
    };
    format!("{place}: {}", mistake.why)
}

/// Parameter values to start a search from: shapes at a part of what the motion goes through, by their units.
pub(crate) fn starts(params: &[Param], survey: &Survey) -> Vec<Vec<f64>> {
    let speed = |q| Survey::quantile(&survey.speed, q).max(1e-6);
    let scales =
        [Survey::quantile(&survey.torque, 0.5), survey.range(), survey.duration_s].map(|x| x.max(1e-9));
    let sizes = |param: &Param| match param.unit.powers() {
        _ if param.kind == Kind::Linear => vec![0.0],
        [0, 1, -1] => vec![speed(0.2), speed(0.5), speed(0.9)],
        [0, 0, 0] => vec![1.0, 2.0],
        _ => [0.1, 0.4].map(|share| param.unit.sized(scales.map(|size| share * size))).to_vec(),
    };
    let mut all = vec![Vec::new()];
    for param in params {
        let sizes = sizes(param);
        let sizes = if all.len() * sizes.len() > STARTS { &sizes[..1] } else { &sizes[..] };
        let within = |x: &f64| x.clamp(param.lower, param.upper);
        all = all
            .iter()
            .flat_map(|before| sizes.iter().map(|x| [&before[..], &[within(x)]].concat()).collect::<Vec<_>>())
            .collect();
    }
    all
}
