//! Where no name explains what a model leaves: laws that would, from a grammar of mechanics.
//!
//! What the model's parameters can absorb is taken off everything first. A scan holds every power and function against the
//! residual, the best are followed to their parameters, and are given one function more where that pays; what is left
//! at the end is a front of error against length. Nothing that is proposed is called a cause.

mod chance;
mod curve;
mod follow;
mod grammar;
mod ground;
mod pairs;
mod penalized;
mod rows;
mod scan;
mod shapes;
mod spline;
mod sum;
mod surface;
#[cfg(test)]
mod tests;

use crate::diagnose::{Tell, Watch};
use crate::model::Model;
use crate::order::{descending, firsts};
use crate::rule::rule;
use crate::signals::Signals;
pub use curve::Curve;
use follow::{Followed, Reach};
use grammar::{Factor, Powers, Shape, Term, Variable};
use ground::Ground;
use rows::Rows;
use scan::{Seen, Tried, scan, sines, turning, values, widened};
pub use shapes::{Need, Shapes};
pub use spline::Written;
use std::sync::OnceLock;
use sum::Sum;
pub use surface::Map;

/// Rows that tell what is fast.
const MEDIUM: usize = 8000;
/// Rows that tell what is slow.
const COARSE: usize = 2000;
/// What is slow goes by fewer radians a second.
const FAST: f64 = 200.0;
/// Powers that are looked at with waves of time: none, the sign of the velocity, the velocity.
const TIMED: usize = 3;
/// Laws of a scan that are followed, beside the best of each kind.
const FOLLOWED: usize = 24;
/// Of those so many are given one function more, and the best of each kind.
const WIDENED: usize = 8;
/// Laws with one function more that are followed, of each.
const MORE: usize = 3;
/// Laws that are followed to their end behind the measurement filter.
const ENDED: usize = 12;
/// Laws that are drawn on the curve.
const DRAWN: usize = 3;
/// Functions of a law at most.
const FUNCTIONS: usize = 2;
/// Of what laws may be off by, the part that a longer one has to explain: together with errors of its parameters the shorter
/// one is then off by no more than that.
const OFF: f64 = 0.25;
/// Of two laws that take off the same to this share, one is the other written anew.
const SAME: f64 = 1e-6;
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
    /// Whether it explains as much as the best.
    pub alike: bool,
    /// How many of its parameters are free.
    pub count: usize,
    /// How long it is.
    pub complexity: usize,
    /// How many laws are added in it.
    pub terms: usize,
}

/// What of a residual follows a law, before any is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// What the law is of.
    pub variables: Vec<&'static str>,
    /// What it takes off the sum of squares at least, in variances of the raw noise.
    pub gain: f64,
    /// Chance that a law of the grammar takes off as much where nothing is missing.
    pub p_value: f64,
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
    /// What is left without a formula; nothing where there is no law.
    pub shapes: Shapes,
}

/// The law that a scan sees most of in what a fitted model leaves; of nothing where the noise is not known, and None if
/// `tell` no longer wanted it.
pub fn trace(data: &[&Signals], model: &Model, tell: &Tell<'_>) -> Option<Trace> {
    let watch = Watch::new(tell, 2);
    let none = Trace { variables: Vec::new(), gain: 0.0, p_value: 1.0 };
    let Some(ground) = Ground::of(data, model) else { return Some(none) };
    let seen = ground.search(&watch).looked();
    watch.step();
    if !watch.wanted() {
        return None;
    }
    let Some(first) = seen.first() else { return Some(none) };
    Some(Trace {
        variables: Sum::from(first.term.clone()).variables(),
        gain: first.gain / ground.floor.white,
        p_value: ground.chance().p_value(first),
    })
}

