//! Several runs of one knob: the physics is the same in all, and what belongs to a run may have a value in each.
//!
//! The parameters that a run has for itself follow those that all share, which they stand in for wherever that run is
//! evaluated. The first run of a fit, and any that the model does not know, have the shared ones.

use super::{Model, Role, Slot};
use crate::effects::Id;
use crate::prelude::*;
use alloc::borrow::Cow;
use alloc::sync::Arc;
use core::ops::Range;

/// One run of a knob, as whoever recorded it knows it again.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Run {
    /// What a person calls it.
    pub name: String,
    /// What no other run has; empty where nobody said.
    pub fingerprint: String,
}

impl Run {
    fn is(&self, other: &Self) -> bool {
        !self.fingerprint.is_empty() && self.fingerprint == other.fingerprint
    }
}

/// A run under a name that no other of them has.
fn named(runs: &[&Run], number: usize) -> Run {
    let Run { name, fingerprint } = runs[number].clone();
    let alike = runs.iter().filter(|other| other.name == name).count();
    let name = match (name.is_empty(), alike) {
        (true, _) => format!("capture {}", number + 1),
        (false, 1) => name,
        (false, _) => format!("{name} ({})", number + 1),
    };
    Run { name, fingerprint }
}

impl Model {
    /// The parameters that a run has for itself, each with the shared one that it stands in for.
    fn own<'a>(&'a self, run: &'a Run) -> impl Iterator<Item = (usize, usize)> + 'a {
        let is = |slot: &Slot| slot.run.as_ref().is_some_and(|own| own.is(run));
        (0..self.slots.len()).filter(move |&at| is(&self.slots[at])).map(|at| (at, self.shared(at)))
    }

    /// Index of the shared parameter that one stands in for; of a shared one its own.
    pub fn shared(&self, at: usize) -> usize {
        let Slot { effect, param, base, ref run, .. } = self.slots[at];
        let place = effect.info().params.iter().position(|other| other.name == param.name);
        if run.is_some() { base + place.unwrap_or(0) } else { at }
    }

