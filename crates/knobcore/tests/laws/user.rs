//! An effect of the user's own obeys the laws of the built-in ones, and is left out where it fails.

use super::*;
use crate::derivatives::{SMOOTH, check};
use knobcore::effects::{Info, Torque, User};
use knobcore::param::Unit;

const PARAMS: &[Param] = &[
    Param::linear("d", Unit::of(1, -2, 2), "drag"),
    Param::shape("shift", Unit::of(0, 1, -1), [-10.0, 10.0], 0.5, "speed of the air"),
];

fn register(id: &'static str, torque: Torque) -> Id {
    let info = Info {
        id,
        place: Place::Load,
        law: "d (omega - shift) |omega - shift|",
        source: "made here",
        shows: "at high speed",
        params: PARAMS,
        confused: &[],
        needs: None,
        touches: &[knobcore::motion::Channel::Drive],
        shapes_friction: false,
        presses: false,
        bends: None,
        describes: false,
    };
    Id::User(User::register(info, false, Vec::new(), torque).unwrap())
}

fn draught(p: &[f64], [_, _, omega, _, _]: [&[f64]; 5]) -> Vec<f64> {
    omega.iter().map(|omega| p[0] * (omega - p[1]) * (omega - p[1]).abs()).collect()
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
    let nan: Torque = Box::new(|_, [t, ..]| Ok(vec![f64::NAN; t.len()]));
    let short: Torque = Box::new(|_, [t, ..]| Ok(vec![1.0; t.len() - 1]));
    let raises: Torque = Box::new(|_, _| Err("no such material".into()));
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

fn user(id: Id) -> &'static User {
    match id {
        Id::User(user) => user,
        _ => panic!("{id:?} is built in"),
    }
}
