//! A shaft that a force drives, with the knob on it or behind the joint of the model.
//!
//! What drives it is a torque, or a grip: a joint like any other, from a motion of its own to the shaft. With a joint
//! of the model behind it the shaft is a body between two.

use crate::chain::stepper::{Acts, Body};
use crate::effects::{BENT, Joint};
use crate::error::{Error, Result};
use crate::model::{Model, Rigid};
use crate::motion::Motion;

/// Fewest steps per sample: what breaks away does so within a few of them.
const STEPS: usize = 32;
/// Longest step, s: loads are those at its start, and a stiff detent must not gain energy by that.
const LONGEST_S: f64 = 3.2e-5;
/// Most steps per sample, whatever their length: a log of a sample a minute must not take hours.
const MOST: usize = 1024;
/// Halvings at most in the search for the speed of a shaft between two joints.
const HALVINGS: usize = 60;

/// Steps from one sample to the next, `dt` seconds later.
pub fn steps(dt: f64) -> usize {
    // A rounding error makes no step more.
    ((dt / LONGEST_S * (1.0 - 1e-9)).ceil() as usize).clamp(STEPS, MOST)
}

/// What drives the shaft in a step.
pub enum Drive<'a> {
    /// A joint whose other end goes from one angle to the next, rad.
    Grip(&'a Joint<f64>, [f64; 2]),
    /// A torque, N m.
    Torque(f64),
}

/// Shaft and knob, and what the effects remember.
pub struct Driven<'a> {
    model: &'a Model,
    p: &'a [f64],
    state: Vec<f64>,
    joint: Option<Joint<f64>>,
    /// What loads the shaft beside the joint: the difference of the two.
    sides: Option<[Rigid; 2]>,
    /// Inertia at the start, kg m^2.
    pub inertia: f64,
    /// That of it which is the same everywhere, of which the joint has a share on either side.
    stored: f64,
    /// What is driven, and measured.
    pub shaft: Body<f64>,
    /// The same as the shaft where they are one.
    knob: Body<f64>,
}

impl<'a> Driven<'a> {
    /// Shaft and knob together, at an angle and a speed.
    ///
    /// # Errors
    /// A model without inertia.
    pub fn new(model: &'a Model, p: &'a [f64], theta: f64, omega: f64) -> Result<Self> {
        let mut state = vec![0.0; model.states()];
        let inertia = model.load(p, &mut state, &Motion::exact(0.0, 0.0, 0.0, 0.0)).inertia;
        if inertia.is_nan() || inertia <= 0.0 {
            return Err(Error::invalid(
                "inertia.M",
                format!(
                    "is {inertia}, and must be positive where torque makes motion; add the effect inertia, or fit \
                     it to a motion that shows it"
                ),
            ));
        }
        if let Some(id) = model.effects().find(|id| id.bends_over_alpha()) {
            return Err(Error::invalid(format!("effect '{}'", id.info().id), BENT));
        }
        let stored = model.inertia().map_or(0.0, |at| p[at]);
        let (start, state) = (Body::at(theta, omega), vec![0.0; model.states()]);
        let (joint, sides) = (model.joint(p), model.rigid_sides(p)?);
        Ok(Self { model, p, state, joint, sides, inertia, stored, shaft: start, knob: start })
    }

    /// Puts the shaft there; a knob behind a joint keeps its place beside it, and the effects what they remember.
    pub fn put(&mut self, theta: f64, omega: f64) {
        let Self { shaft, knob, .. } = *self;
        self.knob = Body::at(knob.theta - shaft.theta + theta, knob.omega - shaft.omega + omega);
        self.shaft = Body::at(theta, omega);
    }

