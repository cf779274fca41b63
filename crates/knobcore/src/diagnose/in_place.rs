//! One joint in the place of another.

use super::ends::{Ends, RIVAL, cost, on, others};
use super::joined::{joined_as, joined_by};
use super::screen::survey;
use super::slower::enough;
use super::watch::{Tell, Watch};
use crate::effects::Id;
use crate::fit::{Fit, glance, loads, report, sketch};
use crate::floor::Floor;
use crate::model::Model;
use crate::signals::Signals;

/// Starts of a joint in another's place that are followed.
const PLACED: usize = 2;

/// A fit with another coupling in the place of a model's own, from where that one ended. None for a model without one or
/// with that one, where no such model can be followed, and if `tell` no longer wanted it.
pub fn in_place(data: &[&Signals], model: &Model, other: Id, tell: &Tell<'_>) -> Option<Fit> {
    if !model.is_coupled() || model.has(other) {
        return None;
    }
    let bare = joined_as(&joined_by(model, other)?, model);
    // What its own joint lacks it starts with.
    let mut starts = vec![bare.clone()];
    for values in other.law().starts(&survey(data, &loads(model))) {
        let mut start = bare.clone();
        for (param, value) in other.info().params.iter().zip(values) {
            // The names are the joint's own, the values within their bounds.
            let _ = start.set(&format!("{}.{}", other.info().id, param.name), value);
        }
        let start = joined_as(&start, model);
        if starts.iter().all(|known| known.values() != start.values()) {
            starts.push(start);
        }
    }
    let watch = Watch::new(tell, starts.len());
    let look = |start: &Model| (0, on(start, |model| glance(data, model)));
    let mut looked: Ends = watch.each(&starts[..1], look);
    // Where that leads to what noise leaves no other start is needed.
    let enough = enough(data, Floor::of(data, model).squares);
    if looked.iter().all(|(_, (_, found))| found.cost > enough) {
        looked.extend(watch.each(&starts[1..], look));
    }
    looked.sort_by_cached_key(cost);
    others(&mut looked, RIVAL);
    looked.truncate(PLACED);
    let ends = watch.each(&looked, |(_, (model, _))| on(model, |model| sketch(data, model)));
    let (model, found) = ends.into_iter().min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))?;
    if watch.wanted() { report(data, &model, found).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::fit::refine;

    #[test]
    fn a_joint_that_stands_in_for_another_is_followed_from_where_that_one_ended() {
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let truth =
            knob(&[Id::Compliance, Id::ReturnSpring], &[&joint[..], &[("return_spring.k", 0.1)]].concat());
        let truth = truth.with_at_shaft(Id::ReturnSpring).unwrap();
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let soft = refine(&data, &truth).unwrap();
        let gap = in_place(&data, &soft.model, Id::Backlash, &|_| true).unwrap();
        assert!(gap.model.at_shaft(Id::ReturnSpring) && !gap.model.has(Id::Compliance));
        // A gap that closes is compliance, but for surfaces that do not pull.
        assert!(gap.rmse < 1.5 * soft.rmse, "{} {}", gap.rmse, soft.rmse);
        assert!(in_place(&data, &soft.model, Id::Compliance, &|_| true).is_none());
        assert!(in_place(&data, &knob(&[], &[]), Id::Backlash, &|_| true).is_none());
    }
}
