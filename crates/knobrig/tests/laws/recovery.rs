//! What was simulated is what is fitted: torque without noise gives its parameters back.

use super::*;
use knobcore::filter::{ZeroPhase, cheby2};
use knobcore::fit::{Detents, Fit, Status, fit};

/// Relative error of a parameter that counts as found.
const FOUND: f64 = 1e-6;

/// The first exact fit from the starts of the catalogue, or the best; of what the knob has anyway from nothing but
/// the period of its detents.
fn best(data: &Signals, truth: &Model, id: Id) -> Fit {
    let starts: Vec<Model> = if knob().has(id) {
        let period = truth.slots().iter().find(|slot| slot.param.name == "P").map_or(0.0, |slot| slot.value);
        let start = |param: &Param| if param.name == "P" { period } else { param.neutral };
        vec![at(truth.clone(), id, &id.info().params.iter().map(start).collect::<Vec<_>>())]
    } else {
        id.law().starts(&survey(data)).iter().map(|start| at(truth.clone(), id, start)).collect()
    };
    let mut best: Option<Fit> = None;
    for start in starts {
        let found = fit(&[data], &start, Detents::AsModel).unwrap();
        if best.as_ref().is_none_or(|best| found.rmse < best.rmse) {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|best| best.status == Status::Exact) {
            break;
        }
    }
    best.unwrap()
}

fn assert_found(found: &Fit, truth: &Model, id: Id) {
    for (want, got) in truth.slots().iter().zip(found.model.slots()) {
        let error = (want.value - got.value).abs() / want.value.abs().max(1e-3);
        assert!(error < FOUND, "{}: {} of {} is fitted as {}", name(id), want.name(), want.value, got.value);
    }
    assert!(found.undetermined.is_empty(), "{}: {:?}", name(id), found.undetermined);
}

/// The knob with an effect at values that it could have, such that all of them show.
pub fn telling_knob(id: Id, noise: &mut Noise) -> Model {
    let mut truth = plausible_knob(id, noise);
    // A constant torque shows only where friction is the same both ways.
    truth.tie("coulomb.neg", "coulomb.pos").unwrap();
    truth
}

#[test]
fn what_was_simulated_is_what_is_fitted() {
    // Stiction acts where torque makes motion. The borders between regions are steps, which no slope leads to, and
    // so are a contact behind a gap and the border of a stop that damps: they have laws of their own below.
    let others = [Id::Karnopp, Id::Regional, Id::Backlash, Id::EndStop];
    for &id in Id::BUILT_IN.iter().filter(|id| !others.contains(id)) {
        // To each its own draw, so that one effect more changes nothing of the others.
        let truth = telling_knob(id, &mut Noise::new(6));
        let data = torque(&truth);
        let found = best(&data, &truth, id);
        if id == Id::Presliding {
            // An element that slips a little late passes for its neighbour: the torque is found, not the shares.
            let share = found.rmse / rms(data.tau.iter().copied());
            assert!(share < 5e-3, "{}: {share}", name(id));
        } else {
            assert_found(&found, &truth, id);
        }
    }
}

#[test]
fn stops_that_do_not_damp_are_found_with_their_borders() {
    let id = Id::EndStop;
    let mut truth = telling_knob(id, &mut Noise::new(8));
    for (name, value) in [("d", 0.0), ("lo", -0.6), ("hi", 0.7), ("k_lo", 0.3), ("k_hi", 0.2), ("g", 0.5)] {
        truth.set(&format!("end_stop.{name}"), value).unwrap();
    }
    truth.set_role("end_stop.d", Role::Fixed).unwrap();
    let data = torque(&truth);
    assert_found(&best(&data, &truth, id), &truth, id);
}

#[test]
fn within_its_borders_each_region_is_found() {
    let id = Id::Regional;
    let mut truth = telling_knob(id, &mut Noise::new(7));
    for border in ["b1", "b2", "b3"] {
        truth.set_role(&format!("regional.{border}"), Role::Fixed).unwrap();
    }
    let mut start = truth.clone();
    for slot in truth.slots().iter().filter(|slot| slot.effect == id && slot.role == Role::Free) {
        start.set(&slot.name(), 0.0).unwrap();
    }
    assert_found(&fit(&[&torque(&truth)], &start, Detents::AsModel).unwrap(), &truth, id);
}

#[test]
fn a_gap_is_found_from_coarse_to_fine_from_a_fifth_off() {
    // Contact comes in pulses, and a start that is off moves them past each other: no slope leads back to the exact
    // parameters. A slow filter makes the pulses broad. The contact itself hardly shows through it, the gap does.
    let id = Id::Backlash;
    let knob = telling_knob(id, &mut Noise::new(8));
    let knob = knob.only(&[Id::Inertia, Id::Coulomb, Id::Viscous, id]).unwrap();
    let truth = at(knob, id, &[0.02, 165.0, 0.13, 0.7]);
    let mut model = at(truth.clone(), id, &[0.024, 200.0, 0.16, 0.8]);
    for edge_hz in [60.0, 150.0, 300.0] {
        let filter = ZeroPhase::new(cheby2(3, 20.0, edge_hz, RATE_HZ).unwrap());
        let mut data = Signals { filter: Some(filter), ..torque(&truth) };
        data.filter_torque();
        let found = fit(&[&data], &model, Detents::AsModel).unwrap();
        let share = found.rmse / rms(data.tau.iter().copied());
        assert!(share < 0.05, "{share} of the torque is left through {edge_hz} Hz");
        model = found.model;
    }
    let gap = model.values()[model.index("backlash.gap").unwrap()];
    assert!((gap - 0.02).abs() < 0.03 * 0.02, "{gap}");
}
