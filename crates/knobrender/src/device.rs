//! The force-feedback device that a model is rendered on, and what it allows.

use super::nature::Nature;
use knobcore::error::{Error, Result};
use knobcore::param::Axis;
use knobcore::prelude::*;
use knobcore::scalar::Scalar;

/// A force-feedback device: what a motor with its handle adds to whatever it renders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Device {
    /// Inertia of all that moves with the handle, kg m^2 (kg).
    pub inertia: f64,
    /// Its viscous damping, N m s/rad.
    pub damping: f64,
    /// Whole samples from a measurement to the torque that answers it.
    pub delay: usize,
    /// Largest torque of the motor, N m; infinite if there is no limit.
    pub torque_limit: f64,
    /// Fastest change of torque, N m/s; infinite if there is no limit.
    pub torque_rate_limit: f64,
    /// Smallest angle that its encoder tells apart, rad; 0 if it resolves everything.
    pub encoder_step: f64,
    /// Whether a rig holds the handle and imposes its motion. Then all that the device adds is taken off; a free
    /// handle is never made lighter than it is, for what acts late would create energy.
    pub held: bool,
}

impl Device {
    /// An angle as its encoder tells it, rad.
    pub fn counted(&self, theta: f64) -> f64 {
        let step = self.encoder_step;
        if step > 0.0 { (theta / step).round() * step } else { theta }
    }

    /// From a measurement to the middle of the sample in which the torque that answers it acts, s.
    pub fn late_s(&self, dt: f64) -> f64 {
        (self.delay as f64 + 0.5) * dt
    }

    /// Checks that such a device can be.
    ///
    /// # Errors
    /// Names the quantity that cannot be.
    pub fn checked(self) -> Result<Self> {
        let positive = |name: &str, x: f64, least: bool| {
            if (least && x >= 0.0 || x > 0.0) && !x.is_nan() {
                return Ok(());
            }
            let bound = if least { "from 0 on" } else { "above 0" };
            Err(Error::invalid(format!("device {name}"), format!("is {x}; give one {bound}")))
        };
        positive("inertia", self.inertia, false)?;
        positive("damping", self.damping, true)?;
        positive("encoder step", self.encoder_step, true)?;
        positive("torque limit", self.torque_limit, false)?;
        positive("torque-rate limit", self.torque_rate_limit, false)?;
        if ![self.inertia, self.damping, self.encoder_step].into_iter().all(f64::is_finite) {
            let why = "has an infinite inertia, damping or encoder step; give finite ones";
            return Err(Error::invalid("device", why));
        }
        if self.delay > 1000 {
            return Err(Error::invalid("device delay", format!("is {} samples; at most 1000", self.delay)));
        }
        Ok(self)
    }
}

/// What the step does differently on one device and on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tuning {
    /// How far ahead of the measurement the torque acts, s: the model is evaluated at the angle there.
    pub ahead_s: f64,
    /// The same for the speed, which takes the acceleration: only where nothing can ring by it.
    pub rush_s: f64,
    /// Stiffness that ties a stuck knob to where it stuck, N m/rad.
    pub stiffness: f64,
    /// The same where the torque of the hand is known and does most of the holding.
    pub weak: f64,
    /// Damping of a stuck knob, N m s/rad.
    pub damping: f64,
    /// Angle that the encoder does not tell from another, rad.
    pub count: f64,
    /// Share of the present in the acceleration that inertia is rendered with; 1 is no filter.
    pub freshness: f64,
    /// Inertia and damping that are rendered beside the model's: negative where the device's own are taken off.
    pub own: [f64; 2],
    /// Stiffness and damping that a joint of the model is cut to.
    pub stiffest: [f64; 2],
}

/// Stiffness and damping that a sampled spring on an inertia J with the delay T may have, in units of J/T^2 and
/// J/T. The loop (0.05 + 0.4 s) e^-s / s^2 has a phase margin of 50 degrees and a gain margin of 3.6.
pub(super) const SPRING: [f64; 2] = [0.05, 0.4];
/// Damping that a spring needs, in units of the square root of stiffness times inertia.
const DAMPED: f64 = 1.6;
/// A stuck knob whose hand is measured is held by this share of the stiffness.
const WEAK: f64 = 0.1;
/// Share of what holds a knob by which one count of the encoder may change the torque.
const PER_COUNT: f64 = 0.1;
/// Inertia of a handle that nobody described, kg m^2 and kg.
const USUAL: [f64; 2] = [3e-5, 0.03];
/// Count of an encoder that nobody described (that of the paper's), rad.
const USUAL_COUNT: f64 = 9.8e-6;
/// The stiffness and damping that no joint is cut to.
const UNCUT: [f64; 2] = [f64::INFINITY, 0.0];
/// A speed that no sensor tells from rest, rad/s.
pub(super) const SLOWEST: f64 = 1e-3;
/// A twentieth of the finest step of a velocity (that of the paper's sensor), rad/s: whatever is not zero is
/// a direction.
const DIRECTED: f64 = 1e-5;
/// Rendered inertia that is beyond this share of the device's own is filtered.
const LIGHT: f64 = 0.3;

impl Tuning {
    /// For a device of which nothing is known, where torque acts after a sample: the model as it is.
    pub fn faithful(axis: Axis, nature: &Nature, dt: f64) -> Self {
        let inertia = if axis == Axis::Linear { USUAL[1] } else { USUAL[0] };
        let [stiffness, damping] = spring(inertia, dt, nature, USUAL_COUNT);
        Self {
            ahead_s: 0.0,
            rush_s: 0.0,
            stiffness,
            weak: WEAK * stiffness,
            damping,
            count: 0.0,
            freshness: 1.0,
            own: [0.0; 2],
            stiffest: UNCUT,
        }
    }

