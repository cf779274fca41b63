//! Friction that builds up over a distance, beside a joint that gives way as far: each does nearly what the other does, so
//! that a fit without the joint leaves all of the distance to the friction. From there no slope leads back to both: the
//! distance is divided between them.

use super::screen::Screen;
use crate::effects::{Id, Joint};
use crate::model::{Model, Role};
use crate::param::Unit;

/// Shares of the distance that are left to the friction, and shares of the inertia that are behind the joint.
const KEPT: [f64; 2] = [0.5, 0.25];
const BEHIND: [f64; 2] = [0.3, 0.7];
/// Damping of the joint, as a share of the critical one.
const DAMPED: f64 = 0.1;

/// A screen's model with a joint that gives way to its friction by what this is made to build up sooner; none where none
/// builds up, or where the joint has free play.
pub fn divided(screen: &Screen<'_>, joint: Id) -> Vec<Model> {
    let ways = KEPT.into_iter().flat_map(|kept| BEHIND.map(|behind| (kept, behind)));
    ways.filter_map(|(kept, behind)| with_joint(screen, joint, kept, behind)).collect()
}

fn with_joint(screen: &Screen<'_>, joint: Id, kept: f64, behind: f64) -> Option<Model> {
    let model = screen.model;
    let over = model.builds_up_over().filter(|over| *over > 0.0)?;
    let inertia = behind * model.inertia().map(|at| model.slots()[at].value.abs())?;
    let friction = 0.5 * screen.survey.friction.iter().map(|level| level.abs()).sum::<f64>();
    let stiffness = friction / (over * (1.0 - kept));
    let mut with = model.with(joint).ok()?;
    if with.joint(&with.values()).is_none_or(|Joint { welded, .. }| !welded) {
        return None;
    }
    let damping = 2.0 * DAMPED * (stiffness * inertia).sqrt();
    let mut values = with.values();
    for (value, slot) in values.iter_mut().zip(with.slots()).filter(|(_, slot)| slot.role == Role::Free) {
        let param = slot.param;
        let new = match param.unit {
            unit if slot.effect != joint => {
                let late = model.builds_up_over_by(slot.effect).is_some();
                if late && unit == Unit::of(0, 1, 0) { kept * *value } else { *value }
            }
            unit if unit == Unit::of(1, -1, 0) => stiffness,
            unit if unit == Unit::of(1, -1, 1) => damping,
            _ => behind,
        };
        *value = new.clamp(param.lower, param.upper);
    }
    with.set_values(&values);
    Some(with)
}

#[cfg(test)]
mod tests {
    use super::super::coupled::coupled;
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::super::watch::Watch;
    use super::*;
    use crate::fit::refine;

    #[test]
    fn a_joint_is_found_beside_friction_that_builds_up_to_which_a_fit_has_left_all_of_the_distance() {
        let late = [("presliding.s", 2.25e-3), ("presliding.w1", 0.5), ("presliding.w2", 0.5)];
        let joint = [("compliance.k", 10.0), ("compliance.d", 1e-3), ("compliance.share", 0.6)];
        let friction = [("coulomb.neg", 0.03), ("coulomb.pos", 0.03)];
        let truth = knob(&[Id::Presliding, Id::Compliance], &[&late[..], &joint[..], &friction[..]].concat());
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let base = refine(&data, &knob(&[Id::Presliding], &late)).unwrap();
        assert!(base.rmse > 2.0 * SD, "{}", base.rmse);
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &base.model, &watch);
        for id in [Id::Compliance, Id::Backlash] {
            let starts = divided(&screen, id);
            assert_eq!(starts.len(), if id == Id::Compliance { 4 } else { 0 });
        }
        let ways = coupled(&screen, &[Id::Compliance], false, None);
        let left = ways[0].end.as_ref().unwrap().1.cost;
        assert!(left < 1.02 * 4000.0 * SD * SD, "{left}");
    }

    #[test]
    fn where_none_builds_up_there_is_nothing_to_divide() {
        let model = knob(&[], &[]);
        let signals = recorded(&model, "a");
        let (data, watch) = ([&signals], Watch::new(&|_| true, 1));
        assert!(divided(&Screen::new(&data, &model, &watch), Id::Compliance).is_empty());
    }
}
