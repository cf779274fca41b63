//! What goes into an effect and what comes out: sign conventions and units, in one place.
//!
//! `tau` is the torque that the rig applies to move the knob (N m; N on a linear axis). Friction has the
//! sign of omega: the rig must push with it. Resistances are magnitudes.

use crate::scalar::Scalar;

/// The motion of the knob at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Motion<T> {
    /// Time since the start of the capture, s.
    pub t: T,
    /// Angle, rad (m on a linear axis).
    pub theta: T,
    /// Angular velocity, rad/s.
    pub omega: T,
    /// Angular acceleration, rad/s^2.
    pub alpha: T,
    /// How far the motion is known to go forward: 1 forward, 0 backward, between them where the sign of
    /// a measured omega is not certain (the probability that it is positive).
    pub forward: T,
}

impl<T: Scalar> Motion<T> {
    /// A motion that is known exactly, so that `forward` is the sign of omega alone.
    #[inline(always)]
    pub fn exact(t: T, theta: T, omega: T, alpha: T) -> Self {
        let (one, half, zero) = (T::of(1.0), T::of(0.5), T::of(0.0));
        let forward = omega.where_positive(one, (-omega).where_positive(zero, half));
        Self { t, theta, omega, alpha, forward }
    }

    /// The weights of the backward and of the forward direction; they add up to one.
    #[inline(always)]
    pub fn directions(&self) -> [T; 2] {
        [T::of(1.0) - self.forward, self.forward]
    }
}

/// What an effect asks of the rig. Loads add up.
#[derive(Debug, Clone, Copy)]
pub struct Load<T> {
    /// Torque that pushes, N m.
    pub drive: T,
    /// Dry friction, N m: magnitudes when moving backward and forward. It may only oppose motion.
    pub resist: [T; 2],
    /// Stored inertia, kg m^2 (kg).
    pub inertia: T,
    /// Static friction, N m: magnitudes that hold the knob backward and forward while it sticks.
    pub hold: [T; 2],
    /// Speed below which the knob counts as stuck, rad/s.
    pub band: T,
}

impl<T: Scalar> Load<T> {
    /// Nothing at all.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = T::of(0.0);
        Self { drive: zero, resist: [zero; 2], inertia: zero, hold: [zero; 2], band: zero }
    }

    /// A torque that pushes.
    #[inline(always)]
    pub fn drive(tau: T) -> Self {
        Self { drive: tau, ..Self::none() }
    }

    /// Both loads together.
    #[inline(always)]
    pub fn plus(self, o: Self) -> Self {
        Self {
            drive: self.drive + o.drive,
            resist: [self.resist[0] + o.resist[0], self.resist[1] + o.resist[1]],
            inertia: self.inertia + o.inertia,
            hold: [self.hold[0] + o.hold[0], self.hold[1] + o.hold[1]],
            band: self.band + o.band,
        }
    }

    /// Spends the friction budget while the knob moves: inverse dynamics, N m.
    #[inline(always)]
    pub fn sliding(&self, motion: &Motion<T>) -> T {
        let [back, forth] = motion.directions();
        self.drive + self.inertia * motion.alpha + self.resist[1] * forth - self.resist[0] * back
    }

    /// Spends the friction budget while the knob is stuck: friction answers the torque `tau_other` that
    /// would otherwise move it, as far as static friction reaches (Karnopp 1985; Equation 2, with D in
    /// the stick branch).
    #[inline(always)]
    pub fn sticking(&self, tau_other: T) -> T {
        tau_other.min(self.hold[1]).max(-self.hold[0])
    }
}
