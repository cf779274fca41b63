//! Loads: what effects ask of the rig, together.

use super::{Channel, Motion, Touched};
use crate::scalar::Scalar;

/// What an effect asks of the rig. Loads of several effects come together in [`Load::plus`].
#[derive(Debug, Clone, Copy)]
pub struct Load<T> {
    /// Torque that pushes, N m.
    pub drive: T,
    /// The part of `drive` that presses the sliding surfaces together where it arises, N m (what detents do).
    pub normal_load: T,
    /// The part of `drive` that comes from elsewhere by position, such as of gravity and springs, N m: it presses where
    /// the sliding surfaces hand it on.
    pub position_load: T,
    /// Dry friction, N m: magnitudes when moving backward and forward. It may only oppose motion.
    pub resist: [T; 2],
    /// Factor on the dry friction; the factors of several effects multiply.
    pub friction_scale: T,
    /// Dry friction per load that presses the sliding surfaces together.
    pub mu: T,
    /// Share of `position_load` that is handed on through them.
    pub position_share: T,
    /// Share of the inertia whose torque is.
    pub inertia_share: T,
    /// How far dry friction is from following the sign of the motion: 0 fully, -2 still fully backward in a
    /// forward motion, +2 the other way round.
    pub hysteresis: T,
    /// The share of dry friction that does not turn round with the motion: of `hysteresis`, what there would be less of
    /// for each unit of direction.
    pub builds_up: T,
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
        Self {
            drive: zero,
            normal_load: zero,
            position_load: zero,
            resist: [zero; 2],
            friction_scale: T::of(1.0),
            mu: zero,
            position_share: zero,
            inertia_share: zero,
            hysteresis: zero,
            builds_up: zero,
            inertia: zero,
            hold: [zero; 2],
            band: zero,
        }
    }

    /// A torque that pushes.
    #[inline(always)]
    pub fn drive(tau: T) -> Self {
        Self { drive: tau, ..Self::none() }
    }

    /// A torque that pushes by position, from beyond whatever slides.
    #[inline(always)]
    pub fn position(tau: T) -> Self {
        Self { drive: tau, position_load: tau, ..Self::none() }
    }

    /// A torque that pushes, and presses the sliding surfaces together as it does.
    #[inline(always)]
    pub fn detent(tau: T) -> Self {
        Self { drive: tau, normal_load: tau, ..Self::none() }
    }

    /// A factor on the dry friction.
    #[inline(always)]
    pub fn friction_scale(factor: T) -> Self {
        Self { friction_scale: factor, ..Self::none() }
    }

    /// Both loads together: they add up, but for the factors on friction, which multiply.
    #[inline(always)]
    pub fn plus(mut self, o: Self) -> Self {
        self.join(&o, Channel::among(Channel::ALL));
        self
    }

    /// Brings a load in that touches these channels alone.
    #[inline(always)]
    pub fn join(&mut self, o: &Self, touched: Touched) {
        let touches = |channel: Channel| touched[channel as usize];
        if touches(Channel::Drive) {
            self.drive = self.drive + o.drive;
        }
        if touches(Channel::Inertia) {
            self.inertia = self.inertia + o.inertia;
        }
        if touches(Channel::Back) {
            self.resist[0] = self.resist[0] + o.resist[0];
        }
        if touches(Channel::Forth) {
            self.resist[1] = self.resist[1] + o.resist[1];
        }
        if touches(Channel::NormalLoad) {
            self.normal_load = self.normal_load + o.normal_load;
        }
        if touches(Channel::PositionLoad) {
            self.position_load = self.position_load + o.position_load;
        }
        if touches(Channel::FrictionScale) {
            self.friction_scale = self.friction_scale * o.friction_scale;
        }
        if touches(Channel::Mu) {
            self.mu = self.mu + o.mu;
        }
        if touches(Channel::PositionShare) {
            self.position_share = self.position_share + o.position_share;
        }
        if touches(Channel::InertiaShare) {
            self.inertia_share = self.inertia_share + o.inertia_share;
        }
        if touches(Channel::Hysteresis) {
            self.hysteresis = self.hysteresis + o.hysteresis;
            self.builds_up = self.builds_up + o.builds_up;
        }
        if touches(Channel::Stick) {
            self.hold = [self.hold[0] + o.hold[0], self.hold[1] + o.hold[1]];
            self.band = self.band + o.band;
        }
    }

    /// What presses the sliding surfaces together at a constant speed, N m.
    #[inline(always)]
    pub fn presses(&self) -> T {
        self.normal_load + at_most_all(self.position_share) * self.position_load
    }

    /// The share of the inertia whose torque presses besides.
    #[inline(always)]
    pub fn carried(&self) -> T {
        at_most_all(self.inertia_share)
    }

    /// The same at this acceleration.
    #[inline(always)]
    fn pressed(&self, alpha: T) -> T {
        self.presses() + self.carried() * self.inertia * alpha
    }

    /// What presses them where they hand on all that there is, N m.
    pub fn pressing(&self, alpha: T) -> T {
        self.normal_load + self.position_load + self.inertia * alpha
    }

    /// In a motion that goes forward with the probability `forward`: the dry friction whatever presses, N m, and what
    /// there is more of it per load that presses.
    #[inline(always)]
    pub fn rubs(&self, forward: T) -> [T; 2] {
        self.rubs_with(self.hysteresis, forward)
    }

    /// The same backward and forward, of a load that was looked at in a motion of this direction: friction that builds up
    /// over a distance does not turn round at once, whichever way the knob goes on.
    #[inline(always)]
    pub fn rubs_either_way(&self, direction: T) -> [[T; 2]; 2] {
        [-1.0, 1.0].map(|way| {
            let hysteresis = self.hysteresis + self.builds_up * (direction - T::of(way));
            self.rubs_with(hysteresis, T::of(0.5 * (1.0 + way)))
        })
    }

    #[inline(always)]
    fn rubs_with(&self, hysteresis: T, forward: T) -> [T; 2] {
        let forth = forward + T::of(0.5) * hysteresis;
        let back = T::of(1.0) - forth;
        let unpressed = (self.resist[1] * forth - self.resist[0] * back) * self.friction_scale;
        [unpressed, self.mu * (forth - back)]
    }

    /// Spends the friction budget while the knob moves, forward with the probability `forward`, N m.
    #[inline(always)]
    pub fn friction(&self, forward: T, alpha: T) -> T {
        let [unpressed, per_load] = self.rubs(forward);
        unpressed + per_load * self.pressed(alpha).abs()
    }

    /// Magnitude of the friction that follows the sign of the motion, N m.
    #[inline(always)]
    pub fn dry(&self, forward: T, alpha: T) -> T {
        let back = T::of(1.0) - forward;
        (self.resist[0] * back + self.resist[1] * forward) * self.friction_scale
            + self.mu * self.pressed(alpha).abs()
    }

    /// Friction that a spring among the effects holds whichever way the knob would go, N m: of the hysteresis of both ways,
    /// this one backward and that forward, the mean is what it is strained by.
    #[inline]
    pub fn strained(&self, forth: &Self, alpha: T) -> T {
        let half = T::of(0.5);
        half * (self.hysteresis + forth.hysteresis) * forth.dry(half, alpha)
    }

    /// Torque on the moving knob: inverse dynamics, N m.
    #[inline(always)]
    pub fn sliding(&self, motion: &Motion<T>) -> T {
        self.drive + self.inertia * motion.alpha + self.friction(motion.forward, motion.alpha)
    }

    /// Spends the friction budget while the knob is stuck: friction answers the torque `tau_other` that
    /// would otherwise move it, as far as static friction reaches (Karnopp 1985; Equation 2, with D in
    /// the stick branch).
    #[inline(always)]
    pub fn sticking(&self, tau_other: T) -> T {
        tau_other.min(self.hold[1]).max(-self.hold[0])
    }
}

