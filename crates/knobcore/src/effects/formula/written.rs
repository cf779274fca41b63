//! A formula as an effect of the catalogue: units found, parameters that it is proportional to told from the others.

use super::powers::EXPONENTS;
use super::{Formula, Mistake, OverAlpha};
use crate::effects::law::Stated;
use crate::effects::user::{Does, User};
use crate::effects::{Info, Nonlinear, Place};
use crate::error::{Error, Result};
use crate::local::Shared;
use crate::motion::Channel;
use crate::param::{Kind, Param, Unit, Usual};
use crate::prelude::*;
use alloc::collections::BTreeMap;

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

/// Where in the chain a formula acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// A torque that the rig has to apply.
    Load,
    /// A factor on the dry friction.
    Friction,
    /// What the torque sensor reads beside the torque.
    Sensor,
}

impl Acts {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Load, Self::Friction, Self::Sensor];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Friction => "friction",
            Self::Sensor => "sensor",
        }
    }

    fn named(id: &str, word: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|acts| acts.name() == word).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            let why = format!("'{word}' is no way in which a formula acts; choose {known}");
            Error::invalid(format!("effect '{id}'"), why)
        })
    }

    /// How an effect acts that is written as a formula.
    pub fn of(info: &Info) -> Self {
        match info.place {
            Place::Sensor => Self::Sensor,
            _ if info.touches.contains(&Channel::FrictionScale) => Self::Friction,
            _ => Self::Load,
        }
    }

    /// What it answers where it changes nothing.
    fn neutral(self) -> f64 {
        f64::from(u8::from(self == Self::Friction))
    }

    /// The unit in which it answers.
    fn unit(self) -> Unit {
        if self == Self::Friction { Unit::NUMBER } else { Unit::of(1, 0, 0) }
    }

    fn place(self) -> Place {
        if self == Self::Sensor { Place::Sensor } else { Place::Load }
    }

    fn touches(self, law: &Formula) -> &'static [Channel] {
        match self {
            Self::Sensor => &[],
            Self::Friction => &[Channel::FrictionScale],
            Self::Load if law.rubs() => &[Channel::Mu, Channel::PositionShare, Channel::InertiaShare],
            Self::Load if law.over_alpha() == OverAlpha::Straight => &[Channel::Drive, Channel::Inertia],
            Self::Load => &[Channel::Drive],
        }
    }
}

/// Those that were ever made, each once, however many models have it.
static MADE: Shared<Vec<&'static User>> = Shared::new(Vec::new());

/// Registers a formula as the effect `id` of the catalogue.
///
/// # Errors
/// As of [`made`].
pub fn register(id: &str, acts: &str, text: &str, asked: &BTreeMap<String, Asked>) -> Result<&'static User> {
    let user = made(id, acts, text, asked)?;
    user.enter();
    Ok(user)
}

/// A formula as an effect `id` that only those models have which are given it.
///
/// # Errors
/// What is wrong with the law and at which character, or with what is said of its parameters.
pub fn made(id: &str, acts: &str, text: &str, asked: &BTreeMap<String, Asked>) -> Result<&'static User> {
    let acts = Acts::named(id, acts)?;
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
    let units = law.units(&known, acts.unit()).map_err(bad)?;
    if let Some((at, name)) = law.idle() {
        return Err(bad(Mistake { at, why: format!("'{name}' changes nothing; leave it out") }));
    }
    if let Some(at) = law.misloaded().or_else(|| law.loaded().filter(|_| acts != Acts::Load)) {
        let why = "a load makes friction, which is a torque in proportion to abs(load)*sign(omega)".into();
        return Err(bad(Mistake { at, why }));
    }
    let linear = if acts == Acts::Friction { Vec::new() } else { law.linear() };
    // A law that is proportional to nothing changes nothing where one of its shapes is nought, as in 1 + a x.
    let silent = if linear.is_empty() { law.silent_without(acts.neutral()) } else { None };
    let (undone, exponents) = (law.undone(), law.exponents());
    let rows: Vec<Row> = law
        .params()
        .iter()
        .zip(units)
        .enumerate()
        .map(|(at, (name, unit))| {
            let mut one = asked.get(name).cloned().unwrap_or_default();
            let unbounded = one.bounds == Asked::default().bounds;
            if unbounded && exponents.contains(&at) {
                one.bounds = EXPONENTS;
            }
            let linear = linear.contains(&at) && unbounded;
            let neutral = if linear || silent == Some(at) { 0.0 } else { 1.0_f64 };
            let neutral = neutral.max(one.bounds[0]).min(one.bounds[1]);
            // What another undoes stays as it is told.
            let usual = if undone.contains(&at) { Usual::Fixed } else { Usual::Free };
            Row { name: name.clone(), unit, linear, neutral, usual, asked: one }
        })
        .collect();
    MADE.with(|made| once(made, id, acts, law, rows))
}

/// The effect as it was made before, or made now.
fn once(
    made: &mut Vec<&'static User>,
    id: &str,
    acts: Acts,
    law: Formula,
    rows: Vec<Row>,
) -> Result<&'static User> {
    let same = |user: &&&User| {
        let rows_same = rows.len() == user.info.params.len()
            && rows.iter().zip(user.info.params).all(|(row, param)| row.is(param));
        user.info.id == id && user.formula() == Some(&law) && Acts::of(user.info) == acts && rows_same
    };
    if let Some(user) = made.iter().find(same) {
        return Ok(user);
    }
    let shown = law.text().to_owned().leak();
    let params: Vec<Param> = rows.into_iter().map(Row::param).collect();
    let id: &'static str = id.to_owned().leak();
    let own = Info::own(id, acts.place(), shown, params.leak(), acts.touches(&law));
    let makes_nonlinear = law.rubs().then_some(Nonlinear::ByLoad);
    let own = Info { source: "a formula of one's own", makes_nonlinear, ..own };
    let info: &'static Info = Box::leak(Box::new(own));
    let user = User::made(info, law.remembers(), Vec::new(), Does::Formula(Stated::new(info, law)))?;
    made.push(user);
    Ok(user)
}

/// A parameter of a formula.
struct Row {
    name: String,
    unit: Unit,
    linear: bool,
    neutral: f64,
    usual: Usual,
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
        let shape = Param::shape(self.name.leak(), self.unit, [lower, upper], self.neutral, meaning.leak());
        Param { kind, usual: self.usual, ..shape }
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
