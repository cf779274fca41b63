//! What a delay allows: which stiffness a device can render, and how far a model on it is from ringing.
//!
//! Two questions, which are not the same. *Passive*: can any hand at all make the device give out energy?
//! Colgate & Schenkel (1997, "Passivity of a class of sampled-data systems", their Equation 10) answer
//! b > K T/2 + |B| for a virtual spring K and damper B at the sampling time T; a further delay d adds to the T/2 of
//! the hold. *Stable*: does the device ring by itself, in no hand at all? That follows from the phase margin of the
//! loop through the delay, and is what a hand, which only adds damping, meets in practice.

use super::device::{Device, SPRING, Tuning};
use super::nature::Nature;
use knobcore::error::Result;
use knobcore::model::Model;
#[cfg(not(feature = "std"))]
use knobcore::prelude::*;
use knobcore::scalar::Scalar;

/// What [`check_stability`] found; SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// From a measurement to the torque that answers it, with half a sample for the hold, s.
    pub delay_s: f64,
    /// Greatest slope of the model's torque over angle, N m/rad.
    pub stiffness: f64,
    /// Greatest slope of the model's torque over speed, N m s/rad.
    pub damping: f64,
    /// Inertia of the model over that of the device.
    pub inertia_ratio: f64,
    /// Stiffness that this device renders with a phase margin of 50 degrees, N m/rad.
    pub allowed_stiffness: f64,
    /// Stiffness up to which no hand at all can draw energy out of it, N m/rad.
    pub passive_stiffness: f64,
    /// Damping that is left after Colgate & Schenkel's condition, N m s/rad: negative where some hand could draw
    /// energy out of the model's stiffest detent, dry friction not counted.
    pub passivity_margin: f64,
    /// Stiffness that holds a stuck knob, N m/rad.
    pub anchor_stiffness: f64,
    /// Phase margin of the loop in no hand while the knob slides, rad.
    pub sliding_margin: f64,
    /// The same while it sticks.
    pub sticking_margin: f64,
}

impl Stability {
    /// Whether the model does not ring on this device.
    pub fn is_stable(&self) -> bool {
        self.sliding_margin > 0.0 && self.sticking_margin > 0.0
    }
}

/// How stably a device renders a model at `rate_hz`.
///
/// # Errors
/// A device that cannot be.
pub fn check_stability(model: &Model, device: Device, rate_hz: f64) -> Result<Stability> {
    let device = device.checked()?;
    let dt = 1.0 / rate_hz;
    let p = model.values();
    let mut nature = Nature::of(model, &p, FASTEST);
    if let Some(joint) = model.joint(&p) {
        nature.stiffness = nature.stiffness.max(joint.stiffness);
    }
    let tuning = Tuning::of(&device, &nature, dt);
    let late = device.late_s(dt);
    let stiffness =
        if model.joint(&p).is_some() { nature.stiffness.min(tuning.stiffest[0]) } else { nature.stiffness };
    let damping = nature.damping.max(0.0);
    let sliding = Loop { device, tuning, dt, stiffness, damping, extra: nature.surge + tuning.own[0] };
    let sticking =
        Loop { stiffness: stiffness + tuning.stiffness, damping: damping + tuning.damping, ..sliding };
    Ok(Stability {
        delay_s: late,
        stiffness: nature.stiffness,
        damping: nature.damping,
        inertia_ratio: nature.inertia / device.inertia,
        allowed_stiffness: SPRING[0] * device.inertia / (late * late),
        passive_stiffness: (device.damping / late).max(0.0),
        passivity_margin: device.damping - stiffness * late - damping,
        anchor_stiffness: tuning.stiffness,
        sliding_margin: sliding.phase_margin(),
        sticking_margin: sticking.phase_margin(),
    })
}

/// Speeds up to which the model's damping counts, rad/s.
const FASTEST: f64 = 100.0;
/// Frequencies that are looked at, per factor of e.
const FINE: f64 = 200.0;

/// The linearised loop from the handle's angle through the model and the delay back to its torque.
#[derive(Debug, Clone, Copy)]
struct Loop {
    device: Device,
    tuning: Tuning,
    dt: f64,
    stiffness: f64,
    damping: f64,
    extra: f64,
}

