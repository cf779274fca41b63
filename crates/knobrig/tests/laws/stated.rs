//! Laws that are written as formulas act wherever those of the catalogue do, and what repeats one of them is that one.

use super::derivatives::{Compared, SMOOTH, check};
use super::driven::{off, pushed, seen};
use super::rendering::{OPEN, sensed};
use super::*;
use knobcore::chain::{Hand, push};
use knobcore::effects::formula::written::made;
use knobcore::model_file;
use knobrender::Renderer;
use std::collections::BTreeMap;

/// Name, how it acts, law, and the values of its parameters.
type Row = (&'static str, &'static str, &'static str, &'static [f64]);

/// One of everything that a law may look at.
const LAWS: [Row; 9] = [
    ("of_speed", "load", "2 a (omega/w) / (1 + (omega/w)^2)", &[0.01, 3.0]),
    ("of_distance", "load", "a direction exp(-s/b)", &[0.01, 0.3]),
    ("of_time", "load", "a sin(v t + p)", &[0.005, 30.0, 0.4]),
    ("of_acceleration", "load", "m alpha cos(theta)^2 - h omega^2 sin(2 theta)", &[8e-5, 4e-5]),
    ("worn_in", "friction", "1 + r exp(-s/b)", &[0.8, 0.2]),
    ("tooth", "friction", "1 + h exp(-((theta - c)/b)^2)", &[2.0, 0.3, 0.2]),
    ("mesh", "load", "(a + b exp(-|omega|/w)) |load| sign(omega)", &[0.3, 0.2, 2.0]),
    ("hum", "sensor", "a sin(v t)", &[0.004, 40.0]),
    ("pull_of_a_cable", "sensor", "g theta + c |omega|", &[0.004, 1e-3]),
];

fn stated((name, acts, law, _): Row) -> Id {
    Id::User(made(name, acts, law, &BTreeMap::new()).unwrap())
}

/// A knob with the law, or without one; where asked for behind a joint.
fn with(row: Option<Row>, joined: bool) -> Model {
    let bare =
        if joined { at(knob_with(Id::Compliance), Id::Compliance, &[20.0, 5e-3, 0.6]) } else { knob() };
    match row {
        Some(row) => at(bare.with(stated(row)).unwrap(), stated(row), row.3),
        None => bare,
    }
}

fn rendered(model: &Model) -> Vec<f64> {
    let mut knob = Renderer::forced(model, RATE_HZ, None, OPEN).unwrap();
    (0..CYCLE).map(|i| knob.step(sensed(i))).collect()
}

