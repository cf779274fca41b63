//! The one stepper: a body under loads and dry friction, at a joint or alone, from one instant to the next.
//!
//! Contact is stiff and friction dry, so both are implicit: the midpoint rule for the joint, whose free play is that
//! at the midpoint too (so that two motions never part in a step, however stiff the contact: Burrage & Butcher 1979),
//! and friction that stops the body at the end of a step if it can (Moreau 1988).

use crate::effects::Joint;
use crate::motion::Load;
use crate::scalar::{Branches, Lanes, Scalar};

/// A body that turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body<T: Branches> {
    /// Angle, rad.
    pub theta: T,
    /// Angular velocity, rad/s.
    pub omega: T,
    /// Whether it grew faster in the step before: a body that broke away sticks again when its speed falls back into
    /// the stick band, not while it leaves it.
    pub leaving: T::Lanes,
}

/// What acts on a body in a step.
#[derive(Debug, Clone, Copy)]
pub struct Acts<T> {
    /// Its inertia, kg m^2.
    pub inertia: T,
    /// What loads it, against its motion forward, N m.
    pub push: T,
    /// What may oppose its motion, N m.
    pub friction: T,
    /// Friction beside these that grows with what presses, where the torque of the inertia does too.
    pub pressed: Option<Pressed<T>>,
}

/// Friction that grows with a load in which the inertia has a part: the acceleration depends on the friction, and the
/// friction on the acceleration.
#[derive(Debug, Clone, Copy)]
pub struct Pressed<T> {
    /// What presses at a constant speed, N m.
    pub load: T,
    /// Share of the inertia whose torque presses too.
    pub share: T,
    /// Friction per load, backward and forward, with the sign of the motion.
    pub per_load: [T; 2],
}

/// Friction may take so much of what makes a body faster at most: more would stop it however it is pushed, in no time
/// (Painleve 1895).
const JAMS: f64 = 0.99;

impl<T: Branches> Acts<T> {
    /// A load on a body of this inertia: the friction that slides, and within the stick band static
    /// friction (Karnopp 1985) where that holds more. `plain` where no effect shapes the friction of others.
    #[inline(always)]
    pub fn of(load: &Load<T>, plain: bool, body: &Body<T>, inertia: T) -> Self {
        let (half, zero) = (T::Value::of(0.5), T::of(0.0));
        let [back, forth] = load.resist;
        let [mut backward, mut forward] =
            if plain { [[-back, zero], [forth, zero]] } else { [load.rubs(zero), load.rubs(T::of(1.0))] };
        let presses = load.presses();
        let sticks = body.leaving.not().and((load.band - body.omega.abs()).positive());
        if sticks.any() {
            for ([unpressed, per_load], hold, sign) in
                [(&mut backward, load.hold[0], -1.0), (&mut forward, load.hold[1], 1.0)]
            {
                let sign = T::Value::of(sign);
                let more = hold - (*unpressed + *per_load * presses.abs()).scaled(sign);
                let held = sticks.and(more.positive());
                *unpressed = T::choose(held, hold.scaled(sign), *unpressed);
                *per_load = T::choose(held, zero, *per_load);
            }
        }
        let inertial = load.inertia_share.positive().any() || load.mu.abs().positive().any();
        let ([mut back, back_per_load], [mut forth, forth_per_load]) = (backward, forward);
        let mut pressed = None;
        if inertial && !plain {
            let per_load = [back_per_load, forth_per_load];
            pressed = Some(Pressed { load: presses, share: load.carried(), per_load });
        } else if !plain {
            back = back + back_per_load * presses.abs();
            forth = forth + forth_per_load * presses.abs();
        }
        let friction = (forth - back).scaled(half).max(zero);
        Self { inertia, push: load.drive + (forth + back).scaled(half), friction, pressed }
    }

    /// What opposes a motion at this speed that takes so much torque of the inertia, N m.
    #[inline(always)]
    fn opposes(&self, omega: T, inertial: T) -> T {
        let rubs = omega.where_positive(self.friction, -self.friction);
        self.push
            + self.pressed.map_or(rubs, |Pressed { load, share, per_load: [back, forth] }| {
                rubs + omega.where_positive(forth, back) * (load + share * inertial).abs()
            })
    }
}

