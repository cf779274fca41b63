//! Laws that are in no catalogue are proposed from captures that have them, and from no other.

mod pressed;
mod surfaces;
mod traces;

use super::grammar::Shape;
use super::scan::functions;
use super::*;
use crate::effects::formula::Formula;
use crate::fit::refine;
use crate::model::Run;
use crate::motion::Motion;
use crate::param::{Axis, Unit};
use crate::predict;
use crate::random;
use alloc::collections::BTreeMap;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 1000.0;
/// Standard deviation of the torque sensor, N m.
const SD: f64 = 1e-3;

type Instant = (f64, f64, f64, f64);

/// A knob turned to and fro for four seconds, which a law of t, theta, omega and alpha loads too, and its model fitted.
fn turned(law: impl Fn(Instant) -> f64, seed: u64) -> (Signals, Model) {
    let mut model = Model::equation_1(Axis::Rotary, false);
    for (name, value) in [("inertia.M", 1e-4), ("coulomb.neg", 8e-3), ("coulomb.pos", 8e-3)] {
        model.set(name, value).unwrap();
    }
    moved(&model, law, seed)
}

/// The same of any knob.
fn moved(model: &Model, law: impl Fn(Instant) -> f64, seed: u64) -> (Signals, Model) {
    let over = |of: &dyn Fn(f64) -> f64| (0..4000).map(|i| of(f64::from(i) / RATE_HZ)).collect::<Vec<f64>>();
    let parts = [(0.9, 3.1), (0.4, 5.3), (0.2, 7.9)];
    let sum =
        |t: f64, of: &dyn Fn(f64, f64, f64) -> f64| parts.iter().map(|(a, w)| of(*a, *w, t)).sum::<f64>();
    let omega = over(&|t| sum(t, &|a, w, t| a * w * (w * t).cos()));
    let mut signals = Signals {
        run: Run { name: "a".into(), fingerprint: "a".into() },
        rate_hz: RATE_HZ,
        substeps: 2,
        t: over(&|t| t),
        theta: over(&|t| sum(t, &|a, w, t| a * (w * t).sin())),
        alpha: over(&|t| sum(t, &|a, w, t| -a * w * w * (w * t).sin())),
        forward: omega.iter().map(|omega| f64::from(u8::from(*omega > 0.0))).collect(),
        omega_sd: vec![0.0; omega.len()],
        weight: vec![1.0; omega.len()],
        segments: vec![0..omega.len(); 1],
        omega,
        ..Signals::default()
    };
    let mut noise = random::Noise::new(seed);
    signals.tau_raw = predict::torque_raw(model, &signals)
        .iter()
        .enumerate()
        .map(|(at, tau)| {
            let s = &signals;
            tau + law((s.t[at], s.theta[at], s.omega[at], s.alpha[at])) + SD * noise.normal()
        })
        .collect();
    signals.tau = signals.tau_raw.clone();
    let fitted = refine(&[&signals], model).unwrap().model;
    (signals, fitted)
}

/// What is proposed first, and what it leaves of the truth as a share of its RMS, beyond what the model can absorb.
fn first(law: impl Fn(Instant) -> f64 + Copy) -> (Law, f64) {
    let (signals, model) = turned(law, 5);
    let data = [&signals];
    let found = propose(&data, &model, true, &|_| true).unwrap();
    assert!(found.p_value < 0.01);
    let first = found.laws[0].clone();
    let (rows, _) = Rows::of(&data, &model);
    let truth: Vec<f64> = (0..signals.len())
        .map(|at| law((signals.t[at], signals.theta[at], signals.omega[at], signals.alpha[at])))
        .collect();
    let off: Vec<f64> = torque(&first, &signals).iter().zip(&truth).map(|(a, b)| a - b).collect();
    (first, rms(&rows, &off) / rms(&rows, &truth))
}

