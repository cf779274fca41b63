//! The one stepper: a body under loads and dry friction from one instant to the next. Friction is dry, and so implicit: it
//! stops the body at the end of a step if it can (Moreau 1988).

use crate::motion::{Load, Motion};
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
            if plain { [[-back, zero], [forth, zero]] } else { load.rubs_either_way(body.direction()) };
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
    pub(super) fn opposes(&self, omega: T, inertial: T) -> T {
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
    /// Itself without derivatives that died away.
    #[inline(always)]
    pub fn settled(self) -> Self {
        Self { theta: self.theta.settled(), omega: self.omega.settled(), ..self }
    }

    /// A body at an angle and a speed.
    #[inline]
    pub fn at(theta: T, omega: T) -> Self {
        Self { theta, omega, leaving: T::Lanes::NONE }
    }

    /// The sign of its velocity, 0 at rest: the way that its loads were looked at.
    #[inline(always)]
    fn direction(&self) -> T {
        let zero = T::of(0.0);
        Motion::exact(zero, zero, self.omega, zero).direction()
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    const INERTIA: f64 = 1e-4;
    const STEP_S: f64 = 5e-5;

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
}
