//! Models of what a motor was given, where nobody measured its torque: in A, V or a duty cycle.

use super::{Model, Role, Slot};
use crate::effects::{Base, Nonlinear};
use crate::error::{Error, Result};
use crate::param::{Given, Kind, Unit};
use crate::prelude::*;

impl Model {
    /// Its units of torque and of angle.
    pub fn units(&self) -> [&'static str; 2] {
        let [torque, angle] = self.axis.units();
        [self.given.map_or(torque, Given::unit), angle]
    }

    /// Unit of a parameter, as it is printed.
    pub fn unit(&self, slot: &Slot) -> String {
        slot.param.unit.named(self.units())
    }

    /// The same model with its torques in N m (forces in N): `factor` of them make one of what the motor was given,
    /// less `back_emf` omega, N m s/rad (N s/m).
    ///
    /// # Errors
    /// A value beyond its bounds, and a back-EMF that is no term of its own.
    pub fn as_torque(&self, factor: f64, back_emf: f64) -> Result<Self> {
        let mut model = self.clone();
        model.given = None;
        model.fitted_to.clear();
        for slot in self.slots.iter().filter(|slot| !matches!(slot.role, Role::Tied(_))) {
            model.set(&slot.name(), slot.value * slot.param.unit.sized([factor, 1.0, 1.0]))?;
        }
        // To set one value may bring others of its effect into their usual role.
        model.slots.iter_mut().zip(&self.slots).for_each(|(slot, before)| slot.role = before.role);
        if back_emf == 0.0 {
            return Ok(model);
        }
        let name = if self.name.is_empty() { "the model".into() } else { format!("model '{}'", self.name) };
        model.take_off(back_emf).map_err(|why| Error::invalid(name, why))
    }

    /// Takes a torque in proportion to the speed off the term that holds it.
    fn take_off(mut self, per_speed: f64) -> core::result::Result<Self, String> {
        if let Some(id) = self.effects().find(|id| id.info().makes_nonlinear == Some(Nonlinear::Everything)) {
            let id = id.info().id;
            return Err(format!(
                "has {id}, so the back-EMF is no term of its own; convert the captures and fit again"
            ));
        }
        let held = |slot: &Slot| {
            let by_speed = slot.param.unit == Unit::of(1, -1, 1) && slot.param.kind == Kind::Linear;
            by_speed && slot.effect.info().base == Some(Base::Always)
        };
        let at: Vec<_> = (0..self.slots.len()).filter(|&at| held(&self.slots[at])).collect();
        if at.is_empty() {
            return Err("has no term in proportion to the speed, which would hold the back-EMF".into());
        }
        for at in at {
            if !matches!(self.slots[at].role, Role::Tied(_)) {
                self.slots[at].value -= per_speed;
            }
        }
        self.resolve_ties();
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    const KT: f64 = 0.05;

    fn motor(given: Given) -> Model {
        let mut model = Model::equation_1(Axis::Rotary, true);
        model.given = Some(given);
        for (name, value) in [
            ("inertia.M", 0.002),
            ("viscous.pos", 0.3),
            ("viscous.neg", 0.4),
            ("detent.A", 0.5),
            ("detent.P", 0.1),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    fn value(model: &Model, name: &str) -> f64 {
        model.slots()[model.index(name).unwrap()].value
    }

    #[test]
    fn a_torque_is_so_many_times_what_the_motor_was_given() {
        let model = motor(Given::Current);
        let other = model.as_torque(KT, 0.0).unwrap();
        assert_eq!(model.unit(&model.slots()[0]), "A s^2/rad");
        assert_eq!(other.unit(&other.slots()[0]), "N m s^2/rad");
        for (name, factor) in [("inertia.M", KT), ("viscous.neg", KT), ("detent.A", KT), ("detent.P", 1.0)] {
            assert_eq!(value(&other, name), factor * value(&model, name), "{name}");
        }
    }

    #[test]
    fn what_the_back_emf_takes_is_no_friction() {
        let other = motor(Given::Voltage).as_torque(KT, 1e-3).unwrap();
        assert_eq!(value(&other, "inertia.M"), KT * 0.002);
        assert_eq!(value(&other, "viscous.pos"), KT * 0.3 - 1e-3);
        assert_eq!(value(&other, "viscous.neg"), KT * 0.4 - 1e-3);
    }

    #[test]
    fn a_back_emf_that_is_no_term_of_its_own_is_refused() {
        let still = motor(Given::Voltage).only(&[Id::Inertia]).unwrap();
        let clipped = motor(Given::Voltage).with(Id::Saturation).unwrap();
        for (model, why) in [(&still, "no term in proportion"), (&clipped, "saturation")] {
            let error = model.as_torque(KT, 1e-3).unwrap_err().to_string();
            assert!(error.contains(why) && !error.contains('\n'), "{why}: {error}");
        }
    }
}
