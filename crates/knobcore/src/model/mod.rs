//! A model: effects of the catalogue with their parameter values, and which of those may move.

mod loads;
mod motor;
mod own;
mod roles;
mod runs;
mod sides;

use crate::effects::law::{Carried, Law};
use crate::effects::{Base, Id, Joint, Nonlinear, Place};
use crate::error::{Error, Result};
use crate::motion::Channel;
use crate::param::{Axis, Given, Kind, Param, Usual};
use crate::prelude::*;
use alloc::sync::Arc;
use core::ops::Range;

pub use runs::Run;
pub use sides::Rigid;

/// What the fitter may do with a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Fitted.
    Free,
    /// Kept as it is.
    Fixed,
    /// Equal to the parameter at this index.
    Tied(usize),
}

/// One parameter of a model.
#[derive(Debug, Clone)]
pub struct Slot {
    /// The effect that it belongs to.
    pub effect: Id,
    /// Its row in the catalogue.
    pub param: &'static Param,
    /// Its value, SI.
    pub value: f64,
    /// Whether the fitter may move it.
    pub role: Role,
    /// Index in the model of the first parameter of its effect.
    pub base: usize,
    /// The run whose own it is; none for what the others share.
    pub run: Option<Arc<Run>>,
}

impl Slot {
    /// `effect.parameter`, of a run's own `effect.parameter@run`.
    pub fn name(&self) -> String {
        let name = format!("{}.{}", self.effect.info().id, self.param.name);
        self.run.as_ref().map_or(name.clone(), |run| format!("{name}@{}", run.name))
    }
}

/// One effect of a chain: which, its parameters, and the column of each.
pub type Part<'a> = (Id, &'a [f64], &'a [Option<usize>]);

