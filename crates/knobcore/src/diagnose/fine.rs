//! The last part of the search for a joint: descents with all that was measured.

use super::ends::{Ends, RIVAL, SAME, least, on};
use super::joined::{joined_as, joined_by};
use super::shown::detents;
use super::slower::{BEFORE, MIDDLE_HZ};
use super::unseen::softer;
use super::watch::Watch;
use crate::effects::Place;
use crate::fit::{Found, glance, sketch_within, used};
use crate::model::Model;
use crate::signals::Signals;

/// Ends that are followed to their end; the others only as long as they may leave less than these.
const FINE: usize = 2;

/// Where ends, best first, lead with all that was measured: `roughly` a few steps each. The `worse` ones are told by
/// where the best leads them.
pub fn finely(data: &[&Signals], ends: &Ends, worse: Ends, roughly: bool, watch: &Watch<'_>) -> Ends {
    let (first, rest) = ends.split_at(ends.len().min(FINE));
    let mut first: Vec<(usize, Model)> = first.iter().map(|(of, (model, _))| (*of, model.clone())).collect();
    if !roughly {
        first.extend(softer(data, ends, [MIDDLE_HZ, BEFORE * MIDDLE_HZ]));
    }
    let to = |model: &Model, within: f64| {
        if roughly { glance(data, model) } else { sketch_within(data, model, within) }
    };
    let mut fine = watch.each(&first, |(of, model)| (*of, on(model, |m| to(m, f64::INFINITY))));
    let within = (RIVAL * least(&fine) / used(data)).sqrt();
    fine.extend(watch.each(rest, |(of, (model, _))| (*of, on(model, |m| to(m, within)))));
    let beaten = |found: Found| Found { cost: f64::INFINITY, ..found };
    fine.extend(worse.into_iter().map(|(of, (model, found))| (of, (model, beaten(found)))));
    let within = (RIVAL * least(&fine) / used(data)).sqrt();
    let lowest = least(&fine);
    fine.extend(crossed(&fine, watch, |model| to(model, within)));
    if least(&fine) < lowest {
        // What went on from the best end is better: that one goes on from there.
        fine.extend(crossed(&fine, watch, |model| to(model, within)));
    }
    fine.retain(|(_, (_, found))| found.cost.is_finite());
    fine
}

/// Where each coupling but the best leads to from the best one's end: a gap that closes is compliance, and a soft shaft with
/// play is what both have nearly the same error for.
fn crossed(
    ends: &[(usize, (Model, Found))],
    watch: &Watch<'_>,
    to: impl Fn(&Model) -> Found + Sync,
) -> Vec<(usize, (Model, Found))> {
    let by_cost =
        |a: &&(usize, (Model, Found)), b: &&(usize, (Model, Found))| a.1.1.cost.total_cmp(&b.1.1.cost);
    let Some((best, (from, lowest))) = ends.iter().min_by(by_cost) else { return Vec::new() };
    let own = |of: usize| ends.iter().filter(move |(own, _)| *own == of).min_by(by_cost);
    let worse: Vec<(usize, Model)> = (0..=ends.iter().map(|(of, _)| *of).max().unwrap_or(0))
        .filter(|of| of != best)
        .filter_map(own)
        .filter(|(_, (_, found))| found.cost > (1.0 + SAME) * lowest.cost)
        .filter_map(|(of, (model, _))| Some((*of, crossing(model, from)?)))
        .collect();
    watch.each(&worse, |(of, model)| (*of, on(model, &to)))
}

/// A model with the values that another ended with, and with the detents that came with that one's coupling.
fn crossing(model: &Model, from: &Model) -> Option<Model> {
    let has = |model: &Model| detents().is_some_and(|own| model.has(own));
    if has(model) == has(from) {
        return Some(joined_as(model, from));
    }
    let coupling = model.effects().find(|id| id.info().place == Place::Coupling)?;
    Some(joined_as(&joined_by(from, coupling)?, from))
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::knob;
    use super::*;
    use crate::effects::Id;

    #[test]
    fn from_the_best_end_of_all_those_joints_go_on_that_ended_worse() {
        let end = |(id, cost, k): (Id, f64, f64)| {
            let name = format!("{}.k", id.info().id);
            let model = knob(&[id], &[(&name, k)]);
            let found = glance(&[], &model);
            (model, Found { cost, ..found })
        };
        let watch = Watch::new(&|_| true, 1);
        for (other, again) in [(1.5e-4, true), (1.000_1e-4, false)] {
            let ends = [(1, end((Id::Backlash, other, 7.0))), (0, end((Id::Compliance, 1e-4, 45.0)))];
            let went = crossed(&ends, &watch, |model| Found { cost: 5e-5, ..glance(&[], model) });
            assert_eq!(went.len(), usize::from(again), "{other}");
            for (of, (model, found)) in went {
                assert_eq!((of, found.cost), (1, 5e-5));
                assert_eq!(model.values()[model.index("backlash.k").unwrap()], 45.0);
            }
        }
    }
}
