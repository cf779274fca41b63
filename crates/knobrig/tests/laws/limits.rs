//! Where an effect fades out it leaves what was there without it.

use super::*;

/// Samples on either side of a reversal, where friction turns at once in a rigid knob and soon in any other.
const BESIDE: usize = 4;

/// Root mean square difference from the torque of the knob itself, over its own, away from reversals.
fn share_apart(model: &Model) -> f64 {
    let (with, without) = (torque(model), torque(&knob()));
    let steady = |i: &usize| {
        let around = &without.forward[i - BESIDE..(i + BESIDE).min(2 * CYCLE)];
        around.iter().all(|forward| *forward == around[0])
    };
    let far: Vec<usize> = (CYCLE..2 * CYCLE).filter(steady).collect();
    rms(far.iter().map(|i| with.tau[*i] - without.tau[*i])) / rms(far.iter().map(|i| without.tau[*i]))
}

#[test]
fn presliding_over_no_distance_is_dry_friction() {
    let apart = |s: f64| {
        let mut model = knob_with(Id::Presliding);
        for (name, value) in [("s", s), ("w1", 0.5), ("w3", 0.3), ("w6", 0.2)] {
            model.set(&format!("presliding.{name}"), value).unwrap();
        }
        share_apart(&model)
    };
    let apart = [0.3, 0.03, 3e-3, 3e-6].map(apart);
    assert!(apart[0] > 0.1 && apart.is_sorted_by(|a, b| a > b), "{apart:?}");
    assert!(apart[3] < 1e-6, "{apart:?}");
}

#[test]
fn a_joint_becomes_rigid_as_it_gets_stiff() {
    for &id in Id::BUILT_IN.iter().filter(|id| is_joint(**id)) {
        let apart = |k: f64| {
            // Damped to a half at each stiffness.
            let d = (0.7 * 1.5e-4 * k).sqrt();
            let mut model = knob_with(id);
            model.set(&format!("{}.k", name(id)), k).unwrap();
            model.set(&format!("{}.d", name(id)), d).unwrap();
            share_apart(&model)
        };
        let apart = [1.0, 10.0, 100.0, 1e5].map(apart);
        assert!(apart[0] > 0.02 && apart.is_sorted_by(|a, b| a > b), "{}: {apart:?}", name(id));
        assert!(apart[3] < 2e-3, "{}: {apart:?}", name(id));
    }
}

#[test]
fn a_delay_of_one_sample_shifts_the_torque_by_one_sample() {
    let mut model = knob_with(Id::TorqueLag);
    model.set("torque_lag.delay", 1.0 / RATE_HZ).unwrap();
    let (late, prompt) = (torque(&model).tau, torque(&knob()).tau);
    assert!(late[1..].iter().zip(&prompt).all(|(late, prompt)| (late - prompt).abs() < 1e-15));
}
