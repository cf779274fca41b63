//! Which parameters of a model a fitter may move, and which are the same.

use super::{Model, Role, Slot};
use crate::effects::{Id, Nonlinear, Place};
use crate::error::{Error, Result};
use crate::motion::Channel;
use crate::param::{Axis, Kind, Usual};
use crate::prelude::*;

impl Model {
    /// The usual role of a parameter, by the values that the model has.
    pub(crate) fn usual(&self, at: usize) -> Role {
        match self.slots[at].param.usual {
            Usual::Free => Role::Free,
            Usual::Fixed | Usual::WherePaid(_) => Role::Fixed,
            Usual::Follows(other) => self.index(other).map_or(Role::Free, Role::Tied),
            Usual::Beside(_) => {
                if self.is_idle(at) {
                    Role::Fixed
                } else {
                    Role::Free
                }
            }
            Usual::Weighs(ways) => {
                let acts = |way| self.effects().any(|id| id.info().touches.contains(way));
                if ways.iter().all(acts) { Role::Free } else { Role::Fixed }
            }
            Usual::FreeAlong => {
                if self.axis == Axis::Linear {
                    Role::Free
                } else {
                    Role::Fixed
                }
            }
        }
    }

    /// Whether a parameter says nothing at present: one that others of its effect are beside is nought, or it is that
    /// one.
    pub fn is_idle(&self, at: usize) -> bool {
        let Slot { effect, param, base, .. } = self.slots[at];
        let beside = |of: usize| effect.info().params.iter().any(|param| param.usual == Usual::Beside(of));
        let of = match param.usual {
            Usual::Beside(of) => of,
            _ if beside(at - base) => at - base,
            _ => return false,
        };
        self.slots[base + of].value == 0.0
    }

    /// Brings parameters that say something at some values alone into the roles that are usual at the present ones.
    pub fn settle(&mut self) {
        for at in 0..self.slots.len() {
            if matches!(self.slots[at].param.usual, Usual::Beside(_)) {
                self.slots[at].role = self.usual(at);
            }
        }
    }

    /// Whether the torque's derivative by a parameter stays as it is while the free parameters change: linear, of an effect
    /// whose free parameters all are, and no joint, sensor or friction between it and the torque that others shape.
    pub fn lasts(&self, at: usize) -> bool {
        let direct = |place| self.at(place).next().is_none();
        let by_load = self.effects().any(|id| id.info().makes_nonlinear == Some(Nonlinear::ByLoad));
        let own = |other: usize| other == at || self.slots[other].role == Role::Tied(at);
        let mut effects =
            (0..self.slots.len()).filter(|other| own(*other)).map(|other| self.slots[other].effect);
        direct(Place::Coupling) && direct(Place::Sensor) && !by_load && effects.all(|id| self.adds_up(id))
    }

    /// Whether an effect of the catalogue adds to the torque, linearly in all that it has free.
    fn adds_up(&self, id: Id) -> bool {
        let adds = |channel: &Channel| match channel {
            Channel::Drive | Channel::Inertia | Channel::NormalLoad | Channel::PositionLoad => true,
            Channel::Back | Channel::Forth => self.plain,
            _ => false,
        };
        let mut free = self.slots.iter().filter(|slot| slot.effect == id && slot.role != Role::Fixed);
        let linear = free.all(|slot| slot.param.kind == Kind::Linear);
        linear && !matches!(id, Id::User(_)) && id.info().touches.iter().all(adds)
    }

    /// Frees or fixes one parameter.
    pub fn set_role(&mut self, name: &str, role: Role) -> Result<()> {
        let at = self.index(name)?;
        self.slots[at].role = role;
        Ok(())
    }

    /// Makes one parameter equal to another, from now on.
    pub fn tie(&mut self, name: &str, to: &str) -> Result<()> {
        let (at, target) = (self.index(name)?, self.index(to)?);
        let bad = |why: &str| {
            Err(Error::invalid(format!("parameter '{name}'"), format!("cannot be tied to '{to}': {why}")))
        };
        if at == target {
            return bad("that is itself");
        }
        if matches!(self.slots[target].role, Role::Tied(_)) {
            return bad("that one is tied too; tie both to the same parameter");
        }
        if self.slots[at].param.unit != self.slots[target].param.unit {
            return bad("their units differ");
        }
        if self.slots[at].param.kind != self.slots[target].param.kind {
            return bad("they enter the torque in different ways");
        }
        self.slots[at].role = Role::Tied(target);
        self.resolve_ties();
        Ok(())
    }

    pub(super) fn resolve_ties(&mut self) {
        for at in 0..self.slots.len() {
            if let Role::Tied(to) = self.slots[at].role {
                self.slots[at].value = self.slots[to].value;
            }
        }
    }
}
