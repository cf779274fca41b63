//! A coupling and what hides beside it, looked for together.
//!
//! A joint bends what is seen of every other cause, and another cause what is seen of the joint: one after the other
//! neither is found. So each joint is tried with each of the others, from coarse to fine: the starts of the joint beside
//! the rigid model that has the other effect, a few steps from the most promising, descents from the best of these.

use super::coupled::{squares, strode};
use super::divided::divided;
use super::ends::on;
use super::screen::{Screen, Start};
use super::shown::{may_come, shown, with_joint};
use super::slower::{self, BEFORE, COARSE_HZ, MIDDLE_HZ, beginnings, slowed};
use super::unseen::lower;
use super::watch::{Tell, Watch};
use crate::effects::{Id, Place};
use crate::fit::{Fit, Found, glance, report, sketch, used};
use crate::floor::Floor;
use crate::model::Model;
use crate::order::Ascending;
use crate::rule::rule;
use crate::signals::Signals;

/// Starts of pairs that are looked at by a few steps, those of these that are followed through the coarse filter, and
/// of those through all of it.
const LOOKED: usize = 40;
const COARSE: usize = 6;
const FINE: usize = 2;
/// Starts of one pair among the first.
const ALIKE: usize = 2;
/// Samples of captures that the coarse search looks at.
const ENOUGH: usize = 12_000;
/// Starts of the other effect.
const STARTS: usize = 2;

/// A coupling and another effect that a model lacks.
#[derive(Debug, Clone)]
pub struct Pair {
    /// How shaft and knob are joined.
    pub coupling: Id,
    /// What else is missing.
    pub companion: Id,
    /// The model with both, fitted.
    pub fit: Fit,
}

/// A pair somewhere on its way.
#[derive(Clone)]
struct Way {
    coupling: Id,
    companion: Id,
    model: Model,
    /// Sum of squares there, (N m)^2.
    squares: f64,
}

impl Way {
    /// The best of these with the other effect on the other side of the joint; with it at the knob, if it is at the
    /// shaft, where there is none.
    fn elsewhere(&self, looked: &[Self]) -> Option<Self> {
        let other = |way: &&Self| way.kind() == self.kind() && way.at_shaft() != self.at_shaft();
        let best = looked.iter().filter(other).min_by(|a, b| a.squares.total_cmp(&b.squares));
        let moved = || Some(Self { model: self.model.with_all_at_knob().ok()?, ..*self });
        best.cloned().or_else(|| if self.at_shaft() { moved() } else { None })
    }

    /// Which pair it is.
    fn kind(&self) -> (Id, Id) {
        (self.coupling, self.companion)
    }

    /// The same, and on which side of the joint the other effect is.
    fn side(&self) -> ((Id, Id), bool) {
        (self.kind(), self.at_shaft())
    }

    fn at_shaft(&self) -> bool {
        !self.model.shafts().is_empty()
    }

    /// What it leaves with so much on it for each of its parameters.
    fn priced(&self, price: f64) -> f64 {
        self.squares + price * self.model.free().count() as f64
    }

    /// Where it ended.
    fn at(&self, (model, found): (Model, Found)) -> Self {
        Self { model, squares: found.cost, ..*self }
    }
}

/// The pairs of a coupling and another of the `effects` that explain most for their parameters, best first. None if `tell` no
/// longer wanted it.
pub fn pairs(data: &[&Signals], model: &Model, effects: &[Id], tell: &Tell<'_>) -> Option<Vec<Pair>> {
    let (couplings, others): (Vec<Id>, Vec<Id>) =
        effects.iter().partition(|id| id.info().place == Place::Coupling);
    let watch = Watch::new(tell, others.len() + LOOKED + 2 * COARSE + FINE);
    let first = beginnings(data, ENOUGH);
    let first: Vec<&Signals> = first.iter().collect();
    let coarse = slowed(&first, COARSE_HZ);
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let white = Floor::of(data, model).white;
    // Of few samples a parameter takes off as much less.
    let price = if white.is_finite() { rule().price * white * used(&coarse) / used(&first) } else { 0.0 };
    let rigid = Screen::new(&coarse, model, &watch);
    let floor = slower::floor(&first, COARSE_HZ, &coarse, model);
    let detents = may_come(model, effects);
    let through: Vec<(Id, Vec<Start>)> = couplings
        .iter()
        .filter(|_| detents)
        .map(|id| (*id, shown(&rigid, *id, &rigid.starts(*id), &[], floor)))
        .collect();
    let starts = watch.each(&others, |companion| {
        watch.step();
        beside(&rigid, *companion, &couplings, &through)
    });
    let looked = best_of(starts.into_iter().flatten().collect(), price, LOOKED, ALIKE, Way::side);
    let looked = watch.each(&looked, |way| {
        watch.step();
        way.at(on(&way.model, |model| glance(&coarse, model)))
    });
    let followed = best_of(looked.clone(), price, COARSE, 1, Way::kind);
    // Where the other effect acts the first steps do not tell.
    let elsewhere: Vec<Way> = followed.iter().filter_map(|way| way.elsewhere(&looked)).collect();
    let followed: Vec<Way> = followed.into_iter().chain(elsewhere).collect();
    let began = watch.each(&followed, |way| {
        watch.step();
        on(&way.model, |model| sketch(&coarse, model))
    });
    // Where one leads to what noise leaves no other is led out of its dents.
    let enough = slower::enough(&coarse, floor);
    let ended = began.iter().any(|(_, found)| found.cost <= enough);
    let began: Vec<(Way, (Model, Found))> = followed.into_iter().zip(began).collect();
    let followed = watch.each(&began, |(way, end)| {
        way.at(if ended { end.clone() } else { strode(&coarse, end.clone(), floor, rigid.squares, &watch) })
    });
    let middle = slowed(data, MIDDLE_HZ);
    let middle: Vec<&Signals> = middle.iter().collect();
    let floor = slower::floor(data, MIDDLE_HZ, &middle, model);
    let without = squares(&middle, model);
    let ends = watch.each(&best_of(followed, price, FINE, 1, Way::kind), |way| {
        watch.step();
        let between = lower(&middle, &way.model, [COARSE_HZ, MIDDLE_HZ], sketch);
        let between = strode(&middle, between, floor, without, &watch).0;
        let (model, found) = lower(data, &between, [MIDDLE_HZ, BEFORE * MIDDLE_HZ], sketch);
        let fit = report(data, &model, found).ok()?;
        Some(Pair { coupling: way.coupling, companion: way.companion, fit })
    });
    let mut ends: Vec<Pair> = ends.into_iter().flatten().collect();
    let left = |fit: &Fit| fit.white_squares * (fit.rmse / fit.noise_floor).powi(2);
    ends.sort_by_cached_key(|Pair { fit, .. }| {
        Ascending(if price > 0.0 {
            left(fit) + rule().price * fit.model.free().count() as f64
        } else {
            fit.rmse
        })
    });
    watch.wanted().then_some(ends)
}

