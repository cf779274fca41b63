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
        let lag =
            if self.tuning.freshness < 1.0 { -self.dt / (1.0 - self.tuning.freshness).ln() } else { 0.0 };
        let (sin, cos) = (0.5 * w * self.dt + (w * lag).atan()).sin_cos();
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
        let top = std::f64::consts::PI / self.dt;
        let steps = (FINE * (top / 0.1).ln()) as usize;
        let mut worst = std::f64::consts::PI;
        let (mut before, mut last) = self.at(0.1);
        for step in 1..=steps {
            let (size, phase) = self.at(0.1 * (step as f64 / FINE).exp());
            if (before - 1.0) * (size - 1.0) <= 0.0 && before != size {
                worst = worst.min(std::f64::consts::PI + phase);
            }
            (before, last) = (size, phase);
        }
        if before >= 1.0 {
            // Still that strong at half the sampling rate: the delay has turned it round on the way.
            worst = worst.min((std::f64::consts::PI + last).min(0.0));
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
}
