//! Sets of effects, each fitted as one: which of those that were weighed explain most together?
//!
//! A search one by one keeps what came in first, and that may have stood in for two others: beside it these are
//! never asked for. What a set has to be worth is what a single effect has (a price for each parameter), so that
//! the order in which effects are met does not matter.

use super::watch::{Tell, Watch};
use crate::effects::Id;
use crate::fit::{Fit, Found, report, sketch};
use crate::floor::Floor;
use crate::model::Model;
use crate::order::Ascending;
use crate::rule::rule;
use crate::signals::Signals;

/// Sets that are told of.
const TOLD: usize = 2;

/// Effects that a model lacks.
#[derive(Debug, Clone)]
pub struct Set {
    /// Which.
    pub effects: Vec<Id>,
    /// The model with them, fitted.
    pub fit: Fit,
}

/// The best sets of up to `most` effects of a pool beside a fitted model, by what they take off the sum of squares
/// less the price of their parameters, best first. The pool has a model for each effect with values near its best.
/// None if `tell` no longer wanted it.
pub fn sets(
    data: &[&Signals],
    base: &Model,
    pool: &[(Id, Model)],
    most: usize,
    tell: &Tell<'_>,
) -> Option<Vec<Set>> {
    let members: Vec<usize> =
        (1_usize..1 << pool.len()).filter(|set| (1..=most).contains(&(set.count_ones() as usize))).collect();
    let watch = Watch::new(tell, members.len());
    let white = Floor::of(data, base).white;
    let price = if white.is_finite() { rule().price * white } else { 0.0 };
    let mut ends: Vec<(f64, Vec<Id>, Model, Found)> = watch
        .each(&members, |set| {
            watch.step();
            let chosen = || pool.iter().enumerate().filter(|(at, _)| set >> at & 1 == 1).map(|(_, own)| own);
            let model = chosen().try_fold(base.clone(), |model, (id, from)| joined(&model, *id, from))?;
            let found = sketch(data, &model);
            let own: Vec<Id> = chosen().map(|(id, _)| *id).collect();
            Some((found.cost + price * model.free().count() as f64, own, model, found))
        })
        .into_iter()
        .flatten()
        .filter(|(cost, ..)| cost.is_finite())
        .collect();
    ends.sort_by_cached_key(|(cost, ..)| Ascending(*cost));
    let told = ends.into_iter().take(TOLD).filter_map(|(_, effects, model, found)| {
        report(data, &model, found).ok().map(|fit| Set { effects, fit })
    });
    let told = told.collect();
    watch.wanted().then_some(told)
}

/// A model with one effect more, at the values that it has in another.
fn joined(model: &Model, id: Id, from: &Model) -> Option<Model> {
    let mut with = model.with(id).ok()?;
    for slot in from.slots().iter().filter(|slot| slot.effect == id && slot.run.is_none()) {
        with.set(&slot.name(), slot.value).ok()?;
        with.set_role(&slot.name(), slot.role).ok()?;
    }
    Some(with)
}
