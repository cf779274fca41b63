//! What a formula is written as for the catalogue compiles, is what is written today, and answers what the formula does.
//!
//! The files beside this one are what [`source`] wrote, as `rustfmt` left them.

mod crank;
mod eddy_brake;
mod hum;
mod mesh;
mod tooth;

use crate::effects::formula::catalogued::source;
use crate::effects::formula::written::{Asked, made};
use crate::effects::{Effect, LoadEffect, Nonlinear, SensorEffect, Survey, Words, formula};
use crate::motion::Motion;
use crate::random::Noise;
use crate::scalar::{Dual, Scalar};
use std::collections::BTreeMap;

type D = Dual<f64, 6>;

/// Holds a file and its function to the formula that it was written from.
fn held<const N: usize>(
    [id, acts, law]: [&str; 3],
    (p, asked): ([f64; N], &[(&str, Asked)]),
    file: &str,
    answer: fn(&[D; N], &Motion<D>) -> D,
) {
    let asked: BTreeMap<String, Asked> =
        asked.iter().map(|(name, one)| ((*name).into(), one.clone())).collect();
    let user = made(&format!("own_{id}"), acts, law, &asked).unwrap();
    let written = source(user, id, &p).unwrap();
    // Lines, and the commas at their ends, are those of who formatted the file.
    let plain = |text: &str| text.chars().filter(|c| !c.is_whitespace() && *c != ',').collect::<String>();
    assert_eq!(plain(&written.text), plain(file), "{id}");
    assert!(written.line.starts_with(&format!("{id}::")) && written.line.ends_with(&format!("({N}),")));
    let mut noise = Noise::new(3);
    for _ in 0..200 {
        let [t, theta, omega, alpha] = [1.0, 2.0, 4.0, 30.0].map(|size| size * noise.normal());
        let motion = Motion::exact(t.abs(), theta, omega, alpha).map(D::of);
        let p: [D; N] = Dual::seeds(p.map(|p| p * (1.0 + 0.3 * noise.uniform())), 0);
        let (own, stated) = (answer(&p, &motion), user.formula().unwrap().at(&p, &motion));
        for (own, stated) in [(own.v, stated.v)].into_iter().chain(own.d.into_iter().zip(stated.d)) {
            assert!((own - stated).abs() <= 1e-12 * (1.0 + stated.abs()), "{id}: {own} {stated}");
        }
    }
}

fn load<const N: usize, E: LoadEffect<N>>(p: &[D; N], motion: &Motion<D>) -> D {
    let load = E::load(p, motion);
    load.drive + load.inertia * motion.alpha
}

fn bounds(lower: f64, upper: f64) -> Asked {
    Asked { bounds: [lower, upper], ..Asked::default() }
}

#[test]
fn an_effect_that_was_written_from_a_formula_is_that_formula() {
    let fastest = Asked { meaning: "speed at which it brakes most".into(), ..bounds(0.1, 100.0) };
    held(
        ["eddy_brake", "load", "2 a (omega/w) / (1 + (omega/w)^2)"],
        ([0.004, 2.0], &[("w", fastest)]),
        include_str!("eddy_brake.rs"),
        load::<2, eddy_brake::EddyBrake>,
    );
    held(
        ["tooth", "friction", "1 + h exp(-((theta - c)/b)^2) (2 + sign(theta) tanh(3 n))"],
        ([0.5, 0.2, 0.3, 0.4], &[("b", bounds(0.01, 3.0))]),
        include_str!("tooth.rs"),
        |p, motion| tooth::Tooth::load(p, motion).friction_scale,
    );
    held(
        ["hum", "sensor", "(a sin(v t) + c cos(v t)) exp(-t/T) - k sqrt(1 + |omega|/T2)"],
        ([0.004, 40.0, 1e-3, 2.5, 1e-3, 3.0], &[]),
        include_str!("hum.rs"),
        |p, motion| hum::Hum::sense(p, motion, D::of(0.0)),
    );
    held(
        ["mesh", "load", "a (1 + b exp(-|omega|/w)) |load| sign(omega)"],
        ([0.1, 0.5, 2.0], &[("w", bounds(0.1, 50.0))]),
        include_str!("mesh.rs"),
        |p, motion| motion.direction() * mesh::Mesh::load(p, motion).mu,
    );
    held(
        ["crank", "load", "m alpha cos(theta)^2 - h omega^2 sin(2 theta) + g max(theta - c, 0)"],
        ([8e-5, 4e-5, -1e-3, 0.1], &[]),
        include_str!("crank.rs"),
        load::<4, crank::Crank>,
    );
}

#[test]
fn friction_per_load_that_is_always_the_same_looks_at_no_motion() {
    let user = made("plain_mesh", "load", "sign(omega) a |load|", &BTreeMap::new()).unwrap();
    let text = source(user, "gears", &[0.1]).unwrap().text;
    assert!(text.contains("&[a]: &[T; 1], _: &Motion<T>)") && text.contains("mu: a,"), "{text}");
}

#[test]
fn what_has_no_formula_to_write_is_refused() {
    let user = made("remembering", "load", "a exp(-s/b)", &BTreeMap::new()).unwrap();
    let error = source(user, "remembers", &[1.0, 1.0]).unwrap_err().to_string();
    assert!(error.contains("remembering") && error.contains("by hand"), "{error}");
}
