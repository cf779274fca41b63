//! Chance: where nothing is missing, a p-value is as often small as it says.

use super::*;
use knobcore::diagnose::diagnose;
use knobcore::filter::{ZeroPhase, cheby2};
use knobcore::fit::refine;

/// Captures of a faultless knob.
const RUNS: usize = 40;
/// Standard deviation of the torque sensor, N m.
pub const NOISE: f64 = 1.8e-3;
/// Effects of every nature but joints, which take long: a factor on friction, a force, a map, a sensor.
const WEIGHED: [Id; 5] =
    [Id::Stribeck, Id::QuadraticDrag, Id::DetentHarmonics, Id::ReturnSpring, Id::FrictionDrift];

/// A knob's torque with noise, through the measurement filter.
pub fn noisy(model: &Model, seed: u64) -> Signals {
    let mut noise = Noise::new(seed);
    let mut signals = torque(model);
    signals.tau_raw.iter_mut().for_each(|tau| *tau += NOISE * noise.normal());
    signals.filter = Some(ZeroPhase::new(cheby2(3, 20.0, 500.0, RATE_HZ).unwrap()));
    signals.filter_torque();
    let n = signals.len();
    for (at, weight) in signals.weight.iter_mut().enumerate() {
        *weight = f64::from(u8::from((100..n - 100).contains(&at)));
    }
    signals
}

#[test]
fn where_nothing_is_missing_small_p_values_are_as_rare_as_they_say() {
    let best: Vec<f64> = (0..RUNS as u64)
        .map(|run| {
            let signals = noisy(&knob(), 700 + run);
            let fit = refine(&[&signals], &knob()).unwrap();
            let found = diagnose(&[&signals], &fit.model, &WEIGHED, &|_| true).unwrap();
            found.iter().map(|candidate| candidate.p_value).fold(1.0, f64::min)
        })
        .collect();
    let below = |p: f64| best.iter().filter(|own| **own <= p).count();
    // Four and twenty are expected; a fair count is outside of these once in a thousand times.
    assert!(below(0.1) <= 11, "{best:?}");
    assert!((9..=31).contains(&below(0.5)), "{best:?}");
}