/// Laws for what a fitted model leaves of captures, sums of two among them where `sums` may be; None if `tell` no longer
/// wanted it.
pub fn propose(data: &[&Signals], model: &Model, sums: bool, tell: &Tell<'_>) -> Option<Proposed> {
    let watch = Watch::new(tell, 7);
    let none = Proposed { laws: Vec::new(), p_value: 1.0, curve: None, shapes: Shapes::default() };
    let Some(ground) = Ground::of(data, model) else { return Some(none) };
    let Ground { fine, squares, floor, rows, reach, .. } = &ground;
    let (squares, white) = (*squares, floor.white);
    let search = ground.search(&watch);
    let seen = search.looked();
    watch.step();
    let mut followed = search.followed(&seen);
    watch.step();
    let parents = varied(followed.iter(), |one| kinds(one.law.factors()), WIDENED);
    let parents: Vec<&Term> = parents.into_iter().filter_map(|one| one.law.alone()).collect();
    let wider: Vec<Seen> = watch.each(&parents, |term| search.widened(term)).concat();
    followed.extend(search.followed(&wider));
    followed.sort_by_cached_key(|one| descending(search.score(one)));
    watch.step();
    let mut ended: Vec<Followed> = watch
        .each(&spread(&followed), |one| Some(Followed::at(fine, one.law.clone())?.best(fine, END, reach)))
        .into_iter()
        .flatten()
        .collect();
    watch.step();
    if !watch.wanted() {
        return None;
    }
    ended.sort_by_cached_key(|one| descending(search.score(one)));
    let (Some(found), Some(first)) = (seen.first(), ended.first()) else { return Some(none) };
    let chance = ground.chance();
    let p_value = chance.p_value(found);
    let excess = squares - floor.squares;
    let enough = |one: &Followed| one.gain >= rule().share * excess && one.gain >= rule().worth * squares;
    if p_value > rule().chance || !enough(first) || search.score(first) <= 0.0 {
        return Some(Proposed { p_value, ..none });
    }
    if sums && squares - first.gain > rule().explained * floor.squares {
        let left = squares - first.gain;
        let more = |pair: &Followed| pair.gain - first.gain;
        let worth = |pair: &Followed| {
            more(pair) >= rule().share * (left - floor.squares) && more(pair) >= rule().worth * left
        };
        let by_chance = |pair: &Followed| {
            pair.law.0.iter().any(|term| {
                let second = Seen { term: term.clone(), gain: more(pair) };
                chance.p_value(&second) > rule().chance
            })
        };
        // What is small beside the first shows once that is taken off.
        let rest = [rows[0].without(&first.law), rows[1].without(&first.law)];
        let beside = Search { rows: &rest, ..search }.looked();
        let pairs = search.pairs(&followed, &[&seen, &beside], fine);
        let pairs: Vec<Followed> = pairs.into_iter().filter(|pair| worth(pair) && !by_chance(pair)).collect();
        ended.extend(pairs);
        ended.sort_by_cached_key(|one| descending(search.score(one)));
    }
    watch.step();
    if !watch.wanted() {
        return None;
    }
    // Of those that explain the same the shortest has the best claim.
    ended.retain(enough);
    let Some(first) = ended.first() else { return Some(none) };
    let left = (squares - first.gain) / white - floor.squares / white;
    let off = OFF * rule().law.powi(2) * first.gain / white;
    let margin = rule().alike.max(rule().relative * left).max(off);
    let ended = paid(ended, margin, white);
    let curve = curve::of(fine, &ended[..ended.len().min(DRAWN)]);
    let top = ended.iter().map(|one| search.score(one)).fold(f64::NEG_INFINITY, f64::max);
    let law = |one: Followed| {
        let written = one.law.written(&one.coefficients);
        Law {
            text: written.text,
            params: written.params,
            variables: one.law.variables(),
            gain: one.gain / white,
            alike: top - search.score(&one) <= margin,
            count: one.law.count(),
            complexity: one.law.complexity(),
            terms: one.law.0.len(),
        }
    };
    let laws: Vec<Law> = ended.into_iter().map(law).collect();
    let shapes = shapes::shapes((fine, rows), reach, &chance, top, &watch)?;
    Some(Proposed { laws, p_value, curve, shapes })
}

/// Of laws, best first, those that pay for their length: no shorter one explains as much; those that explain as much as the
/// best stand first, the shortest before the others.
fn paid(laws: Vec<Followed>, margin: f64, white: f64) -> Vec<Followed> {
    let score = |one: &Followed| one.gain / white - rule().price * one.law.count() as f64;
    let top = laws.iter().map(score).fold(f64::NEG_INFINITY, f64::max);
    let far = |one: &Followed| top - score(one) > margin;
    // Of two that are as long the one with fewer parameters is the shorter.
    let length = |one: &Followed| (one.law.complexity(), one.law.count());
    let needless = |one: &Followed| {
        laws.iter().any(|other| {
            let shorter = length(other) < length(one);
            shorter && ((one.gain - other.gain) / white <= margin || score(other) >= score(one))
        })
    };
    let mut kept: Vec<Followed> = laws.iter().filter(|one| !needless(one)).cloned().collect();
    kept.sort_by(|a, b| {
        far(a).cmp(&far(b)).then_with(|| {
            if far(a) {
                score(b).total_cmp(&score(a))
            } else {
                length(a).cmp(&length(b)).then(b.gain.total_cmp(&a.gain))
            }
        })
    });
    firsts(kept, |other, one| (other.gain / one.gain - 1.0).abs() < SAME)
}

/// A search among laws.
struct Search<'a> {
    /// Rows that tell what is fast, and fewer that tell what is slow.
    rows: &'a [Rows<'static>; 2],
    /// The functions at either, once they are asked for: the same whatever is left.
    values: &'a [OnceLock<Vec<Vec<f64>>>; 2],
    reach: &'a Reach,
    powers: &'a [Powers],
    tried: &'a [Factor],
    watch: &'a Watch<'a>,
    white: f64,
    /// Whether the angle is one, and no way.
    turns: bool,
}

