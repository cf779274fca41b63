//! What is missing: an effect that was left out is the one that explains what it left, and says how much that is.

use super::chance::{NOISE, noisy};
use super::*;
use knobcore::diagnose::{Candidate, diagnose, implausible, sets};
use knobcore::fit::{Fit, refine};

/// Effects of every nature but joints.
const WEIGHED: [Id; 4] = [Id::Stribeck, Id::QuadraticDrag, Id::ReturnSpring, Id::FrictionDrift];

fn knob_of(values: &[(&str, f64)]) -> Model {
    let mut model = knob();
    for (name, value) in values {
        let id = *Id::BUILT_IN.iter().find(|id| name.split('.').next() == Some(id.info().id)).unwrap();
        if !model.has(id) {
            model = model.with(id).unwrap();
        }
        model.set(name, *value).unwrap();
    }
    model
}

const SPRING: (&str, f64) = ("return_spring.k", 0.01);
const DRAG: (&str, f64) = ("quadratic_drag.d", 1e-4);
const JOINT: [(&str, f64); 2] = [("compliance.k", 3.0), ("compliance.d", 5e-3)];

/// What is said of a capture of `truth` by who knows of `base` alone.
fn told(truth: &Model, base: &Model, effects: &[Id]) -> (Signals, Fit, Vec<Candidate>) {
    let signals = noisy(truth, 51);
    let fit = refine(&[&signals], base).unwrap();
    let candidates = diagnose(&[&signals], &fit.model, effects, &|_| true).unwrap();
    (signals, fit, candidates)
}

fn of(candidates: &[Candidate], id: Id) -> &Candidate {
    candidates.iter().find(|candidate| candidate.id == id).unwrap()
}

#[test]
fn the_effect_that_was_left_out_explains_what_it_left() {
    for missing in [SPRING, DRAG] {
        let truth = knob_of(&[missing]);
        let (signals, before, candidates) = told(&truth, &knob(), &WEIGHED);
        let best = &candidates[0];
        assert_eq!(name(best.id), missing.0.split('.').next().unwrap());
        let fit = best.fit.as_ref().unwrap();
        let value = fit.model.values()[fit.model.index(missing.0).unwrap()];
        assert!(
            before.rmse > 1.2 * fit.rmse && (fit.rmse / fit.noise_floor - 1.0).abs() < 0.03,
            "{missing:?}"
        );
        assert!((value / missing.1 - 1.0).abs() < 0.1, "{missing:?}: {value}");
        // What it takes off, in variances of the sensor's white noise; its price is by its parameters.
        let squares = (before.rmse.powi(2) - fit.rmse.powi(2)) * signals.used() as f64;
        assert!((best.gain * NOISE * NOISE / squares - 1.0).abs() < 0.1, "{missing:?}: {}", best.gain);
        let free = |model: &Model| model.slots().iter().filter(|slot| slot.role == Role::Free).count();
        assert_eq!(best.parameters, free(&fit.model) - free(&knob()), "{missing:?}");
        // Of 999 captures without it none has as much.
        assert_eq!(best.p_value, 1e-3, "{missing:?}");
        assert!(candidates.windows(2).all(|pair| pair[0].gain >= pair[1].gain));
        assert!(candidates.iter().all(|one| one.p_value > 0.0 && one.p_value <= 1.0));
    }
}

#[test]
fn of_two_that_are_missing_the_best_set_is_both() {
    let (signals, before, candidates) = told(&knob_of(&[SPRING, DRAG]), &knob(), &WEIGHED);
    let pool: Vec<(Id, Model)> = WEIGHED
        .iter()
        .filter_map(|id| Some((*id, of(&candidates, *id).fit.as_ref()?.model.clone())))
        .collect();
    let best = sets(&[&signals], &before.model, &pool, 2, &|_| true).unwrap();
    let mut effects: Vec<&str> = best[0].effects.iter().map(|id| name(*id)).collect();
    effects.sort_unstable();
    assert_eq!(effects, ["quadratic_drag", "return_spring"]);
    assert!((best[0].fit.rmse / best[0].fit.noise_floor - 1.0).abs() < 0.03);
}

#[test]
fn a_joint_that_was_left_out_is_found() {
    let (_, before, candidates) = told(&knob_of(&JOINT), &knob(), &[Id::Compliance]);
    let fit = candidates[0].fit.as_ref().unwrap();
    let value = fit.model.values()[fit.model.index("compliance.k").unwrap()];
    assert!(before.rmse > 1.2 * fit.rmse && fit.rmse < 1.1 * fit.noise_floor, "{} {}", before.rmse, fit.rmse);
    assert!((value / JOINT[0].1 - 1.0).abs() < 0.2, "{value}");
}

#[test]
fn beside_a_joint_too_what_was_left_out_explains_most() {
    let joined = knob_of(&JOINT);
    let (_, before, candidates) = told(&knob_of(&[JOINT[0], JOINT[1], SPRING]), &joined, &WEIGHED[1..3]);
    let best = &candidates[0];
    let fit = best.fit.as_ref().unwrap();
    assert_eq!(name(best.id), "return_spring");
    assert!(before.rmse > 1.2 * fit.rmse && fit.rmse < 1.1 * fit.noise_floor, "{} {}", before.rmse, fit.rmse);
}

#[test]
fn how_many_detents_were_crossed_is_counted() {
    let mut base = knob();
    base.set("detent.P", 0.5).unwrap();
    let mut truth = base.with(Id::DetentHarmonics).unwrap();
    truth.set("detent_harmonics.A2", 0.01).unwrap();
    let signals = noisy(&truth, 52);
    let fit = refine(&[&signals], &truth).unwrap();
    let said = implausible(&[&signals], &fit, Id::DetentHarmonics, false, true);
    let counted = signals.theta.iter().zip(&signals.weight).filter(|(_, weight)| **weight > 0.0);
    let ends = counted.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (theta, _)| {
        [low.min(*theta), high.max(*theta)]
    });
    let period = fit.model.values()[fit.model.period().unwrap()];
    let crossed = (ends[1] - ends[0]) / (TAU * period);
    assert!(crossed < 1.0);
    assert_eq!(said[0], format!("only {crossed:.1} detents were crossed"));
}