/// Shares of several effects that rub together: what slides hands on no more than there is.
#[inline(always)]
fn at_most_all<T: Scalar>(share: T) -> T {
    let one = T::of(1.0);
    (share - one).where_positive(one, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_add_channel_by_channel_and_factors_on_friction_multiply() {
        let load = |k: f64| Load {
            drive: k,
            normal_load: 2.0 * k,
            position_load: 3.0 * k,
            resist: [4.0 * k, 5.0 * k],
            friction_scale: 6.0 * k,
            mu: 7.0 * k,
            position_share: 8.0 * k,
            inertia_share: 9.0 * k,
            hysteresis: 10.0 * k,
            builds_up: 15.0 * k,
            inertia: 11.0 * k,
            hold: [12.0 * k, 13.0 * k],
            band: 14.0 * k,
        };
        let channels = |load: &Load<f64>| {
            let [back, forth] = load.resist;
            let others = [
                load.mu,
                load.position_share,
                load.inertia_share,
                load.hysteresis,
                load.inertia,
                load.builds_up,
            ];
            [&[load.drive, load.normal_load, load.position_load, back, forth], &others[..], &load.hold]
                .concat()
        };
        let mut both = load(1.0);
        both.join(&load(3.0), Channel::among(Channel::ALL));
        assert_eq!(channels(&both), channels(&load(4.0)));
        assert_eq!(both.friction_scale, 6.0 * 18.0);
        // Beside nothing each is itself.
        let mut alone = Load::none();
        alone.join(&load(2.0), Channel::among(Channel::ALL));
        assert_eq!((channels(&alone), alone.friction_scale), (channels(&load(2.0)), 12.0));
        let mut drive = load(1.0);
        drive.join(&load(3.0), Channel::among(&[Channel::Drive]));
        assert_eq!((drive.drive, drive.inertia, drive.friction_scale), (4.0, 11.0, 6.0));
    }
}
