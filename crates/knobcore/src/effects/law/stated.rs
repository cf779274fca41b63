//! A formula as a [`Law`]: by the same numbers as the catalogue's functions, wherever those are evaluated.

use super::{LEAST, Law, NARROW};
use crate::effects::formula::{Formula, Room, STATES, follow};
use crate::effects::{Info, Place};
use crate::local::local;
use crate::motion::{Channel, Load, Motion};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Parameter values that are kept of what fails.
const TOLD: usize = 12;

/// Where a law had no value: which, what it answered, its motion and parameters. In place, since a rendered step may
/// neither allocate nor wait.
#[derive(Clone, Copy)]
struct Failure {
    of: &'static Info,
    answer: f64,
    theta: f64,
    omega: f64,
    p: [f64; TOLD],
}

local! {
    /// What went wrong last on this thread: two fits at a time do not see each other's.
    static FAILED: Option<Failure> = None;
}

/// An effect that is written as a formula: a load, friction under one, a factor on the dry friction, or what a sensor adds.
pub struct Stated {
    pub(super) info: &'static Info,
    /// Its formula.
    pub law: Formula,
}

impl Stated {
    /// The effect of this row of the catalogue.
    pub(crate) fn new(info: &'static Info, law: Formula) -> Self {
        Self { info, law }
    }

    pub(super) fn loads(&self) -> bool {
        self.info.place == Place::Load
    }

    pub(super) fn channel(&self) -> Channel {
        self.info.touches.first().copied().unwrap_or(Channel::Drive)
    }

    /// Where it had no value since this was last asked on this thread.
    pub(crate) fn failure(&self) -> Option<String> {
        let failed = FAILED.get().filter(|failed| core::ptr::eq(failed.of, self.info))?;
        FAILED.set(None);
        let Failure { answer, theta, omega, p, .. } = failed;
        let values = self.info.with_values(&p);
        Some(format!("returned {answer} at theta = {theta}, omega = {omega} (with {values}); {NARROW}"))
    }

    /// That parameters are no numbers is no failure of the law.
    #[cold]
    pub(super) fn fail(&self, p: &[f64], answer: f64, [theta, omega]: [f64; 2]) {
        let told = FAILED.get().is_some_and(|failed| core::ptr::eq(failed.of, self.info));
        if !told && p.iter().all(|x| x.is_finite()) {
            let p = core::array::from_fn(|i| p.get(i).copied().unwrap_or(0.0));
            FAILED.set(Some(Failure { of: self.info, answer, theta, omega, p }));
        }
    }

    /// Whether it has an inertia: the slope over the acceleration, which it is straight over.
    pub(super) fn stores(&self) -> bool {
        self.info.touches.contains(&Channel::Inertia)
    }

    /// Brings its load at one instant into a sum. What is no number stays none, so that who goes on from there notices.
    #[inline(always)]
    pub(super) fn add<T: Scalar>(&self, p: &[T], state: &mut [T], motion: &Motion<T>, sum: &mut Load<T>) {
        let distance = if self.law.remembers() { follow(state, motion) } else { T::ZERO };
        let mut room = Room::new();
        let own = if self.channel() == Channel::Mu {
            self.law.worked(&mut room, p, &Motion { forward: T::of(1.0), ..*motion }, distance)
        } else if self.stores() {
            let at = Motion { alpha: T::ZERO, ..*motion };
            let still = self.law.worked(&mut room, p, &at, distance);
            let at = Motion { alpha: T::of(1.0), ..at };
            sum.inertia = sum.inertia + self.law.worked(&mut room, p, &at, distance) - still;
            still
        } else {
            self.law.worked(&mut room, p, motion, distance)
        };
        let value = own.value();
        if !value.is_finite() {
            let mut values = [0.0; TOLD];
            values.iter_mut().zip(p).for_each(|(value, p)| *value = p.value());
            self.fail(&values, value, [motion.theta.value(), motion.omega.value()]);
        }
        match self.channel() {
            Channel::FrictionScale => {
                let factor = if value.is_finite() { own.max(T::of(LEAST)) } else { own };
                sum.friction_scale = sum.friction_scale * factor;
            }
            Channel::Mu => {
                sum.mu = sum.mu + own;
                sum.position_share = sum.position_share + T::of(1.0);
                sum.inertia_share = sum.inertia_share + T::of(1.0);
            }
            _ => sum.drive = sum.drive + own,
        }
    }
}

impl Law for Stated {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn states(&self) -> usize {
        if self.loads() && self.law.remembers() { STATES } else { 0 }
    }

    fn remembers(&self) -> bool {
        self.law.remembers()
    }

    fn load(&self, p: &[f64], state: &mut [f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        if self.loads() {
            self.add(p, state, motion, sum);
        }
    }
}
