//! The one stepper, behind a joint.
//!
//! Contact is stiff, and so implicit: the midpoint rule, whose free play is that at the midpoint too, so that two motions
//! never part in a step, however stiff the contact (Burrage & Butcher 1979). Where contact begins within a step, it acts
//! for the rest of it: so the motion is as smooth in every parameter as a joint lets it be, and slopes are those of it.

use super::stepper::{Acts, Body, Pressed};
use crate::effects::Joint;
use crate::scalar::{Branches, Lanes, Scalar};

impl<T: Branches> Body<T> {
    /// A step of `h` seconds behind a joint, and the torque of the joint in it, while the shaft goes from one angle
    /// to the next.
    #[inline(always)]
    pub fn stepped(&self, joint: &Joint<T>, acts: &Acts<T>, shaft: [f64; 2], h: f64) -> (Self, T) {
        let step = Step { body: self, joint, acts, shaft: shaft[0], speed: (shaft[1] - shaft[0]) / h, h };
        // Which way it goes, by the values alone: only that way has to be gone with derivatives.
        let Contact { side, touches, lasts, enters } = step.contact();
        let reached = |omega: T| {
            let inertial = acts.inertia.over(h) * (omega - self.omega);
            inertial + acts.opposes(omega, inertial)
        };
        if !touches.any() {
            return (self.moved(step.alone(), h), T::of(0.0));
        }
        let touch = step.touch(side, enters);
        if lasts.all() {
            let omega = step.held(&touch);
            return (self.moved(omega, h), step.force(&touch, omega));
        }
        let reaching = step.reaching(&touch);
        if touches.and(lasts.not()).all() {
            return (self.moved(reaching, h), reached(reaching));
        }
        // Of several knobs each goes its own way.
        let choose = |lasting: T, reaching: T, alone: T| {
            T::choose(lasts, lasting, T::choose(touches, reaching, alone))
        };
        let omega = choose(step.held(&touch), reaching, step.alone());
        (self.moved(omega, h), choose(step.force(&touch, omega), reached(omega), T::of(0.0)))
    }
}

/// What a joint does in a step.
#[derive(Debug, Clone, Copy)]
struct Contact<V: Branches> {
    /// The side that may touch, 1 or -1.
    side: V,
    /// Where it does.
    touches: V::Lanes,
    /// Where it does to the end of the step. Else it just does: the damper would stop the knob short of the contact, which
    /// has to be reached for it to act.
    lasts: V::Lanes,
    /// Where it did not at the start.
    enters: V::Lanes,
}

/// A side that touches, from the start of the step or from within it on.
#[derive(Debug, Clone, Copy)]
struct Touch<T> {
    /// How far beyond the twist at which it touches that of the joint is at the start. Half of it where it touches from
    /// within the step on: in the mean of that part it is half as far as at the end.
    before: T,
    /// The share of the step in which it touches, where that may not be all of it. If it did for a whole step or for none, the damper, whose torque is there
    /// at once, would let the motion leap where a parameter moves the contact from one step into the next.
    share: Option<T>,
}

/// A step behind a joint. Its parts are functions, and not closures, for these would be left out of what is compiled for
/// the machine's instruction set.
#[derive(Debug, Clone, Copy)]
struct Step<'a, T: Branches> {
    body: &'a Body<T>,
    joint: &'a Joint<T>,
    acts: &'a Acts<T>,
    /// Angle of the shaft at the start, and its speed.
    shaft: f64,
    speed: f64,
    h: f64,
}

