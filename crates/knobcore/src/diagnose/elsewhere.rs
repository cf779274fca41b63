//! An effect at other values: what repeats over position has a period, and of periods an error has many minima.

use super::candidate::Candidate;
use super::implausible::implausible;
use super::screen::{Screen, Start};
use super::watch::{Tell, Watch};
use crate::effects::Id;
use crate::fit::{Fit, report, sketch, used};
use crate::rule::rule;
use crate::signals::Signals;

/// Starts that are followed.
const FOLLOWED: usize = 3;

/// A fit with one of its effects looked for anew at values that can be its own, beside all others as they are. None for
/// what does not repeat over position, where that leads to no such values, and if `tell` no longer wanted it.
pub fn elsewhere(data: &[&Signals], fit: &Fit, id: Id, tell: &Tell<'_>) -> Option<Fit> {
    id.info().scan?;
    let others: Vec<Id> = fit.model.effects().filter(|one| *one != id).collect();
    let bare = fit.model.only(&others).ok()?;
    let watch = Watch::new(tell, FOLLOWED);
    let screen = Screen::new(data, &bare, &watch);
    let starts = screen.starts(id);
    let starts = if fit.model.at_shaft(id) { screen.at_shaft(id, &starts) } else { starts };
    own_end(&screen, fit, id, &starts).filter(|_| watch.wanted())
}

/// Has what explains most at values that can be its own, where it ended at others and these explain as much. `found` are
/// effects with the starts that they had; `noise` as of all that is weighed: its variance, and what it leaves.
pub fn lead_by_its_own_values(
    screen: &Screen<'_>,
    found: &mut [(Candidate, Vec<Start>)],
    [white, floor]: [f64; 2],
) {
    let lead = found.iter_mut().max_by(|(a, _), (b, _)| a.worth().total_cmp(&b.worth()));
    let Some((lead, starts)) = lead.filter(|(lead, _)| lead.worth() > 0.0) else { return };
    let Some(fit) = lead.fit.as_ref().filter(|_| lead.id.info().scan.is_some()) else { return };
    if implausible(screen.data, fit, lead.id, false, false).is_empty() {
        return;
    }
    let Some(own) = own_end(screen, fit, lead.id, starts) else { return };
    let squares = |fit: &Fit| fit.rmse.powi(2) * used(screen.data);
    let left = (squares(fit) - floor).max(0.0);
    if squares(&own) - squares(fit) <= (rule().alike * white).max(rule().relative * left) {
        lead.gain = (screen.squares - squares(&own)) / white;
        lead.fit = Some(own);
    }
}

/// The best end of an effect whose values can be its own, from those of its starts whose can; None where there is none.
/// `fit` has the effect at values that cannot.
fn own_end(screen: &Screen<'_>, fit: &Fit, id: Id, starts: &[Start]) -> Option<Fit> {
    id.info().scan?;
    let data = screen.data;
    let can_be = |fit: &Fit| implausible(data, fit, id, false, false).is_empty();
    let of_its_kind = |start: &&Start| start.model.slots().len() == fit.model.slots().len();
    let sets_out = |start: &&Start| {
        let mut at = fit.clone();
        at.model = start.model.clone();
        can_be(&at)
    };
    let starts: Vec<&Start> = starts.iter().filter(of_its_kind).filter(sets_out).take(FOLLOWED).collect();
    let ends = screen.watch.each(&starts, |start| {
        let found = sketch(data, &start.model);
        report(data, &start.model, found).ok().filter(can_be)
    });
    ends.into_iter().flatten().min_by(|a, b| a.rmse.total_cmp(&b.rmse))
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::fit::refine;
    use std::f64::consts::TAU;

    #[test]
    fn friction_with_a_period_that_is_a_trend_is_found_at_one_that_the_motion_crosses_beside_a_joint_too() {
        // The motion goes through some 2.2 rad.
        let rough =
            [("position_friction.P", 0.32), ("position_friction.a1", 0.4), ("position_friction.b2", 0.3)];
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let joined = knob(&[Id::Compliance, Id::PositionFriction], &[&rough[..], &joint].concat());
        let joined = joined.with_at_shaft(Id::PositionFriction).unwrap();
        for truth in [knob(&[Id::PositionFriction], &rough), joined] {
            let signals = recorded(&truth, "a");
            let data = [&signals];
            let mut fit = refine(&data, &truth).unwrap();
            let right = fit.rmse;
            let ends = signals.theta.iter().fold((0.0, 0.0), |(a, b): (f64, f64), x| (a.min(*x), b.max(*x)));
            fit.model.set("position_friction.P", (ends.1 - ends.0) / TAU / 0.6).unwrap();
            fit.model.set("position_friction.b2", 0.0).unwrap();
            assert!(!implausible(&data, &fit, Id::PositionFriction, false, false).is_empty());
            let own = elsewhere(&data, &fit, Id::PositionFriction, &|_| true).unwrap();
            assert!(implausible(&data, &own, Id::PositionFriction, false, false).is_empty());
            assert!(own.rmse < 1.02 * right, "{} {right}", own.rmse);
            let period = own.model.slots()[own.model.index("position_friction.P").unwrap()].value;
            assert!((period / 0.32 - 1.0).abs() < 0.05, "{period}");
            assert_eq!(own.model.at_shaft(Id::PositionFriction), truth.at_shaft(Id::PositionFriction));
            assert!(elsewhere(&data, &fit, Id::PositionFriction, &|_| false).is_none());
            // What does not repeat has one best.
            assert!(elsewhere(&data, &fit, Id::Viscous, &|_| true).is_none());
        }
    }
}
