//! Kept answers: small captures go the whole way from sensors to what is said to be missing, and all numbers are those
//! that were kept. A test that fails here says that answers changed, not that they are wrong: look at what changed, and
//! where it is meant, make the files anew and commit them with the reason.

#[path = "../../../knobcore/src/tests/answers.rs"]
mod answers;
mod captures;
mod catalogue;
mod formulas;
mod rendering;
mod sensors;
mod spaces;
mod stages;

use answers::Answers;
use captures::{Chance, RATE_HZ, Recorded, WAVES, Waves, base, joined, recorded};
use knobcore::diagnose::pairs;
use knobcore::effects::Id;
use knobcore::effects::formula::written::{Asked, register};
use knobcore::fit::{Detents, refine};
use knobcore::model::Model;
use knobcore::param::Axis;
use knobcore::prepare::Preparation;
use knobcore::signals::Signals;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

const COUNT: usize = 2500;

fn equation_1(detents: bool) -> Model {
    Model::equation_1(Axis::Rotary, detents)
}

/// Goes all the way with one capture and the model without detents, unless there are some.
fn searched(name: &str, capture: &Recorded) {
    let mut told = Answers::of(name);
    stages::all(&mut told, &[&capture.smooth("a")], &equation_1(false), Detents::Find, None);
    told.done();
}

#[test]
fn nothing_is_missing() {
    searched("nothing", &recorded(COUNT, &WAVES, 0.0, 1, |_, motion| base(motion)));
}

#[test]
fn detents_with_a_harmonic() {
    let detents = |theta: f64| 0.03 * (theta / 0.08 + 0.7).sin() + 6e-3 * (2.0 * theta / 0.08).sin();
    searched("detents", &recorded(COUNT, &WAVES, 0.0, 2, |_, motion| base(motion) + detents(motion[0])));
}

#[test]
fn friction_that_rises_towards_standstill_in_coloured_noise() {
    let rises = |omega: f64| 8e-3 * omega.signum() * (-(omega.abs() / 0.8)).exp();
    searched("stribeck", &recorded(COUNT, &WAVES, 0.8, 3, |_, motion| base(motion) + rises(motion[1])));
}

#[test]
fn friction_that_warms_up_and_a_sensor_that_drifts() {
    let warms = |t: f64, omega: f64| 6e-3 * omega.signum() * (-t / 0.7).exp() + 2e-3 * t;
    searched("drift", &recorded(COUNT, &WAVES, 0.0, 4, |t, motion| base(motion) + warms(t, motion[1])));
}

#[test]
fn a_torque_that_comes_late() {
    let mut behind = 0.0;
    let late = move |_: f64, motion: [f64; 3]| {
        behind += (base(motion) - behind) * (1.0 - (-1.0_f64 / 4.0).exp());
        behind
    };
    searched("lag", &recorded(COUNT, &WAVES, 0.0, 5, late));
}

#[test]
fn friction_that_builds_up_after_each_reversal() {
    let (mut last, mut strain) = (0.0, 0.0_f64);
    let builds = move |_: f64, motion: [f64; 3]| {
        strain = (strain + (motion[0] - last) / 0.05).clamp(-1.0, 1.0);
        last = motion[0];
        base(motion) + 8e-3 * (strain - motion[1].signum())
    };
    searched("presliding", &recorded(COUNT, &WAVES, 0.0, 6, builds));
}

#[test]
fn two_runs_with_a_spring_a_drag_and_each_its_own_zero() {
    let more = |[theta, omega, _]: [f64; 3]| 5e-3 * (theta - 0.1) + 2e-4 * omega * omega.abs();
    let other = [[0.7, 6.3], [0.25, 17.0]];
    let run = |waves: Waves, seed: u64, zero: f64| {
        recorded(COUNT, waves, 0.0, seed, |_, motion| base(motion) + more(motion) + zero)
    };
    let [one, two] = [run(&WAVES, 7, 2e-3), run(&other, 8, -3e-3)];
    let mut told = Answers::of("two");
    let captures = [&one.smooth("a"), &two.smooth("bb")];
    stages::all(&mut told, &captures, &equation_1(false), Detents::AsModel, None);
    told.done();
}

