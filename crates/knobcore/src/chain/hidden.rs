//! The hidden knob: where shaft and knob are not one, the knob's own motion is simulated from the shaft's.
//!
//! Two bodies (Nordin & Gutman 2002, "Controlling mechanical systems with backlash"): the shaft, whose motion is
//! measured, with a share of the inertia; the knob with the rest and with every load. Between them a spring and a
//! damper, after a free play. Static friction holds the knob where the model has it.

use super::stepper::{Acts, Body};
use crate::effects::Joint;
use crate::effects::law::Carried;
use crate::model::Model;
use crate::motion::{Load, Motion};
use crate::scalar::Scalar;

/// The motion of the shaft at one instant: t, theta, omega, alpha.
pub type Instant = [f64; 4];

/// What no log says of the instant at which it begins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Begins {
    /// By how much the shaft is ahead of a hidden knob, rad.
    pub ahead: f64,
    /// By how much it is faster, rad/s.
    pub faster: f64,
    /// How far friction that builds up has done so: 1 forward, -1 backward, 0 not at all.
    pub bent: f64,
}

/// How a knob is followed.
#[derive(Debug, Clone, Copy)]
pub struct Follow {
    /// Steps from one sample to the next.
    pub substeps: usize,
    /// From where.
    pub begins: Begins,
}

impl Follow {
    /// One that begins with the shaft, and has not moved before.
    pub fn of(substeps: usize) -> Self {
        Self { substeps, begins: Begins::default() }
    }
}

/// What functions of a user's own do to the knob: a torque, N m, and a factor on its dry friction. They are evaluated
/// along the shaft's motion, as if the joint were not strained, for their laws take whole columns.
#[derive(Debug, Clone, Copy)]
pub struct Beside<T> {
    /// N m.
    pub drive: T,
    /// Factor.
    pub friction_scale: T,
}

/// The hidden knob, carried along behind the shaft.
#[derive(Debug, Clone, Copy)]
pub struct Hidden<T: Carried> {
    joint: Joint<T>,
    knob: Body<T>,
    own: T,
    /// The inertia that is the same everywhere, of which the joint has a share on either side; what more the loads have
    /// is the knob's.
    stored: T,
    /// Inertia on the shaft's side, kg m^2.
    pub shafts: T,
    plain: bool,
    substeps: usize,
    /// Length of a step, s.
    step_s: f64,
    /// The last instant that it was followed to, and the functions of a user's own there.
    before: Option<(Instant, Option<Beside<T>>)>,
    /// What loads the knob in every motion.
    steady: Load<T>,
    /// What loads the knob where it is. It stays where it is: to copy one takes longer than most effects.
    load: Load<T>,
}

impl<T: Carried> Hidden<T> {
    /// A knob that begins so far behind the shaft; none without a joint. Samples are `dt` seconds apart. The joint needs
    /// no steps between them to be stable, they resolve when contact begins and ends.
    pub fn new(model: &Model, p: &[T], start: Instant, dt: f64, follow: Follow) -> Option<Self> {
        let joint = model.joint(p)?;
        let Follow { substeps, begins: Begins { ahead, faster, .. } } = follow;
        let knob = Body::at(T::of(start[1] - ahead), T::of(start[2] - faster));
        let stored = model.inertia().and_then(|at| p.get(at).copied()).unwrap_or(T::of(0.0));
        let shafts = (T::of(1.0) - joint.share) * stored;
        let (own, substeps) = (joint.share * stored, substeps.max(1));
        let (plain, step_s) = (model.is_plain(), dt / substeps as f64);
        let steady = model.steady_load(p);
        Some(Self {
            joint,
            knob,
            own,
            stored,
            shafts,
            plain,
            substeps,
            step_s,
            before: None,
            steady,
            load: steady,
        })
    }

    /// Cuts the joint to a stiffness and raises its damping to at least what such a stiffness needs.
    #[inline]
    pub fn soften(&mut self, [stiffness, damping]: [f64; 2]) {
        if (self.joint.stiffness - T::of(stiffness)).is_positive() {
            self.joint.stiffness = T::of(stiffness);
            self.joint.damping = T::of(damping);
        }
    }

