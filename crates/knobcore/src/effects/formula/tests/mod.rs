//! Laws as formulas: what is read, what is refused and where, units, derivatives.

mod catalogued;

use super::*;
use crate::motion::Motion;
use crate::param::{Kind, Usual};
use crate::scalar::Dual;

const TORQUE: Unit = Unit::of(1, 0, 0);

fn law(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|mistake| panic!("{text}: {mistake:?}"))
}

fn value(text: &str, p: &[f64]) -> f64 {
    law(text).at(p, &Motion { t: 0.5, theta: 1.2, omega: -3.0, alpha: 7.0, forward: 0.0 })
}

fn mistake(text: &str) -> Mistake {
    match Formula::parse(text) {
        Ok(law) => law.units(&BTreeMap::new(), TORQUE).unwrap_err(),
        Err(mistake) => mistake,
    }
}

#[test]
fn formulas_are_read_as_people_write_them() {
    for (text, is) in [
        ("1 + 2*3^2", 19.0),
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2^3^0.5", 2.0_f64.powf(3.0_f64.sqrt())),
        ("8/4/2", 1.0),
        ("2 - 3 - 4", -5.0),
        ("2 omega theta", -7.2),
        ("2 (1 + omega)(theta)", -4.8),
        ("|omega| - -1", 4.0),
        ("omega |omega (1 - |theta|)| |2|", -3.6),
        ("sign(omega) + sign(theta)", 0.0),
        ("omega**2 + 1e1", 19.0),
        ("min(theta, max(t, 2)) + pi - pi", 1.2),
        ("sqrt(4) exp(0) cos(0)", 2.0),
        ("tanh(0.5)", 0.5_f64.tanh()),
        ("tan(0.5) - log(2.5)", 0.5_f64.tan() - 2.5_f64.ln()),
        (".5alpha", 3.5),
        // Per load that presses.
        ("0.1 |load| sign(omega)", -0.1),
        ("spline(theta, 0, -3, 0, 0)", -(5.832 - 2.048) / 2.0),
        ("spline(2 theta, 1, 1, 1, 1, 1, 1) + spline(-theta - 0.8, 1, 1, 1, 1)", 1.0),
    ] {
        assert!((value(text, &[]) - is).abs() < 1e-13, "{text}: {} {is}", value(text, &[]));
    }
    assert!((value("2 a (omega/w) / (1 + (omega/w)^2)", &[0.5, 3.0]) + 0.5).abs() < 1e-15);
    assert_eq!(law("b + a + b").params(), ["b", "a"]);
    assert!(value("log(omega)", &[]).is_nan() && value("omega^0.5", &[]).is_nan());
}

#[test]
fn what_is_no_law_is_refused_at_its_place() {
    let long = "1+".repeat(400) + "1";
    let (deep, huge) = ("(".repeat(40) + "1" + &")".repeat(40), "a".repeat(1_000_000));
    for (text, at, said) in [
        ("a * (theta", 10, "')'"),
        ("a theta)", 7, "bracket"),
        ("a $ theta", 2, "no place"),
        ("k * foo(theta)", 4, "no function"),
        ("sin theta", 4, "sin("),
        ("min(theta)", 9, "comma"),
        ("a *", 3, "ends"),
        ("a * / b", 4, "stands where"),
        ("1.2.3", 0, "no number"),
        ("", 0, "ends"),
        (&long, 199, "too long"),
        (&deep, 32, "brackets"),
        (&huge, 1000, "1000000 characters"),
        ("a b c d e f g h i j k l m", 24, "one parameter more"),
        ("a theta (theta + omega)", 15, "other units"),
        ("a exp(theta)", 2, "exp of rad"),
        ("theta", 0, "another unit"),
        ("a b omega", 0, "does not follow"),
        ("a sin(omega)", 2, "sin of rad/s"),
        ("a spline(theta)", 2, "0 values"),
        ("a spline(theta/w, 1, 2, b)", 24, "written out"),
        ("a spline theta", 9, "spline("),
        ("a spline(theta, 1, 2, 3, 4)", 2, "spline of rad"),
    ] {
        let found = mistake(text);
        assert!(found.at == at && found.why.contains(said), "{}: {found:?}", &text[..text.len().min(40)]);
    }
}

