//! One chain: whatever drives a knob, every effect acts, and the same motion takes the same torque.

use super::*;
use knobcore::chain::{Hand, Pushed, push};
use knobcore::forward::forward;

const HAND: Hand = Hand { stiffness: 0.4, damping: 4e-3 };

/// A hand that turns the knob back and forth, resting at each end.
pub fn pushed(model: &Model) -> Pushed {
    let rest = |x: f64| (4.0 * x.sin()).clamp(-1.0, 1.0);
    let reference: Vec<f64> = (0..CYCLE).map(|i| 0.8 * rest(TAU * 2.0 * i as f64 / CYCLE as f64)).collect();
    push(model, &reference, 1.0 / RATE_HZ, HAND).unwrap()
}

/// The motion that came out, as a capture.
pub fn seen(pushed: &Pushed) -> Signals {
    let n = pushed.theta.len();
    Signals {
        t: (0..n).map(|i| i as f64 / RATE_HZ).collect(),
        theta: pushed.theta.clone(),
        omega: pushed.omega.clone(),
        alpha: pushed.alpha.clone(),
        forward: pushed.omega.iter().map(|w| Motion::exact(0.0, 0.0, *w, 0.0).forward).collect(),
        omega_sd: vec![0.0; n],
        weight: vec![1.0; n],
        segments: vec![0..n; 1],
        tau_raw: pushed.tau.clone(),
        tau: pushed.tau.clone(),
        ..signals(|_| 0.0)
    }
}

#[test]
fn every_effect_changes_what_a_hand_feels() {
    let mut noise = Noise::new(23);
    let bare = pushed(&knob());
    let scale = rms(bare.tau.iter().copied());
    for &id in Id::BUILT_IN.iter().filter(|id| !knob().has(**id)) {
        let mut values = plausible(id, &mut noise);
        if id == Id::Saturation {
            // The limit that is plausible for the faster motion of the other laws is not reached by this one.
            values[0] = 0.5 * scale;
        }
        let with = pushed(&at(knob_with(id), id, &values));
        let apart = |a: &[f64], b: &[f64]| rms(a.iter().zip(b).map(|(a, b)| a - b));
        let felt = apart(&with.tau, &bare.tau) / scale + apart(&with.theta, &bare.theta);
        assert!(felt > 1e-4, "{} changes nothing: {felt}", name(id));
    }
}

#[test]
fn a_hand_feels_what_is_predicted_on_the_motion_that_it_makes() {
    let mut noise = Noise::new(24);
    for &id in Id::BUILT_IN {
        let model = plausible_knob(id, &mut noise);
        let pushed = pushed(&model);
        let predicted = predict::torque_raw(&model, &seen(&pushed));
        let scale = rms(pushed.tau.iter().copied());
        // A knob at rest answers the hand, which its motion does not tell; a sensor that is late, or ahead, has
        // some of that rest.
        let rests = |i: usize| pushed.omega[i] == 0.0;
        let late = if id.law().remembers() { 600 } else { 0 };
        let ahead = if id.info().place == Place::Sensor { 30 } else { 0 };
        let clear = |i: &usize| {
            model.is_coupled() || (i.saturating_sub(late)..=(i + ahead).min(CYCLE - 1)).all(|i| !rests(i))
        };
        let moving: Vec<usize> = (0..CYCLE).filter(clear).collect();
        assert!(moving.len() > CYCLE / 10, "{} moves", name(id));
        let most = moving.iter().map(|i| (predicted[*i] - pushed.tau[*i]).abs()).fold(0.0, f64::max);
        assert!(most < 1e-9 * scale.max(1.0), "{}: {most} N m apart", name(id));
    }
}

/// How far the torque of a motion makes another one, rad: over spans long enough to turn round in, short beside the time
/// in which detents throw a knob off its way.
pub fn off(model: &Model, signals: &Signals) -> f64 {
    let made = forward(model, signals, Some(0.02)).unwrap().theta;
    rms(made.iter().zip(&signals.theta).skip(CYCLE).map(|(made, theta)| made - theta))
}

#[test]
fn friction_under_every_load_at_once_is_the_same_with_a_motion_and_with_a_torque_given() {
    let mut noise = Noise::new(27);
    let mut model = at(knob_with(Id::LoadFriction), Id::LoadFriction, &[0.4, 0.7, 0.9]);
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().presses && !id.info().describes) {
        if !model.has(id) {
            model = at(model.with(id).unwrap(), id, &plausible(id, &mut noise));
        }
    }
    let mut light = model.clone();
    light.set("load_friction.s_alpha", 0.0).unwrap();
    let signals = torque(&model);
    let (made, without) = (off(&model, &signals), off(&light, &signals));
    assert!(made < 5e-4 && made < 0.3 * without, "{made} rad off, {without} without the inertia's part");
    let mut behind = model.with(Id::Compliance).unwrap();
    behind = at(behind, Id::Compliance, &[300.0, 0.05, 0.9]);
    let made = off(&behind, &torque(&behind));
    assert!(made < 5e-4, "{made} rad off behind a joint");
}

#[test]
fn the_torque_of_a_motion_makes_that_motion_whatever_the_effect() {
    let mut noise = Noise::new(26);
    for &id in Id::BUILT_IN {
        // A prescribed motion breaks away without the torque for it; what a limit cut off is lost.
        if matches!(id, Id::Karnopp | Id::Saturation) {
            continue;
        }
        let model = plausible_knob(id, &mut noise);
        let signals = torque(&model);
        let (made, bare) = (off(&model, &signals), off(&knob(), &signals));
        // What a late sensor did is taken off to some order only.
        let late = id.info().place == Place::Sensor && id.law().remembers();
        assert!(made < if late { 2e-3 } else { 5e-4 }, "{}: {made} rad off", name(id));
        assert!(knob().has(id) || made < 0.6 * bare, "{} acts: {made} with it, {bare} without", name(id));
    }
}

#[test]
fn no_effect_gives_energy_anywhere_along_the_way() {
    const SLICES: usize = 24;
    let mut noise = Noise::new(25);
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Load) {
        // What only changes another effect gives or takes beside that one; what is stored comes back elsewhere.
        if id.info().needs.is_some() || id == Id::Inertia || id.law().remembers() {
            continue;
        }
        let model = at(Model::new(&[id], Axis::Rotary), id, &plausible(id, &mut noise));
        let run = torque(&model);
        let (low, high) = (-1.2, 1.2);
        let mut work = [0.0; SLICES];
        let mut scale = [0.0; SLICES];
        for i in 0..CYCLE {
            let place = (run.theta[i] - low) / (high - low) * SLICES as f64;
            let slice = (place.max(0.0) as usize).min(SLICES - 1);
            work[slice] += run.tau[i] * run.omega[i];
            scale[slice] += (run.tau[i] * run.omega[i]).abs();
        }
        let total: f64 = scale.iter().sum();
        for slice in 0..SLICES {
            // A slice that begins or ends within a sample is a little open.
            let open = 2e-2 * scale[slice] + 1e-3 * total;
            assert!(work[slice] >= -open, "{} gives {} of {total} in slice {slice}", name(id), work[slice]);
        }
    }
}
