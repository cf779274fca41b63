//! An effect of the user's own obeys the laws of the built-in ones, and is left out where it fails.

use super::*;
use crate::derivatives::{SMOOTH, check};
use crate::rendering::OPEN;
use knobcore::effects::{Does, Function, Info, Nonlinear, User};
use knobcore::motion::Channel;
use knobcore::param::Unit;
use knobrender::{Renderer, Sensed};

const PARAMS: &[Param] = &[
    Param::linear("d", Unit::of(1, -2, 2), "drag"),
    Param::shape("shift", Unit::of(0, 1, -1), [-10.0, 10.0], 0.5, "speed of the air"),
];

fn register(id: &'static str, torque: Function) -> Id {
    register_at(id, Place::Load, &[Channel::Drive], PARAMS, torque)
}

fn register_at(
    id: &'static str,
    place: Place,
    touches: &'static [Channel],
    params: &'static [Param],
    function: Function,
) -> Id {
    let beyond = place != Place::Load;
    let info = Info {
        id,
        place,
        law: "d (omega - shift) |omega - shift|",
        source: "made here",
        shows: "at high speed",
        params,
        confused: &[],
        needs: None,
        touches,
        shapes_friction: Channel::shape_friction(touches),
        presses: false,
        makes_nonlinear: beyond.then_some(Nonlinear::Everything),
        ..*Id::QuadraticDrag.info()
    };
    Id::User(User::register(info, false, Vec::new(), Does::Call(function)).unwrap())
}

fn draught(p: &[f64], motion: &[&[f64]]) -> Vec<f64> {
    motion[2].iter().map(|omega| p[0] * (omega - p[1]) * (omega - p[1]).abs()).collect()
}

#[test]
fn it_is_silent_at_its_neutral_values_and_has_its_derivatives_in_the_chain() {
    let id = register("draught", Box::new(|p, motion| Ok(draught(p, motion))));
    assert!(Id::all().contains(&id) && Id::parse("draught") == Ok(id));
    let model = knob().with(id).unwrap();
    assert_eq!(torque(&model).tau, torque(&knob()).tau);
    check(&at(model, id, &[2e-3, 0.7]), SMOOTH, "draught");
    assert_eq!(user(id).failure(), None);
}

#[test]
fn without_a_shift_it_is_the_drag_of_the_catalogue() {
    let id = register("still_air", Box::new(|p, motion| Ok(draught(p, motion))));
    let own = torque(&at(knob().with(id).unwrap(), id, &[2e-3, 0.0]));
    let drag = Id::QuadraticDrag;
    assert!(apart(&own, &torque(&at(knob_with(drag), drag, &[2e-3]))) < 1e-15);
}

#[test]
fn a_law_that_fails_says_so_and_predicts_nothing() {
    let nan: Function = Box::new(|_, motion| Ok(vec![f64::NAN; motion[0].len()]));
    let short: Function = Box::new(|_, motion| Ok(vec![1.0; motion[0].len() - 1]));
    let raises: Function = Box::new(|_, _| Err("no such material".into()));
    for (name, torque_of, why) in
        [("nan", nan, "NaN"), ("short", short, "values for"), ("raises", raises, "no such material")]
    {
        let id = register(name, torque_of);
        let model = knob().with(id).unwrap();
        assert_eq!(torque(&model).tau, torque(&knob()).tau, "{name}");
        let said = user(id).failure();
        assert!(said.as_ref().is_some_and(|said| said.contains(why)), "{name}: {said:?}");
        assert_eq!(user(id).failure(), None, "{name}: it is said once");
    }
}

