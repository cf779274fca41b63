//! The hidden knob: where shaft and knob are not one, the knob's own motion is simulated from the shaft's.
//!
//! Two bodies (Nordin & Gutman 2002, "Controlling mechanical systems with backlash"): the shaft, whose motion is
//! measured, with a share of the inertia; the knob with the rest and with every load. Between them a spring and a
//! damper, after a free play. Contact is stiff and friction dry, so both are implicit: the midpoint rule for the
//! joint, whose free play is that at the midpoint too (so that two motions never part in a step, however stiff the
//! contact: Burrage & Butcher 1979), and friction that stops the knob at the end of a step if it can (Moreau 1988).
//!
//! Effects of a user's own load the knob too. Their laws take whole columns, so they are evaluated along the
//! shaft's motion, as if the joint were not strained.

use crate::effects::{Id, Joint};
use crate::model::Model;
use crate::motion::Motion;
use crate::scalar::{Dual, Scalar};

/// Derivatives that are carried along at a time.
const MOST: usize = 16;

/// The measured motion of the shaft.
#[derive(Debug, Clone, Copy)]
pub struct Shaft<'a> {
    /// t, theta, omega, alpha, forward.
    pub motion: [&'a [f64]; 5],
    /// Steps per sample. The joint needs none of them to be stable; they resolve when contact begins and ends.
    pub substeps: usize,
}

/// Torque on the shaft and its derivatives; see [`crate::predict`]. `columns` says which column each parameter
/// has.
pub fn sweep(
    model: &Model,
    p: &[f64],
    columns: &[Option<usize>],
    shaft: Shaft<'_>,
    torque: &mut [f64],
    slopes: &mut [Vec<f64>],
) {
    let hidden = Hidden { model, p, columns, shaft, own: Own::over(model, p, columns, shaft.motion) };
    if slopes.is_empty() {
        let (more, out) = (|at: usize| hidden.own.torque(at), |at: usize, tau: f64| torque[at] = tau);
        pulp::Arch::new().dispatch(Simulation { model, p, shaft, more, out });
        return;
    }
    for (group, few) in slopes.chunks_mut(MOST).enumerate() {
        let first = group * MOST;
        match few.len() {
            0..=8 => hidden.carry::<8>(first, torque, few),
            _ => hidden.carry::<MOST>(first, torque, few),
        }
    }
}

/// What is simulated, and by which parameters it is differentiated.
struct Hidden<'a> {
    model: &'a Model,
    p: &'a [f64],
    columns: &'a [Option<usize>],
    shaft: Shaft<'a>,
    own: Own,
}

impl Hidden<'_> {
    /// Simulates with the derivatives whose columns begin at `first`.
    fn carry<const L: usize>(&self, first: usize, torque: &mut [f64], few: &mut [Vec<f64>]) {
        let lane = |column: usize| column.checked_sub(first).filter(|lane| *lane < L);
        let seed = |(i, x): (usize, &f64)| {
            Dual::<f64, L>::seeded(*x, self.columns.get(i).copied().flatten().and_then(lane))
        };
        let p: Vec<_> = self.p.iter().enumerate().map(seed).collect();
        let more = |at: usize| {
            let mut tau = Dual::constant(self.own.torque(at)?);
            for (column, slope) in &self.own.slopes {
                if let Some(lane) = lane(*column) {
                    tau.d[lane] += slope[at];
                }
            }
            Some(tau)
        };
        let out = |at: usize, tau: Dual<f64, L>| {
            torque[at] = tau.v;
            few.iter_mut().zip(tau.d).for_each(|(column, slope)| column[at] = slope);
        };
        pulp::Arch::new().dispatch(Simulation { model: self.model, p: &p, shaft: self.shaft, more, out });
    }
}

/// What effects of a user's own load the knob with: torque, empty without any, and derivatives by column.
struct Own {
    torque: Vec<f64>,
    slopes: Vec<(usize, Vec<f64>)>,
}

impl Own {
    fn over(model: &Model, p: &[f64], columns: &[Option<usize>], motion: [&[f64]; 5]) -> Self {
        let mut own = Self { torque: Vec::new(), slopes: Vec::new() };
        for (id, p, columns) in model.parts(p, columns) {
            let Id::User(user) = id else { continue };
            own.torque.resize(motion[0].len(), 0.0);
            own.torque.iter_mut().zip(user.over(p, motion)).for_each(|(sum, tau)| *sum += tau);
            let asked = columns.iter().enumerate().filter_map(|(i, column)| Some((i, (*column)?)));
            own.slopes.extend(asked.map(|(i, column)| (column, user.slope(p, i, motion))));
        }
        own
    }

    fn torque(&self, at: usize) -> Option<f64> {
        self.torque.get(at).copied()
    }
}

/// A simulation as a value, so that its body is compiled for the machine's instruction set.
struct Simulation<'a, T, M, F> {
    model: &'a Model,
    p: &'a [T],
    shaft: Shaft<'a>,
    more: M,
    out: F,
}