#[test]
fn repeats_of_a_motion_through_a_sensor_that_was_smoothed() {
    let mut capture = recorded(3000, &[[0.9, TAU], [0.2, 2.0 * TAU]], 0.97, 9, |_, motion| {
        base(motion) + 4e-3 * (motion[0] - 0.2).powi(2)
    });
    let mut smooth = 0.0;
    for tau in &mut capture.tau {
        smooth += 0.4 * (*tau - smooth);
        *tau = smooth;
    }
    searched("smoothed", &capture);
}

#[test]
fn an_angle_alone_in_steps_with_gaps_bridges_and_a_slow_torque() {
    let mut capture = recorded(3000, &WAVES, 0.0, 10, |_, motion| base(motion) + 5e-3 * motion[0]);
    capture.theta.iter_mut().for_each(|theta| *theta = (*theta / 1e-3).round() * 1e-3);
    (capture.omega, capture.alpha) = (None, None);
    // A hundred rows are lost; three are bridged; one reading is far off; the torque is new at every other row.
    capture.t.iter_mut().skip(1200).for_each(|t| *t += 0.1);
    capture.after_gap[1200] = true;
    (700..703).for_each(|at| capture.measured[at] = false);
    capture.theta[2100] += 0.3;
    (0..3000).step_by(2).for_each(|at| capture.tau[at] = f64::NAN);
    searched("steps", &capture);
}

#[test]
fn impacts_and_readings_that_are_far_off() {
    // At each of its ends the knob is thrown back: its acceleration is there for a few samples alone.
    let mut chance = Chance(11);
    let mut capture = recorded(COUNT, &[[0.8, 7.0]], 0.0, 11, |_, motion| base(motion));
    let thrown = |at: usize| (at % 400) as f64 / 400.0;
    for at in 0..COUNT {
        let (leg, up) = (thrown(at), (at / 400).is_multiple_of(2));
        let way = if up { 1.0 } else { -1.0 };
        let speed = way * 2.5;
        let hit = if at % 400 < 4 && at > 4 { way * 5.0 / 4e-3 } else { 0.0 };
        capture.theta[at] = way * (leg - 0.5) + 2e-5 * chance.normal();
        if let (Some(omega), Some(alpha)) = (&mut capture.omega, &mut capture.alpha) {
            omega[at] = speed + 2e-3 * chance.normal();
            alpha[at] = hit + 0.5 * chance.normal();
            if at == 901 {
                omega[at] += 1.0;
            }
        }
        capture.tau[at] = base([0.0, speed, hit]) + 1e-3 * chance.normal();
    }
    let mut told = Answers::of("impacts");
    stages::prepared(&mut told, &capture.smooth("a"));
    told.done();
}

#[test]
fn a_motor_that_cogs_before_other_preparations() {
    let cogs = |theta: f64| 8e-3 * (12.0 * theta + 0.4).sin() + 5e-3 * (24.0 * theta).cos();
    let fast = [[3.5, 3.1], [0.3, 9.7]];
    let capture = recorded(3000, &fast, 0.0, 12, |_, motion| base(motion) + cogs(motion[0]));
    let mut told = Answers::of("cogging");
    for how in [Preparation::paper(RATE_HZ), Preparation::none(), Preparation::differences(80.0, 4)] {
        stages::prepared(&mut told, &capture.prepared("a", &how));
    }
    let effects = [Id::Cogging, Id::Unbalance, Id::SecondDetent, Id::DirectionalDetent, Id::Wavelet];
    stages::all(&mut told, &[&capture.smooth("a")], &equation_1(false), Detents::AsModel, Some(&effects));
    told.done();
}