/// At every place of the chain an effect of the user's own that says what one of the catalogue says is that one: the
/// torque and, where the catalogue's are exact, nearly the derivatives.
#[test]
fn wherever_it_acts_it_is_the_effect_of_the_catalogue_that_it_repeats() {
    const RISE: Param = Param::shape("rise", Unit::NUMBER, [-1.0, 9.0], 0.0, "rise");
    const FRICTION: &[Param] =
        &[RISE, Param::shape("tau", Unit::of(0, 0, 1), [0.1, 9.0], 1.0, "time constant")];
    const SENSOR: &[Param] = &[Param::shape("limit", Unit::of(1, 0, 0), [1e-3, 1e3], 1e3, "limit")];
    const JOINT: &[Param] = &[
        Param::shape("k", Unit::of(1, -1, 0), [1e-3, 1e5], 1e5, "stiffness"),
        Param::shape("d", Unit::of(1, -1, 1), [1e-9, 1e2], 1e2, "damping"),
        Param::shape("share", Unit::NUMBER, [0.01, 1.0], 0.7, "share"),
    ];
    let warm: Function =
        Box::new(|p, motion| Ok(motion[0].iter().map(|t| 1.0 + p[0] * (-t / p[1]).exp()).collect()));
    let clip: Function =
        Box::new(|p, motion| Ok(motion[5].iter().map(|tau| tau.clamp(-p[0], p[0])).collect()));
    let soft: Function = Box::new(|p, _| Ok(vec![0.0, p[0], p[1], p[2], 1.0]));
    let level: &[Channel] = &[Channel::FrictionScale];
    for (id, place, touches, params, function, as_is, values) in [
        ("own_warmth", Place::Load, level, FRICTION, warm, Id::FrictionDrift, vec![0.8, 0.5]),
        ("own_clip", Place::Sensor, &[], SENSOR, clip, Id::Saturation, vec![0.05]),
        ("own_shaft", Place::Coupling, &[], JOINT, soft, Id::Compliance, vec![5.0, 2e-3, 0.6]),
    ] {
        let own = register_at(id, place, touches, params, function);
        let mine = at(knob().with(own).unwrap(), own, &values);
        let theirs = at(knob_with(as_is), as_is, &values);
        let scale = rms(torque(&theirs).tau.iter().copied());
        assert!(apart(&torque(&mine), &torque(&theirs)) < 1e-9 * scale, "{id}");
        assert!(apart(&torque(&mine), &torque(&knob())) > 1e-3 * scale, "{id} does something");
        check(&mine, SMOOTH, id);
        assert_eq!(user(own).failure(), None);
        if place != Place::Sensor {
            let mut knob = Renderer::new(&mine, RATE_HZ, None, OPEN).unwrap();
            let steps = (0..CYCLE).map(|i| {
                let Motion { theta, omega, alpha, .. } = motion(i as f64 / RATE_HZ);
                knob.step(Sensed { theta, omega, alpha, hand: None })
            });
            let rendered: Vec<f64> = steps.collect();
            let whole = torque(&mine).tau;
            let near = rendered.iter().zip(&whole).filter(|(a, b)| (**a - **b).abs() < 1e-9 * scale).count();
            assert!(near > 9 * CYCLE / 10, "{id}: rendered as predicted but where it sticks: {near}");
        }
    }
}

#[test]
fn a_factor_on_friction_acts_as_larger_friction_whether_a_joint_is_before_it_or_not() {
    const TIMES: &[Param] = &[Param::shape("times", Unit::NUMBER, [0.1, 9.0], 1.0, "factor")];
    let factor: Function = Box::new(|p, motion| Ok(vec![p[0]; motion[0].len()]));
    let own = register_at("own_factor", Place::Load, &[Channel::FrictionScale], TIMES, factor);
    for joined in [false, true] {
        let bare =
            if joined { at(knob_with(Id::Compliance), Id::Compliance, &[5.0, 2e-3, 0.6]) } else { knob() };
        let mut rough = bare.clone();
        rough.set("coulomb.neg", 0.06).unwrap();
        rough.set("coulomb.pos", 0.075).unwrap();
        let neutral = bare.with(own).unwrap();
        assert!(apart(&torque(&neutral), &torque(&bare)) < 1e-15, "{joined}");
        let threefold = at(neutral, own, &[3.0]);
        assert!(apart(&torque(&threefold), &torque(&rough)) < 1e-12, "{joined}");
        check(&threefold, SMOOTH, "own_factor");
    }
}

