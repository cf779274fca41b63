//! What loads the shaft before a joint, and what loads the knob behind it.

use super::derivatives::{Compared, check};
use super::driven::pushed;
use super::rendering::{OPEN, sensed};
use super::*;
use knobcore::model_file;
use knobrender::Renderer;

/// A knob behind a joint that is nearly rigid, with one more effect.
fn stiff(id: Id, noise: &mut Noise) -> Model {
    behind_a_joint(plausible_knob(id, noise))
}

fn behind_a_joint(knob: Model) -> Model {
    let mut model = knob.with(Id::Compliance).unwrap();
    for (name, value) in [("compliance.k", 2e3), ("compliance.d", 0.2), ("compliance.share", 0.6)] {
        model.set(name, value).unwrap();
    }
    model
}

fn loads() -> impl Iterator<Item = Id> {
    Id::BUILT_IN.iter().copied().filter(|id| Model::may_be_at_shaft(*id))
}

#[test]
fn beside_a_joint_that_is_nearly_rigid_a_load_is_the_same_on_either_side() {
    let mut noise = Noise::new(51);
    for id in loads() {
        let knob = stiff(id, &mut noise);
        let shaft = knob.with_at_shaft(id).unwrap();
        let (behind, before) = (torque(&knob).tau, torque(&shaft).tau);
        let bare: Vec<Id> = knob.effects().filter(|other| *other != id).collect();
        let without = torque(&knob.only(&bare).unwrap()).tau;
        let apart = |a: &[f64], b: &[f64]| rms(a.iter().zip(b).skip(CYCLE).map(|(a, b)| a - b));
        let own = apart(&behind, &without);
        // Right at a reversal even a stiff joint lets the knob turn round at another instant.
        assert!(apart(&behind, &before) < 0.5 * own, "{}: {} of {own}", name(id), apart(&behind, &before));
    }
}

#[test]
fn what_loads_the_shaft_does_not_move_the_knob() {
    let mut noise = Noise::new(52);
    for id in loads() {
        let mut soft = stiff(id, &mut noise);
        soft.set("compliance.k", 2.0).unwrap();
        soft.set("compliance.d", 2e-3).unwrap();
        let shaft = soft.with_at_shaft(id).unwrap();
        let bare: Vec<Id> = soft.effects().filter(|other| *other != id).collect();
        let rigid: Vec<Id> = soft.effects().filter(|other| *other != Id::Compliance).collect();
        let rigid = soft.only(&rigid).unwrap();
        let rigid_bare = rigid.only(&bare.iter().copied().filter(|id| rigid.has(*id)).collect::<Vec<_>>());
        let rigid_bare = rigid_bare.unwrap();
        let [whole, joint, with, less] =
            [&shaft, &soft.only(&bare).unwrap(), &rigid, &rigid_bare].map(|model| torque(model).tau);
        let apart = (0..2 * CYCLE).map(|i| (whole[i] - (joint[i] + with[i] - less[i])).abs());
        let most = apart.fold(0.0, f64::max);
        assert!(most < 1e-12, "{}: {most} N m apart", name(id));
    }
}

#[test]
fn derivatives_at_the_shaft_are_those_of_the_finite_difference() {
    let mut noise = Noise::new(53);
    let compared = Compared { step: 1e-7, off: 1e-3, spared: 2e-2 };
    for id in loads() {
        let mut soft = stiff(id, &mut noise);
        soft.set("compliance.k", 2.0).unwrap();
        soft.set("compliance.d", 2e-2).unwrap();
        check(&soft.with_at_shaft(id).unwrap(), compared, name(id));
    }
}

#[test]
fn a_hand_feels_what_loads_the_shaft() {
    let mut noise = Noise::new(54);
    let without = pushed(&behind_a_joint(knob()));
    for id in loads() {
        assert!(!knob().has(id), "{} is in the knob without it", name(id));
        let with = pushed(&stiff(id, &mut noise).with_at_shaft(id).unwrap());
        let moved = rms(with.theta.iter().zip(&without.theta).map(|(a, b)| a - b));
        assert!(moved > 1e-6, "{} moves the hand by {moved} rad", name(id));
    }
}