#[test]
fn a_slide_that_runs_into_its_stops() {
    let stops = |x: f64| 0.8 * (x - 0.9).max(0.0) - 0.6 * (-0.8 - x).max(0.0);
    let mut capture = recorded(COUNT, &WAVES, 0.0, 13, |_, motion| base(motion) + stops(motion[0]));
    capture.axis = Axis::Linear;
    let mut told = Answers::of("slide");
    let model = Model::equation_1(Axis::Linear, false);
    let effects = [Id::EndStop, Id::PositionPolynomial, Id::Regional, Id::ReturnSpring, Id::PositionFriction];
    stages::all(&mut told, &[&capture.smooth("a")], &model, Detents::AsModel, Some(&effects));
    told.done();
}

#[test]
fn a_law_of_ones_own() {
    let bends = |omega: f64| 0.02 * (omega / 2.0) / (1.0 + (omega / 2.0).powi(2));
    let capture = recorded(COUNT, &WAVES, 0.0, 14, |_, motion| base(motion) + bends(motion[1]));
    let law = register("kept_law", "load", "2 a (omega/w) / (1 + (omega/w)^2)", &BTreeMap::new()).unwrap();
    let asked = BTreeMap::from([("w".to_owned(), Asked { bounds: [0.1, 9.0], ..Asked::default() })]);
    let scales = register("kept_factor", "friction", "1 + c exp(-(theta/w)^2)", &asked).unwrap();
    let mut told = Answers::of("own");
    let effects = [Id::User(law), Id::User(scales), Id::Stribeck, Id::QuadraticDrag];
    stages::all(&mut told, &[&capture.smooth("a")], &equation_1(false), Detents::AsModel, Some(&effects));
    told.done();
}

/// A knob behind a joint: what is said of joints, of what is beside them, and with one in the model.
fn coupled(
    name: &str,
    torque: impl FnMut(f64, [f64; 3]) -> f64,
    joint: Id,
    values: &[(&str, f64)],
    beside: &[Id],
) {
    let capture = recorded(1500, &WAVES, 0.0, 15, torque).smooth("a");
    let data: [&Signals; 1] = [&capture.signals];
    let mut told = Answers::of(name);
    let effects = [joint, Id::TorqueLag];
    stages::all(&mut told, &[&capture], &equation_1(false), Detents::AsModel, Some(&effects));
    let mut model = equation_1(false).with(joint).unwrap();
    let base = [("inertia.M", 1e-4), ("coulomb.neg", 8e-3), ("coulomb.pos", 8e-3)];
    base.iter().chain(values).for_each(|(name, value)| model.set(name, *value).unwrap());
    let before = refine(&data, &model).unwrap();
    stages::fitted(&mut told, "joined", &data, &before);
    stages::diagnosed(&mut told, &data, &before, &[], beside);
    told.done();
}

#[test]
fn a_joint_that_gives() {
    let values = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
    let beside = [Id::ReturnSpring, Id::QuadraticDrag];
    coupled("compliance", joined(0.0, [0.3, 2e-3]), Id::Compliance, &values, &beside);
}

#[test]
fn a_joint_with_play() {
    // Soft contacts: after hard ones a knob goes on by the last digit, and a search ends by the instruction set, as one for
    // what is not there does after soft ones too.
    let values = [("backlash.gap", 0.04), ("backlash.k", 3.0), ("backlash.d", 0.03)];
    coupled("backlash", joined(0.04, [3.0, 0.03]), Id::Backlash, &values, &[]);
}

#[test]
fn a_joint_and_a_spring_at_once() {
    let mut gives = joined(0.0, [0.5, 2e-3]);
    let torque = move |t: f64, motion: [f64; 3]| gives(t, motion) + 0.01 * motion[0];
    let capture = recorded(1200, &WAVES, 0.0, 16, torque).smooth("a");
    let data: [&Signals; 1] = [&capture.signals];
    let before = refine(&data, &equation_1(false)).unwrap();
    let mut told = Answers::of("pairs");
    let found = pairs(&data, &before.model, &[Id::Compliance, Id::ReturnSpring, Id::Stribeck], &|_| true);
    for pair in found.unwrap() {
        let name = format!("{} {}", pair.coupling.info().id, pair.companion.info().id);
        stages::sure(&mut told, name, &pair.fit);
    }
    told.done();
}
