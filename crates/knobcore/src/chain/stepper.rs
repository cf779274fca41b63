//! The one stepper: a body under loads and dry friction, at a joint or alone, from one instant to the next.
//!
//! Contact is stiff and friction dry, so both are implicit: the midpoint rule for the joint, whose free play is that
//! at the midpoint too (so that two motions never part in a step, however stiff the contact: Burrage & Butcher 1979),
//! and friction that stops the body at the end of a step if it can (Moreau 1988).

use crate::effects::Joint;
use crate::motion::Load;
use crate::scalar::Scalar;

/// A body that turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body<T> {
    /// Angle, rad.
    pub theta: T,
    /// Angular velocity, rad/s.
    pub omega: T,
    /// Whether it grew faster in the step before: a body that broke away sticks again when its speed falls back into
    /// the stick band, not while it leaves it.
    pub leaving: bool,
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
}

impl<T: Scalar> Acts<T> {
    /// A load on a body of this inertia: the friction that slides, and within the stick band static
    /// friction (Karnopp 1985) where that holds more. `plain` where no effect shapes the friction of others.
    #[inline(always)]
    pub fn of(load: &Load<T>, plain: bool, body: &Body<T>, inertia: T) -> Self {
        let (half, zero, one) = (T::of(0.5), T::of(0.0), T::of(1.0));
        let (mut forth, mut back) =
            if plain { (load.resist[1], -load.resist[0]) } else { (load.friction(one), load.friction(zero)) };
        if !body.leaving && (load.band - body.omega.abs()).is_positive() {
            (forth, back) = (forth.max(load.hold[1]), back.min(-load.hold[0]));
        }
        let push = load.drive + half * (forth + back);
        Self { inertia, push, friction: (half * (forth - back)).max(zero) }
    }
}

impl<T: Scalar> Body<T> {
    /// A body at an angle and a speed.
    #[inline]
    pub fn at(theta: T, omega: T) -> Self {
        Self { theta, omega, leaving: false }
    }

    /// Its speed after a step of `h` seconds under what acts on it and under a torque along its motion that is
    /// `fixed - drag * (speed at the end)`, N m and N m s/rad.
    #[inline(always)]
    pub fn slid(&self, acts: &Acts<T>, fixed: T, drag: T, h: f64) -> T {
        let mass = acts.inertia / T::of(h);
        let weight = mass + drag;
        let free = (mass * self.omega + fixed - acts.push) / weight;
        let stop = acts.friction / weight;
        free - free.min(stop).max(-stop)
    }

    /// Where it is after a step of `h` seconds at whose end it has this speed.
    #[inline(always)]
    pub fn moved(&self, omega: T, h: f64) -> Self {
        let leaving = omega.abs().is_positive() && !(self.omega.abs() - omega.abs()).is_positive();
        Self { theta: self.theta + T::of(0.5 * h) * (self.omega + omega), omega, leaving }
    }

    /// A step of `h` seconds behind a joint, and the torque of the joint in it, while the shaft goes from one angle
    /// to the next.
    #[inline(always)]
    pub fn stepped(&self, joint: &Joint<T>, acts: &Acts<T>, shaft: [T; 2], h: f64) -> (Self, T) {
        let (half, zero) = (T::of(0.5), T::of(0.0));
        let speed = (shaft[1] - shaft[0]) / T::of(h);
        // Rate and twist of the joint halfway, by the speed of the knob at the end of the step.
        let rate = |omega: T| speed - half * (self.omega + omega);
        let twist = |omega: T| shaft[0] - self.theta + T::of(0.5 * h) * rate(omega);
        let slid = |fixed: T, drag: T| self.slid(acts, fixed, drag, h);
        let ends = |omega: T, force: T| (self.moved(omega, h), force);
        // The side that the knob without joint would be on is the one that touches, if any does.
        let alone = slid(zero, zero);
        let side = twist(alone).where_positive(T::of(1.0), T::of(-1.0));
        let border = half * side * joint.gap;
        let strain = |omega: T| twist(omega) - border;
        let force = |omega: T| joint.stiffness * strain(omega) + joint.damping * rate(omega);
        let inside = |omega: T| (side * strain(omega)).is_positive();
        let touches = joint.welded || inside(alone) && (side * force(alone)).is_positive();
        if !touches {
            return ends(alone, zero);
        }
        let drag = T::of(0.25 * h) * joint.stiffness + half * joint.damping;
        let omega = slid(force(zero), drag);
        if joint.welded || inside(omega) {
            return ends(omega, force(omega));
        }
        // The damper would stop the knob short of the contact, which has to be reached for it to act: just there.
        let omega = rate(zero) + rate(zero) + (shaft[0] - self.theta - border) * T::of(4.0 / h);
        let rubs = omega.where_positive(acts.friction, -acts.friction);
        ends(omega, acts.inertia / T::of(h) * (omega - self.omega) + acts.push + rubs)
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
            let acts =
                Acts { inertia: INERTIA, push: 0.05 * noise.normal(), friction: 0.05 * noise.uniform() };
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
                    .stepped(&joint, &Acts { inertia: INERTIA, push: 0.0, friction: 0.0 }, [0.0, 0.0], STEP_S)
                    .0;
                assert!(energy(&knob) < 1.01 * start, "{stiffness}: {}", energy(&knob) / start);
            }
            assert!(energy(&knob) < 0.1 * start, "{stiffness}: {}", energy(&knob) / start);
        }
    }

    #[test]
    fn friction_stops_the_knob_and_does_not_turn_it_round() {
        let acts = Acts { inertia: INERTIA, push: 0.0, friction: 0.05 };
        let start = Body::at(0.0, 0.01);
        let (knob, _) = start.stepped(&joint(1.0, 0.0), &acts, [0.0, 0.0], STEP_S);
        assert_eq!(knob.omega, 0.0);
    }
}
