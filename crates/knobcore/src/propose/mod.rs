//! Where no name explains what a model leaves: laws that would, from a grammar of mechanics.
//!
//! What the model's parameters can absorb is taken off everything first. A scan holds every power and function against the
//! residual, the best are followed to their parameters, and are given one function more where that pays; what is left
//! at the end is a front of error against length. Nothing that is proposed is called a cause.

mod chance;
mod curve;
mod follow;
mod grammar;
mod rows;
mod scan;

use crate::diagnose::{Tell, Watch};
use crate::floor::{Floor, noises};
use crate::model::Model;
use crate::noise::Noise;
use crate::rule::rule;
use crate::signals::Signals;
pub use curve::Curve;
use follow::{Followed, Reach};
use grammar::{Factor, Powers, Term, Variable};
use rows::Rows;
use scan::{Seen, functions, scan, sines, widened};

/// Laws of a scan that are followed.
const FOLLOWED: usize = 24;
/// Of those so many are given one function more.
const WIDENED: usize = 8;
/// Laws that are followed to their end behind the measurement filter.
const ENDED: usize = 12;
/// Laws that are drawn on the curve.
const DRAWN: usize = 3;
/// Functions of a law at most.
const FUNCTIONS: usize = 2;
/// Steps that tell how good a law may be.
const GLANCE: usize = 6;
/// Steps to its end.
const END: usize = 12;

/// A law that could be what is missing.
#[derive(Debug, Clone)]
pub struct Law {
    /// As it is written.
    pub text: String,
    /// Its parameters at the start of a fit.
    pub params: Vec<(String, f64)>,
    /// What it is a law of.
    pub variables: Vec<&'static str>,
    /// What it takes off the sum of squares, in variances of the raw noise.
    pub gain: f64,
    /// How long it is.
    pub complexity: usize,
}

/// What could be missing from a model.
#[derive(Debug, Clone)]
pub struct Proposed {
    /// Laws, the one for which most speaks first; none where chance does as well.
    pub laws: Vec<Law>,
    /// Chance of what the first takes off, where nothing is missing.
    pub p_value: f64,
    /// What is left as a curve over the variable of the first law.
    pub curve: Option<Curve>,
}

/// Laws for what a fitted model leaves of captures; None if `tell` no longer wanted it.
pub fn propose(data: &[&Signals], model: &Model, tell: &Tell<'_>) -> Option<Proposed> {
    let watch = Watch::new(tell, 4);
    let (fine, squares) = Rows::of(data, model);
    let noises = noises(data, model);
    let floor = Floor::with(data, &noises);
    let none = Proposed { laws: Vec::new(), p_value: 1.0, curve: None };
    let white = floor.white;
    if !(white > 0.0 && floor.squares.is_finite()) || fine.len() == 0 {
        return Some(none);
    }
    let noises: Vec<Noise> = noises.into_iter().map(|noise| noise.unwrap_or(Noise::white(white))).collect();
    let coarse = fine.coarse();
    let reach = Reach::of(&fine);
    let of: Vec<Variable> = Variable::ALL.into_iter().filter(|one| known(*one)).collect();
    let tried = functions(&reach, &of);
    let seen = looked(&fine, &coarse, data, &tried, &reach, &watch);
    watch.step();
    let score = |gain: f64, term: &Term| gain / white - rule().price * term.count() as f64;
    let best = seen.first()?.gain;
    let mut followed = followed(&coarse, &seen, &reach, &watch, &score);
    watch.step();
    let wider: Vec<Seen> = watch
        .each(&followed[..followed.len().min(WIDENED)], |one| {
            let functions =
                one.term.factors.iter().filter(|factor| factor.shape != grammar::Shape::Sine).count();
            let mut wider =
                if functions < FUNCTIONS { widened(&coarse, &one.term, &tried) } else { Vec::new() };
            if one.term.sine().is_none() {
                wider.extend(sines(&coarse, &[one.term.clone()], Variable::Theta, &reach, f64::INFINITY));
            }
            wider.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            wider.truncate(FUNCTIONS + 1);
            wider
        })
        .into_iter()
        .flatten()
        .collect();
    followed.extend(self::followed(&coarse, &wider, &reach, &watch, &score));
    followed.sort_by(|a, b| score(b.gain, &b.term).total_cmp(&score(a.gain, &a.term)));
    watch.step();
    let mut ended: Vec<Followed> = watch
        .each(&spread(&followed), |one| Some(Followed::at(&fine, one.term.clone())?.best(&fine, END, &reach)))
        .into_iter()
        .flatten()
        .collect();
    if !watch.wanted() {
        return None;
    }
    ended.sort_by(|a, b| score(b.gain, &b.term).total_cmp(&score(a.gain, &a.term)));
    let p_value = chance::p_value(data, &noises, &fine, &coarse, &tried, &seen[0].term, best, white);
    let Some(first) = ended.first() else { return Some(none) };
    let excess = squares - floor.squares;
    let enough = first.gain >= rule().share * excess && first.gain >= rule().worth * squares;
    if p_value > rule().chance || !enough || score(first.gain, &first.term) <= 0.0 {
        return Some(Proposed { p_value, ..none });
    }
    // Of those that explain the same the shortest has the best claim.
    let left = (squares - first.gain) / white - floor.squares / white;
    let margin = rule().alike.max(rule().relative * left);
    let top = score(first.gain, &first.term);
    ended.sort_by(|a, b| {
        let far = |one: &Followed| top - score(one.gain, &one.term) > margin;
        far(a).cmp(&far(b)).then_with(|| {
            if far(a) {
                score(b.gain, &b.term).total_cmp(&score(a.gain, &a.term))
            } else {
                a.term.complexity().cmp(&b.term.complexity()).then(b.gain.total_cmp(&a.gain))
            }
        })
    });
    let curve = curve::of(&fine, &ended[..ended.len().min(DRAWN)]);
    let law = |one: Followed| {
        let written = one.term.written(&one.coefficients);
        Law {
            text: written.text,
            params: written.params,
            variables: one.term.variables(),
            gain: one.gain / white,
            complexity: one.term.complexity(),
        }
    };
    Some(Proposed { laws: ended.into_iter().map(law).collect(), p_value, curve })
}