    /// Parameters as one run has them.
    pub fn of_run<'a>(&self, run: &Run, p: &'a [f64]) -> Cow<'a, [f64]> {
        let mut p = Cow::from(p);
        for (own, shared) in self.own(run) {
            p.to_mut()[shared] = p[own];
        }
        p
    }

    /// Parameters and their columns as one run has them.
    pub fn in_run<'a>(
        &self,
        run: &Run,
        p: &'a [f64],
        columns: &'a [Option<usize>],
    ) -> (Cow<'a, [f64]>, Cow<'a, [Option<usize>]>) {
        let mut columns = Cow::from(columns);
        for (own, shared) in self.own(run) {
            columns.to_mut()[shared] = columns[own];
        }
        (self.of_run(run, p), columns)
    }

    /// Whether runs have parameters of this effect for themselves.
    pub fn is_apart(&self, id: Id) -> bool {
        self.slots.iter().any(|slot| slot.effect == id && slot.run.is_some())
    }

    /// The model in which each run but the first has for itself what may be a run's own: of an effect, and of those
    /// that every run may have beside it. None where that is nothing, or the runs are not told apart.
    pub fn apart(&self, id: Id, runs: &[&Run]) -> Option<Self> {
        let told = |at: usize| {
            runs[..at].iter().all(|other| !runs[at].fingerprint.is_empty() && !other.is(runs[at]))
        };
        if runs.len() < 2 || !(0..runs.len()).all(told) {
            return None;
        }
        let mut model = self.clone();
        for own in Id::BUILT_IN.iter().filter(|own| **own == id || own.info().every_run) {
            model.part(*own, runs);
        }
        (model.is_apart(id) && !self.is_apart(id)).then_some(model)
    }

    fn part(&mut self, id: Id, runs: &[&Run]) {
        if self.is_apart(id) {
            return;
        }
        if !self.has(id) {
            // What nothing else takes up is an effect that can be found missing.
            let free = |name: &&str| self.index(name).is_ok_and(|at| self.slots[at].role == Role::Free);
            let taken_up = id.info().taken_up.is_some_and(|others| others.by.iter().all(free));
            let Some(with) = self.with(id).ok().filter(|_| taken_up) else { return };
            *self = with;
            // In the first run the others hold it: those that come after are told from that one.
            self.of_shared(id).for_each(|at| self.slots[at].role = Role::Fixed);
        }
        let tied = |at: usize| self.slots.iter().any(|slot| slot.role == Role::Tied(at));
        let parted: Vec<usize> = self
            .of_shared(id)
            .filter(|&at| self.slots[at].param.of_a_run && !tied(at))
            .filter(|&at| self.slots[at].role == Role::Free || self.is_silent(at))
            .collect();
        for number in 1..runs.len() {
            let run = Arc::new(named(runs, number));
            for &at in &parted {
                let like = self.slots[at].clone();
                self.push_own(&like, &run, like.value, Role::Free);
            }
        }
    }

    /// The model in which all runs share an effect; one that does nothing then goes.
    pub fn together(&self, id: Id) -> Self {
        let mut model = self.clone();
        model.slots.retain(|slot| slot.effect != id || slot.run.is_none());
        let silent = id.info().every_run && model.of_shared(id).all(|at| model.is_silent(at));
        let others: Vec<Id> = model.effects().filter(|other| *other != id).collect();
        if silent { model.only(&others).unwrap_or(model) } else { model }
    }

    /// The model of these runs alone, the first of which has what is shared.
    pub fn among(&self, runs: &[&Run]) -> Self {
        let mut model = self.clone();
        model.slots.retain(|slot| slot.run.is_none());
        let known: Vec<Vec<(usize, usize)>> = runs.iter().map(|run| self.own(run).collect()).collect();
        for number in 0..runs.len() {
            for at in 0..model.slots.len() {
                let of =
                    |own: &[(usize, usize)]| own.iter().find(|(_, shared)| *shared == at).map(|own| own.0);
                let Some(example) = known.iter().find_map(|own| of(own)) else { continue };
                let value = self.slots[of(&known[number]).unwrap_or(at)].value;
                if number == 0 {
                    model.slots[at].value = value;
                } else if model.slots[at].run.is_none() {
                    let run = Arc::new(named(runs, number));
                    model.push_own(&self.slots[at], &run, value, self.slots[example].role);
                }
            }
        }
        for id in self.effects().filter(|id| self.is_apart(*id) && !model.is_apart(*id)).collect::<Vec<_>>() {
            model = model.together(id);
        }
        model
    }

    /// Gives a run a parameter for itself, one like a shared one or another run's.
    pub(crate) fn push_own(&mut self, like: &Slot, run: &Arc<Run>, value: f64, role: Role) {
        let base = self.of_shared(like.effect).start;
        self.slots.push(Slot { value, role, base, run: Some(run.clone()), ..like.clone() });
    }

    /// The parameters of an effect that runs share.
    fn of_shared(&self, id: Id) -> Range<usize> {
        self.parts.iter().find(|(own, _)| *own == id).map(|(_, range)| range.clone()).unwrap_or_default()
    }

    /// Whether a parameter of what every run may have stays as if it were not there.
    fn is_silent(&self, at: usize) -> bool {
        let slot = &self.slots[at];
        slot.effect.info().every_run && slot.role == Role::Fixed && slot.value == slot.param.neutral
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::Axis;

    fn run(name: &str, fingerprint: &str) -> Run {
        Run { name: name.into(), fingerprint: fingerprint.into() }
    }

    /// A base model of three runs whose zeros are 0, 1 and 2.
    fn three(runs: &[Run; 3]) -> Model {
        let mut model =
            Model::equation_1(Axis::Rotary, false).apart(Id::Offset, &runs.each_ref()[..]).unwrap();
        model.set("offset.tau0@b", 1.0).unwrap();
        model.set("offset.tau0@c", 2.0).unwrap();
        model
    }

    fn zero(model: &Model, run: &Run) -> f64 {
        let p = model.values();
        let p = model.of_run(run, &p);
        model.index("offset.tau0").map_or(0.0, |at| p[at])
    }

    #[test]
    fn each_run_has_its_own_and_an_unknown_one_the_shared() {
        let runs @ [a, b, c] = &[run("a", "0a"), run("b", "0b"), run("c", "0c")];
        let model = three(runs);
        let zeros = [a, b, c, &run("b", "ff")].map(|run| zero(&model, run));
        assert_eq!(zeros, [0.0, 1.0, 2.0, 0.0]);
        // The zero of the first is in the difference of the Coulomb levels.
        assert_eq!(model.slots()[model.index("offset.tau0").unwrap()].role, Role::Fixed);
        assert!(
            model.apart(Id::Offset, &[a, b]).is_none()
                && model.with(Id::Stribeck).unwrap().is_apart(Id::Offset)
        );
    }

    #[test]
    fn a_model_among_other_runs_keeps_what_it_knows_of_them() {
        let runs @ [a, b, c] = &[run("a", "0a"), run("b", "0b"), run("c", "0c")];
        let (model, new) = (three(runs), run("new", "0d"));
        for among in [&[b, c][..], &[c, a], &[c], &[b, &new, a]] {
            let other = model.among(among);
            for run in among {
                assert_eq!(zero(&other, run), zero(&model, run), "{} of {among:?}", run.name);
            }
            assert_eq!(other.slots().iter().filter(|slot| slot.run.is_some()).count(), among.len() - 1);
        }
        assert!(!model.among(&[&new]).has(Id::Offset));
        assert!(!model.together(Id::Offset).has(Id::Offset));
    }

    #[test]
    fn runs_that_nobody_can_tell_apart_share_everything() {
        let (model, a, nameless) = (Model::equation_1(Axis::Rotary, false), run("a", "0a"), Run::default());
        for runs in [&[&a][..], &[&a, &a], &[&a, &nameless], &[]] {
            assert!(model.apart(Id::Offset, runs).is_none());
        }
    }

    #[test]
    fn runs_of_one_name_or_of_none_are_told_apart_by_their_number() {
        let (a, b, c) = (run("x.npz", "0a"), run("x.npz", "0b"), run("", "0c"));
        let model = Model::equation_1(Axis::Rotary, false).apart(Id::Offset, &[&a, &b, &c]).unwrap();
        let names: Vec<String> =
            model.slots().iter().map(Slot::name).filter(|name| name.contains('@')).collect();
        assert_eq!(names, ["offset.tau0@x.npz (2)", "offset.tau0@capture 3"]);
    }
}
