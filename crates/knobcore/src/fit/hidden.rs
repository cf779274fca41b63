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
    let p = model.of_run(&signals.run, &values);
    for passage in signals.passages() {
        let motion = signals.motion_columns(passage.clone());
        let Some([theta, omega, alpha]) =
            chain::knob(model, &p, motion, 1.0 / signals.rate_hz, signals.substeps)
        else {
            continue;
        };
        let forward = omega.iter().map(|omega| if *omega == 0.0 { 0.5 } else { f64::from(*omega > 0.0) });
        hidden.forward.splice(passage.clone(), forward);
        hidden.theta[passage.clone()].copy_from_slice(&theta);
        hidden.omega[passage.clone()].copy_from_slice(&omega);
        hidden.alpha[passage.clone()].copy_from_slice(&alpha);
    }
    let (joined, rigid) = (predict::torque(model, signals), predict::torque(loads, &hidden));
    for segment in &signals.segments {
        for at in segment.clone() {
            hidden.tau[at] += rigid[at] - joined[at];
        }
    }
    hidden
}

#[cfg(test)]
mod tests {
    use super::super::tests::turned;
    use super::*;
    use crate::model::Run;
    use crate::param::Axis;

    #[test]
    fn runs_with_a_zero_of_their_own_move_behind_a_joint_as_one_does() {
        let runs = ["a", "b"].map(|name| Run { name: name.into(), fingerprint: format!("0{name}") });
        let mut one = turned(1.0, 0.0, |_, _| 0.0);
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Compliance).unwrap();
        model.set("inertia.M", 1e-4).unwrap();
        model.set("compliance.k", 5.0).unwrap();
        let alone = behind(&[&one], &model);
        let mut apart = model.apart(Id::Offset, &runs.each_ref()[..]).unwrap();
        apart.set("offset.tau0@b", 1e-3).unwrap();
        one.run = runs[1].clone();
        let beside = behind(&[&one], &apart);
        assert!((0..one.len()).any(|at| alone[0].omega[at] != one.omega[at]));
        assert_eq!(alone[0].omega, beside[0].omega);
    }
}