#[test]
fn what_looks_at_a_load_is_friction_under_it() {
    for (text, at) in [
        ("a load", 2),
        ("a |load|", 3),
        ("a load sign(omega)", 2),
        ("a |load - b| sign(omega)", 3),
        ("a |load|^2 sign(omega)", 3),
        ("a + b |load| sign(omega)", 7),
        ("a |load| tanh(omega/w)", 3),
        ("a |load| sign(omega) direction", 3),
    ] {
        assert_eq!(law(text).misloaded(), Some(at), "{text}");
    }
    for text in ["a |load| sign(omega)", "sign(omega) (a abs(load) theta - |load| b)", "a theta"] {
        assert_eq!(law(text).misloaded(), None, "{text}");
    }
    let refused = |acts: &str, text: &str| written::made("pressed", acts, text, &BTreeMap::new());
    for (acts, text) in [("friction", "1 + a |load| sign(omega)"), ("sensor", "a |load| sign(omega)")] {
        let error = refused(acts, text).unwrap_err().to_string();
        assert!(error.contains("abs(load)*sign(omega)") && error.contains("'load"), "{error}");
    }
}

#[test]
fn units_of_parameters_follow_from_the_law() {
    let units = |text: &str| law(text).units(&BTreeMap::new(), TORQUE).unwrap();
    assert_eq!(units("2 a (omega/w) / (1 + (omega/w)^2)"), [TORQUE, Unit::of(0, 1, -1)]);
    assert_eq!(units("a sin(n theta + p)"), [TORQUE, Unit::NUMBER, Unit::NUMBER]);
    assert_eq!(units("d omega |omega|"), [Unit::of(1, -2, 2)]);
    assert_eq!(units("a exp(-t/tau) + b"), [TORQUE, Unit::of(0, 0, 1), TORQUE]);
    assert_eq!(units("k sqrt(theta^2 + l^2)"), [Unit::of(1, -1, 0), Unit::of(0, 1, 0)]);
    assert_eq!(units("a (|omega|/w)^p"), [TORQUE, Unit::of(0, 1, -1), Unit::NUMBER]);
    // A nought is of any unit.
    assert_eq!(units("g max(theta - c, 0)"), [Unit::of(1, -1, 0), Unit::of(0, 1, 0)]);
    let given = BTreeMap::from([("b", Unit::of(0, -1, 1))]);
    assert_eq!(law("a b omega").units(&given, TORQUE).unwrap()[0], TORQUE);
    let wrong = BTreeMap::from([("w", Unit::of(0, 1, 0))]);
    assert!(law("a/(1 + omega/w)").units(&wrong, TORQUE).unwrap_err().why.contains("other units"));
    // What rubs under a load does so in proportion to it.
    assert_eq!(units("mu exp(-|omega|/w) abs(load) sign(omega)"), [Unit::NUMBER, Unit::of(0, 1, -1)]);
    // What multiplies the dry friction is a pure number.
    assert_eq!(law("1 + a cos(theta)").units(&BTreeMap::new(), Unit::NUMBER).unwrap(), [Unit::NUMBER]);
}

#[test]
fn parameters_that_the_law_is_proportional_to_are_found() {
    let linear = |text: &str| -> Vec<String> {
        let law = law(text);
        law.linear().into_iter().map(|at| law.params()[at].clone()).collect()
    };
    assert_eq!(linear("2 a (omega/w) / (1 + (omega/w)^2)"), ["a"]);
    assert_eq!(linear("a omega + b theta - c"), ["a", "b", "c"]);
    assert_eq!(linear("a b omega"), ["a"]);
    assert!(linear("1 + a theta").is_empty() && linear("a^2").is_empty() && linear("omega/a").is_empty());
    assert_eq!(linear("(a sin(w t) + b cos(w t)) exp(-t/tau)"), ["a", "b"]);
}

