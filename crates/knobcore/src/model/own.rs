//! Effects of a user's own in a model: functions that are called beside the chain, and what failed in them.

use super::Model;
use crate::effects::{BENT, Id, User};
use crate::error::{Error, Result};
use crate::motion::{Load, Motion};
use crate::prelude::*;

impl Model {
    /// Refuses a law that the simulated motion of a knob behind a joint cannot follow.
    ///
    /// # Errors
    /// Names it, and the way out.
    pub fn check_joined(&self) -> Result<()> {
        match self.effects().find(|id| self.is_coupled() && id.bends_over_alpha()) {
            Some(id) => Err(Error::invalid(format!("effect '{}'", id.info().id), BENT)),
            None => Ok(()),
        }
    }

    /// Does work that evaluates the model, on this thread.
    ///
    /// # Errors
    /// An effect of the user's own failed in it, so that its result is void.
    pub fn watched<R>(&self, work: impl FnOnce() -> R) -> Result<R> {
        // What failed before, where nobody asked, is not this work's.
        self.failures().for_each(drop);
        let done = work();
        match self.failures().next() {
            Some((user, why)) => Err(Error::invalid(format!("effect '{}'", user.info.id), why)),
            None => Ok(done),
        }
    }

    /// Effects of the user's own that failed on this thread since this was last asked, as far as it is, and why.
    pub fn failures(&self) -> impl Iterator<Item = (&'static User, String)> + '_ {
        self.effects().filter_map(|id| match id {
            Id::User(user) => Some((user, user.failure()?)),
            _ => None,
        })
    }

    /// Brings the functions of a user's own at one instant into a load.
    pub fn own_load(&self, p: &[f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        for (id, range) in self.parts.iter().filter(|(id, _)| id.calls_out()) {
            id.law().load(p.get(range.clone()).unwrap_or(&[]), &mut [], motion, sum);
        }
    }
}
