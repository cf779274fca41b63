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

impl<T: Scalar> Acts<T> {
    /// A load on a body of this inertia: the friction that slides, and within the stick band static
    /// friction (Karnopp 1985) where that holds more. `plain` where no effect shapes the friction of others.
    #[inline(always)]
    pub fn of(load: &Load<T>, plain: bool, body: &Body<T>, inertia: T) -> Self {
        let (half, zero, one) = (T::of(0.5), T::of(0.0), T::of(1.0));
        let [back, forth] = load.resist;
        let [mut backward, mut forward] =
            if plain { [[-back, zero], [forth, zero]] } else { [load.rubs(zero), load.rubs(one)] };
        let presses = load.presses();
        if !body.leaving && (load.band - body.omega.abs()).is_positive() {
            for ([unpressed, per_load], hold, sign) in
                [(&mut backward, load.hold[0], -one), (&mut forward, load.hold[1], one)]
            {
                let more = hold - sign * (*unpressed + *per_load * presses.abs());
                *unpressed = more.where_positive(sign * hold, *unpressed);
                *per_load = more.where_positive(zero, *per_load);
            }
        }
        let inertial = load.inertia_share.is_positive() || load.mu.abs().is_positive();
        let ([mut back, back_per_load], [mut forth, forth_per_load]) = (backward, forward);
        let mut pressed = None;
        if inertial && !plain {
            let per_load = [back_per_load, forth_per_load];
            pressed = Some(Pressed { load: presses, share: load.inertia_share, per_load });
        } else if !plain {
            back = back + back_per_load * presses.abs();
            forth = forth + forth_per_load * presses.abs();
        }
        let friction = (half * (forth - back)).max(zero);
        Self { inertia, push: load.drive + half * (forth + back), friction, pressed }
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

impl<T: Scalar> Pressed<T> {
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
        let leaving = omega.abs().is_positive() && !(self.omega.abs() - omega.abs()).is_positive();
        Self { theta: self.theta + T::of(0.5 * h) * (self.omega + omega), omega, leaving }
    }

    /// A step of `h` seconds behind a joint, and the torque of the joint in it, while the shaft goes from one angle
    /// to the next.
    #[inline(always)]
    pub fn stepped(&self, joint: &Joint<T>, acts: &Acts<T>, shaft: [T; 2], h: f64) -> (Self, T) {
        let step = Step::of(self, joint, acts, shaft, h);
        // Which way it goes, by the values alone: only that way has to be gone with derivatives.
        let contact = step.values().contact();
        let omega = match contact {
            Contact::None => return (self.moved(step.alone(), h), T::of(0.0)),
            Contact::Lasts(side) => step.held(side),
            Contact::Reached(side) => step.reaching(side),
        };
        let force = match contact {
            Contact::Reached(_) => {
                let inertial = acts.inertia / T::of(h) * (omega - self.omega);
                inertial + acts.opposes(omega, inertial)
            }
            Contact::Lasts(side) => step.force(side, omega),
            Contact::None => T::of(0.0),
        };
        (self.moved(omega, h), force)
    }
}

/// What a joint does in a step, and on which side (1 or -1).
#[derive(Debug, Clone, Copy)]
enum Contact {
    /// Nothing.
    None,
    /// It touches to the end of the step.
    Lasts(f64),
    /// It touches just at its end: the damper would stop the knob short of the contact, which has to be reached for it
    /// to act.
    Reached(f64),
}

/// A step behind a joint. Its parts are functions, and not closures, for these would be left out of what is compiled for
/// the machine's instruction set.
#[derive(Debug, Clone, Copy)]
struct Step<T> {
    body: Body<T>,
    joint: Joint<T>,
    acts: Acts<T>,
    /// Angle of the shaft at the start, and its speed.
    shaft: T,
    speed: T,
    h: f64,
}

impl<T: Scalar> Step<T> {
    #[inline(always)]
    fn of(body: &Body<T>, joint: &Joint<T>, acts: &Acts<T>, [from, to]: [T; 2], h: f64) -> Self {
        let speed = (to - from) / T::of(h);
        Self { body: *body, joint: *joint, acts: *acts, shaft: from, speed, h }
    }

    /// The same without derivatives.
    #[inline(always)]
    fn values(&self) -> Step<f64> {
        let Self { body, joint, acts, shaft, speed, h } = *self;
        let body = Body { theta: body.theta.value(), omega: body.omega.value(), leaving: body.leaving };
        let joint = Joint {
            gap: joint.gap.value(),
            stiffness: joint.stiffness.value(),
            damping: joint.damping.value(),
            share: joint.share.value(),
            welded: joint.welded,
        };
        let pressed = acts.pressed.map(|Pressed { load, share, per_load: [back, forth] }| Pressed {
            load: load.value(),
            share: share.value(),
            per_load: [back.value(), forth.value()],
        });
        let acts = Acts {
            inertia: acts.inertia.value(),
            push: acts.push.value(),
            friction: acts.friction.value(),
            pressed,
        };
        Step { body, joint, acts, shaft: shaft.value(), speed: speed.value(), h }
    }

    /// Rate of the joint halfway, by the speed of the knob at the end of the step.
    #[inline(always)]
    fn rate(&self, omega: T) -> T {
        self.speed - T::of(0.5) * (self.body.omega + omega)
    }

    /// Twist of the joint there.
    #[inline(always)]
    fn twist(&self, omega: T) -> T {
        self.shaft - self.body.theta + T::of(0.5 * self.h) * self.rate(omega)
    }

    /// The twist at which a side touches.
    #[inline(always)]
    fn border(&self, side: f64) -> T {
        T::of(0.5 * side) * self.joint.gap
    }

    /// Torque of the joint halfway.
    #[inline(always)]
    fn force(&self, side: f64, omega: T) -> T {
        self.joint.stiffness * (self.twist(omega) - self.border(side)) + self.joint.damping * self.rate(omega)
    }

    /// Speed at the end without joint;
    #[inline(always)]
    fn alone(&self) -> T {
        self.body.slid(&self.acts, T::of(0.0), T::of(0.0), self.h)
    }

    /// with a side that touches to the end;
    #[inline(always)]
    fn held(&self, side: f64) -> T {
        let drag = T::of(0.25 * self.h) * self.joint.stiffness + T::of(0.5) * self.joint.damping;
        self.body.slid(&self.acts, self.force(side, T::of(0.0)), drag, self.h)
    }

    /// with one that just touches there.
    #[inline(always)]
    fn reaching(&self, side: f64) -> T {
        let rate = self.rate(T::of(0.0));
        rate + rate + (self.shaft - self.body.theta - self.border(side)) * T::of(4.0 / self.h)
    }
}

impl Step<f64> {
    #[inline(always)]
    fn contact(&self) -> Contact {
        // The side that the knob without joint would be on is the one that touches, if any does.
        let alone = self.alone();
        let side = if self.twist(alone) > 0.0 { 1.0 } else { -1.0 };
        if self.joint.welded {
            return Contact::Lasts(side);
        }
        if !(self.inside(side, alone) && side * self.force(side, alone) > 0.0) {
            return Contact::None;
        }
        if self.inside(side, self.held(side)) { Contact::Lasts(side) } else { Contact::Reached(side) }
    }

    /// Whether a side touches halfway.
    #[inline(always)]
    fn inside(&self, side: f64, omega: f64) -> bool {
        side * (self.twist(omega) - self.border(side)) > 0.0
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
