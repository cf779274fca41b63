//! Which parameters each of several runs has for itself: those that the data ask for, and no others.

use super::layout::Layout;
use super::moments::moments;
use super::solve::{Normal, independent, least_squares, solvable};
use super::{Fit, refine};
use crate::effects::Id;
use crate::error::Result;
use crate::model::{Model, Run};
use crate::rule::rule;
use crate::signals::Signals;

/// The runs of several captures.
pub fn runs<'a>(data: &[&'a Signals]) -> Vec<&'a Run> {
    data.iter().map(|signals| &signals.run).collect()
}

/// Effects of which runs may have parameters for themselves beside a model, those of every run last.
fn of_runs(model: &Model) -> Vec<Id> {
    let mut found: Vec<Id> = Id::BUILT_IN
        .iter()
        .filter(|id| {
            id.info().every_run || model.has(**id) && id.info().params.iter().any(|param| param.of_a_run)
        })
        .copied()
        .collect();
    found.sort_by_key(|id| id.info().every_run);
    found
}

/// The fit with parameters of runs apart where they differ beyond chance, and shared where they do not; `again` fits
/// another model to the same captures.
pub fn settled(data: &[&Signals], mut fit: Fit, again: impl Fn(&Model) -> Result<Fit>) -> Result<Fit> {
    if data.len() < 2 || fit.free.is_empty() {
        return Ok(fit);
    }
    for id in of_runs(&fit.model) {
        if fit.model.is_apart(id) {
            if !differ(&fit, id) {
                fit = again(&fit.model.together(id))?;
            }
        } else if let Some(model) = fit.model.apart(id, &runs(data))
            && promising(data, &fit, &model)
        {
            let near = refine(data, &model)?;
            if differ(&near, id) && mainly(&fit, &near) {
                fit = again(&near.model)?;
            }
        }
    }
    Ok(fit)
}

/// Whether a fit takes enough off what noise does not explain of the one before; where noise is unknown, nothing tells.
fn mainly(before: &Fit, now: &Fit) -> bool {
    let excess = before.rmse.powi(2) - before.noise_floor.powi(2);
    excess.is_nan() || before.rmse.powi(2) - now.rmse.powi(2) >= rule().own_of_runs * excess
}

/// Whether one step towards the optimum of a richer model could be worth its parameters. The filter takes more off
/// the noise than off what is slow, so that more pass than will stay.
fn promising(data: &[&Signals], fit: &Fit, richer: &Model) -> bool {
    let layout = Layout::of(richer);
    let at = moments(data, richer, &richer.values(), &layout.seeds(richer));
    let gram = |i: usize, j: usize| at.gram(i, j);
    let kept = solvable(gram, independent(gram, &layout.linear_first()));
    let more = layout.free.len().saturating_sub(Layout::of(&fit.model).free.len()) as f64;
    least_squares(&at, &kept).is_none_or(|step| {
        let gain = at.squares() - at.squares_after(&step);
        gain > rule().price * more * at.squares() / at.rows
    })
}

/// Whether the parameters of an effect that runs have for themselves differ from the shared ones beyond chance: Wald's
/// statistic, with the covariance of correlated residuals.
pub fn differ(fit: &Fit, id: Id) -> bool {
    let (slots, values) = (fit.model.slots(), fit.model.values());
    let place = |at: usize| fit.free.iter().position(|free| *free == at);
    let own: Vec<usize> = (0..slots.len())
        .filter(|&at| slots[at].effect == id && slots[at].run.is_some() && place(at).is_some())
        .collect();
    let covariance = |a: usize, b: usize| match (place(a), place(b)) {
        (Some(a), Some(b)) => fit.covariance[(a, b)],
        _ => 0.0,
    };
    let shared: Vec<usize> = own.iter().map(|&at| fit.model.shared(at)).collect();
    let apart = |i: usize, j: usize| {
        covariance(own[i], own[j]) + covariance(shared[i], shared[j])
            - covariance(own[i], shared[j])
            - covariance(shared[i], own[j])
    };
    let difference = |i: usize| values[own[i]] - values[shared[i]];
    let kept = solvable(apart, independent(apart, &(0..own.len()).collect::<Vec<_>>()));
    let Some(normal) = Normal::of(apart, &kept) else { return false };
    let solved = normal.solve(|i| difference(kept[i]));
    let wald: f64 = kept.iter().zip(&solved).map(|(&i, x)| difference(i) * x).sum();
    wald > rule().price * kept.len() as f64
}