impl Loop {
    /// Magnitude and phase (without the delay, within a turn) of the loop at `w` rad/s, and the delay's phase.
    fn at(&self, w: f64) -> (f64, f64) {
        let late = self.device.late_s(self.dt);
        // Looking ahead adds damping. A mass responds to an acceleration that is filtered and half a sample older.
        let damping = self.damping + self.stiffness * self.tuning.ahead_s;
        let lag = if self.tuning.freshness < 1.0 {
            -self.dt / Scalar::ln(1.0 - self.tuning.freshness)
        } else {
            0.0
        };
        let (sin, cos) = Scalar::sin_cos(0.5 * w * self.dt + (w * lag).atan());
        let mass = self.extra * w * w / (1.0 + w * lag * w * lag).sqrt();
        let answer = [self.stiffness - mass * cos, w * damping + mass * sin];
        let plant = [-self.device.inertia * w * w, self.device.damping * w];
        let size = answer[0].hypot(answer[1]) / plant[0].hypot(plant[1]);
        let phase = answer[1].atan2(answer[0]) - plant[1].atan2(plant[0]);
        (size, phase - w * late)
    }

    /// How far the phase is from turning the loop round where its size goes through one, rad; of several places
    /// the worst. pi where it is never that strong.
    fn phase_margin(&self) -> f64 {
        let top = core::f64::consts::PI / self.dt;
        let steps = (FINE * Scalar::ln(top / 0.1)) as usize;
        let mut worst = core::f64::consts::PI;
        let (mut before, mut last) = self.at(0.1);
        for step in 1..=steps {
            let (size, phase) = self.at(0.1 * Scalar::exp(step as f64 / FINE));
            if (before - 1.0) * (size - 1.0) <= 0.0 && before != size {
                worst = worst.min(core::f64::consts::PI + phase);
            }
            (before, last) = (size, phase);
        }
        if before >= 1.0 {
            // Still that strong at half the sampling rate: the delay has turned it round on the way.
            worst = worst.min((core::f64::consts::PI + last).min(0.0));
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knobcore::effects::Id;
    use knobcore::param::Axis;

    fn device(delay: usize) -> Device {
        Device {
            inertia: 5e-5,
            damping: 1e-3,
            delay,
            torque_limit: f64::INFINITY,
            torque_rate_limit: f64::INFINITY,
            encoder_step: 0.0,
            held: false,
        }
    }

    fn spring(k: f64) -> Model {
        let mut model = Model::new(&[Id::Inertia, Id::ReturnSpring], Axis::Rotary);
        model.set("inertia.M", 5e-5).unwrap();
        model.set("return_spring.k", k).unwrap();
        model
    }

    #[test]
    fn longer_delays_allow_less_stiffness() {
        let allowed: Vec<f64> = (0..=10)
            .map(|delay| check_stability(&spring(0.1), device(delay), 5000.0).unwrap().allowed_stiffness)
            .collect();
        assert!(allowed.windows(2).all(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn a_spring_is_passive_up_to_the_stiffness_of_colgate_and_schenkel() {
        // b = K T/2 at no further delay: K = 2 b / T.
        let found = check_stability(&spring(9.9), device(0), 5000.0).unwrap();
        assert!((found.passive_stiffness - 10.0).abs() < 1e-12);
        assert!(found.passivity_margin > 0.0);
        assert!(check_stability(&spring(10.1), device(0), 5000.0).unwrap().passivity_margin < 0.0);
    }

    #[test]
    fn the_allowed_stiffness_leaves_a_margin_and_ten_times_of_it_does_not() {
        for delay in [0, 1, 3, 10] {
            let allowed = check_stability(&spring(0.1), device(delay), 5000.0).unwrap().allowed_stiffness;
            assert!(check_stability(&spring(allowed), device(delay), 5000.0).unwrap().is_stable());
            assert!(!check_stability(&spring(30.0 * allowed), device(delay), 5000.0).unwrap().is_stable());
        }
    }

    /// A knob with every number of its own.
    fn rubbed() -> Model {
        let mut model = Model::new(&[Id::Inertia, Id::Coulomb, Id::Viscous, Id::ReturnSpring], Axis::Rotary);
        for (name, value) in [
            ("inertia.M", 2e-5),
            ("coulomb.neg", 0.03),
            ("coulomb.pos", 0.02),
            ("viscous.neg", 1e-3),
            ("viscous.pos", 2e-3),
            ("return_spring.k", 0.4),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    #[test]
    fn what_is_asked_of_a_device_is_what_the_model_has() {
        let device = device(1);
        let found = check_stability(&rubbed(), device, 5000.0).unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * b.abs();
        // One sample of delay and half a sample of the hold.
        let late = 1.5 * 2e-4;
        assert!(near(found.delay_s, late) && near(found.inertia_ratio, 0.4));
        assert!(near(found.stiffness, 0.4) && near(found.damping, 2e-3), "{found:?}");
        assert!(near(found.passivity_margin, device.damping - 0.4 * late - 2e-3), "{found:?}");
    }

    #[test]
    fn a_stuck_knob_is_tied_as_finely_as_its_friction_and_the_encoder_ask() {
        let tied = |encoder_step: f64, held: bool, times: f64| {
            let mut model = rubbed();
            model.set("coulomb.neg", times * 0.03).unwrap();
            model.set("coulomb.pos", times * 0.02).unwrap();
            let device = Device { encoder_step, held, ..device(1) };
            check_stability(&model, device, 5000.0).unwrap().anchor_stiffness
        };
        // A count changes the torque by a tenth of what holds the knob where it is held least; imposed, by all of it.
        assert!((tied(1e-2, false, 1.0) / (0.1 * 0.02 / 1e-2) - 1.0).abs() < 1e-9);
        assert!((tied(1e-3, true, 1.0) / (0.02 / 1e-3) - 1.0).abs() < 1e-9);
        assert!((tied(1e-2, false, 3.0) / tied(1e-2, false, 1.0) - 3.0).abs() < 1e-9);
        // Where counts are fine, delay and inertia are what limits it.
        assert!(
            tied(1e-9, false, 1.0) < 0.1 * 0.02 / 1e-9 && tied(1e-9, false, 3.0) == tied(1e-9, false, 1.0)
        );
    }

    #[test]
    fn the_margin_of_a_spring_and_a_mass_is_that_of_its_loop() {
        // A plain spring on a mass with nothing but delay: at the frequency where k / (J w^2) is one.
        let (k, late) = (0.02, 1.5 * 2e-4);
        let bare = Device { damping: 0.0, ..device(1) };
        let mut weightless = spring(k);
        weightless.set("inertia.M", 0.0).unwrap();
        let found = check_stability(&weightless, bare, 5000.0).unwrap();
        let w = (k / bare.inertia).sqrt();
        // The model is looked up where the knob will be when the torque acts: that takes back the delay, to first order.
        let taken_back = (w * late).atan();
        assert!((found.sliding_margin - (taken_back - w * late)).abs() < 0.02, "{found:?}");
    }

    /// The product of two complex numbers.
    fn times([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
        [a * c - b * d, a * d + b * c]
    }

    #[test]
    fn the_loop_is_that_of_its_equation() {
        // J s^2 + b s = -(k + (d + k ahead) s + M s^2 e^(-s T/2) / (1 + lag s)) e^(-s late).
        let (dt, late, lag, w0) = (2e-4, 1.5 * 2e-4, 7e-4, 300.0);
        for [k, d, extra] in [[0.3, 2e-3, 0.0], [0.3, 2e-3, 4e-4], [0.0, 0.0, 4e-4], [5.0, 0.0, 1e-5]] {
            let mut of = Loop {
                device: device(1),
                tuning: Tuning::of(&device(1), &Nature::of(&rubbed(), &rubbed().values(), 100.0), dt),
                dt,
                stiffness: k,
                damping: d,
                extra,
            };
            (of.tuning.ahead_s, of.tuning.freshness) = (late, 1.0 - (-dt / lag).exp());
            for w in [0.3 * w0, w0, 5.0 * w0, 20.0 * w0] {
                let turned = |by: f64| [by.cos(), -by.sin()];
                let filter = 1.0 / (1.0 + (w * lag).powi(2));
                let filtered = times([filter, -w * lag * filter], turned(0.5 * w * dt));
                let mass = times([-extra * w * w, 0.0], filtered);
                let answer = times([k + mass[0], w * (d + k * late) + mass[1]], turned(w * late));
                let plant = [-5e-5 * w * w, 1e-3 * w];
                let square = plant[0].powi(2) + plant[1].powi(2);
                let right = times(answer, [plant[0] / square, -plant[1] / square]);
                let (size, phase) = of.at(w);
                let found = [size * phase.cos(), size * phase.sin()];
                let off = (found[0] - right[0]).hypot(found[1] - right[1]) / size;
                assert!(off < 1e-9, "{k} {d} {extra} {w}: {found:?} {right:?}");
            }
        }
    }

    #[test]
    fn a_spring_beyond_all_that_a_sample_can_follow_is_far_from_stable() {
        // Stronger than the handle's inertia up to half the sampling rate, where the delay is three quarters of a turn.
        let found = check_stability(&spring(1e6), device(1), 5000.0).unwrap();
        assert!(found.sliding_margin < -1.0, "{found:?}");
    }
}
