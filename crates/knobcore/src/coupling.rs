//! The hidden knob: where shaft and knob are not one, the knob's own motion is simulated from the shaft's.
//!
//! Two bodies (Nordin & Gutman 2002, "Controlling mechanical systems with backlash"): the shaft, whose motion is
//! measured, with a share of the inertia; the knob with the rest and with every load. Between them a spring and a
//! damper, after a free play. Contact is stiff and friction dry, so both are implicit: the trapezoidal rule for
//! the joint, and friction that stops the knob at the end of a step if it can (Moreau 1988).
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
    let Some(joint) = model.joint(p) else { return };
    let [t, theta, omega, alpha, _] = shaft.motion;
    let substeps = shaft.substeps.max(1);
    let mut state = vec![T::of(0.0); model.states()];
    let first = |column: &[f64]| T::of(column.first().copied().unwrap_or(0.0));
    let mut knob = Knob { theta: first(theta), omega: first(omega) };
    let inertia = model
        .load(p, &mut state.clone(), &Motion::exact(first(t), knob.theta, knob.omega, T::of(0.0)))
        .inertia;
    let (own, shafts) = (joint.share * inertia, (T::of(1.0) - joint.share) * inertia);
    for at in 0..t.len() {
        let force = contact(&joint, T::of(theta[at]) - knob.theta, T::of(omega[at]) - knob.omega);
        out(at, shafts * T::of(alpha[at]) + force);
        let next = (at + 1).min(t.len() - 1);
        let span = t[next] - t[at];
        if span <= 0.0 {
            continue;
        }
        let h = span / substeps as f64;
        let more = more(at).zip(more(next));
        let mut from = theta[at];
        for step in 1..=substeps {
            let share = |steps: usize| steps as f64 / substeps as f64;
            let to = hermite([theta[at], theta[next]], [omega[at] * span, omega[next] * span], share(step));
            let clock = t[at] + (step - 1) as f64 * h;
            let motion = Motion::exact(T::of(clock), knob.theta, knob.omega, T::of(0.0));
            let load = model.load(p, &mut state, &motion);
            let half = T::of(0.5);
            let (forth, back) = if model.is_plain() {
                (load.resist[1], -load.resist[0])
            } else {
                (load.friction(T::of(1.0)), load.friction(T::of(0.0)))
            };
            let friction = (half * (forth - back)).max(T::of(0.0));
            let mut push = load.drive + half * (forth + back);
            if let Some((from, to)) = more {
                push = push + from + T::of(share(step - 1)) * (to - from);
            }
            knob = knob.stepped(&joint, own, push, friction, [from, to], h);
            from = to;
        }
    }
}

/// The angle of the shaft after a share `u` of a sample, by the cubic through its angles and speeds.
fn hermite([a, b]: [f64; 2], [da, db]: [f64; 2], u: f64) -> f64 {
    let v = 1.0 - u;
    v * v * (1.0 + 2.0 * u) * a + u * u * (1.0 + 2.0 * v) * b + u * v * (v * da - u * db)
}

/// How far the joint is strained: what `twist` has beyond the free play.
#[inline(always)]
fn strain<T: Scalar>(joint: &Joint<T>, twist: T) -> T {
    let half = T::of(0.5) * joint.gap;
    twist - twist.min(half).max(-half)
}

/// Torque of the joint on the knob at a twist and its rate; two surfaces that touch push and never pull.
#[inline(always)]
fn contact<T: Scalar>(joint: &Joint<T>, twist: T, rate: T) -> T {
    let strain = strain(joint, twist);
    let force = joint.stiffness * strain + joint.damping * rate;
    pushing(joint, strain, force)
}

#[inline(always)]
fn pushing<T: Scalar>(joint: &Joint<T>, strain: T, force: T) -> T {
    if joint.welded { force } else { (force * strain).where_positive(force, T::of(0.0)) }
}

impl<T: Scalar> Knob<T> {
    /// One step of `h` seconds: the shaft moves from one angle to the next, `push` is what loads the knob and
    /// `friction` what may oppose its motion.
    #[inline(always)]
    fn stepped(&self, joint: &Joint<T>, inertia: T, push: T, friction: T, shaft: [f64; 2], h: f64) -> Self {
        let (h, half) = (T::of(h), T::of(0.5));
        let speed = T::of(shaft[1] - shaft[0]) / h;
        let twist = T::of(shaft[0]) - self.theta;
        let (strain, ahead) = (strain(joint, twist), strain(joint, twist + h * (speed - self.omega)));
        // The share of the step in which the surfaces touch; so contact that begins a little later changes little.
        let way = (h * (speed - self.omega)).abs() + T::of(f64::MIN_POSITIVE);
        let one = T::of(1.0);
        let share = if joint.welded { one } else { one.min((strain.abs() + ahead.abs()) / way) };
        // The trapezoidal rule: force = fixed - drag * (speed at the end of the step).
        let stiff = share * joint.stiffness * half * h + joint.damping;
        let fixed = joint.stiffness * strain + stiff * (speed - half * self.omega);
        let drag = half * stiff;
        let force = pushing(joint, strain + ahead, fixed - drag * self.omega);
        let touches = share * (force * force).where_positive(one, T::of(0.0));
        let weight = inertia / h + touches * drag;
        let free = (inertia / h * self.omega + touches * fixed - push) / weight;
        let stop = friction / weight;
        let omega = free - free.min(stop).max(-stop);
        Self { theta: self.theta + half * h * (self.omega + omega), omega }
    }
}
