//! Laws that every effect of the catalogue obeys: a product of effects and laws, no effect named twice.

use knobcore::effects::{Id, Sweep};
use knobcore::fit::{Detents, fit};
use knobcore::model::{Model, Role};
use knobcore::motion::Motion;
use knobcore::param::{Axis, Kind};
use knobcore::predict;
use knobcore::prepare::{Preparation, Recording, prepare};
use knobcore::random::Noise;
use knobcore::scalar::{Dual, Scalar};
use knobcore::signals::Signals;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 2000.0;

/// A motion that goes forth and back over many positions and speeds and ends where it began.
fn motion(t: f64) -> Motion<f64> {
    let (mut theta, mut omega, mut alpha) = (0.0, 0.0, 0.0);
    for (k, size) in [(1.0, 1.1), (3.0, 0.35), (7.0, 0.08)] {
        let w = TAU * k / 4.0;
        theta += size * (w * t + k).sin();
        omega += size * w * (w * t + k).cos();
        alpha -= size * w * w * (w * t + k).sin();
    }
    Motion::exact(t, theta, omega, alpha)
}

fn times() -> impl Iterator<Item = f64> {
    (0..8000).map(|i| f64::from(i) / RATE_HZ)
}

/// Prepared signals of the motion, with this torque.
fn signals(torque: &dyn Fn(&Motion<f64>) -> f64) -> Signals {
    let motions: Vec<Motion<f64>> = times().map(motion).collect();
    let column = |of: fn(&Motion<f64>) -> f64| motions.iter().map(of).collect::<Vec<f64>>();
    let (t, theta, omega, alpha) =
        (column(|m| m.t), column(|m| m.theta), column(|m| m.omega), column(|m| m.alpha));
    let tau: Vec<f64> = motions.iter().map(torque).collect();
    let recording = Recording {
        axis: Axis::Rotary,
        rate_hz: RATE_HZ,
        t: &t,
        theta: &theta,
        omega: Some(&omega),
        alpha: Some(&alpha),
        tau: &tau,
        after_gap: &vec![false; t.len()],
    };
    prepare(&recording, &Preparation::none()).unwrap().signals
}

/// Values of an effect that a real knob could have: positive where a sign would create energy.
fn plausible(id: Id, noise: &mut Noise) -> Vec<f64> {
    let value = |lower: f64, kind: Kind, noise: &mut Noise| match kind {
        Kind::Linear => 0.1 + noise.uniform(),
        Kind::PhaseOf(_) => TAU * (noise.uniform() - 0.5),
        Kind::Nonlinear => lower.max(0.0) + 0.1 + 0.3 * noise.uniform(),
    };
    id.info().params.iter().map(|param| value(param.lower, param.kind, noise)).collect()
}

fn only(id: Id, values: &[f64]) -> Model {
    let mut model = Model::new(&[id], Axis::Rotary);
    model.set_values(values);
    model
}

#[test]
fn an_effect_at_its_neutral_values_is_silent() {
    for &id in Id::ALL {
        let model = Model::new(&[id], Axis::Rotary);
        for m in times().map(motion) {
            assert_eq!(model.torque(&model.values(), &m), 0.0, "{}", id.info().id);
        }
    }
}

#[test]
fn resistance_static_friction_and_inertia_are_never_negative() {
    let mut noise = Noise::new(1);
    for &id in Id::ALL {
        for _ in 0..20 {
            let p = plausible(id, &mut noise);
            for m in times().step_by(50).map(motion) {
                let load = id.load(&p, &m);
                let least = [load.resist, load.hold].concat().into_iter().chain([load.inertia, load.band]);
                assert!(least.into_iter().all(|x| x >= 0.0), "{}: {load:?}", id.info().id);
            }
        }
    }
}

#[test]
fn the_derivative_is_that_of_the_finite_difference() {
    let mut noise = Noise::new(2);
    for &id in Id::ALL {
        let p = plausible(id, &mut noise);
        let model = only(id, &p);
        for lane in 0..p.len() {
            for m in times().step_by(97).map(motion) {
                let seeded: Vec<Dual<f64, 1>> =
                    p.iter().enumerate().map(|(i, x)| Dual::seeded(*x, (i == lane).then_some(0))).collect();
                let lifted = Motion {
                    t: Dual::of(m.t),
                    theta: Dual::of(m.theta),
                    omega: Dual::of(m.omega),
                    alpha: Dual::of(m.alpha),
                    forward: Dual::of(m.forward),
                };
                let exact = model.torque(&seeded, &lifted).d[0];
                let h = 1e-6 * p[lane].abs().max(1.0);
                let beside = |step: f64| {
                    let mut moved = p.clone();
                    moved[lane] += step;
                    model.torque(&moved, &m)
                };
                let difference = (beside(h) - beside(-h)) / (2.0 * h);
                assert!(
                    (exact - difference).abs() < 1e-6 * (1.0 + exact.abs()),
                    "{} {lane}: {exact} {difference}",
                    id.info().id
                );
            }
        }
    }
}