/// A load, where its parameters are and where what it remembers is.
type Placed = (&'static dyn Law, Range<usize>, Range<usize>);

/// An ordered chain of effects; at most one of each.
#[derive(Debug, Clone)]
pub struct Model {
    /// What a person calls it.
    pub name: String,
    /// Rotary or linear.
    pub axis: Axis,
    /// What its torques are, where they are no torques.
    pub given: Option<Given>,
    /// The captures that its values come from, as who fitted them named them; none where nobody said.
    pub fitted_to: Vec<String>,
    /// How far to both sides of zero and how fast it is turned, rad and rad/s (m and m/s); none where nobody said.
    pub reach: Option<[f64; 2]>,
    parts: Vec<(Id, Range<usize>)>,
    /// The loads but for functions of a user's own, found once for a render step: each with where its parameters and what it remembers
    /// are.
    loads: Vec<Placed>,
    /// Those of them that are the same in every motion, as far as the order of a sum does not change it.
    steady: Vec<Placed>,
    /// Those of them that load the shaft before a joint, and which effects these are.
    shaft_loads: Vec<Placed>,
    shaft: Vec<Id>,
    slots: Vec<Slot>,
    /// Whether no effect shapes the friction of others.
    plain: bool,
}

impl Model {
    /// A model of these effects at their neutral values, all parameters free.
    pub fn new(effects: &[Id], axis: Axis) -> Self {
        let mut model = Self {
            name: String::new(),
            axis,
            given: None,
            fitted_to: Vec::new(),
            reach: None,
            parts: Vec::new(),
            loads: Vec::new(),
            steady: Vec::new(),
            shaft_loads: Vec::new(),
            shaft: Vec::new(),
            slots: Vec::new(),
            plain: true,
        };
        let mut effects = effects.to_vec();
        effects.sort();
        effects.dedup();
        effects.into_iter().for_each(|id| model.push(id));
        // What comes later in the chain may count.
        for at in 0..model.slots.len() {
            model.slots[at].role = model.usual(at);
        }
        model
    }

    /// The paper's Equation 1, without or with detents.
    pub fn equation_1(axis: Axis, detents: bool) -> Self {
        let belongs = |id: &&Id| match id.info().base {
            Some(Base::Always) => true,
            Some(Base::WhereShown) => detents,
            None => false,
        };
        Self::new(&Id::BUILT_IN.iter().filter(belongs).copied().collect::<Vec<_>>(), axis)
    }

    fn push(&mut self, id: Id) {
        let base = self.slots.len();
        for param in id.info().params {
            self.slots.push(Slot {
                effect: id,
                param,
                value: param.neutral,
                role: Role::Free,
                base,
                run: None,
            });
        }
        let params = base..self.slots.len();
        if id.info().place == Place::Load && !id.calls_out() {
            let (law, first) = (id.law(), self.states());
            let beside = |(other, ..): &Placed| {
                other.info().touches.iter().any(|channel| id.info().touches.contains(channel))
            };
            let first_of_all = id.info().steady && !self.loads.iter().any(beside);
            let loads = if first_of_all { &mut self.steady } else { &mut self.loads };
            loads.push((law, params.clone(), first..first + law.states()));
        }
        self.parts.push((id, params));
        self.plain &= !id.info().shapes_friction;
    }

    /// The same model with one effect more, at its neutral values.
    pub fn with(&self, id: Id) -> Result<Self> {
        // By name: an effect of a user's own that was registered anew is another one of the same name.
        if self.effects().any(|own| own.info().id == id.info().id) {
            return Err(Error::invalid(format!("effect '{}'", id.info().id), "is in the model already"));
        }
        if let Some(needs) =
            id.info().needs.filter(|needs| !self.effects().any(|own| own.info().id == *needs))
        {
            return Err(Error::invalid(
                format!("effect '{}'", id.info().id),
                format!("changes '{needs}', which the model does not have; add that first"),
            ));
        }
        if let Some(other) = self.at(Place::Coupling).find(|_| id.info().place == Place::Coupling) {
            return Err(Error::invalid(
                format!("effect '{}'", id.info().id),
                format!("and '{}' both join shaft and knob; a model has one of them", other.info().id),
            ));
        }
        let effects: Vec<_> = self.effects().chain([id]).collect();
        let model = self.only(&effects)?;
        model.check_joined()?;
        Ok(model)
    }

    /// The same parameters, of these effects alone.
    pub fn only(&self, effects: &[Id]) -> Result<Self> {
        let mut model = Self::new(effects, self.axis);
        model.name.clone_from(&self.name);
        (model.given, model.reach) = (self.given, self.reach);
        for (at, slot) in self.slots.iter().enumerate().filter(|(_, slot)| effects.contains(&slot.effect)) {
            if let Some(run) = &slot.run {
                model.push_own(slot, run, slot.value, slot.role);
                continue;
            }
            model.copy_slot(self, slot)?;
            if matches!(slot.param.usual, Usual::Weighs(_)) && slot.role == self.usual(at) {
                let name = slot.name();
                model.set_role(&name, model.usual(model.index(&name)?))?;
            }
        }
        if model.is_coupled() {
            self.shaft.iter().filter(|id| effects.contains(id)).for_each(|id| model.put_at_shaft(*id));
        }
        Ok(model)
    }

    /// Takes over value and role of a slot of another model.
    pub fn copy_slot(&mut self, from: &Self, slot: &Slot) -> Result<()> {
        self.set(&slot.name(), slot.value)?;
        match slot.role {
            Role::Tied(to) => self.tie(&slot.name(), &from.slots[to].name()),
            role => self.set_role(&slot.name(), role),
        }
    }

    /// The effects, in the order of the catalogue.
    pub fn effects(&self) -> impl Iterator<Item = Id> + '_ {
        self.parts.iter().map(|(id, _)| *id)
    }

    /// Whether the effect is part of it.
    pub fn has(&self, id: Id) -> bool {
        self.effects().any(|own| own == id)
    }

    /// All parameters, effect by effect.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// Places of the parameters that a fit may move, in the order of [`Model::slots`].
    pub fn free(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.slots.len()).filter(|&at| self.slots[at].role == Role::Free)
    }

    /// The parameter values, in the order of [`Model::slots`].
    pub fn values(&self) -> Vec<f64> {
        self.slots.iter().map(|slot| slot.value).collect()
    }

    /// Index of the parameter `effect.parameter`.
    pub fn index(&self, name: &str) -> Result<usize> {
        self.slots.iter().position(|slot| slot.name() == name).ok_or_else(|| {
            let known: Vec<_> = self.slots.iter().map(Slot::name).collect();
            Error::invalid(
                format!("parameter '{name}'"),
                format!("is not in the model; it has {}", known.join(", ")),
            )
        })
    }

    /// Index of the inertia that the knob stores, if it has one.
    pub fn inertia(&self) -> Option<usize> {
        self.slots.iter().position(|slot| slot.effect.info().stores())
    }

    /// Index of the period of its detents over 2 pi, if it has some.
    pub fn period(&self) -> Option<usize> {
        let detents = |slot: &Slot| slot.effect.info().base == Some(Base::WhereShown);
        self.slots.iter().position(|slot| detents(slot) && slot.param.kind == Kind::Nonlinear)
    }

    /// Sets one parameter, and those tied to it.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        let at = self.index(name)?;
        let Param { lower, upper, .. } = *self.slots[at].param;
        if !(lower..=upper).contains(&value) || !value.is_finite() {
            let unit = self.unit(&self.slots[at]);
            return Err(Error::invalid(
                format!("parameter '{name}'"),
                format!(
                    "is {value}, outside of its bounds [{lower}, {upper}] {unit}; change it in the model"
                ),
            ));
        }
        self.slots[at].value = value;
        let of = Usual::Beside(at - self.slots[at].base);
        for beside in 0..self.slots.len() {
            if self.slots[beside].base == self.slots[at].base && self.slots[beside].param.usual == of {
                self.slots[beside].role = self.usual(beside);
            }
        }
        self.resolve_ties();
        Ok(())
    }

    /// All values at once, in the order of [`Model::slots`]; no bounds are checked, ties are kept.
    pub fn set_values(&mut self, values: &[f64]) {
        for (slot, value) in self.slots.iter_mut().zip(values) {
            slot.value = *value;
        }
        self.resolve_ties();
    }

    /// Numbers that its effects remember from sample to sample.
    pub fn states(&self) -> usize {
        self.effects().map(|id| id.law().states()).sum()
    }

    /// What its effects remember of a motion before the first that they see, by which friction that builds up is `bent`.
    pub fn begins(&self, bent: f64) -> Vec<f64> {
        let mut state = vec![0.0; self.states()];
        for (law, _, states) in &self.loads {
            law.bend(&mut state[states.clone()], bent);
        }
        state
    }

    /// Whether no effect shapes the friction of others: loads then simply add up.
    pub fn is_plain(&self) -> bool {
        self.plain
    }

    /// Whether its torque depends on more than the present sample.
    pub fn remembers(&self) -> bool {
        self.effects().any(|id| id.law().remembers())
    }

    /// How a parameter enters this model's torque: what is linear alone need not be so beside an effect that
    /// takes the torque through a hidden motion, a limit, or its own magnitude.
    pub fn kind(&self, slot: &Slot) -> Kind {
        let bent = self.effects().any(|id| match id.info().makes_nonlinear {
            Some(Nonlinear::Everything) => {
                let before = slot.effect.info().place == Place::Sensor && slot.effect > id;
                !before && (!self.at_shaft(slot.effect) || id.info().place != Place::Coupling)
            }
            Some(Nonlinear::ByLoad) => {
                let info = slot.effect.info();
                info.presses || info.touches.contains(&Channel::Inertia)
            }
            None => false,
        });
        if bent { Kind::Nonlinear } else { slot.param.kind }
    }

    /// The effects with their parameters, in the order of the chain.
    pub fn chain<'a>(&'a self, p: &'a [f64]) -> impl Iterator<Item = (Id, &'a [f64])> {
        self.parts.iter().map(|(id, range)| (*id, p.get(range.clone()).unwrap_or(&[])))
    }

    /// How shaft and knob are joined, if not rigidly.
    pub fn joint<T: Carried>(&self, p: &[T]) -> Option<Joint<T>> {
        self.parts.iter().find_map(|(id, range)| T::joint(id.law(), p.get(range.clone()).unwrap_or(&[])))
    }

    /// Whether shaft and knob are not one.
    pub fn is_coupled(&self) -> bool {
        self.at(Place::Coupling).next().is_some()
    }

    /// The effects with their parameters and derivative columns, in the order of the chain.
    pub fn parts<'a>(&self, p: &'a [f64], columns: &'a [Option<usize>]) -> Vec<Part<'a>> {
        let part = |(id, range): &(Id, Range<usize>)| {
            Some((*id, p.get(range.clone())?, columns.get(range.clone())?))
        };
        self.parts.iter().filter_map(part).collect()
    }

    /// The effects that act at this place of the chain.
    pub fn at(&self, place: Place) -> impl Iterator<Item = Id> + '_ {
        self.effects().filter(move |id| id.info().place == place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adding_an_effect_keeps_values_ties_and_the_original() {
        let mut model = Model::equation_1(Axis::Rotary, true);
        model.set("detent.P", 0.2).unwrap();
        model.tie("coulomb.neg", "coulomb.pos").unwrap();
        model.set("coulomb.pos", 0.5).unwrap();
        let richer = model.with(Id::Offset).unwrap();
        assert_eq!(richer.values().len(), model.values().len() + 1);
        assert_eq!(richer.slots()[richer.index("coulomb.neg").unwrap()].value, 0.5);
        assert!(!model.has(Id::Offset) && model.with(Id::Detent).is_err());
    }

    #[test]
    fn a_value_outside_of_its_bounds_is_refused_by_name() {
        let mut model = Model::equation_1(Axis::Rotary, true);
        let error = model.set("detent.P", -0.1).unwrap_err().to_string();
        assert!(error.contains("detent.P") && error.contains("rad"), "{error}");
    }
}
