//! The chain driven by a force: a hand pushes the shaft through a spring, and the knob sticks and slips.
//!
//! A stuck knob has exactly zero velocity and leaves when what would move it exceeds what holds it.

mod driven;

pub use driven::{Drive, Driven, steps};

use super::{Follow, SUBSTEPS, loads, sensors};
use crate::effects::Joint;
use crate::effects::law::Response;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::motion::Motion;

/// A hand: it follows its own motion and is tied to the shaft by a spring and a damper.
#[derive(Debug, Clone, Copy)]
pub struct Hand {
    /// N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    pub damping: f64,
}

/// What the rig would record; SI, one value a sample.
#[derive(Debug, Clone, Default)]
pub struct Pushed {
    /// Angle of the shaft, rad.
    pub theta: Vec<f64>,
    /// Its angular velocity, rad/s.
    pub omega: Vec<f64>,
    /// Its angular acceleration over the last step, rad/s^2.
    pub alpha: Vec<f64>,
    /// Torque on the shaft, as the sensor reads it, N m.
    pub tau: Vec<f64>,
}

/// Lets a hand that moves along `reference` (rad, one value a sample of `dt` seconds) push the knob.
///
/// The torque is that of the chain along the motion that comes out, so that a prediction on it is the same; while a
/// knob on a rigid shaft stands still, it is that of the hand, which nothing else tells.
///
/// # Errors
/// A model without inertia, or a hand that is too stiff for the sampling rate.
pub fn push(model: &Model, reference: &[f64], dt: f64, hand: Hand) -> Result<Pushed> {
    let p = model.values();
    let mut pushed = Driven::new(model, &p, reference.first().copied().unwrap_or(0.0), 0.0)?;
    let steps = steps(dt);
    let h = dt / steps as f64;
    if hand.stiffness * h * h > 0.5 * pushed.inertia || hand.damping * h > 0.5 * pushed.inertia {
        return Err(Error::invalid(
            "hand",
            "is too stiff for this inertia and rate; lower it, or raise the rate",
        ));
    }
    let Hand { stiffness, damping } = hand;
    let grip = Joint { gap: 0.0, stiffness, damping, share: 1.0, welded: true };
    let mut out = Pushed::default();
    let mut held = Vec::with_capacity(reference.len());
    for (sample, target) in reference.iter().enumerate() {
        let before = reference.get(sample.wrapping_sub(1)).copied().unwrap_or(*target);
        let along = |step: usize| before + (target - before) * step as f64 / steps as f64;
        let (mut alpha, mut tau) = (0.0, 0.0);
        for step in 0..steps {
            let t = (sample as f64 - 1.0) * dt + step as f64 * h;
            let speed = pushed.shaft.omega;
            tau = pushed.step(t.max(0.0), h, &Drive::Grip(&grip, [along(step), along(step + 1)]));
            alpha = (pushed.shaft.omega - speed) / h;
        }
        out.theta.push(pushed.shaft.theta);
        out.omega.push(pushed.shaft.omega);
        out.alpha.push(alpha);
        held.push(tau);
    }
    out.tau = recorded(model, &p, &out, dt, &held);
    Ok(out)
}

