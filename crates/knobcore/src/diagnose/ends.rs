//! Ends of the descents of several ways, best first or not: which of them are rivals, and which are one.

use crate::fit::Found;
use crate::model::Model;
use crate::order::Ascending;
use crate::rule::rule;

/// Ends of descents, each with the place of its way among the ways.
pub(super) type Ends = Vec<(usize, (Model, Found))>;

/// Sums of squares of what is followed to its end, in times of the best.
pub(super) const RIVAL: f64 = 1.15;

/// Ends whose sums of squares differ by less than this share are one.
pub(super) const SAME: f64 = 1e-3;

/// What an end may leave at most that is a rival of the best of these, where so much is left without a coupling.
pub(super) fn at_most(ends: &Ends, squares: f64, floor: f64) -> f64 {
    let floor = if floor.is_nan() { 0.0 } else { floor };
    floor + rule().rival_coarse * (least(ends) - floor).max(0.0) + rule().close_coarse * (squares - floor)
}

/// What the best of some ends leaves.
pub(super) fn least(ends: &Ends) -> f64 {
    ends.iter().map(|(_, (_, found))| found.cost).fold(f64::INFINITY, f64::min)
}

/// The first of each way's ends, and the others.
pub(super) fn firsts(ends: Ends) -> (Ends, Ends) {
    let mut seen = Vec::new();
    ends.into_iter().partition(|(of, _)| {
        let first = !seen.contains(of);
        seen.push(*of);
        first
    })
}

/// The ends that leave at most so much, and the others.
pub(super) fn rivals(most: f64, ends: Ends) -> (Ends, Ends) {
    ends.into_iter().partition(|(_, (_, found))| found.cost <= most)
}

/// Keeps of each way's ends, best first, those within so many times the best; two starts mostly lead to one end.
pub(super) fn others(ends: &mut Vec<(usize, (Model, Found))>, within: f64) {
    let mut kept: Vec<(usize, f64)> = Vec::new();
    ends.retain(|(of, (_, found))| {
        let own: Vec<f64> = kept.iter().filter(|(own, _)| own == of).map(|(_, cost)| *cost).collect();
        let rivals = own.first().is_none_or(|best| found.cost <= within * best);
        let other = own.last().is_none_or(|last| found.cost > (1.0 + SAME) * last);
        if rivals && other {
            kept.push((*of, found.cost));
        }
        rivals && other
    });
}

/// What an end is sorted by.
pub(super) fn cost((_, (_, found)): &(usize, (Model, Found))) -> Ascending {
    Ascending(found.cost)
}

/// A model where a descent from it ended.
pub(super) fn on(model: &Model, to: impl Fn(&Model) -> Found) -> (Model, Found) {
    let found = to(model);
    let mut model = model.clone();
    model.set_values(&found.p);
    (model, found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::glance;
    use crate::param::Axis;

    #[test]
    fn of_each_coupling_the_ends_that_differ_and_are_nearly_as_good_are_followed() {
        let model = Model::equation_1(Axis::Rotary, false);
        let end = |(of, cost): (usize, f64)| {
            let found = glance(&[], &model);
            (of, (model.clone(), Found { cost, ..found }))
        };
        let mut ends: Vec<_> =
            [(0, 1.0), (0, 1.0001), (1, 1.05), (0, 1.1), (0, 1.2), (1, 1.3)].into_iter().map(end).collect();
        others(&mut ends, 1.15);
        let kept: Vec<(usize, f64)> = ends.iter().map(|(of, (_, found))| (*of, found.cost)).collect();
        assert_eq!(kept, [(0, 1.0), (1, 1.05), (0, 1.1)]);
    }

    #[test]
    fn the_first_of_each_way_is_told_from_the_others_and_the_order_is_kept() {
        let model = Model::equation_1(Axis::Rotary, false);
        let end = |(of, cost): (usize, f64)| (of, (model.clone(), Found { cost, ..glance(&[], &model) }));
        let ends = [(1, 1.0), (0, 2.0), (1, 3.0), (0, 4.0)].into_iter().map(end).collect();
        let costs = |ends: &Ends| ends.iter().map(|(of, (_, found))| (*of, found.cost)).collect::<Vec<_>>();
        let (first, rest) = firsts(ends);
        assert_eq!((costs(&first), costs(&rest)), (vec![(1, 1.0), (0, 2.0)], vec![(1, 3.0), (0, 4.0)]));
        assert_eq!((least(&first), least(&rest), least(&Ends::new())), (1.0, 3.0, f64::INFINITY));
    }
}
