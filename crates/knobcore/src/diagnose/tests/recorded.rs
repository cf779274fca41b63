//! A knob and a capture of it, for tests of what is said to be missing.

use crate::effects::Id;
use crate::model::{Model, Run};
use crate::param::Axis;
use crate::predict;
use crate::random;
use crate::signals::Signals;

const RATE_HZ: f64 = 1000.0;
/// Standard deviation of the torque sensor, N m.
pub const SD: f64 = 1e-3;

/// A knob turned to and fro for four seconds, with noise.
pub fn recorded(model: &Model, run: &str) -> Signals {
    let over = |of: &dyn Fn(f64) -> f64| (0..4000).map(|i| of(f64::from(i) / RATE_HZ)).collect::<Vec<f64>>();
    let parts = [(0.9, 3.1), (0.2, 7.3), (0.03, 31.0)];
    let sum =
        |t: f64, of: &dyn Fn(f64, f64, f64) -> f64| parts.iter().map(|(a, w)| of(*a, *w, t)).sum::<f64>();
    let omega = over(&|t| sum(t, &|a, w, t| a * w * (w * t).cos()));
    let mut signals = Signals {
        run: Run { name: run.into(), fingerprint: run.into() },
        rate_hz: RATE_HZ,
        substeps: 2,
        t: over(&|t| t),
        theta: over(&|t| sum(t, &|a, w, t| a * (w * t).sin())),
        alpha: over(&|t| sum(t, &|a, w, t| -a * w * w * (w * t).sin())),
        forward: omega.iter().map(|omega| f64::from(u8::from(*omega > 0.0))).collect(),
        omega_sd: vec![0.0; omega.len()],
        weight: vec![1.0; omega.len()],
        segments: vec![0..omega.len(); 1],
        omega,
        ..Signals::default()
    };
    let mut noise = random::Noise::new(run.len() as u64 + 3);
    signals.tau_raw =
        predict::torque_raw(model, &signals).iter().map(|tau| tau + SD * noise.normal()).collect();
    signals.tau = signals.tau_raw.clone();
    signals
}

/// A knob without detents, of so many effects more, with these values.
pub fn knob(effects: &[Id], values: &[(&str, f64)]) -> Model {
    let mut model = Model::equation_1(Axis::Rotary, false);
    for id in effects {
        model = model.with(*id).unwrap();
    }
    let base = [("inertia.M", 1e-4), ("coulomb.neg", 8e-3), ("coulomb.pos", 8e-3)];
    base.iter().chain(values).for_each(|(name, value)| model.set(name, *value).unwrap());
    model
}
