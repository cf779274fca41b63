//! Laws that the physics obeys: a product of effects and laws, no effect named but where a law says why.

mod catalogue;
mod chance;
mod derivatives;
mod driven;
mod implausible;
mod limits;
mod located;
mod missing;
mod recovery;
mod rendering;
mod runs;
mod scales;
mod sides;
mod stated;
mod symmetry;
mod units;
mod user;

use knobcore::chain::{Follow, SUBSTEPS};
use knobcore::effects::{Id, Place, Survey};
use knobcore::model::{Model, Role};
use knobcore::motion::Motion;
use knobcore::param::{Axis, Kind, Param, Usual};
use knobcore::predict;
use knobcore::random::Noise;
use knobcore::signals::Signals;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 5000.0;
/// The motion repeats after so many samples, and is as long as two cycles.
const CYCLE: usize = 5000;

/// A motion that goes forth and back over many positions and speeds and ends where it began.
fn motion(t: f64) -> Motion<f64> {
    let (mut theta, mut omega, mut alpha) = (0.0, 0.0, 0.0);
    for (k, size) in [(1.0, 0.9), (3.0, 0.2), (7.0, 0.02)] {
        let w = TAU * k * RATE_HZ / CYCLE as f64;
        theta += size * (w * t + k).sin();
        omega += size * w * (w * t + k).cos();
        alpha -= size * w * w * (w * t + k).sin();
    }
    Motion::exact(t, theta, omega, alpha)
}

/// Two cycles of the motion as a capture of that torque (N m, one value a sample), exact and unfiltered.
fn signals(tau: impl Fn(&Motion<f64>) -> f64) -> Signals {
    let motions: Vec<Motion<f64>> = (0..2 * CYCLE).map(|i| motion(i as f64 / RATE_HZ)).collect();
    let column = |of: fn(&Motion<f64>) -> f64| motions.iter().map(of).collect::<Vec<f64>>();
    let tau: Vec<f64> = motions.iter().map(tau).collect();
    Signals {
        rate_hz: RATE_HZ,
        substeps: SUBSTEPS,
        t: column(|m| m.t),
        theta: column(|m| m.theta),
        omega: column(|m| m.omega),
        alpha: column(|m| m.alpha),
        forward: column(|m| m.forward),
        omega_sd: vec![0.0; tau.len()],
        weight: vec![1.0; tau.len()],
        segments: vec![0..tau.len(); 1],
        tau_raw: tau.clone(),
        tau,
        ..Signals::default()
    }
}

/// A knob of the size of the paper's, with detents.
fn knob() -> Model {
    let mut model = Model::equation_1(Axis::Rotary, true);
    for (name, value) in [
        ("inertia.M", 1.5e-4),
        ("coulomb.neg", 0.02),
        ("coulomb.pos", 0.025),
        ("viscous.neg", 1e-3),
        ("viscous.pos", 1.5e-3),
        ("detent.A", 0.05),
        ("detent.P", 0.11),
        ("detent.S", 0.4),
    ] {
        model.set(name, value).unwrap();
    }
    model
}

/// The knob with one effect more, at its neutral values; the knob itself where it has the effect.
fn knob_with(id: Id) -> Model {
    let knob = knob();
    if knob.has(id) { knob } else { knob.with(id).unwrap() }
}

/// What the catalogue may know of a capture before it fits.
fn survey(signals: &Signals) -> Survey {
    let sorted = |column: Vec<f64>| {
        let mut column = column;
        column.sort_by(f64::total_cmp);
        column
    };
    let sizes = |column: &[f64]| sorted(column.iter().map(|x| x.abs()).collect());
    Survey {
        theta: sorted(signals.theta.clone()),
        speed: sizes(&signals.omega),
        torque: sizes(&signals.tau),
        duration_s: signals.len() as f64 / RATE_HZ,
        rate_hz: RATE_HZ,
        inertia: knob().values()[0],
        friction: [knob().values()[1], knob().values()[2]],
        revolution: Some(1.0),
        waves: None,
    }
}

/// Where a search for the effect begins: of the starts that it names itself the one in the middle.
fn start(id: Id) -> Vec<f64> {
    let starts = id.law().starts(&survey(&torque(&knob())));
    starts[starts.len() / 2].clone()
}

/// Values that a real effect could have: near a start, and with an amplitude where the start has none.
fn plausible(id: Id, noise: &mut Noise) -> Vec<f64> {
    let params = id.info().params.iter();
    params
        .zip(start(id))
        .map(|(param, start)| {
            let random = noise.uniform();
            match param.kind {
                Kind::Linear => 0.01 + 0.01 * random,
                Kind::PhaseOf(_) => TAU * (random - 0.5),
                Kind::Nonlinear if start == 0.0 => {
                    (0.05 + 0.1 * random).min((0.5 + 0.5 * random) * param.scale())
                }
                Kind::Nonlinear
                    if matches!(
                        param.usual,
                        Usual::Fixed | Usual::FreeAlong | Usual::Weighs(_) | Usual::WherePaid(_)
                    ) =>
                {
                    start
                }
                Kind::Nonlinear => (start * (0.85 + 0.3 * random)).clamp(param.lower, param.upper),
            }
        })
        .collect()
}

/// The model with the parameters of one effect at these values; parameters that are tied stay so.
fn at(mut model: Model, id: Id, values: &[f64]) -> Model {
    let own: Vec<_> = model.slots().iter().filter(|slot| slot.effect == id).cloned().collect();
    for (slot, value) in own.iter().zip(values) {
        if !matches!(slot.role, Role::Tied(_)) {
            model.set(&slot.name(), *value).unwrap();
        }
    }
    model
}

/// The knob with an effect at values that it could have.
fn plausible_knob(id: Id, noise: &mut Noise) -> Model {
    let model = knob_with(id);
    if knob().has(id) { model } else { at(model, id, &plausible(id, noise)) }
}

/// The capture that the model's own torque would be, without noise.
fn torque(model: &Model) -> Signals {
    let still = signals(|_| 0.0);
    let tau = predict::torque_raw(model, &still);
    Signals { tau_raw: tau.clone(), tau, ..still }
}

fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = x.fold((0, 0.0), |(n, sum), x| (n + 1, sum + x * x));
    (sum / f64::from(n.max(1))).sqrt()
}

/// Root mean square difference over the second cycle, when what the start did is over.
fn apart(a: &Signals, b: &Signals) -> f64 {
    rms(a.tau.iter().zip(&b.tau).skip(CYCLE).map(|(a, b)| a - b))
}

fn name(id: Id) -> &'static str {
    id.info().id
}

fn is_joint(id: Id) -> bool {
    id.info().place == Place::Coupling
}