fn most_apart(a: &[f64], b: &[f64], at: impl Fn(&usize) -> bool) -> f64 {
    (0..a.len().min(b.len())).filter(at).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

#[test]
fn every_law_changes_what_is_predicted_what_a_hand_feels_and_what_is_rendered() {
    for joined in [false, true] {
        let bare = with(None, joined);
        let (predicted, felt, steps) = (torque(&bare), pushed(&bare), rendered(&bare));
        let scale = rms(predicted.tau.iter().copied());
        for row in LAWS {
            let model = with(Some(row), joined);
            let what = format!("{} {joined}", row.0);
            assert!(apart(&torque(&model), &predicted) > 1e-3 * scale, "{what}: predicted");
            assert!(most_apart(&pushed(&model).tau, &felt.tau, |_| true) > 1e-4, "{what}: felt");
            let steps = most_apart(&rendered(&model), &steps, |_| true);
            // What a sensor adds stays behind on the rig.
            assert_eq!(steps > 1e-4, row.1 != "sensor", "{what}: rendered, {steps}");
        }
    }
}

#[test]
fn a_hand_feels_and_a_step_renders_what_is_predicted_on_the_same_motion() {
    for row in LAWS {
        for joined in [false, true] {
            let model = with(Some(row), joined);
            let what = format!("{} {joined}", row.0);
            let pushed = pushed(&model);
            let predicted = predict::torque_raw(&model, &seen(&pushed));
            let rests = |i: usize| pushed.omega[i] == 0.0;
            let moves =
                |i: &usize| joined || (i.saturating_sub(600)..=(i + 30).min(CYCLE - 1)).all(|i| !rests(i));
            let most = most_apart(&predicted, &pushed.tau, moves);
            assert!(most < 1e-9, "{what}: {most} N m apart from what a hand feels");
            if row.1 == "sensor" {
                continue;
            }
            let whole = torque(&model);
            let slides = |i: &usize| *i > 100 && (i - 60..=*i).all(|j| whole.forward[j] == whole.forward[*i]);
            let most = most_apart(&rendered(&model), &whole.tau, slides);
            assert!(most < 1e-9, "{what}: {most} N m apart from what is rendered");
        }
    }
}

#[test]
fn the_torque_of_a_motion_makes_that_motion_with_every_law() {
    for row in LAWS {
        let model = with(Some(row), false);
        let signals = torque(&model);
        let (made, bare) = (off(&model, &signals), off(&knob(), &signals));
        assert!(made < 5e-4 && made < 0.6 * bare, "{}: {made} with it, {bare} without", row.0);
    }
}

#[test]
fn derivatives_of_every_law_are_those_of_differences_also_behind_a_joint() {
    for row in LAWS {
        check(&with(Some(row), false), SMOOTH, row.0);
        // Where the knob turns round behind the joint depends on every parameter.
        let compared = Compared { step: 1e-6, off: 1e-3, spared: 1e-2 };
        check(&with(Some(row), true), compared, row.0);
    }
}

#[test]
fn what_repeats_an_effect_of_the_catalogue_is_that_effect_in_every_motion() {
    let repeats: [(Row, Id, &[f64]); 4] = [
        (("drag_again", "load", "d omega |omega|", &[2e-3]), Id::QuadraticDrag, &[2e-3]),
        (("warmth_again", "friction", "1 + r exp(-t/b)", &[0.8, 0.5]), Id::FrictionDrift, &[0.8, 0.5]),
        (("gear_again", "load", "m |load| sign(omega)", &[0.3]), Id::LoadFriction, &[0.3, 1.0, 1.0]),
        (("zero_again", "sensor", "c", &[0.003]), Id::Offset, &[0.003]),
    ];
    for (row, id, values) in repeats {
        for joined in [false, true] {
            let (own, theirs) =
                (with(Some(row), joined), at(with(None, joined).with(id).unwrap(), id, values));
            let what = format!("{} {joined}", row.0);
            assert!(most_apart(&torque(&own).tau, &torque(&theirs).tau, |_| true) < 1e-12, "{what}");
            let (mine, others) = (pushed(&own), pushed(&theirs));
            assert!(most_apart(&mine.theta, &others.theta, |_| true) < 1e-9, "{what}: pushed");
            assert!(most_apart(&mine.tau, &others.tau, |_| true) < 1e-9, "{what}: pushed");
            assert!(most_apart(&rendered(&own), &rendered(&theirs), |_| true) < 1e-12, "{what}: rendered");
        }
    }
}

#[test]
fn what_is_in_proportion_to_the_acceleration_is_inertia() {
    let row: Row = ("mass", "load", "m alpha", &[5e-5]);
    let own = with(Some(row), false);
    let mut heavy = knob();
    heavy.set("inertia.M", 2e-4).unwrap();
    assert!(most_apart(&torque(&own).tau, &torque(&heavy).tau, |_| true) < 1e-12);
    let (mine, others) = (pushed(&own), pushed(&heavy));
    assert!(most_apart(&mine.theta, &others.theta, |_| true) < 1e-9);
    assert!(most_apart(&rendered(&own), &rendered(&heavy), |_| true) < 1e-12);
    // Also as a load on what slides.
    let pressed =
        |model: Model| at(model.with(Id::LoadFriction).unwrap(), Id::LoadFriction, &[0.4, 0.7, 0.9]);
    let (own, heavy) = (pressed(own), pressed(heavy));
    assert!(most_apart(&torque(&own).tau, &torque(&heavy).tau, |_| true) < 1e-12);
    check(&own, SMOOTH, "mass that presses");
}

#[test]
fn a_law_at_the_shaft_loads_it_and_does_not_move_the_knob() {
    for row in LAWS.into_iter().filter(|row| Model::may_be_at_shaft(stated(*row))) {
        let shaft = with(Some(row), true).with_at_shaft(stated(row)).unwrap();
        let again = model_file::parse(&model_file::write(&shaft)).unwrap();
        let models = [&again, &with(None, true), &with(Some(row), false), &with(None, false)];
        let [whole, joint, rigid, bare] = models.map(|model| torque(model).tau);
        let sum: Vec<f64> = (0..whole.len()).map(|i| joint[i] + rigid[i] - bare[i]).collect();
        assert!(most_apart(&whole, &sum, |_| true) < 1e-12, "{}", row.0);
    }
}

#[test]
fn a_law_that_bends_over_the_acceleration_is_refused_where_a_motion_is_simulated() {
    let row: Row = ("bent", "load", "a |alpha|", &[1e-6]);
    let model = with(Some(row), false);
    assert!(most_apart(&torque(&model).tau, &torque(&knob()).tau, |_| true) > 1e-5);
    let hand = Hand { stiffness: 0.4, damping: 4e-3 };
    let error = push(&model, &[0.0, 0.1], 1.0 / RATE_HZ, hand).unwrap_err().to_string();
    assert!(error.contains("'bent'") && error.contains("alpha"), "{error}");
    let error = model.with(Id::Compliance).unwrap_err().to_string();
    assert!(error.contains("'bent'") && error.contains("leave alpha out"), "{error}");
}

#[test]
fn two_models_may_have_each_its_own_law_of_one_name_and_the_catalogue_has_neither() {
    let file = |law: &str| {
        let head = "schema = \"knobcam.model/1\"\n[effects.inertia]\nM = 1e-4\n";
        model_file::parse(&format!("{head}[effects.namesake]\nlaw = \"{law}\"\na = 0.01\n")).unwrap()
    };
    let (one, other) = (file("a sin(theta)"), file("a cos(theta)"));
    let (same, text) = (file("a sin(theta)"), model_file::write(&one));
    assert!(!Id::all().iter().any(|id| name(*id) == "namesake"));
    assert!(apart(&torque(&one), &torque(&other)) > 1e-4);
    assert_eq!(torque(&one).tau, torque(&same).tau);
    assert!(one.effects().eq(same.effects()) && !one.effects().eq(other.effects()));
    assert_eq!(model_file::write(&model_file::parse(&text).unwrap()), text);
}

#[test]
fn a_law_without_a_value_somewhere_is_named_and_never_rendered() {
    let row: Row = ("steep_place", "load", "a log(theta/c + 1)", &[1e-3, 0.5]);
    let model = with(Some(row), false);
    let error = model.watched(|| torque(&model)).unwrap_err().to_string();
    assert!(error.contains("'steep_place'") && error.contains("returned NaN at theta = "), "{error}");
    let error = Renderer::new(&model, RATE_HZ, None, OPEN).err().unwrap().to_string();
    assert!(error.contains("steep_place"), "{error}");
    let mut knob = Renderer::forced(&model, RATE_HZ, None, OPEN).unwrap();
    let steps: Vec<f64> = (0..CYCLE).map(|i| knob.step(sensed(i))).collect();
    assert!(knob.fault().is_some() && steps.iter().all(|tau| tau.is_finite()));
    // A knob behind a joint, and one that a hand pushes, say so too.
    let joined = with(Some(row), true);
    assert!(joined.watched(|| torque(&joined)).is_err());
    assert!(model.watched(|| pushed(&model)).is_err());
}