impl<T: Scalar, M: Fn(usize) -> Option<T>, F: FnMut(usize, T)> pulp::NullaryFnOnce
    for Simulation<'_, T, M, F>
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        run(self.model, self.p, self.shaft, self.more, self.out);
    }
}

/// The knob behind the joint.
#[derive(Debug, Clone, Copy)]
struct Knob<T> {
    theta: T,
    omega: T,
}

/// Simulates the knob along the shaft's motion, under the torque `more`, if any, beside its loads, and hands over
/// the torque on the shaft at every sample.
#[inline(always)]
fn run<T: Scalar>(
    model: &Model,
    p: &[T],
    shaft: Shaft<'_>,
    more: impl Fn(usize) -> Option<T>,
    mut out: impl FnMut(usize, T),
) {
    let [t, theta, omega, alpha, _] = shaft.motion;
    let first = |column: &[f64]| column.first().copied().unwrap_or(0.0);
    let mut state = vec![T::of(0.0); model.states()];
    let at_first = [first(t), first(theta), first(omega)];
    let Some(mut hidden) = Follower::new(model, p, &state, at_first, Dry::Sliding) else { return };
    let mut before = None;
    for at in 0..t.len() {
        let next = (at + 1).min(t.len() - 1);
        let span = Span {
            from: [t[at], theta[at], omega[at]],
            to: [t[next], theta[next], omega[next]],
            substeps: shaft.substeps,
        };
        let ends = hidden.follow(model, p, &mut state, &span, more(at).zip(more(next)));
        // A sample lies between two steps. The mean of both also takes out what the midpoint rule leaves of a
        // spring that is too stiff for the step: an error that changes sign from step to step.
        let force = match (before, ends.map(|[first, _]| first)) {
            (Some(a), Some(b)) => T::of(0.5) * (a + b),
            (a, b) => a.or(b).unwrap_or(T::of(0.0)),
        };
        out(at, hidden.shafts * T::of(alpha[at]) + force);
        before = ends.map(|[_, last]| last);
    }
}

/// What a knob at rest is held by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dry {
    /// The friction of the moving knob: what a measured motion is predicted with.
    Sliding,
    /// Static friction, where the model has it: what is rendered.
    Static,
}

/// The motion of the shaft from one sample to the next: t, theta and omega at both.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    /// At the first sample.
    pub from: [f64; 3],
    /// At the second.
    pub to: [f64; 3],
    /// Steps between them.
    pub substeps: usize,
}

/// The hidden knob, carried along behind the shaft.
#[derive(Debug, Clone, Copy)]
pub struct Follower<T> {
    joint: Joint<T>,
    knob: Knob<T>,
    own: T,
    /// Inertia on the shaft's side, kg m^2.
    pub shafts: T,
    dry: Dry,
}

impl<T: Scalar> Follower<T> {
    /// A knob that starts with the shaft, at `[t, theta, omega]`; none without a joint. `state` is what the
    /// model's effects remember.
    pub fn new(model: &Model, p: &[T], state: &[T], [t, theta, omega]: [f64; 3], dry: Dry) -> Option<Self> {
        let joint = model.joint(p)?;
        let knob = Knob { theta: T::of(theta), omega: T::of(omega) };
        let motion = Motion::exact(T::of(t), knob.theta, knob.omega, T::of(0.0));
        let inertia = model.load(p, &mut state.to_vec(), &motion).inertia;
        let shafts = (T::of(1.0) - joint.share) * inertia;
        Some(Self { joint, knob, own: joint.share * inertia, shafts, dry })
    }

    /// Cuts the joint to a stiffness and raises its damping to at least what such a stiffness needs.
    pub fn soften(&mut self, [stiffness, damping]: [f64; 2]) {
        if (self.joint.stiffness - T::of(stiffness)).is_positive() {
            self.joint.stiffness = T::of(stiffness);
            self.joint.damping = T::of(damping);
        }
    }

    /// Angle and speed of the knob.
    pub fn knob(&self) -> [T; 2] {
        [self.knob.theta, self.knob.omega]
    }

    /// Puts the knob there.
    pub fn put(&mut self, [theta, omega]: [T; 2]) {
        self.knob = Knob { theta, omega };
    }

    /// Follows the shaft over a span, under a torque beside the model's loads that goes from one value to
    /// another, if any. The joint's torque in the first and in the last step; none over no time.
    #[inline(always)]
    pub fn follow(
        &mut self,
        model: &Model,
        p: &[T],
        state: &mut [T],
        span: &Span,
        more: Option<(T, T)>,
    ) -> Option<[T; 2]> {
        let ([t, mut from, speed], [until, end, end_speed]) = (span.from, span.to);
        let (start, time) = (from, until - t);
        if time.is_nan() || time <= 0.0 {
            return None;
        }
        let substeps = span.substeps.max(1);
        let h = time / substeps as f64;
        let (half, mut first, mut last) = (T::of(0.5), None, T::of(0.0));
        for step in 1..=substeps {
            let share = |steps: usize| steps as f64 / substeps as f64;
            let to = hermite([start, end], [speed * time, end_speed * time], share(step));
            let clock = t + (step - 1) as f64 * h;
            let motion = Motion::exact(T::of(clock), self.knob.theta, self.knob.omega, T::of(0.0));
            let load = model.load(p, state, &motion);
            let (mut forth, mut back) = if model.is_plain() {
                (load.resist[1], -load.resist[0])
            } else {
                (load.friction(T::of(1.0)), load.friction(T::of(0.0)))
            };
            let still = (load.band - self.knob.omega.abs()).where_positive(T::of(1.0), T::of(0.0));
            if self.dry == Dry::Static && still.is_positive() {
                (forth, back) = (forth.max(load.hold[1]), back.min(-load.hold[0]));
            }
            let friction = (half * (forth - back)).max(T::of(0.0));
            let mut push = load.drive + half * (forth + back);
            if let Some((from, to)) = more {
                push = push + from + T::of(share(step - 1)) * (to - from);
            }
            (self.knob, last) = self.knob.stepped(&self.joint, self.own, push, friction, [from, to], h);
            first = first.or(Some(last));
            from = to;
        }
        first.map(|first| [first, last])
    }
}