    /// Angle and speed of the knob.
    #[inline]
    pub fn knob(&self) -> [T; 2] {
        [self.knob.theta, self.knob.omega]
    }

    /// Puts shaft and knob there. `state` is what the effects remember once they have seen that instant.
    #[inline]
    pub fn put(
        &mut self,
        model: &Model,
        p: &[T],
        state: &mut [T],
        shaft: Instant,
        beside: Option<Beside<T>>,
        [theta, omega]: [T; 2],
    ) {
        self.knob = Body::at(theta, omega);
        self.load(model, p, state, shaft[0]);
        self.before = Some((shaft, beside));
    }

    /// Forgets where the shaft was: the next instant is the first.
    #[inline]
    pub fn begin(&mut self, theta: T, omega: T) {
        self.knob = Body::at(theta, omega);
        self.before = None;
    }

    /// Looks what loads the knob halfway through the step that begins where it is, as the torque of the joint is: what acts
    /// half a step late, whichever way the knob goes, is felt as a gap.
    #[inline(always)]
    fn load(&mut self, model: &Model, p: &[T], state: &mut [T], t: f64) {
        let later = 0.5 * self.step_s;
        let theta = self.knob.theta + self.knob.omega.scaled(T::Value::of(later));
        let motion = Motion::exact(T::of(t + later), theta, self.knob.omega, T::of(0.0));
        self.load = self.steady;
        model.add_loads(p, state, &motion, &mut self.load);
    }

    /// What acts on the knob in a step from there.
    #[inline(always)]
    fn acts(&self, knob: &Body<T>, beside: Option<Beside<T>>) -> Acts<T> {
        let own = self.own + (self.load.inertia - self.stored);
        let Some(beside) = beside else { return Acts::of(&self.load, self.plain, knob, own) };
        let mut load = self.load;
        load.drive = load.drive + beside.drive;
        load.friction_scale = load.friction_scale * beside.friction_scale;
        Acts::of(&load, self.plain, knob, own)
    }

    /// Follows the shaft to its next instant, and answers the torque on it there but for its own inertia, N m.
    ///
    /// An instant lies between steps: the last ones before it, and as many that are tried from there with the shaft's
    /// acceleration. Their mean takes out what the midpoint rule leaves of a spring that is too stiff for the step: an
    /// error that changes sign from step to step. Of surfaces that knock it reaches half a sample either way: so it holds
    /// the whole impulse of a contact that is shorter than a sample, whenever it comes. Nothing of it looks ahead, so
    /// that a knob is rendered as it is predicted. `missed` samples lie between the instant before and this one.
    #[inline(always)]
    pub fn follow(
        &mut self,
        model: &Model,
        p: &[T],
        state: &mut [T],
        to: Instant,
        missed: usize,
        beside: Option<Beside<T>>,
    ) -> T {
        let (from, was) = self.before.unwrap_or((to, beside));
        let time = to[0] - from[0];
        let carried = if time > 0.0 { self.substeps * (missed + 1) } else { 0 };
        // Only surfaces that meet and part knock.
        let half = if self.joint.welded { 1 } else { (self.substeps / 2).max(1) };
        let (h, share) = (time / carried as f64, |steps: usize| steps as f64 / carried as f64);
        let (mut knob, mut sum, mut angle) = (self.knob.settled(), T::of(0.0), from[1]);
        // One loop for the steps between the instants and those that are tried, so that a step is compiled once.
        for step in 0..carried + half {
            if step == carried || (0 < step && step < carried) {
                self.knob = knob;
                self.load(model, p, state, if step == carried { to[0] } else { from[0] + step as f64 * h });
            }
            let (h, reached, beside) = if let Some(tried) = step.checked_sub(carried) {
                let ([_, theta, omega, alpha], after) = (to, (tried + 1) as f64 * self.step_s);
                angle = if tried == 0 { theta } else { angle };
                (self.step_s, theta + after * (omega + 0.5 * after * alpha), beside)
            } else {
                let reached = hermite([from[1], to[1]], [from[2] * time, to[2] * time], share(step + 1));
                (h, reached, between(was, beside, share(step)))
            };
            let (next, force) = knob.stepped(&self.joint, &self.acts(&knob, beside), [angle, reached], h);
            if step + half >= carried {
                sum = sum + force;
            }
            (knob, angle) = (next, reached);
        }
        self.before = Some((to, beside));
        sum.scaled(T::Value::of(1.0 / (half + half.min(carried)) as f64))
    }
}

