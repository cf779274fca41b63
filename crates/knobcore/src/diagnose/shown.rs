//! Detents that come with a joint: what the base has where it shows may show through a joint alone.

use super::candidate::Candidate;
use super::screen::{Screen, Start};
use crate::effects::{Base, Id, Joint, Place, Survey};
use crate::fit::{Shown, Through, range};
use crate::model::{Model, Role, Slot};
use crate::order::descending;
use crate::param::Unit;
use crate::rule::rule;
use std::f64::consts::PI;

/// Starts that are told of.
const TOLD: usize = 4;
/// Detents that take off more than so many times all that there is are none: the torque, over a joint far too soft, says
/// nothing of where the knob is.
const MOST: f64 = 1.5;

/// What the base has where it shows: detents.
pub fn detents() -> Option<Id> {
    Id::BUILT_IN.iter().copied().find(|id| id.info().base == Some(Base::WhereShown))
}

/// Whether detents may come with a joint beside a model: where it has some, or lacks them and they are weighed, or where
/// nothing but joints is asked for.
pub fn may_come(model: &Model, weighed: &[Id]) -> bool {
    let joints = weighed.iter().all(|id| id.info().place == Place::Coupling);
    detents().is_some_and(|own| joints || model.has(own) || weighed.contains(&own))
}

/// Of a joint's starts those through which detents show that the screen's model does not have, with these; and again with
/// `shaft` loading the shaft. `floor` is what noise leaves of the sum of squares.
pub fn shown(screen: &Screen<'_>, id: Id, starts: &[Start], shaft: &[Id], floor: f64) -> Vec<Start> {
    let (data, model) = (screen.data, screen.model);
    let Some(detents) = detents() else { return Vec::new() };
    let others: Vec<Id> = model.effects().filter(|id| *id != detents).collect();
    if others.iter().any(|id| id.info().needs == Some(detents.info().id)) {
        // They are known by what changes them.
        return Vec::new();
    }
    let Some(through) = model.only(&others).ok().and_then(|bare| Through::of(data, &bare)) else {
        return Vec::new();
    };
    let known = model.period().map(|at| 1.0 / model.slots()[at].value);
    let apart = PI / range(data);
    let squares = through.squares;
    let excess = squares - if floor.is_finite() { floor } else { 0.0 };
    let through = |at: &usize, times: f64| {
        let model = &starts[*at].model;
        let joint = model.joint(&model.values())?;
        let inertia = model.inertia().map(|at| model.slots()[at].value.abs())?;
        let joint = Joint { stiffness: times * joint.stiffness, ..joint };
        let seen = through.shown(&joint, joint.share * inertia)?;
        Some((*at, Shown { stiffness: times * seen.stiffness, ..seen }))
    };
    let all: Vec<usize> = (0..starts.len()).collect();
    let mut seen: Vec<(usize, Shown)> =
        screen.watch.each(&all, |at| through(at, 1.0)).into_iter().flatten().collect();
    seen.retain(|(_, shown)| shown.peak.gain <= MOST * squares);
    seen.sort_by_cached_key(|(_, shown)| descending(shown.peak.gain));
    seen.truncate(TOLD);
    // Where the knob is depends on the stiffness: once more from the one that shows most.
    let better = |(at, first): &(usize, Shown)| {
        let again = through(at, first.stiffness).filter(|(_, again)| again.peak.gain > first.peak.gain);
        again.unwrap_or((*at, *first))
    };
    let mut seen = screen.watch.each(&seen, better);
    seen.retain(|(_, shown)| {
        let gain = shown.peak.gain;
        let other = known.is_none_or(|known| (known - 1.0 / shown.peak.period).abs() > apart);
        let stands_out = gain >= rule().detents_stand_out * shown.background;
        other && stands_out && gain >= rule().detents_share * excess
    });
    let with = |(at, shown): &(usize, Shown)| -> Option<Model> {
        let mut with = starts[*at].model.clone();
        if !with.has(detents) {
            with = with.with(detents).ok()?;
        }
        let mut values = with.values();
        for (value, slot) in values.iter_mut().zip(with.slots()).filter(|(_, slot)| slot.effect == id) {
            if slot.param.unit == Unit::of(1, -1, 0) {
                *value *= shown.stiffness;
            }
        }
        let wave = [shown.peak.amplitude, shown.peak.period, shown.peak.phase];
        let start = detents.law().starts(&Survey { waves: Some(vec![wave]), ..screen.survey.clone() });
        let own = with.slots().iter().zip(&mut values).filter(|(slot, _)| slot.effect == detents);
        for ((slot, value), new) in own.zip(start.first()?) {
            if slot.role == Role::Free {
                *value = *new;
            }
        }
        with.set_values(&values);
        Some(with)
    };
    let models = seen.iter().filter_map(with);
    let mut starts = screen.by_promise(id, models.flat_map(|with| placed(&with, shaft)).collect());
    starts.retain(|start| start.predicted < screen.squares);
    starts
}

