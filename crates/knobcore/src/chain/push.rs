//! The chain driven by a force: a hand pushes the shaft through a spring, and the knob sticks and slips.
//!
//! The hand is a joint like any other, from its own motion to the shaft; with a joint of the model behind it the shaft
//! is a body between two. A stuck knob has exactly zero velocity and leaves when what would move it exceeds what holds
//! it.

use super::stepper::{Acts, Body};
use super::{SUBSTEPS, loads, sensors};
use crate::effects::Joint;
use crate::effects::law::Response;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::motion::Motion;

/// Steps per sample: what breaks away does so within a few of them.
const STEPS: usize = 32;
/// Halvings at most in the search for the speed of a shaft between two joints.
const HALVINGS: usize = 60;

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
    let still = Motion::exact(0.0, 0.0, 0.0, 0.0);
    let inertia = model.load(&p, &mut vec![0.0; model.states()], &still).inertia;
    if inertia.is_nan() || inertia <= 0.0 {
        return Err(Error::invalid(
            "inertia.M",
            "must be positive where torque makes motion; add the effect inertia",
        ));
    }
    let h = dt / STEPS as f64;
    if hand.stiffness * h * h > 0.5 * inertia || hand.damping * h > 0.5 * inertia {
        return Err(Error::invalid(
            "hand",
            "is too stiff for this inertia and rate; lower it, or raise the rate",
        ));
    }
    let Hand { stiffness, damping } = hand;
    let grip = Joint { gap: 0.0, stiffness, damping, share: 1.0, welded: true };
    let start = Body::at(reference.first().copied().unwrap_or(0.0), 0.0);
    let (joint, state) = (model.joint(&p), vec![0.0; model.states()]);
    let mut pushed = Pushing { model, p: &p, state, grip, joint, inertia, shaft: start, knob: start, h };
    let mut out = Pushed::default();
    let mut held = Vec::with_capacity(reference.len());
    for (sample, target) in reference.iter().enumerate() {
        let before = reference.get(sample.wrapping_sub(1)).copied().unwrap_or(*target);
        let along = |step: usize| before + (target - before) * step as f64 / STEPS as f64;
        let (mut alpha, mut tau) = (0.0, 0.0);
        for step in 0..STEPS {
            let t = (sample as f64 - 1.0) * dt + step as f64 * h;
            let speed = pushed.shaft.omega;
            tau = pushed.step(t.max(0.0), [along(step), along(step + 1)]);
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
    loads(model, p, &columns, SUBSTEPS, &mut over);
    if !model.is_coupled() {
        let rest = |i: &usize| motion.omega[*i] == 0.0;
        (0..held.len()).filter(rest).for_each(|i| over.torque[i] = held[i]);
    }
    sensors(model, p, &columns, &mut over);
    tau
}

/// A shaft in a hand, with the knob on it or behind a joint.
struct Pushing<'a> {
    model: &'a Model,
    p: &'a [f64],
    state: Vec<f64>,
    grip: Joint<f64>,
    joint: Option<Joint<f64>>,
    inertia: f64,
    shaft: Body<f64>,
    /// The same as the shaft where they are one.
    knob: Body<f64>,
    h: f64,
}

impl Pushing<'_> {
    /// One step while the hand goes from one angle to the next; the torque of the hand in it, N m.
    fn step(&mut self, t: f64, hand: [f64; 2]) -> f64 {
        let motion = Motion::exact(t, self.knob.theta, self.knob.omega, 0.0);
        let mut load = self.model.load(self.p, &mut self.state, &motion);
        self.model.own_load(self.p, &motion, &mut load);
        let share = self.joint.map_or(1.0, |joint| joint.share);
        let acts = Acts::of(&load, false, &self.knob, share * self.inertia);
        let Some(joint) = self.joint else {
            let (next, force) = self.shaft.stepped(&self.grip, &acts, hand, self.h);
            (self.shaft, self.knob) = (next, next);
            return force;
        };
        // The shaft takes what the hand gives and the joint does not pass on: the one speed at which that is so,
        // for the hand gives less and the joint takes more the faster it goes.
        let (shaft, knob, h, own) = (self.shaft, self.knob, self.h, (1.0 - share) * self.inertia);
        let given = |omega: f64| {
            let middle = 0.5 * (shaft.theta + shaft.moved(omega, h).theta);
            let (goal, speed) = (0.5 * (hand[0] + hand[1]), (hand[1] - hand[0]) / h);
            self.grip.stiffness * (goal - middle) + self.grip.damping * (speed - 0.5 * (shaft.omega + omega))
        };
        let passed = |omega: f64| knob.stepped(&joint, &acts, [shaft.theta, shaft.moved(omega, h).theta], h);
        let left = |omega: f64| own * (omega - shaft.omega) / h + passed(omega).1 - given(omega);
        let omega = crossing(left, shaft.omega, given(shaft.omega).abs() * h / self.inertia + 1e-9);
        (self.shaft, self.knob) = (shaft.moved(omega, h), passed(omega).0);
        given(omega)
    }
}

/// Where a rising function crosses zero, near `guess`; `by` is a first step away from it.
fn crossing(rising: impl Fn(f64) -> f64, guess: f64, by: f64) -> f64 {
    let (mut low, mut high, mut step) = (guess, guess, by);
    for _ in 0..HALVINGS {
        if rising(low) <= 0.0 {
            break;
        }
        (low, step) = (low - step, 2.0 * step);
    }
    step = by;
    for _ in 0..HALVINGS {
        if rising(high) >= 0.0 {
            break;
        }
        (high, step) = (high + step, 2.0 * step);
    }
    // Straight in pieces: a secant lands on the zero of its piece, a halving finds the piece.
    let (mut below, mut above) = (rising(low), rising(high));
    for _ in 0..HALVINGS {
        if high - low <= 1e-15 * (1.0 + low.abs().max(high.abs())) || above == below {
            break;
        }
        for middle in [low - below * (high - low) / (above - below), 0.5 * (low + high)] {
            let middle = middle.max(low).min(high);
            let value = rising(middle);
            if value > 0.0 {
                (high, above) = (middle, value);
            } else {
                (low, below) = (middle, value);
            }
        }
    }
    if above.abs() < below.abs() { high } else { low }
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
}