impl<T: Branches> Pressed<T> {
    /// The speed at the end of a step in the direction `way` (0 backward, 1 forward): where the torques of the step
    /// are in balance, `weight * speed = free - per_load |load + share * mass * (speed - omega)|`. Straight on either
    /// side of where the load turns round, and rising: one of the two is right.
    #[inline(always)]
    fn slid(&self, way: usize, weight: T, mass: T, free: T, omega: T) -> T {
        let (per_load, most) = (self.per_load[way], T::of(JAMS) * weight);
        let carried = self.share * mass;
        let beyond = per_load.abs() * carried - most;
        let carried = beyond.where_positive(most / per_load.abs(), carried);
        let end = |sign: T| {
            let (load, by_speed) = (sign * per_load * self.load, sign * per_load * carried);
            (free - load + by_speed * omega) / (weight + by_speed)
        };
        let one = T::of(1.0);
        let pressed = end(one);
        let turned = -(self.load + carried * (pressed - omega));
        turned.where_positive(end(-one), pressed)
    }
}

impl<T: Branches> Body<T> {
    /// A body at an angle and a speed.
    #[inline]
    pub fn at(theta: T, omega: T) -> Self {
        Self { theta, omega, leaving: T::Lanes::NONE }
    }

    /// Its speed after a step of `h` seconds under what acts on it and under a torque along its motion that is
    /// `fixed - drag * (speed at the end)`, N m and N m s/rad.
    #[inline(always)]
    pub fn slid(&self, acts: &Acts<T>, fixed: T, drag: T, h: f64) -> T {
        let mass = acts.inertia.over(h);
        let weight = mass + drag;
        let free = mass * self.omega + fixed - acts.push;
        if let Some(pressed) = &acts.pressed {
            let end = |way: usize, free: T| pressed.slid(way, weight, mass, free, self.omega);
            let zero = T::of(0.0);
            return end(1, free - acts.friction).max(zero) + end(0, free + acts.friction).min(zero);
        }
        let (free, stop) = (free / weight, acts.friction / weight);
        free - free.min(stop).max(-stop)
    }

    /// Where it is after a step of `h` seconds at whose end it has this speed.
    #[inline(always)]
    pub fn moved(&self, omega: T, h: f64) -> Self {
        let slower = (self.omega.abs() - omega.abs()).positive();
        let leaving = omega.abs().positive().and(slower.not());
        Self { theta: self.theta + (self.omega + omega).scaled(T::Value::of(0.5 * h)), omega, leaving }
    }

    /// A step of `h` seconds behind a joint, and the torque of the joint in it, while the shaft goes from one angle
    /// to the next.
    #[inline(always)]
    pub fn stepped(&self, joint: &Joint<T>, acts: &Acts<T>, shaft: [f64; 2], h: f64) -> (Self, T) {
        let step = Step { body: self, joint, acts, shaft: shaft[0], speed: (shaft[1] - shaft[0]) / h, h };
        // Which way it goes, by the values alone: only that way has to be gone with derivatives.
        let Contact { side, touches, lasts } = step.contact();
        let reached = |omega: T| {
            let inertial = acts.inertia.over(h) * (omega - self.omega);
            inertial + acts.opposes(omega, inertial)
        };
        if !touches.any() {
            return (self.moved(step.alone(), h), T::of(0.0));
        }
        if lasts.all() {
            let omega = step.held(side);
            return (self.moved(omega, h), step.force(side, omega));
        }
        let reaching = step.reaching(side);
        if touches.and(lasts.not()).all() {
            return (self.moved(reaching, h), reached(reaching));
        }
        // Of several knobs each goes its own way.
        let choose = |lasting: T, reaching: T, alone: T| {
            T::choose(lasts, lasting, T::choose(touches, reaching, alone))
        };
        let omega = choose(step.held(side), reaching, step.alone());
        (self.moved(omega, h), choose(step.force(side, omega), reached(omega), T::of(0.0)))
    }
}

/// What a joint does in a step.
#[derive(Debug, Clone, Copy)]
struct Contact<V: Branches> {
    /// The side that may touch, 1 or -1.
    side: V,
    /// Where it does.
    touches: V::Lanes,
    /// Where it does to the end of the step. Else just at its end: the damper would stop the knob short of the contact,
    /// which has to be reached for it to act.
    lasts: V::Lanes,
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

    /// The twist at which a side touches.
    #[inline(always)]
    fn border(&self, side: T::Value) -> T {
        self.joint.gap.scaled(T::Value::of(0.5) * side)
    }

    /// Torque of the joint halfway.
    #[inline(always)]
    fn force(&self, side: T::Value, omega: T) -> T {
        self.joint.stiffness * (self.twist(omega) - self.border(side)) + self.joint.damping * self.rate(omega)
    }