#[test]
fn derivatives_are_exact_and_packs_answer_as_single_samples() {
    let law = law(
        "a sin(n theta) exp(-t/tau) + b tanh(omega/w)/(1 + |alpha|^1.5 c) + b spline(theta/w, 1, -2, 1, 3)",
    );
    let p = [0.3, 5.0, 0.7, 0.2, 1.1, 0.4];
    let columns: [Vec<f64>; 5] = core::array::from_fn(|i| {
        (0..21_u32).map(|k| (f64::from(k) * 0.37 + i as f64).sin() + 1.5 * f64::from(i == 0)).collect()
    });
    let columns: [&[f64]; 5] = core::array::from_fn(|i| columns[i].as_slice());
    let over = law.over(&p, &columns);
    for (at, over) in over.iter().enumerate() {
        let [t, theta, omega, alpha, forward] = columns.map(|column| column[at]);
        let motion = Motion { t, theta, omega, alpha, forward };
        assert!((law.at(&p, &motion) - over).abs() < 1e-14);
    }
    for by in 0..p.len() {
        let slope = law.slope(&p, by, &columns);
        let moved = |step: f64| {
            let mut p = p;
            p[by] += step;
            law.over(&p, &columns)
        };
        let (low, high) = (moved(-1e-6), moved(1e-6));
        for ((slope, low), high) in slope.iter().zip(low).zip(high) {
            assert!((slope - (high - low) / 2e-6).abs() < 1e-8, "{by}: {slope}");
        }
    }
    // A square root of nothing has a value, and no derivative that is none.
    let root = Formula::parse("a sqrt(theta)").unwrap();
    let dual = root
        .at(&[Dual::<f64, 1>::seeded(2.0, Some(0))], &Motion::exact(0.0, 0.0, 1.0, 0.0).map(Dual::constant));
    assert_eq!((dual.v, dual.d), (0.0, [0.0]));
}

#[test]
fn a_power_with_a_free_exponent_has_a_value_and_derivatives_at_rest_and_near_it() {
    let law = law("a sign(omega) (abs(omega)/w)^n");
    for n in [0.3, 1.0, 1.5, 2.6] {
        for (omega, forward) in [(0.0, 0.5), (1e-300, 1.0), (-1e-12, 0.0), (-2.0, 0.0), (3.0, 1.0)] {
            let motion = Motion { t: 0.0, theta: 0.0, omega, alpha: 0.0, forward };
            let p: [Dual<f64, 3>; 3] = Dual::seeds([0.2, 2.0, n], 0);
            let found = law.at(&p, &motion.map(Dual::constant));
            let base = omega.abs() / 2.0;
            let unit = base.powf(n) * (2.0 * forward - 1.0);
            let steep = if base > 0.0 { 0.2 * unit * base.ln() } else { 0.0 };
            let right = [0.2 * unit, unit, -0.1 * n * unit, steep];
            for (found, right) in core::iter::once(found.v).chain(found.d).zip(right) {
                assert!(
                    (found - right).abs() <= 1e-13 * right.abs() + 1e-300,
                    "{omega} {n}: {found} {right}"
                );
            }
        }
    }
}

#[test]
fn what_no_capture_tells_from_the_amplitude_is_held_and_exponents_keep_a_value_at_rest() {
    let held = |text: &str| -> Vec<String> {
        let law = law(text);
        law.undone().into_iter().map(|at| law.params()[at].clone()).collect()
    };
    assert_eq!(held("a sign(omega) (abs(omega)/w)^n"), ["w"]);
    assert_eq!(held("(a + b t) (abs(omega)/w)^n + c"), ["w"]);
    assert_eq!(held("a exp(-(theta - c)/d)"), ["c"]);
    for text in
        ["2 a (omega/w) / (1 + (omega/w)^2)", "a tanh(omega/w)", "1 + r (s/b)^n", "a sin(k theta + p)"]
    {
        assert!(held(text).is_empty(), "{text}");
    }
    let exponents = |text: &str| law(text).exponents();
    assert_eq!(exponents("a sign(omega) (abs(omega)/w)^n"), [2]);
    assert_eq!(exponents("1 + r (s/b)^n"), [2]);
    assert!(exponents("a (1 + abs(omega)/w)^n").is_empty() && exponents("a theta^2").is_empty());
    let user = written::made("film", "load", "a sign(omega) (abs(omega)/w)^n", &BTreeMap::new()).unwrap();
    let [a, w, n] = user.info.params else { panic!("three parameters") };
    assert_eq!((a.kind, w.usual, n.usual), (Kind::Linear, Usual::Fixed, Usual::Free));
    assert_eq!((w.unit, n.unit, [n.lower, n.upper]), (Unit::of(0, 1, -1), Unit::NUMBER, [0.0, 10.0]));
}

#[test]
fn a_power_of_what_has_a_unit_says_how_it_is_written() {
    let why = mistake("a abs(omega)^1.5").why;
    assert!(why.contains("broken power") && why.contains("(abs(omega)/w)^1.5"), "{why}");
    assert!(mistake("a abs(omega)^n").why.contains("raises what has a unit"));
}
