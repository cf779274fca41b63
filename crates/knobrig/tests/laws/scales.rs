//! Scales and mirrors of a whole search: what is said to be missing does not hang on units or on which way is forward.

use super::chance::noisy;
use super::*;
use knobcore::diagnose::{Candidate, diagnose, locate};
use knobcore::fit::{Fit, refine};

/// Effects of every nature but joints.
const WEIGHED: [Id; 6] = [
    Id::Stribeck,
    Id::QuadraticDrag,
    Id::DetentHarmonics,
    Id::ReturnSpring,
    Id::FrictionDrift,
    Id::PositionFriction,
];

/// A capture of a knob with a spring and a drag that the model does not know.
fn capture() -> Signals {
    let mut truth = knob().with(Id::ReturnSpring).unwrap().with(Id::QuadraticDrag).unwrap();
    truth.set("return_spring.k", 3e-3).unwrap();
    truth.set("quadratic_drag.d", 2e-5).unwrap();
    noisy(&truth, 61)
}

fn found(signals: &Signals, base: &Model) -> (Fit, Vec<Candidate>) {
    let fit = refine(&[signals], base).unwrap();
    let mut found = diagnose(&[signals], &fit.model, &WEIGHED, &|_| true).unwrap();
    found.sort_by_key(|one| one.id);
    (fit, found)
}

fn near(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() <= 1e-4 * a.abs().max(b.abs()) + 1e-12, "{what}: {a} {b}");
}

/// Both tell the same of every effect.
fn alike(here: &[Candidate], there: &[Candidate]) {
    for (a, b) in here.iter().zip(there) {
        assert_eq!((a.id, a.parameters), (b.id, b.parameters));
        assert!((a.gain - b.gain).abs() < 0.01 + 1e-3 * a.gain, "{}: {} {}", name(a.id), a.gain, b.gain);
        assert!((a.p_value - b.p_value).abs() < 0.01, "{}: {} {}", name(a.id), a.p_value, b.p_value);
    }
}

/// Both fail at the same places; `torque` is how many units of the second one of the first has.
fn fail_alike(here: (&Signals, &Fit), there: (&Signals, &Fit), torque: f64) {
    let [a, b] = [here, there].map(|(signals, fit)| locate(&[signals], &fit.model));
    for (a, b) in a.iter().zip(&b) {
        assert_eq!(a.axis, b.axis);
        for (a, b) in [(a.share, b.share), (a.part, b.part), (a.chance, b.chance)] {
            near(a, b, "share");
        }
        a.rms.iter().zip(&b.rms).for_each(|(x, y)| near(torque * x, *y, a.axis));
        a.band.iter().zip(&b.band).for_each(|(x, y)| near(torque * x, *y, a.axis));
    }
}

#[test]
fn a_search_does_not_know_in_what_torque_is_counted() {
    let here = capture();
    let times = 1024.0;
    let by = |column: &[f64]| column.iter().map(|x| x * times).collect::<Vec<f64>>();
    let there = Signals { tau: by(&here.tau), tau_raw: by(&here.tau_raw), ..here.clone() };
    let mut scaled = knob();
    let size = |slot: &knobcore::model::Slot| slot.value * times.powi(slot.param.unit.powers()[0]);
    scaled.set_values(&knob().slots().iter().map(size).collect::<Vec<f64>>());
    let (fit, candidates) = found(&here, &knob());
    let (other, others) = found(&there, &scaled);
    for (at, slot) in fit.model.slots().iter().enumerate() {
        let [power, ..] = slot.param.unit.powers();
        near(times.powi(power) * slot.value, other.model.values()[at], slot.param.name);
    }
    for (a, b) in fit.standard_errors().iter().zip(other.standard_errors()).take(5) {
        near(times * a, b, "standard error");
    }
    for (a, b) in
        [(fit.rmse, other.rmse), (fit.noise_floor, other.noise_floor), (fit.rmse_heldout, other.rmse_heldout)]
    {
        near(times * a, b, "error");
    }
    near(fit.white_squares, other.white_squares, "white squares");
    alike(&candidates, &others);
    fail_alike((&here, &fit), (&there, &other), times);
}

#[test]
fn a_search_does_not_know_which_way_is_forward() {
    let here = capture();
    let turned = |column: &[f64]| column.iter().map(|x| -x).collect::<Vec<f64>>();
    let there = Signals {
        theta: turned(&here.theta),
        omega: turned(&here.omega),
        alpha: turned(&here.alpha),
        tau: turned(&here.tau),
        tau_raw: turned(&here.tau_raw),
        forward: here.forward.iter().map(|x| 1.0 - x).collect(),
        ..here.clone()
    };
    let (fit, candidates) = found(&here, &knob());
    let (other, others) = found(&there, &symmetry::mirrored(&knob()));
    let seen = symmetry::mirrored(&other.model).values();
    for (at, slot) in fit.model.slots().iter().enumerate() {
        near(slot.value, seen[at], slot.param.name);
    }
    near(fit.rmse, other.rmse, "error");
    near(fit.noise_floor, other.noise_floor, "floor");
    alike(&candidates, &others);
}

#[test]
fn a_search_does_not_know_in_what_time_is_counted() {
    let here = capture();
    let time = 8.0;
    let by = |column: &[f64], factor: f64| column.iter().map(|x| x * factor).collect::<Vec<f64>>();
    let there = Signals {
        rate_hz: here.rate_hz / time,
        t: by(&here.t, time),
        omega: by(&here.omega, 1.0 / time),
        alpha: by(&here.alpha, 1.0 / time / time),
        ..here.clone()
    };
    let mut scaled = knob();
    let size = |slot: &knobcore::model::Slot| slot.value * time.powi(slot.param.unit.powers()[2]);
    scaled.set_values(&knob().slots().iter().map(size).collect::<Vec<f64>>());
    let (fit, candidates) = found(&here, &knob());
    let (other, others) = found(&there, &scaled);
    for (at, slot) in fit.model.slots().iter().enumerate() {
        near(time.powi(slot.param.unit.powers()[2]) * slot.value, other.model.values()[at], slot.param.name);
    }
    near(fit.rmse, other.rmse, "error");
    near(fit.noise_floor, other.noise_floor, "floor");
    alike(&candidates, &others);
}