/// The torque of a law over a capture.
fn torque(law: &Law, signals: &Signals) -> Vec<f64> {
    let formula = Formula::parse(&law.text).unwrap();
    let named = |name: &String| law.params.iter().find(|(own, _)| own == name).unwrap().1;
    let p: Vec<f64> = formula.params().iter().map(named).collect();
    let motion = [&signals.t[..], &signals.theta, &signals.omega, &signals.alpha, &signals.forward];
    formula.over(&p, &motion)
}

/// How large a torque of all samples is behind the measurement filter, beside what the model absorbs.
fn rms(rows: &Rows<'_>, column: &[f64]) -> f64 {
    rows.over(|_| vec![column.to_vec()])[0].iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn a_law_is_proposed_by_its_variables_and_its_form() {
    let peaked = |(_, _, omega, _): Instant| 0.02 * (omega / 0.8) / (1.0 + (omega / 0.8).powi(2));
    let (law, off) = first(peaked);
    assert_eq!((law.text.as_str(), &law.variables[..]), ("2*a*(omega/w)/(1 + (omega/w)^2)", &["omega"][..]));
    assert!(off < 0.03, "{off}");
    let sector = |(_, theta, omega, _): Instant| 4e-3 * omega * (-((theta - 0.4) / 0.3_f64).powi(2)).exp();
    let (law, off) = first(sector);
    assert_eq!(law.text, "a*omega*exp(-((theta - c)/w)^2)");
    assert!(off < 0.03, "{off}");
}

#[test]
fn what_turns_with_the_angle_turns_by_whole_numbers() {
    let (law, off) = first(|(_, theta, _, alpha): Instant| 1e-4 * (2.0 * theta + 0.7).cos() * alpha);
    assert_eq!((law.text.as_str(), law.params.len()), ("a*alpha*sin(2*theta + ph)", 2));
    assert!(off < 0.03, "{off}");
    let (law, _) = first(|(_, theta, omega, _): Instant| 4e-4 * omega * omega * theta.sin());
    assert_eq!(law.text, "a*omega^2*sin(theta)");
}

#[test]
fn a_hum_and_a_wave_that_dies_away_are_laws_of_time() {
    let (law, off) = first(|(t, ..): Instant| 2e-3 * (TAU * 50.0 * t + 0.3).sin());
    assert_eq!((law.text.as_str(), &law.variables[..]), ("a*sin(2*pi*f*t + ph)", &["t"][..]));
    assert!(off < 0.04 && (law.params[1].1 - 50.0).abs() < 0.02, "{off} {:?}", law.params);
    let (law, off) = first(|(t, ..): Instant| 6e-3 * (-t / 1.3).exp() * (TAU * 11.0 * t).sin());
    assert_eq!(law.text, "a*exp(-t/T)*sin(2*pi*f*t + ph)");
    assert!(off < 0.03, "{off}");
}

#[test]
fn a_power_between_those_that_have_names_is_found_with_its_exponent() {
    for n in [0.4, 1.5, 2.6] {
        let (law, off) =
            first(|(_, _, omega, _): Instant| 8e-3 * omega.signum() * (omega.abs() / 3.0).powf(n));
        assert_eq!(law.text, "a*sign(omega)*(abs(omega)/w)^n", "{n}");
        assert_eq!((law.params.len(), law.count, law.complexity), (3, 2, 4));
        assert!(off < 0.03 && (law.params[2].1 - n).abs() < 0.1, "{n}: {off} {:?}", law.params);
    }
    // Where a power that has no free exponent does as well, it stays first.
    let (law, _) = first(|(_, _, omega, _): Instant| 1e-3 * omega * omega.abs());
    assert_eq!(law.text, "a*omega*abs(omega)");
    let (law, _) = first(|(_, _, omega, _): Instant| 2e-4 * omega.powi(3));
    assert_eq!(law.text, "a*omega^3");
}

#[test]
fn a_knob_of_which_nothing_is_missing_is_proposed_nothing() {
    for seed in 20..26 {
        let (signals, model) = turned(|_| 0.0, seed);
        let found = propose(&[&signals], &model, true, &|_| true).unwrap();
        assert!(found.laws.is_empty(), "{seed}: {:?} {}", found.laws[0], found.p_value);
    }
}

#[test]
fn work_that_is_no_longer_wanted_ends() {
    let (signals, model) = turned(|(_, theta, ..)| 1e-3 * theta.powi(2), 3);
    assert!(propose(&[&signals], &model, true, &|_| false).is_none());
}

#[test]
fn the_curve_of_what_is_left_is_its_law_where_the_model_absorbs_nothing_of_it() {
    let (signals, model) = turned(|(_, theta, omega, _)| 3e-3 * omega * (5.0 * theta).sin(), 9);
    let curve = propose(&[&signals], &model, true, &|_| true).unwrap().curve.unwrap();
    assert_eq!((curve.over, curve.times.as_str()), ("theta", "omega"));
    for ((x, value), band) in curve.x.iter().zip(&curve.value).zip(&curve.band) {
        if x.abs() < 1.0 {
            assert!((value - 3e-3 * (5.0 * x).sin()).abs() < 3.0 * band + 2e-4, "{x}: {value} {band}");
        }
    }
}

#[test]
fn what_no_formula_says_is_written_as_a_spline_and_what_one_does_is_not() {
    let bump = |x: f64, c: f64, w: f64| (-((x - c) / w).powi(2)).exp();
    let relief = |x: f64| {
        6e-3 * bump(x, -0.9, 0.15) - 5e-3 * bump(x, -0.2, 0.2) + 7e-3 * bump(x, 0.4, 0.1)
            - 4e-3 * bump(x, 0.8, 0.3)
    };
    let (signals, model) = turned(|(_, theta, omega, _)| relief(theta) * omega, 9);
    let Written { law, heldout } = left(&signals, &model).written.unwrap();
    let formula = Formula::parse(&law.text).unwrap();
    assert_eq!(formula.params(), ["a", "from", "step"]);
    assert_eq!(law.variables, ["omega", "theta"]);
    assert_eq!(formula.units(&BTreeMap::new(), Unit::of(1, 0, 0)).unwrap()[0], Unit::of(1, -1, 1));
    let p: Vec<f64> = law.params.iter().map(|(_, value)| *value).collect();
    // What drag can say as well, a constant beside the relief, drag has.
    let own = |x: f64| formula.at(&p, &Motion::exact(0.0, x, 2.0, 0.0)) / 2.0;
    let offs: Vec<f64> = (-9..=9).map(|at| 0.1 * f64::from(at)).map(|x| own(x) - relief(x)).collect();
    let mean = offs.iter().sum::<f64>() / offs.len() as f64;
    assert!(offs.iter().all(|off| (off - mean).abs() < 7e-4), "{mean} {offs:?}");
    assert!((10..=39).contains(&law.complexity), "{}", law.complexity);
    // Blocks at the ends of the motion are told less surely.
    let unseen = heldout.powi(2) * squares(&signals, &model) / (SD * SD);
    assert!((1.0..1.08).contains(&unseen), "{unseen}");
    let (signals, model) = turned(|(_, theta, omega, _)| 3e-3 * omega * (5.0 * theta).sin(), 9);
    assert!(left(&signals, &model).written.is_none());
}

/// What a model leaves, without a formula.
fn left(signals: &Signals, model: &Model) -> Shapes {
    propose(&[signals], model, true, &|_| true).unwrap().shapes
}

/// The mean square of what a model leaves.
fn squares(signals: &Signals, model: &Model) -> f64 {
    let off =
        predict::torque_raw(model, signals).into_iter().zip(&signals.tau_raw).map(|(a, b)| (a - b).powi(2));
    off.sum::<f64>() / signals.len() as f64
}

#[test]
fn every_law_of_the_grammar_is_one_that_formulas_know_and_has_units_and_the_same_value() {
    let (signals, model) = turned(|_| 0.0, 2);
    let data = [&signals];
    let (rows, _) = Rows::of(&data, &model);
    let reach = Reach::of(&rows);
    let of = Variable::ALL;
    let mut kinds: Vec<Factor> = Vec::new();
    for one in functions(&reach, &of, true) {
        if !kinds.iter().any(|other| (other.of, other.shape) == (one.of, one.shape)) {
            kinds.push(one);
        }
    }
    for (variable, shape) in
        [(Variable::Time, Shape::Sine), (Variable::Theta, Shape::Sine), (Variable::Theta, Shape::Turning)]
    {
        kinds.push(Factor { of: variable, shape, at: [0.5, 0.0] });
    }
    let motion = [&signals.t[..], &signals.theta, &signals.omega, &signals.alpha, &signals.forward];
    let mut twos = kinds.iter().skip(3).cycle();
    for (at, powers) in Powers::among(&of).into_iter().enumerate() {
        for factor in &kinds {
            let with = twos.next().filter(|two| at % 2 == 0 && !two.shape.is_wave());
            let factors: Vec<Factor> = with.into_iter().chain([factor]).copied().collect();
            let term = Term { powers, factors };
            let count = term.count();
            let law = Sum::from(term);
            let columns = law.columns(&rows.motions);
            let coefficients = &[0.3, -0.4][..columns.len()];
            let written = law.written(coefficients);
            let formula = Formula::parse(&written.text).unwrap();
            let units = formula.units(&alloc::collections::BTreeMap::new(), crate::param::Unit::of(1, 0, 0));
            assert!(units.is_ok(), "{}: {units:?}", written.text);
            let named = |name: &String| written.params.iter().find(|(own, _)| own == name).unwrap().1;
            let p: Vec<f64> = formula.params().iter().map(named).collect();
            let held = written.text.matches(")^n").count();
            assert_eq!(p.len(), count + held, "{}", written.text);
            let value = formula.over(&p, &motion);
            for at in (0..value.len()).step_by(97) {
                // Friction under a load as a formula has it is per load.
                let load = if powers.pressed { rows.motions[Variable::ALL.len() + 1][at].abs() } else { 1.0 };
                let sum: f64 = columns.iter().zip(coefficients).map(|(column, by)| column[at] * by).sum();
                assert!((load * value[at] - sum).abs() < 1e-9 * (1.0 + sum.abs()), "{}: {at}", written.text);
            }
        }
    }
}

#[test]
fn two_laws_at_once_are_proposed_as_their_sum_and_one_is_not() {
    let both =
        |(t, theta, omega, _): Instant| 4e-4 * omega * omega * theta.sin() + 3e-3 * (TAU * 50.0 * t).sin();
    let (law, off) = first(both);
    assert!(
        law.text.contains("*omega^2*sin(theta)") && law.text.contains("*sin(2*pi*f*t + ph)"),
        "{}",
        law.text
    );
    assert_eq!((&law.variables[..], law.terms), (&["omega", "t", "theta"][..], 2));
    assert!(off < 0.03, "{off}");
    // What is small beside the first shows once that is taken off.
    let (law, off) = first(|(t, theta, omega, _): Instant| {
        2e-3 * (TAU * 11.0 * t).sin() + 4e-3 * omega * (-((theta - 0.4) / 0.3_f64).powi(2)).exp()
    });
    assert_eq!((law.terms, &law.variables[..]), (2, &["omega", "t", "theta"][..]), "{}", law.text);
    assert!(off < 0.04, "{off}: {}", law.text);
    let (law, _) =
        first(|(_, theta, omega, _): Instant| 4e-3 * omega * (-((theta - 0.4) / 0.3_f64).powi(2)).exp());
    assert_eq!(law.terms, 1);
}

#[test]
fn a_short_law_that_takes_off_next_to_nothing_is_none() {
    let (signals, model) = turned(|(t, ..): Instant| 6e-3 * (TAU * 50.0 * t).sin(), 5);
    let found = propose(&[&signals], &model, true, &|_| true).unwrap();
    let most = found.laws[0].gain;
    assert!(found.laws.iter().all(|law| law.gain > 0.15 * most));
}