/// A difference is taken over a step that suits the parameter, whatever its size is.
#[test]
fn derivatives_of_a_users_own_law_hold_for_large_and_small_parameters() {
    const SIZES: &[Param] = &[
        Param::linear("d", Unit::of(1, 0, 0), "torque"),
        Param::shape("w", Unit::of(0, 1, 0), [1e-6, 1e6], 1.0, "period"),
    ];
    let wave: Function = Box::new(|p, m| Ok(m[1].iter().map(|theta| p[0] * (theta / p[1]).sin()).collect()));
    let own = register_at("own_wave", Place::Load, &[Channel::Drive], SIZES, wave);
    let columns = [vec![0.0; 2], vec![0.3, -0.2]];
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let right: [fn(f64, f64) -> f64; 2] = [|w, x| (x / w).sin(), |w, x| -2.0 * x / (w * w) * (x / w).cos()];
    for w in [1e-2, 1.0, 50.0] {
        for (i, right) in right.iter().enumerate() {
            let slope = user(own).slope(&[2.0, w], i, &columns);
            for (found, x) in slope.iter().zip([0.3, -0.2]) {
                assert!((found - right(w, x)).abs() < 1e-5 * right(w, x).abs(), "{w} {i}: {found}");
            }
        }
    }
}

fn user(id: Id) -> &'static User {
    match id {
        Id::User(user) => user,
        _ => panic!("{id:?} is built in"),
    }
}

#[test]
fn a_joint_that_none_can_be_is_rigid_instead_and_the_reason_is_told() {
    for (own, values) in [
        ("own_gap_below_none", [-1e-3, 10.0, 0.0, 0.5, 1.0]),
        ("own_spring_of_none", [0.0, 0.0, 0.0, 0.5, 1.0]),
        ("own_damper_that_drives", [0.0, 10.0, -1e-3, 0.5, 1.0]),
        ("own_share_of_none", [0.0, 10.0, 0.0, 0.0, 1.0]),
        ("own_share_of_more", [0.0, 10.0, 0.0, 1.5, 1.0]),
        ("own_joint_without_end", [0.0, f64::INFINITY, 0.0, 0.5, 1.0]),
        ("own_sound_joint", [1e-3, 10.0, 1e-3, 1.0, 0.0]),
    ] {
        let given = Box::new(move |_: &[f64], _: &[&[f64]]| Ok(values.to_vec()));
        let id = register_at(own, Place::Coupling, &[], PARAMS, given);
        let joint = knob().with(id).unwrap();
        let joint = joint.joint(&joint.values()).unwrap();
        let told = user(id).failure();
        if own == "own_sound_joint" {
            assert_eq!((joint.gap, joint.stiffness, joint.share, joint.welded), (1e-3, 10.0, 1.0, false));
            assert_eq!(told, None);
        } else {
            assert!(joint.gap == 0.0 && joint.stiffness >= 1e5 && joint.share == 0.5, "{own}: {joint:?}");
            assert!(told.unwrap().contains("a joint has gap and damping from 0 on"), "{own}");
        }
    }
}

#[test]
fn behind_a_joint_an_effect_of_ones_own_does_between_two_samples_what_lies_between() {
    let own = register("own_pull", Box::new(|p, motion| Ok(motion[0].iter().map(|t| p[0] * t).collect())));
    let mut model = knob_with(Id::Compliance).with(own).unwrap();
    for (name, value) in [("compliance.k", 2.0), ("compliance.d", 0.01), ("own_pull.d", 20.0)] {
        model.set(name, value).unwrap();
    }
    // Of constant acceleration and a pull that grows evenly, which are known also between samples.
    let torque = |rate_hz: f64, substeps: usize| {
        let t: Vec<f64> = (0..(0.02 * rate_hz) as u32).map(|i| f64::from(i) / rate_hz).collect();
        let over = |of: &dyn Fn(f64) -> f64| t.iter().map(|t| of(*t)).collect::<Vec<f64>>();
        let signals = Signals {
            rate_hz,
            substeps,
            theta: over(&|t| 3.0 * t + 50.0 * t * t),
            omega: over(&|t| 3.0 + 100.0 * t),
            alpha: vec![100.0; t.len()],
            forward: vec![1.0; t.len()],
            weight: vec![1.0; t.len()],
            segments: vec![0..t.len(); 1],
            t: t.clone(),
            ..Signals::default()
        };
        predict::torque_raw(&model, &signals)
    };
    let (few, many) = (torque(1000.0, 8), torque(8000.0, 1));
    for (i, few) in few.iter().enumerate() {
        assert!((few - many[8 * i]).abs() < 1e-12, "{i}: {few} {}", many[8 * i]);
    }
    assert_eq!(user(own).failure(), None);
}
