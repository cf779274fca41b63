//! Captures along the motion of the knob that a joint hides.

use crate::chain;
use crate::effects::{Id, Place};
use crate::model::Model;
use crate::predict;
use crate::signals::Signals;

/// A model without its coupling.
pub fn loads(model: &Model) -> Model {
    let loads: Vec<Id> = model.effects().filter(|id| id.info().place != Place::Coupling).collect();
    model.only(&loads).unwrap_or_else(|_| model.clone())
}

/// Captures with the hidden knob's motion in place of the shaft's; none where they are one.
pub fn behind(data: &[&Signals], model: &Model) -> Vec<Signals> {
    if !model.is_coupled() {
        return Vec::new();
    }
    let loads = loads(model);
    data.iter().map(|signals| moved(signals, model, &loads)).collect()
}

/// A capture with the motion of the hidden knob of a model, whose forward is that of its speed alone; its torque is what
/// leaves the same error beside the same loads on a rigid shaft that moves so.
fn moved(signals: &Signals, model: &Model, loads: &Model) -> Signals {
    let mut hidden = signals.clone();
    let values = model.values();
    let (p, _) = model.in_run(&signals.run, &values, &[]);
    for segment in &signals.segments {
        let motion = signals.motion_columns(segment.clone());
        let Some([theta, omega, alpha]) =
            chain::knob(model, &p, motion, 1.0 / signals.rate_hz, signals.substeps)
        else {
            continue;
        };
        let forward = omega.iter().map(|omega| if *omega == 0.0 { 0.5 } else { f64::from(*omega > 0.0) });
        hidden.forward.splice(segment.clone(), forward);
        hidden.theta[segment.clone()].copy_from_slice(&theta);
        hidden.omega[segment.clone()].copy_from_slice(&omega);
        hidden.alpha[segment.clone()].copy_from_slice(&alpha);
    }
    let (joined, rigid) = (predict::torque(model, signals), predict::torque(loads, &hidden));
    for segment in &signals.segments {
        for at in segment.clone() {
            hidden.tau[at] += rigid[at] - joined[at];
        }
    }
    hidden
}