/// What the sensor reads along the motion; `held` is the torque of the hand.
fn recorded(model: &Model, p: &[f64], motion: &Pushed, dt: f64, held: &[f64]) -> Vec<f64> {
    let t: Vec<f64> = (0..held.len()).map(|i| i as f64 * dt).collect();
    let forward: Vec<f64> =
        motion.omega.iter().map(|omega| Motion::exact(0.0, 0.0, *omega, 0.0).forward).collect();
    let mut tau = vec![0.0; held.len()];
    let columns = vec![None; p.len()];
    let motion_columns = [&t, &motion.theta, &motion.omega, &motion.alpha, &forward].map(Vec::as_slice);
    let mut over = Response { motion: motion_columns, dt, torque: &mut tau, slopes: &mut [] };
    loads(model, p, &columns, Follow::of(SUBSTEPS), &mut over);
    if !model.is_coupled() {
        let rest = |i: &usize| motion.omega[*i] == 0.0;
        (0..held.len()).filter(rest).for_each(|i| over.torque[i] = held[i]);
    }
    sensors(model, p, &columns, &mut over);
    tau
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    fn knob() -> Model {
        let mut model = Model::new(&[Id::Inertia, Id::Coulomb, Id::Viscous, Id::Karnopp], Axis::Rotary);
        for (name, value) in [
            ("inertia.M", 7e-5),
            ("coulomb.neg", 0.02),
            ("coulomb.pos", 0.02),
            ("viscous.neg", 1e-3),
            ("viscous.pos", 1e-3),
            ("karnopp.D_neg", 0.05),
            ("karnopp.D_pos", 0.04),
            ("karnopp.dv", 0.01),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    const HAND: Hand = Hand { stiffness: 0.5, damping: 0.005 };

    #[test]
    fn a_knob_pushed_below_breakaway_never_moves() {
        let reference: Vec<f64> = (0..20_000).map(|i| 0.07 * (f64::from(i) * 1e-3).sin()).collect();
        let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
        assert!(pushed.theta.iter().all(|theta| *theta == 0.0));
        let most = pushed.tau.iter().fold(0.0_f64, |m, tau| m.max(tau.abs()));
        assert!(most > 0.03 && most < 0.04, "the hand did push: {most}");
    }

    #[test]
    fn the_knob_breaks_away_at_the_static_friction_of_each_direction() {
        for (sign, breakaway) in [(1.0, 0.04), (-1.0, 0.05)] {
            let reference: Vec<f64> = (0..5000).map(|i| sign * f64::from(i) * 5e-5).collect();
            let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
            let moves = pushed.omega.iter().position(|omega| *omega != 0.0).unwrap();
            assert!(
                (pushed.tau[moves - 1].abs() - breakaway).abs() < 0.02 * breakaway,
                "{}",
                pushed.tau[moves - 1]
            );
        }
    }

    #[test]
    fn a_knob_that_is_let_go_comes_to_rest_and_stays() {
        let reference: Vec<f64> =
            (0..10_000).map(|i| if i < 2000 { f64::from(i) * 5e-4 } else { 1.0 }).collect();
        let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
        assert!(pushed.omega[6000..].iter().all(|omega| *omega == 0.0));
        assert!(pushed.theta[9999] > 0.5);
    }

    #[test]
    fn the_sensor_reads_what_the_hand_gives_also_while_friction_wears_off() {
        let dt = 2e-4;
        let mut knob = knob().with(Id::FrictionDrift).unwrap();
        for (name, value) in [("friction_drift.rise", 2.0), ("friction_drift.tau", 0.3)] {
            knob.set(name, value).unwrap();
        }
        let speed = 2.0;
        let reference: Vec<f64> = (0..5000).map(|i| f64::from(i) * speed * dt).collect();
        let pushed = push(&knob, &reference, dt, HAND).unwrap();
        let hand = |i: usize| {
            HAND.stiffness * (reference[i] - pushed.theta[i]) + HAND.damping * (speed - pushed.omega[i])
        };
        let slides = |i: &usize| pushed.omega[*i] > 0.1;
        let moving: Vec<usize> = (0..5000).filter(slides).collect();
        assert!(moving.len() > 3000 && moving[0] < 1500);
        for i in moving {
            assert!((pushed.tau[i] - hand(i)).abs() < 2e-3, "{i}: {} {}", pushed.tau[i], hand(i));
        }
        assert!(pushed.tau[1500] > 1.5 * pushed.tau[4999], "it wears off");
    }

    #[test]
    fn a_hand_is_refused_just_where_a_step_could_not_follow_it() {
        let (dt, inertia) = (2e-4, 7e-5);
        let h = dt / steps(dt) as f64;
        let refused =
            |stiffness: f64, damping: f64| push(&knob(), &[0.0; 3], dt, Hand { stiffness, damping }).is_err();
        let (stiff, damped) = (0.5 * inertia / (h * h), 0.5 * inertia / h);
        assert!(!refused(0.999 * stiff, 0.0) && refused(1.001 * stiff, 0.0));
        assert!(!refused(0.5, 0.999 * damped) && refused(0.5, 1.001 * damped));
    }

    #[test]
    fn a_hand_moves_the_knob_as_it_does_however_often_that_is_written_down() {
        let mut knob = knob().with(Id::FrictionDrift).unwrap();
        for (name, value) in [("friction_drift.rise", 5.0), ("friction_drift.tau", 0.01)] {
            knob.set(name, value).unwrap();
        }
        let (often, seldom) = (1.024e-3, 2.048e-3);
        let ratio = steps(seldom) / steps(often);
        assert_eq!(ratio, 2, "steps are as long in both");
        let pushed = |dt: f64| {
            let reference: Vec<f64> = (0..60).map(|i| 10.0 * f64::from(i) * dt).collect();
            push(&knob, &reference, dt, HAND).unwrap()
        };
        let (often, seldom) = (pushed(often), pushed(seldom));
        for i in 0..30 {
            let [a, b] = [often.theta[2 * i], seldom.theta[i]];
            assert!((a - b).abs() < 1e-12, "{i}: {a} {b}");
        }
        assert!(often.theta[59] > 0.01, "it moves while its friction wears off");
    }
}
