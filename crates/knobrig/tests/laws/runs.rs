//! Several runs of one knob: what belongs to a run is found in each, and only where the runs differ.

use super::recovery::telling_knob;
use super::*;
use knobcore::fit::{Detents, Fit, fit};
use knobcore::model::Run;

/// Noise of the torque, N m.
const SD: f64 = 1e-4;

/// Effects of which a run may have parameters for itself.
fn of_runs() -> impl Iterator<Item = Id> {
    Id::BUILT_IN.iter().copied().filter(|id| id.info().params.iter().any(|param| param.of_a_run))
}

/// The knob recorded once, with noise.
fn recorded(model: &Model, name: &str, noise: &mut Noise) -> Signals {
    let still = torque(model);
    let tau: Vec<f64> = still.tau.iter().map(|tau| tau + SD * noise.normal()).collect();
    let run = Run { name: name.into(), fingerprint: name.into() };
    Signals { run, tau_raw: tau.clone(), tau, ..still }
}

/// Two runs of a knob fitted as one, the second with what belongs to a run a share larger.
fn two(id: Id, larger: f64, noise: &mut Noise) -> (Fit, Model, Model) {
    let first = telling_knob(id, noise);
    let mut second = first.clone();
    for slot in first.slots().iter().filter(|slot| slot.effect == id && slot.param.of_a_run) {
        second.set(&slot.name(), (1.0 + larger) * slot.value).unwrap();
    }
    let data = [recorded(&first, "a", noise), recorded(&second, "b", noise)];
    (fit(&data.each_ref()[..], &first, Detents::AsModel).unwrap(), first, second)
}

#[test]
fn what_differs_between_runs_is_found_in_each() {
    let mut noise = Noise::new(31);
    for id in of_runs() {
        let (found, first, second) = two(id, 0.5, &mut noise);
        assert!(found.model.is_apart(id), "{}", name(id));
        let errors = found.standard_errors();
        for (&at, se) in found.free.iter().zip(errors) {
            let slot = &found.model.slots()[at];
            let shared = found.model.slots()[found.model.shared(at)].name();
            let truth = if slot.run.is_some() { &second } else { &first };
            let off = (slot.value - truth.slots()[truth.index(&shared).unwrap()].value).abs();
            assert!(
                off < 5.0 * se,
                "{}: {} is {off} off, {} standard errors",
                name(id),
                slot.name(),
                off / se
            );
        }
    }
}

#[test]
fn what_runs_share_stays_shared() {
    let mut noise = Noise::new(32);
    for id in of_runs() {
        let (found, ..) = two(id, 0.0, &mut noise);
        assert!(found.model.slots().iter().all(|slot| slot.run.is_none()), "{}", name(id));
        assert_eq!(found.model.slots().len(), telling_knob(id, &mut noise).slots().len(), "{}", name(id));
    }
}

#[test]
fn of_three_runs_the_one_that_differs_is_found_as_well() {
    let mut noise = Noise::new(33);
    let id = of_runs().next().unwrap();
    let first = telling_knob(id, &mut noise);
    let mut other = first.clone();
    for slot in first.slots().iter().filter(|slot| slot.effect == id && slot.param.of_a_run) {
        other.set(&slot.name(), 1.5 * slot.value).unwrap();
    }
    let data = [
        recorded(&first, "a", &mut noise),
        recorded(&first, "b", &mut noise),
        recorded(&other, "c", &mut noise),
    ];
    let found = fit(&data.each_ref()[..], &first, Detents::AsModel).unwrap();
    assert!(found.model.is_apart(id), "{}", name(id));
}
