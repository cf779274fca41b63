//! Values with which an effect stands in for another are called implausible, and its own are not.

use super::*;
use knobcore::effects::Context;

/// A motion from -1 to 1 at 1 rad/s, detents of a tenth of a radian over 2 pi.
fn context() -> Context {
    Context {
        errors: vec![None; 16],
        t: Vec::new(),
        torque: Vec::new(),
        theta: (0..=200).map(|i| f64::from(i) * 0.01 - 1.0).collect(),
        turning: 100.0,
        rate_hz: RATE_HZ,
        noise_floor: 1e-3,
        period: Some(0.1),
        period_error: 0.0,
        revolution: Some(1.0),
        friction: [0.0; 2],
        clipped: false,
        first: true,
    }
}

fn said(id: Id, p: &[f64], context: &Context) -> String {
    id.law().implausible(p, context).join("; ")
}

#[test]
fn no_effect_is_implausible_where_a_search_begins() {
    for &id in Id::BUILT_IN.iter().filter(|id| !matches!(id, Id::PositionFriction | Id::Presliding)) {
        let neutral: Vec<f64> = id.info().params.iter().map(|param| param.neutral).collect();
        let gap = if id == Id::Backlash { 0.1 } else { neutral[0] };
        let p = [&[gap][..], &neutral[1..]].concat();
        assert_eq!(said(id, &p, &context()), "", "{}", name(id));
    }
}

#[test]
fn stops_that_hold_most_samples_or_overlap_are_a_spring() {
    let stops = |lo: f64, hi: f64| said(Id::EndStop, &[1.0, lo, 1.0, hi, 0.0, 0.0], &context());
    assert_eq!(stops(-0.9, 0.9), "");
    assert_eq!(stops(-0.2, 0.2), "80 % of the samples lie in its stops: it is a spring");
    assert!(stops(0.1, -0.1).starts_with("its stops overlap"));
}

#[test]
fn friction_along_the_way_goes_through_a_period_of_its_own() {
    let varies = |period: f64, a1: f64| {
        said(Id::PositionFriction, &[period, a1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &context())
    };
    assert_eq!(varies(0.17, 0.5), "");
    assert_eq!(varies(1.0, 0.5), "only 0.3 of its periods were crossed: it is a trend");
    assert_eq!(varies(0.17, 2.5), "it varies by 2.5 times the friction there is");
    assert!(varies(0.1, 0.5).starts_with("it repeats with the detents"));
    // Of a period of two detents a wave returns with every other detent, two with each.
    assert_eq!(varies(0.2, 0.5), "");
    let twice = [0.2, 0.2, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(said(Id::PositionFriction, &twice, &context()).starts_with("it repeats with the detents"));
}

#[test]
fn a_second_series_is_bound_neither_to_the_detents_nor_to_the_turn() {
    let waves = |period: f64, context: &Context| said(Id::SecondDetent, &[1.0, period, 0.0], context);
    let (short, mut round) = (context(), context());
    round.theta.iter_mut().for_each(|theta| *theta *= 5.0);
    assert_eq!(waves(1.0 / 14.4, &short), "");
    assert!(waves(0.2, &short).starts_with("only 1.6 of its waves"));
    assert!(waves(0.077, &short).starts_with("it is too near the detents"));
    // Twice the detents' waves, and three halves.
    for period in [0.05, 0.0667] {
        assert!(waves(period, &short).ends_with("{detent_harmonics} would, by nature"));
    }
    // Within a third of a turn nothing tells whether an order is whole.
    assert_eq!(waves(1.0 / 17.0, &short), "");
    assert_eq!(waves(1.0 / 17.0, &round), "it comes 17 times per turn: {cogging} would, by nature");
    assert_eq!(waves(1.0 / 17.4, &round), "");
    round.revolution = None;
    assert_eq!(waves(1.0 / 17.0, &round), "");
}

#[test]
fn presliding_is_shorter_than_the_way_and_longer_than_two_samples_after_a_reversal() {
    let over = |s: f64| said(Id::Presliding, &[s, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], &context());
    assert_eq!(over(0.1), "");
    assert_eq!(over(1.0), "it takes 1 rad to slip, a good part of the way: it is a spring");
    // a t^2/2 at 100 rad/s^2: 2e-6 rad a sample from rest.
    assert!(over(7e-6).starts_with("it slips within 7e-06 rad, less than two samples"));
    assert_eq!(over(9e-6), "");
}

#[test]
fn a_gap_that_noise_could_be_is_compliance() {
    let gap = |gap: f64, error: Option<f64>| {
        said(Id::Backlash, &[gap, 10.0, 0.01, 0.7], &Context { errors: vec![error], ..context() })
    };
    assert_eq!(gap(0.01, Some(1e-3)), "");
    assert_eq!(gap(0.01, Some(1e-2)), "its gap is nothing: it is compliance");
    assert_eq!(gap(1e-5, None), "its gap is nothing: it is compliance");
}

#[test]
fn a_limit_beside_another_effect_is_proved_by_readings_that_repeat() {
    let limit = |clipped, first| said(Id::Saturation, &[0.18, 0.0], &Context { clipped, first, ..context() });
    assert_eq!((limit(false, true), limit(true, false)), (String::new(), String::new()));
    assert_eq!(limit(false, false), "no reading repeats at such a limit");
}