#[test]
fn what_pushes_at_the_shaft_is_rendered_as_predicted_and_what_rubs_there_is_refused() {
    let mut noise = Noise::new(55);
    let mut rendered = 0;
    for id in loads() {
        let model = stiff(id, &mut noise).with_at_shaft(id).unwrap();
        let whole = torque(&model);
        match Renderer::new(&model, RATE_HZ, None, OPEN) {
            Ok(mut knob) => {
                let made: Vec<f64> = (0..2 * CYCLE).map(|i| knob.step(sensed(i))).collect();
                let apart = rms(made.iter().zip(&whole.tau).skip(CYCLE).map(|(a, b)| a - b));
                assert!(apart < 1e-9 * rms(whole.tau.iter().copied()), "{}: {apart}", name(id));
                rendered += 1;
            }
            Err(why) => assert!(why.to_string().contains("leave out 'at'"), "{why}"),
        }
    }
    assert!(rendered >= 5, "{rendered} are rendered");
}

#[test]
fn a_model_file_says_what_is_at_the_shaft_and_refuses_what_cannot_be() {
    let mut noise = Noise::new(56);
    for id in loads() {
        let model = stiff(id, &mut noise).with_at_shaft(id).unwrap();
        let back = model_file::parse(&model_file::write(&model)).unwrap();
        assert!(back.at_shaft(id) && back.values() == model.values(), "{}", name(id));
    }
    let head = "schema = \"knobcam.model/1\"\n[effects.inertia]\nM = 1e-4\n";
    let drag = "[effects.quadratic_drag]\nat = \"shaft\"\n";
    for (text, way) in [
        (format!("{head}{drag}"), "add backlash or compliance"),
        (format!("{head}[effects.compliance]\n[effects.quadratic_drag]\nat = \"rim\"\n"), "leave it out"),
        (format!("{head}at = \"shaft\"\n[effects.compliance]\n"), "only loads beside"),
    ] {
        let error = model_file::parse(&text).unwrap_err().to_string();
        assert!(error.contains(way), "{error}");
    }
}

#[test]
fn the_knob_behind_a_joint_that_is_nearly_rigid_moves_as_the_shaft_does() {
    let still = signals(|_| 0.0);
    let mut model = stiff(Id::Inertia, &mut Noise::new(57));
    // What turns round with the direction jolts even a stiff joint.
    for name in ["coulomb.neg", "coulomb.pos", "detent.A"] {
        model.set(name, 0.0).unwrap();
    }
    let of = still.motion_columns(0..CYCLE);
    let [theta, omega, alpha] =
        knobcore::chain::knob(&model, &model.values(), of, 1.0 / RATE_HZ, Follow::of(SUBSTEPS)).unwrap();
    for (name, found, right) in
        [("angle", theta, of[1]), ("speed", omega, of[2]), ("acceleration", alpha, of[3])]
    {
        let (off, scale) = (rms(found.iter().zip(right).map(|(a, b)| a - b)), rms(right.iter().copied()));
        assert!(off < 0.03 * scale, "{name}: {off} of {scale}");
    }
}

/// How a hand that is strong beside the knob moves it, in 0.1 s.
fn led(model: &Model) -> knobcore::chain::Pushed {
    let reference: Vec<f64> = (0..100).map(|i| 0.3 * (TAU * f64::from(i) / 100.0).sin()).collect();
    let hand = knobcore::chain::Hand { stiffness: 5.0, damping: 0.02 };
    knobcore::chain::push(model, &reference, 1e-3, hand).unwrap()
}

#[test]
fn a_hand_at_a_joint_that_is_nearly_rigid_moves_what_it_would_move_without() {
    let mut noise = Noise::new(58);
    for id in [Id::Inertia, Id::ReturnSpring, Id::QuadraticDrag, Id::Coulomb] {
        let rigid = plausible_knob(id, &mut noise);
        let mut joined = stiff(id, &mut noise);
        for slot in rigid.slots() {
            joined.set(&slot.name(), slot.value).unwrap();
        }
        let mut both = vec![joined.clone()];
        both.extend(Model::may_be_at_shaft(id).then(|| joined.with_at_shaft(id).unwrap()));
        let right = led(&rigid);
        for model in both {
            let found = led(&model);
            for (name, found, right, share) in [
                ("angle", &found.theta, &right.theta, 3e-3),
                ("speed", &found.omega, &right.omega, 2e-2),
                ("torque", &found.tau, &right.tau, 5e-2),
            ] {
                let off = rms(found.iter().zip(right).map(|(a, b)| a - b)) / rms(right.iter().copied());
                assert!(off < share, "{}: {name} by {off}", self::name(id));
            }
        }
    }
}
