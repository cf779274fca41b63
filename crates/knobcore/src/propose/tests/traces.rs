//! What a law has left is told from what noise makes, before any law is fitted.

use super::*;

#[test]
fn what_a_law_leaves_has_a_trace_of_its_variables_and_noise_has_none() {
    let seen = |law: fn(Instant) -> f64, seed| {
        let (signals, model) = turned(law, seed);
        trace(&[&signals], &model, &|_| true).unwrap()
    };
    // A pawl that is passed one way.
    let pawl = |(_, theta, omega, _): Instant| {
        let off: f64 = (theta - 0.2) / 0.15;
        if omega > 0.0 { 1.2e-3 * (-0.5 * off * off).exp() } else { 0.0 }
    };
    let found = seen(pawl, 5);
    assert!(found.p_value <= rule().rare && found.variables.contains(&"theta"), "{found:?}");
    // Of chance as often as is said: of forty knobs with nothing missing about two have less than one in twenty.
    let p: Vec<f64> = (0..40).map(|seed| seen(|_| 0.0, seed).p_value).collect();
    let below = |level: f64| p.iter().filter(|p| **p <= level).count();
    assert!(below(rule().rare) <= 1 && below(0.05) <= 6 && below(0.5) >= 8, "{p:?}");
}

#[test]
fn what_nobody_waits_for_has_no_trace() {
    let (signals, model) = turned(|_| 0.0, 5);
    assert_eq!(trace(&[&signals], &model, &|_| false), None);
}
