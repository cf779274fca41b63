//! Friction under a load.

use super::*;
use crate::effects::Id;

/// What presses a knob of this inertia on a spring, N m.
fn pressing((_, theta, _, alpha): Instant) -> f64 {
    0.03 * theta + 1e-4 * alpha
}

#[test]
fn friction_under_a_load_is_proposed_as_that_and_as_what_it_is_of_besides() {
    let mut knob = Model::equation_1(Axis::Rotary, false).with(Id::ReturnSpring).unwrap();
    for (name, value) in
        [("inertia.M", 1e-4), ("coulomb.neg", 8e-3), ("coulomb.pos", 8e-3), ("return_spring.k", 0.03)]
    {
        knob.set(name, value).unwrap();
    }
    let of_speed = |(_, _, omega, _): Instant| (-omega.abs() / 1.2).exp();
    let plain = |at: Instant| 0.25 * pressing(at).abs() * at.2.signum();
    let falling = |at: Instant| 0.6 * pressing(at).abs() * at.2.signum() * of_speed(at);
    let of = |law: &dyn Fn(Instant) -> f64| {
        let (signals, model) = moved(&knob, law, 5);
        propose(&[&signals], &model, true, &|_| true).unwrap().laws.remove(0)
    };
    let law = of(&plain);
    assert_eq!((law.text.as_str(), &law.variables[..]), ("a*abs(load)*sign(omega)", &["load", "omega"][..]));
    assert!((law.params[0].1 - 0.25).abs() < 0.03, "{:?}", law.params);
    let law = of(&falling);
    assert_eq!(law.text, "a*abs(load)*sign(omega)*exp(-abs(omega)/d)");
    assert!((law.params[1].1 - 1.2).abs() < 0.2, "{:?}", law.params);
}

#[test]
fn a_knob_without_a_load_is_told_none() {
    let (signals, model) = turned(|(_, theta, ..): Instant| 4e-3 * (5.0 * theta).sin(), 5);
    let found = propose(&[&signals], &model, true, &|_| true).unwrap();
    assert!(found.laws.iter().all(|law| !law.variables.contains(&"load")));
}