impl<T: Branches> Step<'_, T> {
    /// What the joint does, by the values without derivatives.
    #[inline(always)]
    fn contact(&self) -> Contact<T::Value> {
        let Self { body, joint, acts, shaft, speed, h } = *self;
        let body = Body { theta: body.theta.plain(), omega: body.omega.plain(), leaving: body.leaving };
        let joint = joint.plain();
        let pressed = acts.pressed.map(|Pressed { load, share, per_load: [back, forth] }| Pressed {
            load: load.plain(),
            share: share.plain(),
            per_load: [back.plain(), forth.plain()],
        });
        let acts = Acts {
            inertia: acts.inertia.plain(),
            push: acts.push.plain(),
            friction: acts.friction.plain(),
            pressed,
        };
        Step { body: &body, joint: &joint, acts: &acts, shaft, speed, h }.meets()
    }

    /// Rate of the joint halfway, by the speed of the knob at the end of the step.
    #[inline(always)]
    fn rate(&self, omega: T) -> T {
        T::of(self.speed) - (self.body.omega + omega).scaled(T::Value::of(0.5))
    }

    /// Twist of the joint there.
    #[inline(always)]
    fn twist(&self, omega: T) -> T {
        T::of(self.shaft) - self.body.theta + self.rate(omega).scaled(T::Value::of(0.5 * self.h))
    }

    /// How a side touches that does so in the step, of which `enters` are those where it did not at the start.
    #[inline(always)]
    fn touch(&self, side: T::Value, enters: T::Lanes) -> Touch<T> {
        let [half, one] = [0.5, 1.0].map(T::Value::of);
        let before = T::of(self.shaft) - self.body.theta - self.joint.gap.scaled(half * side);
        if !enters.any() {
            return Touch { before, share: None };
        }
        let until = before / self.rate(self.alone()).scaled(T::Value::of(self.h));
        let share = T::choose(enters, T::of(1.0) + until, T::of(1.0));
        Touch { before: before.scaled(T::Value::choose(enters, half, one)), share: Some(share) }
    }

    /// How far beyond the twist at which it touches that of the joint is, in the mean of what it touches.
    #[inline(always)]
    fn beyond(&self, touch: &Touch<T>, omega: T) -> T {
        touch.before + self.rate(omega).scaled(T::Value::of(0.5 * self.h))
    }

    /// Torque of the joint, in the mean of the step.
    #[inline(always)]
    fn force(&self, touch: &Touch<T>, omega: T) -> T {
        let whole = self.joint.stiffness * self.beyond(touch, omega) + self.joint.damping * self.rate(omega);
        touch.share.map_or(whole, |share| share * whole)
    }

    /// Speed at the end without joint;
    #[inline(always)]
    fn alone(&self) -> T {
        self.body.slid(self.acts, T::of(0.0), T::of(0.0), self.h)
    }

    /// with a side that touches to the end;
    #[inline(always)]
    fn held(&self, touch: &Touch<T>) -> T {
        let [quarter, half] = [0.25 * self.h, 0.5].map(T::Value::of);
        let whole = self.joint.stiffness.scaled(quarter) + self.joint.damping.scaled(half);
        let drag = touch.share.map_or(whole, |share| share * whole);
        self.body.slid(self.acts, self.force(touch, T::of(0.0)), drag, self.h)
    }

    /// with one that just touches there.
    #[inline(always)]
    fn reaching(&self, touch: &Touch<T>) -> T {
        let rate = self.rate(T::of(0.0));
        rate + rate + touch.before.scaled(T::Value::of(4.0 / self.h))
    }
}