impl Search<'_> {
    fn score(&self, one: &Followed) -> f64 {
        one.gain / self.white - rule().price * one.law.count() as f64
    }

    /// What the parameters of a term cost, in variances of the raw noise.
    fn price(&self, term: &Term) -> f64 {
        rule().price * term.count() as f64
    }

    /// The rows that tell a law: waves that few rows would not follow need all.
    fn telling(&self, law: &Sum) -> usize {
        let quick = |sine: &Factor| {
            let speed = match sine.of {
                Variable::Time => 1.0,
                _ => self.reach.far(Variable::Omega),
            };
            speed / sine.at[0].abs() > FAST
        };
        if law.0.iter().filter_map(Term::sine).any(quick) { 0 } else { 1 }
    }

    /// The functions that are tried, at some of the rows.
    fn tried(&self, rows: usize) -> Tried<'_> {
        (self.tried, self.values[rows].get_or_init(|| values(&self.rows[rows], self.tried)))
    }

    /// All that a scan sees, best first.
    fn looked(&self) -> Vec<Seen> {
        let [medium, coarse] = self.rows;
        let alone = |powers: &Powers| Term { powers: *powers, factors: Vec::new() };
        let all: Vec<Term> = self.powers.iter().map(alone).collect();
        let mut found = scan(coarse, self.powers, self.tried(1), self.watch);
        let waves = [(&all[..], Variable::Theta), (&all[..TIMED], Variable::Time)];
        let waves = self.watch.each(&waves, |(terms, of)| sines(medium, terms, *of, self.reach));
        found.extend(waves.into_iter().flatten());
        if self.turns {
            found.extend(turning(coarse, &all));
        }
        found.sort_by_cached_key(|one| descending(one.gain));
        found
    }

    /// A law followed a few steps, which tell how good it may be.
    fn glanced(&self, law: Sum) -> Option<Followed> {
        let rows = &self.rows[self.telling(&law)];
        Some(Followed::at(rows, law)?.best(rows, GLANCE, self.reach))
    }

    /// The best of what was seen, followed a few steps; best first.
    fn followed(&self, seen: &[Seen]) -> Vec<Followed> {
        let mut order: Vec<&Seen> = seen.iter().collect();
        let score = |one: &Seen| one.gain / self.white - self.price(&one.term);
        order.sort_by_cached_key(|one| descending(score(one)));
        let order = varied(order.into_iter(), |one| kinds(one.term.factors.iter()), FOLLOWED);
        let follow = |one: &&Seen| self.glanced(one.term.clone().into());
        let mut found: Vec<Followed> = self.watch.each(&order, follow).into_iter().flatten().collect();
        found.sort_by_cached_key(|one| descending(self.score(one)));
        found
    }

    /// A law with one function more.
    fn widened(&self, term: &Term) -> Vec<Seen> {
        let rows = self.telling(&term.clone().into());
        let own = term.factors.iter().filter(|factor| !factor.shape.is_wave()).count();
        let mut wider =
            if own < FUNCTIONS { widened(&self.rows[rows], term, self.tried(rows)) } else { Vec::new() };
        if term.sine().is_none() {
            if self.turns {
                wider.extend(turning(&self.rows[1], std::slice::from_ref(term)));
            }
            wider.extend(sines(&self.rows[1], std::slice::from_ref(term), Variable::Theta, self.reach));
        }
        wider.sort_by_cached_key(|one| descending(one.gain));
        wider.truncate(MORE);
        wider
    }
}

/// Of functions what they are of, and which.
fn kinds<'a>(factors: impl Iterator<Item = &'a Factor>) -> Vec<(Variable, Shape)> {
    factors.map(|factor| (factor.of, factor.shape)).collect()
}

/// The first so many, and of the others those whose functions none before has: what is a part of a law may explain less than
/// much that is none.
fn varied<'a, T>(
    sorted: impl Iterator<Item = &'a T>,
    kind: impl Fn(&T) -> Vec<(Variable, Shape)>,
    most: usize,
) -> Vec<&'a T> {
    let mut kept: Vec<&T> = Vec::new();
    for one in sorted {
        if kept.len() < most || !kept.iter().any(|other| kind(other) == kind(one)) {
            kept.push(one);
        }
    }
    kept
}

/// The best, of every kind one, and of each length below theirs: a front of error against length ends where nothing is left
/// out. Best first.
fn spread(followed: &[Followed]) -> Vec<Followed> {
    let kind = |law: &Sum| {
        let powers: Vec<Powers> = law.0.iter().map(|term| term.powers).collect();
        let mut shapes: Vec<_> = law.factors().map(|factor| (factor.of, factor.shape as usize)).collect();
        shapes.sort_unstable();
        (powers, shapes)
    };
    let mut kept: Vec<Followed> = Vec::new();
    for one in followed {
        let shorter = |other: &Followed| one.law.complexity() < other.law.complexity();
        let new = !kept.iter().any(|other| kind(&other.law) == kind(&one.law));
        if new && (kept.len() < ENDED || kept.iter().all(shorter)) {
            kept.push(one.clone());
        }
    }
    kept
}