    /// One step of `h` seconds from the time `t`; the torque on the shaft in it, N m.
    pub fn step(&mut self, t: f64, h: f64, drive: &Drive<'_>) -> f64 {
        let motion = Motion::exact(t, self.knob.theta, self.knob.omega, 0.0);
        let mut load = self.model.load(self.p, &mut self.state, &motion);
        self.model.own_load(self.p, &motion, &mut load);
        let share = self.joint.map_or(1.0, |joint| joint.share);
        let knobs = share * self.stored + (load.inertia - self.stored);
        let acts = Acts::of(&load, false, &self.knob, knobs);
        let (shaft, knob, own) = (self.shaft, self.knob, (1.0 - share) * self.stored);
        let Some(joint) = self.joint else {
            let (next, force) = match drive {
                Drive::Grip(grip, ends) => shaft.stepped(grip, &acts, *ends, h),
                Drive::Torque(torque) => (shaft.moved(shaft.slid(&acts, *torque, 0.0, h), h), *torque),
            };
            (self.shaft, self.knob) = (next, next);
            return force;
        };
        // The shaft takes what drives it and the joint does not pass on: the one speed at which that is so, for a grip
        // gives less and the joint takes more the faster it goes.
        let given = |omega: f64| match drive {
            Drive::Grip(grip, [from, to]) => {
                let middle = 0.5 * (shaft.theta + shaft.moved(omega, h).theta);
                let (goal, speed) = (0.5 * (from + to), (to - from) / h);
                grip.stiffness * (goal - middle) + grip.damping * (speed - 0.5 * (shaft.omega + omega))
            }
            Drive::Torque(torque) => *torque,
        };
        let passed = |omega: f64| knob.stepped(&joint, &acts, [shaft.theta, shaft.moved(omega, h).theta], h);
        let beside = beside(self.sides.as_mut(), t, &shaft);
        let left =
            |omega: f64| own * (omega - shaft.omega) / h + passed(omega).1 + beside(omega) - given(omega);
        let omega = crossing(left, shaft.omega, given(shaft.omega).abs() * h / self.inertia + 1e-9);
        (self.shaft, self.knob) = (shaft.moved(omega, h), passed(omega).0);
        given(omega)
    }
}

/// What loads the shaft beside the joint in a step from here, N m, by the speed that it gets.
fn beside(sides: Option<&mut [Rigid; 2]>, t: f64, shaft: &Body<f64>) -> impl Fn(f64) -> f64 + use<> {
    let here = Motion::exact(t, shaft.theta, shaft.omega, 0.0);
    let torques = sides.map(|sides| {
        sides.each_mut().map(|side| {
            let load = side.load(&here);
            let rubs = load.rubs_either_way(here.direction());
            rubs.map(|[unpressed, per_load]| load.drive + unpressed + per_load * load.presses().abs())
        })
    });
    move |omega| {
        let [backward, forward] = Motion::exact(0.0, 0.0, omega, 0.0).directions();
        let torque = |[back, forth]: &[f64; 2]| backward * back + forward * forth;
        torques.as_ref().map_or(0.0, |[with, without]| torque(with) - torque(without))
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
        if high - low <= 1e-15 * (1.0 + low.abs().max(high.abs())) || above == below || below == 0.0 {
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
    use core::cell::Cell;

    #[test]
    fn a_zero_is_found_wherever_it_is_and_soon() {
        // What a joint that opens and friction that turns round make of a shaft: straight pieces, and a step.
        let bent = |x: f64| if x < 0.0 { x } else { 30.0 * x };
        let stepped = |x: f64| x + if x > 0.0 { 4.0 } else { -4.0 };
        for goal in [-1e6, -3.0, -1e-7, 0.0, 1e-7, 3.0, 1e6] {
            for by in [1e-9, 1.0] {
                for guess in [0.0, 2.0 * goal] {
                    let calls = Cell::new(0);
                    let counted = |of: &dyn Fn(f64) -> f64, x: f64| {
                        calls.set(calls.get() + 1);
                        of(x)
                    };
                    for of in [&(|x: f64| x - goal) as &dyn Fn(f64) -> f64, &|x| bent(x - goal), &|x| {
                        stepped(x - goal)
                    }] {
                        let found = crossing(|x| counted(of, x), guess, by);
                        assert!(
                            (found - goal).abs() <= 4e-15 * (1.0 + goal.abs()),
                            "{goal} from {guess}: {found}"
                        );
                    }
                    calls.set(0);
                    crossing(|x| counted(&|x| x - goal, x), guess, by);
                    let doublings = ((goal - guess).abs() / by).log2().max(0.0) as usize;
                    assert!(calls.get() <= 24 + doublings, "{goal} from {guess}: {} calls", calls.get());
                }
            }
        }
    }
}