/// Whether a formula knows a variable by its name.
fn known(variable: Variable) -> bool {
    let text = format!("a*{}", variable.text());
    crate::effects::formula::Formula::parse(&text).is_ok_and(|law| law.params().len() == 1)
}

/// All that a scan sees, best first.
fn looked(
    fine: &Rows<'_>,
    coarse: &Rows<'_>,
    data: &[&Signals],
    tried: &[Factor],
    reach: &Reach,
    watch: &Watch<'_>,
) -> Vec<Seen> {
    let alone = |powers: &Powers| Term { powers: *powers, factors: Vec::new() };
    let all: Vec<Term> = Powers::ALL.iter().map(alone).collect();
    let timed: Vec<Term> = all[..3].to_vec();
    let passes = data.iter().map(|signals| signals.passes_hz()).fold(0.0, f64::max);
    let mut found = scan(coarse, tried, watch);
    let waves =
        [(&all, Variable::Theta, f64::INFINITY), (&timed, Variable::Time, std::f64::consts::TAU * passes)];
    let waves = watch.each(&waves, |(terms, of, fastest)| sines(fine, terms, *of, reach, *fastest));
    found.extend(waves.into_iter().flatten());
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// The best of what was seen, followed a few steps; best first.
fn followed(
    rows: &Rows<'_>,
    seen: &[Seen],
    reach: &Reach,
    watch: &Watch<'_>,
    score: &(impl Fn(f64, &Term) -> f64 + Sync),
) -> Vec<Followed> {
    let mut order: Vec<&Seen> = seen.iter().collect();
    order.sort_by(|a, b| score(b.gain, &b.term).total_cmp(&score(a.gain, &a.term)));
    order.truncate(FOLLOWED);
    let mut found: Vec<Followed> = watch
        .each(&order, |one| Some(Followed::at(rows, one.term.clone())?.best(rows, GLANCE, reach)))
        .into_iter()
        .flatten()
        .collect();
    found.sort_by(|a, b| score(b.gain, &b.term).total_cmp(&score(a.gain, &a.term)));
    found
}

/// The best, of every kind one; best first.
fn spread(followed: &[Followed]) -> Vec<Followed> {
    let kind = |term: &Term| {
        let mut shapes: Vec<_> =
            term.factors.iter().map(|factor| (factor.of, factor.shape as usize)).collect();
        shapes.sort_unstable();
        shapes
    };
    let mut kept: Vec<Followed> = Vec::new();
    for one in followed {
        let same =
            |other: &Followed| other.term.powers == one.term.powers && kind(&other.term) == kind(&one.term);
        if kept.len() < ENDED && !kept.iter().any(same) {
            kept.push(one.clone());
        }
    }
    kept
}
