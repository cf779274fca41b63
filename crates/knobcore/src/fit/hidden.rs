//! Captures along the motion of the knob that a joint hides.

use crate::chain;
use crate::effects::{Id, Joint, Place};
use crate::model::Model;
use crate::predict;
use crate::signals::Signals;
use crate::spans::spans;
use core::ops::Range;

/// Reaches of a filter that a knock lasts at most.
const LONGEST: usize = 4;
/// Squares of the floor, above which the mean within a filter's reach is more than noise and small errors of a law.
const LOUD: f64 = 5.0;

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
        let follow = signals.follow(passage.start);
        let Some([theta, omega, alpha]) = chain::knob(model, &p, motion, 1.0 / signals.rate_hz, follow)
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

/// Stretches in which a knob behind a play knocks, by a model beside which noise leaves `floor`, N m: from a filter's reach before
/// the surfaces meet until as long after they may have parted again, and on as long as the error is loud there. None where
/// they hold on to each other.
///
/// A knock is over within few samples. When it begins, and how it goes on, no law of a contact tells as well as it is
/// measured: one of them is worth more than all that the other samples say of what loads the knob.
pub fn knocks(signals: &Signals, model: &Model, floor: f64) -> Vec<Range<usize>> {
    let values = model.values();
    let p = model.of_run(&signals.run, &values);
    let Some(joint) = model.joint(&p).filter(|joint: &Joint<f64>| !joint.welded) else { return Vec::new() };
    // Half a wave of the fastest that passes.
    let reach = (0.5 * signals.rate_hz / signals.passes_hz()).ceil() as usize;
    let mut knocks = meetings(signals, model, &p, &joint, reach);
    let met = knocks.clone();
    for loud in loud(signals, model, floor, reach) {
        let around = loud.start.saturating_sub(reach)..(loud.end + reach).min(met.len());
        if met[around.clone()].contains(&true) {
            knocks[around].fill(true);
        }
    }
    spans(0..knocks.len(), 0, |at| knocks[at])
}

/// The rows from a filter's reach before the surfaces of a play meet until as long after they may have parted again.
fn meetings(signals: &Signals, model: &Model, p: &[f64], joint: &Joint<f64>, reach: usize) -> Vec<bool> {
    let inertia = model.inertia().map_or(0.0, |at| p[at]) * joint.share;
    let lasts = std::f64::consts::PI * (inertia / joint.stiffness).max(0.0).sqrt() * signals.rate_hz;
    let lasts = (lasts.ceil() as usize).min(LONGEST * reach);
    let mut rows = vec![false; signals.len()];
    for passage in signals.passages() {
        let motion = signals.motion_columns(passage.clone());
        let follow = signals.follow(passage.start);
        let hidden = chain::knob(model, p, motion, 1.0 / signals.rate_hz, follow);
        let Some([theta, ..]) = hidden else { continue };
        let mut touched = true;
        for (i, at) in passage.clone().enumerate() {
            let touches = (signals.theta[at] - theta[i]).abs() >= 0.5 * joint.gap;
            if touches && !touched {
                let end = (at + lasts + reach + 1).min(passage.end);
                rows[at.saturating_sub(reach).max(passage.start)..end].fill(true);
            }
            touched = touches;
        }
    }
    rows
}

/// Where the error, within a filter's reach, is loud.
fn loud(signals: &Signals, model: &Model, floor: f64, reach: usize) -> Vec<Range<usize>> {
    let torque = predict::torque(model, signals);
    let squares =
        |at: usize| if signals.weight[at] > 0.0 { (signals.tau[at] - torque[at]).powi(2) } else { 0.0 };
    let mut sums = vec![0.0; signals.len() + 1];
    (0..signals.len()).for_each(|at| sums[at + 1] = sums[at] + squares(at));
    spans(0..signals.len(), 0, |at| {
        let (from, to) = (at.saturating_sub(reach), (at + reach + 1).min(signals.len()));
        sums[to] - sums[from] > LOUD * floor * floor * (to - from) as f64
    })
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

    #[test]
    fn a_knob_knocks_at_the_end_of_its_play_and_one_on_a_soft_shaft_never() {
        let mut swing = turned(1.0, 0.0, |_, _| 0.0);
        for at in 0..swing.len() {
            let (sin, cos) = (3.0 * swing.t[at]).sin_cos();
            (swing.theta[at], swing.omega[at], swing.alpha[at]) = (sin, 3.0 * cos, -9.0 * sin);
        }
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        for (name, value) in [("inertia.M", 1e-4), ("backlash.gap", 0.02), ("backlash.k", 50.0)] {
            model.set(name, value).unwrap();
        }
        for name in ["coulomb.neg", "coulomb.pos"] {
            model.set(name, 0.01).unwrap();
        }
        let stretches = knocks(&swing, &model, 1.0);
        let rows: Vec<usize> = stretches.iter().cloned().flatten().collect();
        // The shaft turns round, and goes on alone through the play.
        let turns = (1..swing.len()).filter(|at| swing.omega[at - 1] * swing.omega[*at] < 0.0);
        for turn in turns.filter(|turn| turn + 200 < swing.len()) {
            let gone = |at: &usize| (swing.theta[*at] - swing.theta[turn]).abs() > 0.02;
            let end = (turn..swing.len()).find(gone).unwrap();
            assert!(rows.contains(&end) && !rows.contains(&turn), "{turn} {end}");
        }
        assert!(!rows.is_empty() && 4 * rows.len() < swing.len(), "{} of {}", rows.len(), swing.len());
        let fewer = swing.without_knocks(stretches);
        assert_eq!((fewer.used(), fewer.len()), (swing.used() - rows.len(), swing.len()));
        let soft = Model::equation_1(Axis::Rotary, false).with(Id::Compliance).unwrap();
        assert!(
            knocks(&swing, &soft, 1.0).is_empty()
                && knocks(&swing, &model.only(&[Id::Inertia]).unwrap(), 1.0).is_empty()
        );
    }
}