    /// Speed at the end without joint;
    #[inline(always)]
    fn alone(&self) -> T {
        self.body.slid(self.acts, T::of(0.0), T::of(0.0), self.h)
    }

    /// with a side that touches to the end;
    #[inline(always)]
    fn held(&self, side: T::Value) -> T {
        let [quarter, half] = [0.25 * self.h, 0.5].map(T::Value::of);
        let drag = self.joint.stiffness.scaled(quarter) + self.joint.damping.scaled(half);
        self.body.slid(self.acts, self.force(side, T::of(0.0)), drag, self.h)
    }

    /// with one that just touches there.
    #[inline(always)]
    fn reaching(&self, side: T::Value) -> T {
        let rate = self.rate(T::of(0.0));
        let left = T::of(self.shaft) - self.body.theta - self.border(side);
        rate + rate + left.scaled(T::Value::of(4.0 / self.h))
    }
}

impl<V: Branches<Value = V>> Step<'_, V> {
    #[inline(always)]
    fn meets(&self) -> Contact<V> {
        // The side that the knob without joint would be on is the one that touches, if any does.
        let alone = self.alone();
        let side = self.twist(alone).where_positive(V::of(1.0), V::of(-1.0));
        if self.joint.welded {
            let all = V::Lanes::NONE.not();
            return Contact { side, touches: all, lasts: all };
        }
        let touches = self.inside(side, alone).and((side * self.force(side, alone)).positive());
        if !touches.any() {
            return Contact { side, touches, lasts: touches };
        }
        let lasts = touches.and(self.inside(side, self.held(side)));
        Contact { side, touches, lasts }
    }

    /// Where a side touches halfway.
    #[inline(always)]
    fn inside(&self, side: V, omega: V) -> V::Lanes {
        (side * (self.twist(omega) - self.border(side))).positive()
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
            assert!(force * twist >= 0.0, "{force} at {twist}");
            assert!(force == 0.0 || twist.abs() > 0.5 * GAP - 1e-9, "{force} within the gap, at {twist}");
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
    fn friction_under_the_load_of_inertia_is_what_the_acceleration_makes_that_it_leaves() {
        let (mut noise, mut rested) = (Noise::new(2), 0);
        for _ in 0..20_000 {
            let (mu, share) = (0.95 * noise.uniform(), noise.uniform());
            let pressed = Pressed { load: 0.05 * noise.normal(), share, per_load: [-mu, mu] };
            let (push, friction) = (0.05 * noise.normal(), 0.05 * noise.uniform());
            let acts = Acts { inertia: INERTIA, push, friction, pressed: Some(pressed) };
            let (fixed, drag) = (0.1 * noise.normal(), 0.1 * noise.uniform());
            let start = Body::at(0.0, 0.02 * noise.normal());
            let omega = start.slid(&acts, fixed, drag, STEP_S);
            let inertial = INERTIA / STEP_S * (omega - start.omega);
            let (left, rubs) =
                (fixed - drag * omega - push - inertial, mu * (pressed.load + share * inertial).abs());
            if omega == 0.0 {
                rested += 1;
                assert!(left.abs() <= friction + rubs, "{left} beyond {friction} and {rubs}");
            } else {
                assert!((left - omega.signum() * (friction + rubs)).abs() < 1e-12, "{left} at {omega}");
            }
        }
        assert!(rested > 100, "{rested}");
    }

    #[test]
    fn friction_that_could_jam_slows_the_knob_and_does_not_turn_it_round() {
        let pressed = Pressed { load: 0.01, share: 1.0, per_load: [-5.0, 5.0] };
        let acts = Acts { inertia: INERTIA, push: 0.0, friction: 0.0, pressed: Some(pressed) };
        for omega in [-1.0, -1e-6, 1e-6, 1.0] {
            let end = Body::at(0.0, omega).slid(&acts, 0.0, 0.0, STEP_S) / omega;
            assert!((0.0..1.0).contains(&end), "{end}");
        }
    }

    #[test]
    fn friction_stops_the_knob_and_does_not_turn_it_round() {
        let acts = Acts { inertia: INERTIA, push: 0.0, friction: 0.05, pressed: None };
        let start = Body::at(0.0, 0.01);
        let (knob, _) = start.stepped(&joint(1.0, 0.0), &acts, [0.0, 0.0], STEP_S);
        assert_eq!(knob.omega, 0.0);
    }
}