    /// For a known device.
    ///
    /// Torque that follows a delayed acceleration is stable by its small gain alone: at the frequency 1/(4 T)
    /// where delay and filter have turned its phase round, it has to be well below the device's own inertia.
    pub fn of(device: &Device, nature: &Nature, dt: f64) -> Self {
        let late = device.late_s(dt);
        // A rig that imposes the motion looks at the torque when it begins to act, a hand feels its mean.
        let instant = device.delay as f64 * dt;
        let [stiffness, damping] = if device.held {
            firm(nature, device.encoder_step)
        } else {
            spring(device.inertia, late, nature, device.encoder_step)
        };
        let own = if device.held {
            [-device.inertia, -device.damping]
        } else {
            [-device.inertia.min(nature.inertia), 0.0]
        };
        // The acceleration is a mean over the sample before: half a sample older than the angle.
        let turn = late + 0.5 * dt;
        let extra = (nature.surge + own[0]) / device.inertia;
        let filtered = !device.held && extra > LIGHT;
        let corner = if filtered { turn * core::f64::consts::FRAC_2_PI * extra / LIGHT } else { 0.0 };
        Self {
            ahead_s: if device.held { instant } else { late },
            rush_s: if device.held { instant } else { 0.0 },
            stiffness,
            weak: WEAK * stiffness,
            damping,
            count: device.encoder_step,
            freshness: 1.0 - Scalar::exp(-dt / corner),
            own,
            // Where the motion is imposed and its angle is exact nothing rings, and no count shakes a joint.
            stiffest: if device.held && device.encoder_step == 0.0 { UNCUT } else { [stiffness, damping] },
        }
    }
}

/// Stiffness and damping that hold a stuck knob on this inertia under this delay, beside the knob's own damping.
fn spring(inertia: f64, late_s: f64, nature: &Nature, count: f64) -> [f64; 2] {
    let stable = SPRING[0] * inertia / (late_s * late_s);
    let fine = if count > 0.0 && nature.hold > 0.0 { PER_COUNT * nature.hold / count } else { stable };
    let stiffness = stable.min(fine);
    let most = (SPRING[1] * inertia / late_s - nature.damping - nature.stiffness * late_s).max(0.0);
    [stiffness, most.min(DAMPED * (stiffness * inertia).sqrt())]
}

/// The same on a handle whose motion is imposed: nothing can ring, and a reversal is to be as sharp as the sensors.
fn firm(nature: &Nature, count: f64) -> [f64; 2] {
    let hold = nature.hold.max(f64::MIN_POSITIVE);
    [hold / count.max(USUAL_COUNT), hold / DIRECTED]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nature(inertia: f64) -> Nature {
        Nature { inertia, surge: inertia, hold: 0.02, stiffness: 0.0, damping: 0.0, dissipates: true }
    }

    fn device(held: bool) -> Device {
        Device {
            inertia: 5e-5,
            damping: 1e-3,
            delay: 1,
            torque_limit: 1.0,
            torque_rate_limit: 1e4,
            encoder_step: 1e-5,
            held,
        }
    }

    #[test]
    fn inertia_is_filtered_where_a_hand_could_make_it_ring_and_nowhere_else() {
        let freshness =
            |inertia: f64, held: bool| Tuning::of(&device(held), &nature(inertia), 2e-4).freshness;
        // Beside the device's own.
        assert_eq!(freshness(6e-5, false), 1.0);
        assert!(freshness(2e-4, false) < 1.0 && freshness(4e-4, false) < freshness(2e-4, false));
        assert_eq!(freshness(4e-4, true), 1.0);
    }

    #[test]
    fn a_spring_that_holds_is_damped_as_far_as_the_delay_allows() {
        let late = device(false).late_s(2e-4);
        let damping = |damping: f64, stiffness: f64| {
            spring(5e-5, late, &Nature { damping, stiffness, ..nature(0.0) }, 0.0)[1]
        };
        let free = damping(0.0, 0.0);
        let most = SPRING[1] * 5e-5 / late;
        assert!(free <= most && free > 0.0);
        // What the knob itself damps, and what its stiffness takes off by being late, is no longer there.
        assert!((damping(0.9 * most, 0.0) - 0.1 * most).abs() < 1e-12);
        assert!((damping(0.0, 0.9 * most / late) - 0.1 * most).abs() < 1e-12);
        assert_eq!(damping(2.0 * most, 0.0), 0.0);
    }

    #[test]
    fn on_a_handle_that_is_held_a_count_or_the_slowest_motion_meets_all_friction() {
        let held = Tuning::of(&device(true), &nature(1e-4), 2e-4);
        assert!((held.stiffness * device(true).encoder_step / 0.02 - 1.0).abs() < 1e-12);
        assert!((held.damping * DIRECTED / 0.02 - 1.0).abs() < 1e-12);
        assert_eq!(held.stiffest, [held.stiffness, held.damping]);
        let exact = Tuning::of(&Device { encoder_step: 0.0, ..device(true) }, &nature(1e-4), 2e-4);
        assert_eq!(exact.stiffest, UNCUT);
        // What the handle adds is taken off, all of it; of a free one no more than the model has.
        assert_eq!(held.own, [-5e-5, -1e-3]);
        assert_eq!(Tuning::of(&device(false), &nature(1e-4), 2e-4).own, [-5e-5, 0.0]);
        assert_eq!(Tuning::of(&device(false), &nature(2e-5), 2e-4).own, [-2e-5, 0.0]);
    }
}