/// The angle of the shaft after a share `u` of a sample, by the cubic through its angles and speeds.
fn hermite([a, b]: [f64; 2], [da, db]: [f64; 2], u: f64) -> f64 {
    let v = 1.0 - u;
    v * v * (1.0 + 2.0 * u) * a + u * u * (1.0 + 2.0 * v) * b + u * v * (v * da - u * db)
}

impl<T: Scalar> Knob<T> {
    /// One step of `h` seconds, and the torque of the joint in it: the shaft moves from one angle to the next,
    /// `push` is what loads the knob and `friction` what may oppose its motion.
    #[inline(always)]
    fn stepped(
        &self,
        joint: &Joint<T>,
        inertia: T,
        push: T,
        friction: T,
        shaft: [f64; 2],
        h: f64,
    ) -> (Self, T) {
        let (half, zero) = (T::of(0.5), T::of(0.0));
        let speed = T::of((shaft[1] - shaft[0]) / h);
        let mass = inertia / T::of(h);
        // Rate and twist of the joint halfway, by the speed of the knob at the end of the step.
        let rate = |omega: T| speed - half * (self.omega + omega);
        let twist = |omega: T| T::of(shaft[0]) - self.theta + T::of(0.5 * h) * rate(omega);
        // The end of the step where the joint's torque is fixed - drag * (speed at the end).
        let slid = |fixed: T, drag: T| {
            let weight = mass + drag;
            let free = (mass * self.omega + fixed - push) / weight;
            let stop = friction / weight;
            free - free.min(stop).max(-stop)
        };
        let ends = |omega: T, force: T| {
            let theta = self.theta + T::of(0.5 * h) * (self.omega + omega);
            (Self { theta, omega }, force)
        };
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
        let omega = rate(zero) + rate(zero) + (T::of(shaft[0]) - self.theta - border) * T::of(4.0 / h);
        let rubs = omega.where_positive(friction, -friction);
        ends(omega, mass * (omega - self.omega) + push + rubs)
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
            let knob = Knob { theta: GAP * noise.normal(), omega: noise.normal() };
            let joint = joint((10.0 * noise.uniform()).exp(), (-8.0 * noise.uniform()).exp());
            let shaft = [0.0, STEP_S * noise.normal()];
            let (next, force) =
                knob.stepped(&joint, INERTIA, 0.05 * noise.normal(), 0.05 * noise.uniform(), shaft, STEP_S);
            let twist = 0.5 * (shaft[0] + shaft[1] - knob.theta - next.theta);
            assert!(force * twist >= 0.0, "{force} at {twist}");
            assert!(force == 0.0 || twist.abs() > 0.5 * GAP - 1e-9, "{force} within the gap, at {twist}");
        }
    }

    #[test]
    fn a_knob_that_bounces_in_its_gap_loses_its_energy_and_never_gains_a_hundredth() {
        for stiffness in [1.0, 100.0, 1e4] {
            let joint = joint(stiffness, 0.1 * (stiffness * INERTIA).sqrt());
            let mut knob = Knob { theta: 0.0, omega: 1.0 };
            let energy = |knob: &Knob<f64>| {
                let strain = (knob.theta.abs() - 0.5 * GAP).max(0.0);
                0.5 * INERTIA * knob.omega * knob.omega + 0.5 * stiffness * strain * strain
            };
            let start = energy(&knob);
            for _ in 0..40_000 {
                knob = knob.stepped(&joint, INERTIA, 0.0, 0.0, [0.0, 0.0], STEP_S).0;
                assert!(energy(&knob) < 1.01 * start, "{stiffness}: {}", energy(&knob) / start);
            }
            assert!(energy(&knob) < 0.1 * start, "{stiffness}: {}", energy(&knob) / start);
        }
    }

    #[test]
    fn friction_stops_the_knob_and_does_not_turn_it_round() {
        let (knob, _) = Knob { theta: 0.0, omega: 0.01 }.stepped(
            &joint(1.0, 0.0),
            INERTIA,
            0.0,
            0.05,
            [0.0, 0.0],
            STEP_S,
        );
        assert_eq!(knob.omega, 0.0);
    }
}