/// The starts of joints beside the models that have another effect: fitted as if the shaft were rigid, and as it
/// starts, for a joint may bend it so far that no way leads back. `through` has the joints with the detents that show
/// through them.
fn beside(rigid: &Screen<'_>, companion: Id, couplings: &[Id], through: &[(Id, Vec<Start>)]) -> Vec<Way> {
    let mut models: Vec<Model> =
        rigid.starts(companion).into_iter().take(STARTS).map(|start| start.model).collect();
    let Some(first) = models.first() else { return Vec::new() };
    let mut fitted = first.clone();
    fitted.set_values(&sketch(rigid.data, first).p);
    models.push(fitted.clone());
    let shaft = if Model::may_be_at_shaft(companion) { vec![companion] } else { Vec::new() };
    let way = |(coupling, start): (Id, Start)| Way {
        coupling,
        companion,
        model: start.model,
        squares: start.predicted,
    };
    let ways = |model: &Model| {
        let screen = Screen::new(rigid.data, model, rigid.watch).with_shaft(shaft.clone());
        let joined =
            |coupling: &Id| screen.starts(*coupling).into_iter().map(|start| (*coupling, start)).collect();
        let all: Vec<(Id, Start)> = couplings.iter().flat_map::<Vec<_>, _>(joined).collect();
        all.into_iter().map(way).collect::<Vec<_>>()
    };
    let mut all: Vec<Way> = models.iter().flat_map(ways).collect();
    let screen = Screen::new(rigid.data, &fitted, rigid.watch);
    for coupling in couplings {
        let starts = screen.by_promise(*coupling, divided(&screen, *coupling));
        all.extend(starts.into_iter().map(|start| way((*coupling, start))));
    }
    for (coupling, starts) in through {
        let with = starts.iter().take(STARTS).flat_map(|start| with_joint(&fitted, &start.model, &shaft));
        let starts = screen.by_promise(*coupling, with.collect());
        all.extend(starts.into_iter().map(|start| way((*coupling, start))));
    }
    all
}

/// The best of them for their parameters, so many of a kind at most.
fn best_of<K: PartialEq>(
    mut ways: Vec<Way>,
    price: f64,
    most: usize,
    alike: usize,
    kind: impl Fn(&Way) -> K,
) -> Vec<Way> {
    ways.sort_by_cached_key(|way| Ascending(way.priced(price)));
    let mut seen = Vec::new();
    ways.retain(|way| {
        let kind = kind(way);
        let before = seen.iter().filter(|other| **other == kind).count();
        seen.push(kind);
        before < alike
    });
    ways.truncate(most);
    ways
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::fit::refine;

    #[test]
    fn a_joint_and_the_spring_that_hides_beside_it_are_found_together() {
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let truth =
            knob(&[Id::Compliance, Id::ReturnSpring], &[&joint[..], &[("return_spring.k", 0.1)]].concat());
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let base = refine(&data, &knob(&[], &[])).unwrap().model;
        let best = &pairs(&data, &base, &[Id::Compliance, Id::ReturnSpring], &|_| true).unwrap()[0];
        assert_eq!((best.coupling, best.companion), (Id::Compliance, Id::ReturnSpring));
        assert!(best.fit.rmse < 1.05 * best.fit.noise_floor, "{} {}", best.fit.rmse, best.fit.noise_floor);
        let value = |name: &str| best.fit.model.values()[best.fit.model.index(name).unwrap()];
        assert!((value("compliance.k") / 0.3 - 1.0).abs() < 0.1, "{}", value("compliance.k"));
        assert!((value("return_spring.k") / 0.1 - 1.0).abs() < 0.1, "{}", value("return_spring.k"));
    }
}
