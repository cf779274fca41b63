//! On which side of a joint a load acts: at the knob, as all of them do unless a model says otherwise, or at the shaft,
//! whose motion is measured.
//!
//! A bearing, a seal or an encoder disc loads the shaft, whatever the knob behind the joint does. What stands at the
//! shaft does not move the knob: its torque is added to that of the joint.

use super::{Model, Part, Slot};
use crate::effects::{Id, Place};
use crate::error::{Error, Result};
use crate::motion::{Channel, Load, Motion};
use crate::prelude::*;

/// The loads of a model as they would be on a rigid shaft, sample by sample.
#[derive(Debug, Clone)]
pub struct Rigid {
    model: Model,
    p: Vec<f64>,
    state: Vec<f64>,
}

impl Rigid {
    fn of(whole: &Model, p: &[f64], effects: &[Id]) -> Result<Self> {
        let model = whole.only(effects)?;
        let value = |slot: &Slot| whole.index(&slot.name()).map(|at| p[at]);
        let p = model.slots().iter().map(value).collect::<Result<_>>()?;
        Ok(Self { state: vec![0.0; model.states()], model, p })
    }

    /// The load at the next instant.
    pub fn load(&mut self, motion: &Motion<f64>) -> Load<f64> {
        self.model.load(&self.p, &mut self.state, motion)
    }
}

impl Model {
    /// Over which distance its friction builds up after a reversal, rad or m; none where it is there at once. A joint
    /// that gives way as far does nearly the same.
    pub fn builds_up_over(&self) -> Option<f64> {
        self.effects().filter_map(|id| self.builds_up_over_by(id)).reduce(f64::max)
    }

    /// The same of one of its effects.
    pub fn builds_up_over_by(&self, id: Id) -> Option<f64> {
        let own = self.slots.iter().filter(|slot| slot.effect == id && slot.run.is_none());
        let values: Vec<f64> = own.map(|slot| slot.value).collect();
        id.law().builds_up_over(&values)
    }

    /// Whether an effect loads the shaft and not the knob behind a joint.
    pub fn at_shaft(&self, id: Id) -> bool {
        self.shaft.contains(&id)
    }

    /// The effects that load the shaft and not the knob behind a joint.
    pub fn shafts(&self) -> &[Id] {
        &self.shaft
    }

    /// Whether an effect may load the shaft: a load that the base model does not have, that holds no knob at rest,
    /// that does not take off friction which is the knob's (what builds up late would push the shaft on), and that is no
    /// function of a user's own.
    pub fn may_be_at_shaft(id: Id) -> bool {
        let info = id.info();
        let base = info.base.is_some() || info.stores() || info.touches.contains(&Channel::Stick);
        let late = info.touches.contains(&Channel::Hysteresis);
        let inertia = info.touches.contains(&Channel::Inertia);
        info.place == Place::Load && !base && !late && !inertia && !id.calls_out()
    }

    /// The same model with an effect of it at the shaft.
    ///
    /// # Errors
    /// An effect that the model does not have or that cannot be there, or a model without a joint.
    pub fn with_at_shaft(&self, id: Id) -> Result<Self> {
        let bad = |why: &str| Err(Error::invalid(format!("effect '{}'", id.info().id), why));
        if !self.has(id) {
            return bad("is not in the model, so it cannot be at the shaft; add it first");
        }
        if !self.is_coupled() {
            return bad(
                "cannot be at the shaft where shaft and knob are one; add backlash or compliance first",
            );
        }
        if !Self::may_be_at_shaft(id) {
            return bad("cannot be at the shaft; only loads beside those of the base model can");
        }
        let mut model = self.clone();
        model.put_at_shaft(id);
        Ok(model)
    }

    /// The same model with all loads at the knob.
    ///
    /// # Errors
    /// As of [`Model::only`].
    pub fn with_all_at_knob(&self) -> Result<Self> {
        let bare = Self { shaft: Vec::new(), ..self.clone() };
        bare.only(&self.effects().collect::<Vec<_>>())
    }

    /// Takes a load from the knob to the shaft.
    pub(super) fn put_at_shaft(&mut self, id: Id) {
        let Some((_, params)) = self.parts.iter().find(|(own, _)| *own == id).cloned() else { return };
        if !self.shaft.contains(&id) {
            self.shaft.push(id);
            for loads in [&mut self.steady, &mut self.loads] {
                let (at_shaft, at_knob) = loads.drain(..).partition(|(_, own, _)| *own == params);
                *loads = at_knob;
                self.shaft_loads.extend::<Vec<_>>(at_shaft);
            }
        }
    }

    /// What loads the shaft beside the joint at one instant, as far as it pushes.
    pub fn shaft_load(&self, p: &[f64], state: &mut [f64], motion: &Motion<f64>) -> Load<f64> {
        let mut sum = Load::none();
        for (law, params, states) in &self.shaft_loads {
            let own = state.get_mut(states.clone()).unwrap_or(&mut []);
            law.load(p.get(params.clone()).unwrap_or(&[]), own, motion, &mut sum);
        }
        sum
    }

    /// The loads as they would be on a rigid shaft, over whole columns: with those at the shaft, and without.
    pub fn sides<'a>(&self, p: &'a [f64], columns: &'a [Option<usize>]) -> [Vec<Part<'a>>; 2] {
        let loads = |part: &Part<'_>| part.0.info().place == Place::Load;
        let with: Vec<Part<'a>> = self.parts(p, columns).into_iter().filter(loads).collect();
        let without = with.iter().filter(|(id, ..)| !self.at_shaft(*id)).copied().collect();
        [with, without]
    }

    /// The same, sample by sample; none where nothing is at the shaft.
    ///
    /// # Errors
    /// Parameters that are tied to what the loads do not have.
    pub fn rigid_sides(&self, p: &[f64]) -> Result<Option<[Rigid; 2]>> {
        if self.shaft.is_empty() {
            return Ok(None);
        }
        let with: Vec<Id> = self.at(Place::Load).collect();
        let without: Vec<Id> = with.iter().filter(|id| !self.at_shaft(**id)).copied().collect();
        Ok(Some([Rigid::of(self, p, &with)?, Rigid::of(self, p, &without)?]))
    }
}
