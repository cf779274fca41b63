//! What goes into an effect and what comes out: sign conventions and units, in one place.
//!
//! `tau` is the torque that the rig applies to move the knob (N m; N on a linear axis). Friction has the
//! sign of omega: the rig must push with it. Resistances are magnitudes.

mod load;

pub use load::Load;

use crate::scalar::{Packed, Scalar};

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

    /// Every quantity through the same conversion.
    #[inline(always)]
    pub fn map<U>(&self, mut f: impl FnMut(T) -> U) -> Motion<U> {
        Motion {
            t: f(self.t),
            theta: f(self.theta),
            omega: f(self.omega),
            alpha: f(self.alpha),
            forward: f(self.forward),
        }
    }

    /// The weights of the backward and of the forward direction; they add up to one.
    #[inline(always)]
    pub fn directions(&self) -> [T; 2] {
        [T::of(1.0) - self.forward, self.forward]
    }

    /// The expected sign of the velocity: 1 forward, -1 backward.
    #[inline(always)]
    pub fn direction(&self) -> T {
        self.forward + self.forward - T::of(1.0)
    }
}

impl<const L: usize> Motion<Packed<L>> {
    /// A pack of samples of columns (t, theta, omega, alpha, forward) of packs side by side. Written out: mapped over an
    /// array it is a call, which loads also what an effect does not look at.
    #[inline(always)]
    pub fn over([t, theta, omega, alpha, forward]: &[&[f64]; 5], at: usize) -> Self {
        Self {
            t: Packed::of_packs(t, at),
            theta: Packed::of_packs(theta, at),
            omega: Packed::of_packs(omega, at),
            alpha: Packed::of_packs(alpha, at),
            forward: Packed::of_packs(forward, at),
        }
    }
}

/// A way in which a load acts on a moving knob: a field of [`Load`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// `drive`.
    Drive,
    /// `inertia`.
    Inertia,
    /// `resist`, backward.
    Back,
    /// `resist`, forward.
    Forth,
    /// `friction_scale`.
    FrictionScale,
    /// `hysteresis`.
    Hysteresis,
    /// `normal_load`.
    NormalLoad,
    /// `position_load`.
    PositionLoad,
    /// `mu`.
    Mu,
    /// `position_share`.
    PositionShare,
    /// `inertia_share`.
    InertiaShare,
    /// `hold` and `band`: only a knob at rest feels them.
    Stick,
}

/// Which channels a load may differ in from [`Load::none`].
pub type Touched = [bool; Channel::ALL.len()];

impl Channel {
    /// Every channel. The first four suffice where nothing shapes the friction, the first six where
    /// none of it grows with a load; the last one no moving knob feels.
    pub const ALL: &'static [Self] = &[
        Self::Drive,
        Self::Inertia,
        Self::Back,
        Self::Forth,
        Self::FrictionScale,
        Self::Hysteresis,
        Self::NormalLoad,
        Self::PositionLoad,
        Self::Mu,
        Self::PositionShare,
        Self::InertiaShare,
        Self::Stick,
    ];

    /// Which of all channels are among these.
    pub const fn among(these: &[Self]) -> Touched {
        let (mut mask, mut i) = ([false; Self::ALL.len()], 0);
        while i < these.len() {
            mask[these[i] as usize] = true;
            i += 1;
        }
        mask
    }

    /// Whether a load by these channels presses the sliding surfaces together, by position.
    pub const fn press(these: &[Self]) -> bool {
        let mask = Self::among(these);
        mask[Self::NormalLoad as usize] || mask[Self::PositionLoad as usize]
    }

    /// Whether one of these channels shapes the friction of other effects.
    pub const fn shape_friction(these: &[Self]) -> bool {
        let mask = Self::among(these);
        mask[Self::FrictionScale as usize] || mask[Self::Mu as usize] || mask[Self::Hysteresis as usize]
    }
}
