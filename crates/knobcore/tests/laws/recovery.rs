//! What was simulated is what is fitted: torque without noise gives its parameters back.

use super::*;
use knobcore::fit::{Detents, Fit, Status, fit};

/// The best fit over the starts of the catalogue; of what the knob has anyway from nothing but the period.
fn best(data: &Signals, truth: &Model, id: Id) -> Fit {
    let starts: Vec<Model> = if knob().has(id) {
        let neutral = |param: &Param| if param.name == "P" { knob().values()[6] } else { param.neutral };
        vec![at(truth.clone(), id, &id.info().params.iter().map(neutral).collect::<Vec<_>>())]
    } else {
        id.starts(&survey(data)).iter().map(|start| at(truth.clone(), id, start)).collect()
    };
    let mut best: Option<Fit> = None;
    for (k, start) in starts.iter().enumerate() {
        let found = fit(&[data], start, Detents::AsModel).unwrap();
        println!("  {} start {k} {:?} {:e} {}", name(id), found.status, found.rmse/rms(data.tau.iter().copied()), found.evaluations);
        let exact = found.status == Status::Exact;
        if best.as_ref().is_none_or(|best| found.rmse < best.rmse) {
            best = Some(found);
        }
        if exact {
            break;
        }
    }
    best.unwrap()
}

#[test]
fn what_was_simulated_is_what_is_fitted() {
    let mut noise = Noise::new(6);
    // Stiction acts where torque makes motion, not in a prediction from the motion.
    for &id in Id::BUILT_IN.iter().filter(|id| **id != Id::Karnopp) {
        let mut truth = plausible_knob(id, &mut noise);
        // A constant torque shows only where friction is the same both ways.
        truth.tie("coulomb.neg", "coulomb.pos").unwrap();
        let data = torque(&truth);
        let t0 = std::time::Instant::now();
        let found = best(&data, &truth, id);
        let mut bad: Vec<String> = Vec::new();
        for (want, got) in truth.slots().iter().zip(found.model.slots()) {
            let error = (want.value - got.value).abs() / want.value.abs().max(1e-3);
            if error > 1e-6 { bad.push(format!("{} {} {}", want.name(), want.value, got.value)); }
        }
        let share = found.rmse / rms(data.tau.iter().copied());
        println!("{} {:?} rmse/rms {share:e} {:?} ev {} undetermined {:?} bad {:?}", name(id), t0.elapsed(), found.status, found.evaluations, found.undetermined, bad);
    }
}

#[test]
fn explore_backlash() {
    use knobcore::filter::{ZeroPhase, cheby2};
    let id = Id::Backlash;
    for seed in [0, 1] {
    for (gap, f) in [(0.02, 200.0), (0.05, 80.0)] {
    for a in [0.0, 0.01] {
    let mut truth = knob_with(id);
    truth.tie("coulomb.neg", "coulomb.pos").unwrap();
    if a > 0.0 { truth.set("detent.A", a).unwrap(); } else { truth = truth.only(&[Id::Inertia, Id::Coulomb, Id::Viscous, id]).unwrap(); }
    let w = TAU * f;
    let share = 0.7;
    truth = at(truth, id, &[gap, share*1.5e-4*w*w, share*1.5e-4*w, share]);
    let mut data = torque(&truth);
    if seed > 0 { data.filter = Some(ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap())); data.filter_torque(); }
    for off in [1.05, 1.2] {
    let mut start = truth.clone();
    for p in ["gap", "k", "d"] { let v = truth.slots()[truth.index(&format!("backlash.{p}")).unwrap()].value; start.set(&format!("backlash.{p}"), v*off).unwrap(); }
    let found = fit(&[&data], &start, Detents::AsModel).unwrap();
    println!("{seed} {gap} {f} A {a} off {off} {:?} {:e} ev {}", found.status, found.rmse/rms(data.tau.iter().copied()), found.evaluations);
    }
    let t0 = std::time::Instant::now();
    let found = best(&data, &truth, id);
    println!("best {seed} {gap} {f} A {a} {:?} {:e} ev {} {:?} {:?} ", found.status, found.rmse/rms(data.tau.iter().copied()), found.evaluations, t0.elapsed(), &found.model.values()[..5]);
    }
    }
    }
}