#[test]
fn rendering_sample_by_sample_equals_prediction_to_the_last_bit() {
    let mut noise = Noise::new(3);
    let at_rest = signals(&|_| 0.0);
    for &id in Id::ALL {
        let model = only(id, &plausible(id, &mut noise));
        let predicted = predict::torque_raw(&model, &at_rest);
        for (at, tau) in predicted.iter().enumerate() {
            let rendered = model.torque(&model.values(), &at_rest.motion(at));
            assert_eq!(rendered.to_bits(), tau.to_bits(), "{} at {at}", id.info().id);
        }
    }
}

#[test]
fn derivatives_over_a_capture_equal_those_at_a_sample() {
    let mut noise = Noise::new(4);
    let model = {
        let mut model = Model::new(Id::ALL, Axis::Rotary);
        let values: Vec<f64> = Id::ALL.iter().flat_map(|id| plausible(*id, &mut noise)).collect();
        model.set_values(&values);
        model
    };
    let at_rest = signals(&|_| 0.0);
    let n = at_rest.len();
    let p = model.values();
    let columns: Vec<Option<usize>> = (0..p.len()).map(Some).collect();
    let mut torque = vec![0.0; n];
    let mut slopes = vec![vec![0.0; n]; p.len()];
    let over = &mut Sweep { motion: at_rest.motion_columns(0..n), torque: &mut torque, slopes: &mut slopes };
    model.sweep(&p, &columns, over);
    for lane in 0..p.len() {
        let seeded: Vec<Dual<f64, 1>> =
            p.iter().enumerate().map(|(i, x)| Dual::seeded(*x, (i == lane).then_some(0))).collect();
        for at in (0..n).step_by(211) {
            let m = at_rest.motion(at);
            let lift = |x: f64| Dual::<f64, 1>::of(x);
            let lifted = Motion {
                t: lift(m.t),
                theta: lift(m.theta),
                omega: lift(m.omega),
                alpha: lift(m.alpha),
                forward: lift(m.forward),
            };
            let one = model.torque(&seeded, &lifted).d[0];
            assert!((one - slopes[lane][at]).abs() <= 1e-12 * (1.0 + one.abs()), "{lane} at {at}");
        }
    }
}

#[test]
fn no_effect_gives_energy_over_a_closed_cycle() {
    let mut noise = Noise::new(5);
    for &id in Id::ALL {
        let model = only(id, &plausible(id, &mut noise));
        let power = |t: f64| {
            let m = motion(t);
            model.torque(&model.values(), &m) * m.omega
        };
        let work: f64 = times().map(power).sum::<f64>() / RATE_HZ;
        let scale: f64 = times().map(|t| power(t).abs()).sum::<f64>() / RATE_HZ;
        assert!(work >= -1e-4 * scale, "{} gives {work} of {scale}", id.info().id);
    }
}

#[test]
fn what_was_simulated_is_what_is_fitted() {
    let mut noise = Noise::new(6);
    for &id in Id::ALL.iter().filter(|id| **id != Id::Karnopp) {
        let mut truth = Model::equation_1(Axis::Rotary, false);
        for (name, value) in [
            ("inertia.M", 0.4),
            ("coulomb.neg", 2.0),
            ("coulomb.pos", 2.0),
            ("viscous.neg", 1.0),
            ("viscous.pos", 1.5),
        ] {
            truth.set(name, value).unwrap();
        }
        // A constant torque shows only where friction is the same both ways.
        truth.tie("coulomb.neg", "coulomb.pos").unwrap();
        if !truth.has(id) {
            truth = truth.with(id).unwrap();
            let values = plausible(id, &mut noise);
            for (param, value) in id.info().params.iter().zip(values) {
                truth.set(&format!("{}.{}", id.info().id, param.name), value).unwrap();
            }
        }
        let data = signals(&|m| truth.torque(&truth.values(), m));
        let mut start = truth.clone();
        let neutral: Vec<f64> = truth
            .slots()
            .iter()
            .map(|slot| if matches!(slot.role, Role::Tied(_)) { 0.0 } else { slot.param.neutral })
            .collect();
        start.set_values(&neutral);
        let found = fit(&[&data], &start, Detents::AsModel).unwrap();
        for (want, got) in truth.slots().iter().zip(found.model.slots()) {
            let error = (want.value - got.value).abs() / want.value.abs().max(1e-3);
            assert!(error < 1e-7, "{}: {} is fitted as {}", want.name(), want.value, got.value);
        }
        assert!(found.undetermined.is_empty(), "{}: {:?}", id.info().id, found.undetermined);
    }
}