impl<V: Branches<Value = V>> Step<'_, V> {
    #[inline(always)]
    fn meets(&self) -> Contact<V> {
        // The side that the knob without joint would be on is the one that touches, if any does.
        let alone = self.alone();
        let side = self.twist(alone).where_positive(V::of(1.0), V::of(-1.0));
        let none = V::Lanes::NONE;
        if self.joint.welded {
            return Contact { side, touches: none.not(), lasts: none.not(), enters: none };
        }
        let enters = (side * -self.touch(side, none).before).positive();
        let touch = self.touch(side, enters);
        let presses = (side * self.force(&touch, alone)).positive();
        let touches = self.inside(side, &touch, alone).and(presses);
        if !touches.any() {
            return Contact { side, touches, lasts: touches, enters };
        }
        let lasts = touches.and(self.inside(side, &touch, self.held(&touch)));
        Contact { side, touches, lasts, enters }
    }

    /// Where a side touches halfway, or at the end where it did not at the start.
    #[inline(always)]
    fn inside(&self, side: V, touch: &Touch<V>, omega: V) -> V::Lanes {
        (side * self.beyond(touch, omega)).positive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    const GAP: f64 = 0.02;
    const INERTIA: f64 = 1e-4;
    const STEP_S: f64 = 5e-5;

    fn joint(stiffness: f64, damping: f64) -> Joint<f64> {
        Joint { gap: GAP, stiffness, damping, share: 1.0, welded: false }
    }

    #[test]
    fn surfaces_that_touch_push_and_never_pull() {
        let mut noise = Noise::new(1);
        for _ in 0..20_000 {
            let knob = Body::at(GAP * noise.normal(), noise.normal());
            let joint = joint((10.0 * noise.uniform()).exp(), (-8.0 * noise.uniform()).exp());
            let shaft = [0.0, STEP_S * noise.normal()];
            let acts = Acts {
                inertia: INERTIA,
                push: 0.05 * noise.normal(),
                friction: 0.05 * noise.uniform(),
                pressed: None,
            };
            let (next, force) = knob.stepped(&joint, &acts, shaft, STEP_S);
            let twist = 0.5 * (shaft[0] + shaft[1] - knob.theta - next.theta);
            let farthest = twist.abs().max((shaft[1] - next.theta).abs());
            assert!(force * twist >= 0.0, "{force} at {twist}");
            assert!(force == 0.0 || farthest > 0.5 * GAP - 1e-9, "{force} within the gap, at {farthest}");
        }
    }

    #[test]
    fn a_knob_that_bounces_in_its_gap_loses_its_energy_and_never_gains_a_hundredth() {
        for stiffness in [1.0, 100.0, 1e4] {
            let joint = joint(stiffness, 0.1 * (stiffness * INERTIA).sqrt());
            let mut knob = Body::at(0.0, 1.0);
            let energy = |knob: &Body<f64>| {
                let strain = (knob.theta.abs() - 0.5 * GAP).max(0.0);
                0.5 * INERTIA * knob.omega * knob.omega + 0.5 * stiffness * strain * strain
            };
            let start = energy(&knob);
            for _ in 0..40_000 {
                knob = knob
                    .stepped(
                        &joint,
                        &Acts { inertia: INERTIA, push: 0.0, friction: 0.0, pressed: None },
                        [0.0, 0.0],
                        STEP_S,
                    )
                    .0;
                assert!(energy(&knob) < 1.01 * start, "{stiffness}: {}", energy(&knob) / start);
            }
            assert!(energy(&knob) < 0.1 * start, "{stiffness}: {}", energy(&knob) / start);
        }
    }

    #[test]
    fn a_knock_is_as_smooth_in_the_instant_at_which_it_begins_as_in_any_other_thing() {
        let (joint, acts) =
            (joint(100.0, 0.05), Acts { inertia: INERTIA, push: 0.0, friction: 0.0, pressed: None });
        // The shaft goes on at a speed of 1 and meets a knob at rest, so much of a step later.
        let leaves = |late: f64| {
            let mut knob = Body::at(-0.5 * GAP + late * STEP_S, 0.0);
            for step in 0..400 {
                let shaft = [step, step + 1].map(|at| f64::from(at) * STEP_S);
                knob = knob.stepped(&joint, &acts, shaft, STEP_S).0;
            }
            knob.omega
        };
        let after: Vec<f64> = (0..200).map(|late| leaves(3.0 + 0.01 * f64::from(late))).collect();
        let most = after.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(after[0] > 1.1 && most < 1e-4, "{} {most}", after[0]);
    }

    #[test]
    fn friction_stops_the_knob_and_does_not_turn_it_round() {
        let acts = Acts { inertia: INERTIA, push: 0.0, friction: 0.05, pressed: None };
        let start = Body::at(0.0, 0.01);
        let (knob, _) = start.stepped(&joint(1.0, 0.0), &acts, [0.0, 0.0], STEP_S);
        assert_eq!(knob.omega, 0.0);
    }
}