/// A model without a joint with that of another and its detents; and again with `shaft` loading the shaft.
pub fn with_joint(model: &Model, joined: &Model, shaft: &[Id]) -> Vec<Model> {
    let came = |slot: &&Slot| Some(slot.effect) == detents() || slot.effect.info().place == Place::Coupling;
    let mut with = model.clone();
    for slot in joined.slots().iter().filter(came) {
        if !with.has(slot.effect) {
            let Ok(more) = with.with(slot.effect) else { return Vec::new() };
            with = more;
        }
        // It has the same bounds there.
        let _ = with.set(&slot.name(), slot.value);
    }
    placed(&with, shaft)
}

/// A joint, unless the detents that come with it explain as much without it, or the better part of what both do: then
/// they, or what has their place, are what is found first.
pub fn needed(joint: Candidate, rigid: Option<&Candidate>) -> Candidate {
    let came = |own: &&Candidate| joint.fit.as_ref().is_some_and(|fit| fit.model.has(own.id));
    let Some(rigid) = rigid.filter(came) else { return joint };
    let price = rule().price * (joint.parameters as f64 - rigid.parameters as f64);
    let own = joint.gain - rigid.gain;
    if own > price.max(rigid.gain) {
        return joint;
    }
    let much = if own > price { "more than it does" } else { "as much" };
    let note = format!("the {} that comes with it explains {much} without it", rigid.id.info().id);
    Candidate { fit: None, gain: 0.0, p_value: 1.0, note, ..joint }
}