/// What functions of a user's own do after a share `u` of a sample.
#[inline(always)]
fn between<T: Carried>(was: Option<Beside<T>>, now: Option<Beside<T>>, u: f64) -> Option<Beside<T>> {
    let (was, now) = (was?, now?);
    Some(Beside {
        drive: was.drive + T::of(u) * (now.drive - was.drive),
        friction_scale: was.friction_scale + T::of(u) * (now.friction_scale - was.friction_scale),
    })
}

/// The angle of the shaft after a share `u` of a sample, by the cubic through its angles and speeds.
#[inline(always)]
fn hermite([a, b]: [f64; 2], [da, db]: [f64; 2], u: f64) -> f64 {
    let v = 1.0 - u;
    v * v * (1.0 + 2.0 * u) * a + u * u * (1.0 + 2.0 * v) * b + u * v * (v * da - u * db)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;
    use crate::predict;
    use crate::signals::Signals;

    #[test]
    fn between_two_instants_the_shaft_keeps_angles_and_speeds_of_both() {
        let at = |u: f64| hermite([1.0, 3.0], [0.5, -2.0], u);
        let slope = |u: f64| (at(u + 1e-6) - at(u - 1e-6)) / 2e-6;
        assert_eq!((at(0.0), at(1.0)), (1.0, 3.0));
        assert!((slope(0.0) - 0.5).abs() < 1e-8 && (slope(1.0) + 2.0).abs() < 1e-8);
    }

    #[test]
    fn a_knock_that_is_shorter_than_a_sample_has_its_whole_impulse_whenever_it_comes() {
        let (inertia, share, speed, dt) = (1e-4, 0.5, 1.0, 2e-4);
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        let contact = [("backlash.gap", 0.02), ("backlash.k", 2e4), ("backlash.d", 0.5)];
        for (name, value) in contact.into_iter().chain([("inertia.M", inertia), ("backlash.share", share)]) {
            model.set(name, value).unwrap();
        }
        let p = model.values();
        // The shaft goes on at its speed and meets the knob, which stands still, at any time between two samples.
        let shaft = |i: usize| [i as f64 * dt, speed * i as f64 * dt, speed, 0.0];
        for late in 0..10 {
            let mut state = vec![0.0; model.states()];
            let mut hidden = Hidden::<f64>::new(&model, &p, shaft(0), dt, Follow::of(4)).unwrap();
            let behind = -0.005 - f64::from(late) * 0.1 * speed * dt;
            hidden.put(&model, &p, &mut state, shaft(0), None, [behind, 0.0]);
            let felt: f64 =
                (1..40).map(|i| hidden.follow(&model, &p, &mut state, shaft(i), 0, None) * dt).sum();
            let [_, omega] = hidden.knob();
            let given = share * inertia * omega;
            assert!(omega > speed && (felt - given).abs() < 0.02 * given, "{late}: {felt} {given}");
        }
    }

    #[test]
    fn steps_between_samples_are_as_good_as_samples_also_for_what_changes_with_time() {
        let mut knob = Model::equation_1(Axis::Rotary, false).with(Id::Compliance).unwrap();
        knob = knob.with(Id::FrictionDrift).unwrap();
        let friction = [("coulomb.neg", 0.02), ("coulomb.pos", 0.02), ("friction_drift.rise", 5.0)];
        let joint = [("compliance.k", 2.0), ("compliance.d", 0.01), ("inertia.M", 1e-4)];
        for (name, value) in friction.into_iter().chain(joint).chain([("friction_drift.tau", 3e-3)]) {
            knob.set(name, value).unwrap();
        }
        // Of constant acceleration, which is known also between its samples.
        let torque = |rate_hz: f64, substeps: usize| {
            let over = |f: &dyn Fn(f64) -> f64| {
                (0..(0.02 * rate_hz) as u32).map(|i| f(f64::from(i) / rate_hz)).collect::<Vec<f64>>()
            };
            let t = over(&|t| t);
            let n = t.len();
            let signals = Signals {
                rate_hz,
                substeps,
                theta: over(&|t| 3.0 * t + 50.0 * t * t),
                omega: over(&|t| 3.0 + 100.0 * t),
                alpha: vec![100.0; n],
                forward: vec![1.0; n],
                weight: vec![1.0; n],
                segments: vec![0..n; 1],
                t,
                ..Signals::default()
            };
            predict::torque_raw(&knob, &signals)
        };
        let (few, many) = (torque(1000.0, 8), torque(8000.0, 1));
        for (i, few) in few.iter().enumerate() {
            assert!((few - many[8 * i]).abs() < 1e-12, "{i}: {few} {}", many[8 * i]);
        }
    }

    /// The torque of a knob that is swung to and fro, at 5 kHz.
    fn swung(knob: &Model, substeps: usize) -> Vec<f64> {
        let (n, swing) = (5000, 6.0);
        let over = |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(f64::from(i) * 2e-4)).collect::<Vec<f64>>();
        predict::torque_raw(
            knob,
            &Signals {
                rate_hz: 5000.0,
                substeps,
                t: over(&|t| t),
                theta: over(&|t| (swing * t).sin()),
                omega: over(&|t| swing * (swing * t).cos()),
                alpha: over(&|t| -swing * swing * (swing * t).sin()),
                forward: over(&|t| f64::from(u8::from((swing * t).cos() > 0.0))),
                segments: vec![0..n as usize; 1],
                ..Signals::default()
            },
        )
    }

    /// The RMS of the difference of two torques, N m.
    fn apart(one: &[f64], other: &[f64]) -> f64 {
        let squares: f64 = one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum();
        (squares / one.len() as f64).sqrt()
    }

    #[test]
    fn friction_that_builds_up_is_behind_a_stiff_joint_what_it_is_without_one() {
        for (shares, most) in [([0.3, 0.2], 1e-3), ([0.4, 0.6], 2e-4)] {
            let mut rigid = Model::equation_1(Axis::Rotary, false).with(Id::Presliding).unwrap();
            let base = [("inertia.M", 1e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.025)];
            let late = [("presliding.s", 0.02), ("presliding.w1", shares[0]), ("presliding.w3", shares[1])];
            base.into_iter().chain(late).for_each(|(name, value)| rigid.set(name, value).unwrap());
            let mut joined = rigid.with(Id::Compliance).unwrap();
            let joint = [("compliance.k", 2e3), ("compliance.d", 0.1), ("compliance.share", 0.7)];
            joint.into_iter().for_each(|(name, value)| joined.set(name, value).unwrap());
            // Half of the friction turns round at once, and does so behind a spring a sample later: as it does where none
            // builds up. Where it rang for that it had no end.
            let off = apart(&swung(&rigid, 4), &swung(&joined, 4));
            assert!(off < most, "{shares:?}: {off}");
        }
    }

    #[test]
    fn four_steps_a_sample_turn_a_knob_with_detents_as_many_more_do() {
        let mut knob = Model::equation_1(Axis::Rotary, true).with(Id::Compliance).unwrap();
        let base = [("inertia.M", 1e-4), ("coulomb.neg", 4e-3), ("coulomb.pos", 4e-3)];
        let detents = [("detent.A", 0.02), ("detent.P", 0.05)];
        let joint = [("compliance.k", 20.0), ("compliance.d", 0.01)];
        for (name, value) in base.into_iter().chain(detents).chain(joint) {
            knob.set(name, value).unwrap();
        }
        let off = apart(&swung(&knob, 4), &swung(&knob, 64));
        // Of 15 mN m: 29 uN m where detents act at the start of each step.
        assert!(off < 1e-6, "{off}");
    }
}
