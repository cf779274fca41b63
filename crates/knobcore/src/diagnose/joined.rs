//! One joint for another, with the values that both have.

use crate::effects::{Id, Place};
use crate::fit::loads;
use crate::model::{Model, Slot};

/// What a model's coupling joins, joined by another.
pub fn joined_by(model: &Model, other: Id) -> Option<Model> {
    model.shafts().iter().try_fold(loads(model).with(other).ok()?, |with, id| with.with_at_shaft(*id).ok())
}

/// A model with the values of another, and its coupling's with those that go by the same names in the other's.
pub fn joined_as(model: &Model, other: &Model) -> Model {
    let mut joined = model.clone();
    let joins = |slot: &&Slot| slot.effect.info().place == Place::Coupling;
    for slot in model.slots() {
        let same = other.slots().iter().find(|from| from.name() == slot.name());
        let like = || other.slots().iter().filter(joins).find(|from| from.param.name == slot.param.name);
        let from = same.or_else(|| if joins(&slot) { like() } else { None });
        if let Some(from) = from {
            // The other's bounds may be wider; the name is its own.
            let _ = joined.set(&slot.name(), from.value.clamp(slot.param.lower, slot.param.upper));
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::knob;
    use super::*;

    #[test]
    fn a_gap_that_closed_is_a_start_of_compliance_with_its_stiffness_and_share() {
        let closed =
            [("backlash.gap", 0.0), ("backlash.k", 45.0), ("backlash.d", 1e-3), ("backlash.share", 0.6)];
        let gap = knob(&[Id::Backlash], &[&closed[..], &[("inertia.M", 5e-5)]].concat());
        let soft = joined_as(&knob(&[Id::Compliance], &[("compliance.k", 7.0), ("inertia.M", 1e-4)]), &gap);
        let value = |name: &str| soft.slots()[soft.index(name).unwrap()].value;
        let names = ["compliance.k", "compliance.d", "compliance.share", "inertia.M"];
        assert_eq!(names.map(value), [45.0, 1e-3, 0.6, 5e-5]);
    }
}
