//! Joints that a view of captures cannot see: stiffer than anything that its samples show.
//!
//! Where contact rings faster than a view has samples, its stiffness changes nothing there, and a descent takes it wherever
//! chance leads; in the next view, which would tell, there is no slope that leads back. Nor where it is damped so that its
//! surfaces stick together for as long: those that bounce are of another valley.

use super::ends::{Ends, on};
use super::slower::KEPT;
use crate::effects::Place;
use crate::fit::Found;
use crate::model::Model;
use crate::prepare::slower;
use crate::signals::Signals;
use core::f64::consts::TAU;

/// A model whose joint the view through the first of these edges could not see, with one that rings at the edge of the
/// next view and is damped to a half, as the softer starts of a search are; none where it could.
pub fn seen_next(data: &[&Signals], model: &Model, [edge_hz, next_hz]: [f64; 2]) -> Option<Model> {
    let rate_hz = data.iter().map(|one| one.rate_hz).fold(0.0, f64::max);
    let p = model.values();
    let joint = model.joint(&p)?;
    let carried = joint.share * model.inertia().map(|at| p[at])?;
    let rings_at = |hz: f64| TAU * hz * slower(rate_hz);
    // Four samples of the view in a period.
    let fastest = rings_at(edge_hz * KEPT / 4.0);
    if joint.stiffness.hypot(joint.damping * fastest) <= carried * fastest.powi(2) {
        return None;
    }
    let id = model.effects().find(|id| id.info().place == Place::Coupling)?;
    let mut seen = model.clone();
    for (name, value) in [("k", carried * rings_at(next_hz).powi(2)), ("d", carried * rings_at(next_hz))] {
        let param = id.info().params.iter().find(|param| param.name == name)?;
        seen.set(&format!("{}.{name}", id.info().id), value.clamp(param.lower, param.upper)).ok()?;
    }
    Some(seen)
}

/// The same ends with a shaft that gives way where a slower filter does not see it and the next does.
pub fn softer(data: &[&Signals], ends: &Ends, edges: [f64; 2]) -> Vec<(usize, Model)> {
    let seen = |(of, (model, _)): &(usize, (Model, Found))| Some((*of, seen_next(data, model, edges)?));
    ends.iter().filter_map(seen).collect()
}

/// Where a descent leads in a view, or one from a joint that this view sees and the one before it did not, if that ends
/// lower.
pub fn lower(
    view: &[&Signals],
    model: &Model,
    edges: [f64; 2],
    to: impl Fn(&[&Signals], &Model) -> Found,
) -> (Model, Found) {
    let to = |model: &Model| on(model, |model| to(view, model));
    let end = to(model);
    let seen = seen_next(view, model, edges).map(|seen| to(&seen));
    seen.filter(|(_, seen)| seen.cost < end.1.cost).unwrap_or(end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    #[test]
    fn a_joint_that_is_stiffer_than_a_view_shows_begins_softer_in_the_next_and_any_other_goes_on() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        for (name, value) in
            [("inertia.M", 1e-4), ("backlash.gap", 0.01), ("backlash.share", 0.5), ("backlash.d", 0.05)]
        {
            model.set(name, value).unwrap();
        }
        let signals = Signals { rate_hz: 5000.0, ..Signals::default() };
        let next = |model: &Model| seen_next(&[&signals], model, [60.0, 150.0]);
        let value = |model: &Model, name: &str| model.slots()[model.index(name).unwrap()].value;
        // Four samples a period are 9 times the edge: 540 Hz, and 576 N m/rad or 0.17 N m s/rad.
        for (k, d, softer) in [
            (500.0, 0.05, false),
            (600.0, 0.05, true),
            (9e4, 0.05, true),
            (4.0, 0.16, false),
            (4.0, 0.18, true),
        ] {
            model.set("backlash.k", k).unwrap();
            model.set("backlash.d", d).unwrap();
            let next = next(&model);
            assert_eq!(next.is_some(), softer, "{k} {d}");
            if let Some(next) = next {
                let [k, d, gap] = ["k", "d", "gap"].map(|name| value(&next, &format!("backlash.{name}")));
                assert!((k / 44.4 - 1.0).abs() < 1e-3 && (d / 0.0471 - 1.0).abs() < 1e-3 && gap == 0.01);
            }
        }
        assert!(next(&Model::equation_1(Axis::Rotary, false)).is_none());
    }
}
