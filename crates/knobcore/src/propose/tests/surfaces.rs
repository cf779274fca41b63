//! Surfaces over pairs of variables: found, told where they are known, and written as laws.

use super::*;
use crate::algebra::dot;

fn relief(theta: f64, omega: f64) -> f64 {
    let bump = |c: f64, v: f64| (-((theta - c) / 0.5).powi(2) - ((omega - v) / 2.5).powi(2)).exp();
    8e-3 * (bump(-0.6, 2.5) - bump(0.6, 0.5) + bump(0.1, -3.0))
}

#[test]
fn what_no_formula_and_no_curve_says_is_a_surface_over_the_variables_that_it_is_of() {
    let (signals, model) = turned(|(_, theta, omega, _)| relief(theta, omega), 9);
    let data = [&signals];
    let found = left(&signals, &model);
    let first = &found.needs[0];
    assert_eq!(first.variables, ["omega", "theta"]);
    assert!(first.p_value < 0.01 && first.heldout < 0.6, "{first:?}");
    assert!(found.needs.iter().all(|need| need.heldout >= first.heldout));

    let map = found.map.unwrap();
    assert_eq!((map.over, map.times.as_str()), (["theta", "omega"], ""));
    let (mut known, mut off) = (0, 0.0_f64);
    for (i, x) in map.places[0].iter().enumerate() {
        for (j, y) in map.places[1].iter().enumerate() {
            let at = i * map.places[1].len() + j;
            if map.value[at].is_finite() {
                known += 1;
                off = off.max((map.value[at] - relief(*x, *y)).abs() - 4.0 * map.band[at]);
            }
        }
    }
    // Far and fast at once it never goes.
    assert!((400..1500).contains(&known) && map.value[0].is_nan(), "{known}");
    assert!(off < 3e-3, "{off}");

    let Written { law, heldout } = found.written.unwrap();
    assert!(law.text.len() < 1000 && law.text.contains("*spline((omega - from2)/step2, "), "{}", law.text);
    let formula = Formula::parse(&law.text).unwrap();
    assert!(formula.units(&BTreeMap::new(), Unit::of(1, 0, 0)).is_ok());
    let (rows, _) = Rows::of(&data, &model);
    let truth: Vec<f64> = (0..signals.len()).map(|at| relief(signals.theta[at], signals.omega[at])).collect();
    let off: Vec<f64> = torque(&law, &signals).iter().zip(&truth).map(|(a, b)| a - b).collect();
    let off = rms(&rows, &off) / rms(&rows, &truth);
    assert!(off < 0.2 && heldout < 0.7, "{off} {heldout}");
}

#[test]
fn what_friction_can_say_as_well_stays_with_friction() {
    for (seed, side) in [(9, 1.0), (11, -1.0)] {
        // Of a constant and of drag a surface could say any part.
        let of = |(_, theta, omega, _): Instant| side * relief(theta, omega) + 2e-3 + 1e-3 * omega;
        let (signals, model) = turned(of, seed);
        let law = left(&signals, &model).written.unwrap().law;
        let torque = torque(&law, &signals);
        let along = |other: &[f64]| dot(&torque, other) / dot(other, other);
        let (constant, drag) = (along(&vec![1.0; torque.len()]), along(&signals.omega));
        assert!(constant.abs() < 2e-4 && drag.abs() < 1e-4, "{seed}: {constant} {drag}");
    }
}

#[test]
fn a_law_of_one_variable_needs_no_second_and_no_surface_is_written() {
    let (signals, model) = turned(|(_, _, omega, _)| 0.02 * (omega / 0.8) / (1.0 + (omega / 0.8).powi(2)), 5);
    let found = left(&signals, &model);
    assert!(found.written.is_none());
    let alone = found.needs.iter().position(|need| need.variables == ["omega"]).unwrap();
    // Whatever holds the speed says as much, and no pair much more.
    assert!(found.needs[alone].heldout < 1.1 * found.needs[0].heldout, "{:?}", found.needs);
    let needless = found.needs.iter().find(|need| need.variables == ["t", "theta"]).unwrap();
    assert!(needless.heldout > found.needs[alone].heldout, "{:?}", found.needs);
}