/// A model, and again with these effects at the shaft.
fn placed(model: &Model, shaft: &[Id]) -> Vec<Model> {
    let moved = || shaft.iter().try_fold(model.clone(), |model, id| model.with_at_shaft(*id)).ok();
    let moved = if shaft.is_empty() { None } else { moved() };
    std::iter::once(model.clone()).chain(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::super::diagnose;
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::effects::Wave;
    use crate::fit::{refine, waves};

    const JOINT: [(&str, f64); 3] =
        [("compliance.k", 0.6), ("compliance.d", 2e-3), ("compliance.share", 0.7)];

    /// A soft joint beside a rigid knob without detents.
    fn found(truth: &Model, weighed: &[Id]) -> Candidate {
        let signals = recorded(truth, "a");
        let base = refine(&[&signals], &knob(&[], &[])).unwrap().model;
        let all = diagnose(&[&signals], &base, weighed, &|_| true).unwrap();
        all.into_iter().find(|one| one.id == Id::Compliance).unwrap()
    }

    #[test]
    fn a_soft_joint_without_detents_comes_without() {
        let with = found(&knob(&[Id::Compliance], &JOINT), &[Id::Compliance, Id::Detent]);
        let fit = with.fit.unwrap();
        assert!(!fit.model.has(Id::Detent) && fit.rmse < 1.05 * fit.noise_floor);
        assert_eq!(with.parameters, 3);
    }

    #[test]
    fn a_soft_joint_comes_with_the_detents_that_a_slow_filter_takes_off() {
        let detents = [("detent.A", 4e-3), ("detent.P", 0.02), ("detent.S", 0.5)];
        let truth = knob(&[Id::Compliance, Id::Detent], &[&JOINT[..], &detents].concat());
        let fit = found(&truth, &[Id::Compliance, Id::Detent]).fit.unwrap();
        let value = |name: &str| fit.model.values()[fit.model.index(name).unwrap()];
        assert!(fit.rmse < 1.05 * fit.noise_floor, "{} {}", fit.rmse, fit.noise_floor);
        assert!((value("detent.P") / 0.02 - 1.0).abs() < 0.01, "{}", value("detent.P"));
        assert!((value("compliance.k") / 0.6 - 1.0).abs() < 0.1, "{}", value("compliance.k"));
    }

    #[test]
    fn through_a_soft_joint_the_detents_show_that_over_the_position_of_the_shaft_do_not() {
        let detents = [("detent.A", 3e-3), ("detent.P", 0.03), ("detent.S", 0.5)];
        let truth = knob(&[Id::Compliance, Id::Detent], &[&JOINT[..], &detents].concat());
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let rigid = refine(&data, &knob(&[], &[])).unwrap().model;
        let through = Through::of(&data, &rigid).unwrap();
        let own = truth.joint(&truth.values()).unwrap();
        for off in [0.8, 1.0, 1.3] {
            let joint = Joint { stiffness: off * own.stiffness, ..own };
            let seen = through.shown(&joint, 0.7e-4).unwrap();
            assert!((seen.peak.period / 0.03 - 1.0).abs() < 0.02, "{off}: {seen:?}");
            assert!((seen.stiffness * off - 1.0).abs() < 0.3, "{off}: {seen:?}");
            assert!((seen.peak.amplitude / 3e-3 - 1.0).abs() < 0.4, "{off}: {seen:?}");
            assert!(seen.peak.gain > 30.0 * seen.background, "{off}: {seen:?}");
            assert!(seen.peak.gain > 0.3 * through.squares, "{off}: {seen:?} {}", through.squares);
        }
        let [amplitude, ..] = waves(&data, &rigid, Wave::Torque)[0];
        assert!(amplitude < 2e-3, "{amplitude}");
    }

    #[test]
    fn a_joint_is_no_candidate_where_the_detents_that_come_with_it_explain_as_much_alone() {
        let data = recorded(&knob(&[], &[]), "a");
        let beside = |ids: &[Id], gain: f64| {
            let fit = refine(&[&data], &knob(ids, &[])).unwrap();
            let parameters = 3 * ids.len();
            Candidate { id: ids[0], fit: Some(fit), gain, parameters, p_value: 0.001, note: String::new() }
        };
        let with = [Id::Compliance, Id::Detent];
        let price = 3.0 * rule().price;
        for (alone, both, why) in
            [(2.0, 2.0 + price, "as much without"), (9000.0, 18000.0, "more than it does without")]
        {
            let rigid = beside(&[Id::Detent], alone);
            let none = needed(beside(&with, both), Some(&rigid));
            assert!(none.fit.is_none() && none.gain == 0.0 && none.note.contains(why), "{none:?}");
            assert!(needed(beside(&with, both + 0.1), Some(&rigid)).fit.is_some());
        }
        let rigid = beside(&[Id::Detent], 9000.0);
        assert!(needed(beside(&with, 9000.0), None).fit.is_some());
        assert!(needed(beside(&with[..1], 1.0), Some(&rigid)).fit.is_some(), "no detents came with it");
    }

    #[test]
    fn who_asks_for_a_joint_alone_gets_what_a_diagnosis_promises() {
        let detents = [("detent.A", 3e-3), ("detent.P", 0.03), ("detent.S", 0.5)];
        let truth = knob(&[Id::Compliance, Id::Detent], &[&JOINT[..], &detents].concat());
        let promised = found(&truth, &[Id::Compliance, Id::Detent]).fit.unwrap();
        let alone = found(&truth, &[Id::Compliance]).fit.unwrap();
        assert!(alone.model.effects().eq(promised.model.effects()));
        assert!((alone.rmse / promised.rmse - 1.0).abs() < 1e-6);
    }
}
