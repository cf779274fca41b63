//! Laws as people write them: which are read, with what units and parameters, what they answer, and why others are refused.

use crate::answers::Answers;
use crate::captures::Chance;
use crate::catalogue::{knob, motion};
use knobcore::carry::carrier;
use knobcore::effects::formula::Formula;
use knobcore::effects::formula::written::{Asked, made};
use knobcore::effects::{Context, Id};
use knobcore::param::{Axis, Unit};
use knobcore::predict::torque;
use std::collections::BTreeMap;

const LAWS: [&str; 34] = [
    "a theta",
    "-a*theta^3 + b",
    "a (omega/w)/(1 + (omega/w)^2)",
    "a sin(n theta + s) exp(-t/T)",
    "a |omega| omega",
    "a sign(omega) exp(-|omega/v|^d)",
    "a tanh(theta/w) + b tanh(omega/v)",
    "min(a theta, b) + max(c omega, -b)",
    "a sqrt(1 + (theta/w)^2)",
    "a log(1 + t/T)",
    "a alpha",
    "a alpha^2",
    "a alpha/(1 + |theta/w|)",
    "a spline(theta/w, 1, -2, 0.5, 1)",
    "a theta + b a",
    "a b theta",
    "a 2^(theta/w)",
    "a (theta/w)^0.5",
    "a cos(theta) - a cos(2 theta + s)",
    "a + b theta + c theta**2 + d theta^3",
    "a (theta + omega)",
    "a sin(omega)",
    "theta",
    "0",
    "a theta^(1/2)^2",
    "a/(theta/w)/(omega/v)",
    "a - -b - (c)",
    "a |theta - |omega/v||",
    "a theta)",
    "a foo(theta)",
    "a * ",
    "1e3 a 1.5e-2 theta",
    "a tan(theta/w) sign(alpha)",
    "a t^2 + b t",
];

#[test]
fn laws_that_people_write() {
    let mut told = Answers::of("formulas");
    let signals = motion();
    let columns = signals.motion_columns(0..signals.len());
    let mut chance = Chance(81);
    for text in LAWS {
        let law = match Formula::parse(text) {
            Ok(law) => law,
            Err(mistake) => {
                told.words(text, format!("{mistake:?}"));
                continue;
            }
        };
        let variables: Vec<&str> = law.variables().into_iter().map(|one| one.name()).collect();
        told.words(text, format!("{} | {} | {}", law.text(), law.params().join(" "), variables.join(" ")));
        let how = format!("{:?} {} {:?}", law.linear(), law.remembers(), law.over_alpha());
        told.words("  how", how);
        for (answer, known) in [
            (Unit::of(1, 0, 0), BTreeMap::new()),
            (Unit::NUMBER, BTreeMap::new()),
            (Unit::of(1, 0, 0), BTreeMap::from([("a", Unit::of(1, -1, 0)), ("w", Unit::of(0, 1, 0))])),
        ] {
            let units = law.units(&known, answer).map(|units| {
                let texts: Vec<String> = units.iter().map(|unit| unit.text(Axis::Rotary)).collect();
                texts.join(", ")
            });
            told.words("  units", units.unwrap_or_else(|mistake| format!("{mistake:?}")));
        }
        let p: Vec<f64> = law.params().iter().map(|_| 0.3 + chance.uniform()).collect();
        told.column("  over", &law.over(&p, &columns));
        for by in 0..p.len() {
            told.column("    slope", &law.slope(&p, by, &columns));
        }
    }
    told.done();
}

#[test]
fn laws_wherever_they_act() {
    let mut told = Answers::of("laws");
    let signals = motion();
    let surveyed = carrier(&knob(), &signals, 1e-3, 1.0).survey;
    let narrow = BTreeMap::from([("w".to_owned(), Asked { bounds: [0.1, 9.0], ..Asked::default() })]);
    for acts in ["load", "friction", "sensor", "nowhere"] {
        for (i, text) in LAWS.iter().enumerate().filter(|(i, _)| i % 3 != 1) {
            // What is said of a parameter that a law does not have is refused, once in a while.
            let asked = if text.contains("/w") || i % 9 == 0 { narrow.clone() } else { BTreeMap::new() };
            let law = match made(&format!("kept_{acts}_{i}"), acts, text, &asked) {
                Ok(law) => law,
                Err(why) => {
                    told.words(format!("{acts} {text}"), why.to_string());
                    continue;
                }
            };
            let info = &law.info;
            told.words(
                format!("{acts} {text}"),
                format!("{:?} {:?} {:?}", info.place, info.touches, info.over),
            );
            for param in info.params {
                let bounds =
                    [param.lower, param.upper, param.neutral, param.plausible[0], param.plausible[1]];
                told.words(format!("  {} {:?}", param.name, param.kind), param.unit.text(Axis::Rotary));
                told.numbers("    bounds", bounds);
            }
            let mut model = knob().with(Id::User(law)).unwrap();
            for (at, param) in info.params.iter().enumerate() {
                let value = (0.4 + 0.1 * at as f64).clamp(param.lower, param.upper);
                model.set(&format!("{}.{}", info.id, param.name), value).unwrap();
            }
            told.column("  measured", &torque(&model, &signals));
            told.column("  starts", &Id::User(law).law().starts(&surveyed).concat());
            told.words("  said", Id::User(law).law().implausible(&[0.4; 12], &Context::default()).join("; "));
        }
    }
    told.done();
}
