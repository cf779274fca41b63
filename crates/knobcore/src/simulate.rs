//! From torque to motion: a hand pushes the knob through a spring, and the knob sticks and slips.
//!
//! The only integrator: semi-implicit Euler in substeps, with Karnopp's (1985) stick band. A stuck knob has
//! exactly zero velocity and leaves when what would move it exceeds what holds it.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::motion::{Load, Motion};

/// Steps of the integrator per sample.
const SUBSTEPS: usize = 32;

/// A hand: it follows its own motion and is tied to the knob by a spring and a damper.
#[derive(Debug, Clone, Copy)]
pub struct Hand {
    /// N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    pub damping: f64,
}

/// What the rig would record; SI, one value a sample.
#[derive(Debug, Clone, Default)]
pub struct Pushed {
    /// Angle, rad.
    pub theta: Vec<f64>,
    /// Angular velocity, rad/s.
    pub omega: Vec<f64>,
    /// Angular acceleration over the last substep, rad/s^2.
    pub alpha: Vec<f64>,
    /// Torque of the hand, N m.
    pub tau: Vec<f64>,
}

/// Lets a hand that moves along `reference` (rad, one value a sample of `dt` seconds) push the knob.
///
/// # Errors
/// A model without inertia, or a hand that is too stiff for the sampling rate.
pub fn push(model: &Model, reference: &[f64], dt: f64, hand: Hand) -> Result<Pushed> {
    let p = model.values();
    let h = dt / SUBSTEPS as f64;
    let mut state = vec![0.0; model.states()];
    let inertia = model.load(&p, &mut state.clone(), &Motion::exact(0.0, 0.0, 0.0, 0.0)).inertia;
    if inertia.is_nan() || inertia <= 0.0 {
        return Err(Error::invalid(
            "inertia.M",
            "must be positive where torque makes motion; add the effect inertia",
        ));
    }
    if hand.stiffness * h * h > 0.5 * inertia || hand.damping * h > 0.5 * inertia {
        return Err(Error::invalid(
            "hand",
            "is too stiff for this inertia and rate; lower it, or raise the rate",
        ));
    }
    let mut out = Pushed::default();
    let first = reference.first().copied().unwrap_or(0.0);
    let (mut theta, mut omega) = (first, 0.0);
    // A knob that broke away sticks again when its speed falls back into the band, not while it leaves it.
    let mut slipping = false;
    for (sample, target) in reference.iter().enumerate() {
        let before = reference.get(sample.wrapping_sub(1)).copied().unwrap_or(*target);
        let speed = (target - before) / dt;
        let (mut alpha, mut tau) = (0.0, 0.0);
        for step in 1..=SUBSTEPS {
            let at = before + (target - before) * step as f64 / SUBSTEPS as f64;
            tau = hand.stiffness * (at - theta) + hand.damping * (speed - omega);
            let motion = Motion::exact(sample as f64 * dt, theta, omega, 0.0);
            let own = Load::drive(model.own_torque(&p, &motion));
            let load = model.load(&p, &mut state, &motion).plus(own);
            let other = tau - load.drive;
            let held = load.sticking(other) == other;
            let slow = omega.abs() <= load.band;
            alpha = if slow && held && !slipping {
                omega = 0.0;
                0.0
            } else {
                // At rest friction opposes what moves the knob; otherwise the motion.
                let direction = if omega == 0.0 { other } else { omega };
                let friction = load.friction(if direction > 0.0 { 1.0 } else { 0.0 });
                (other - friction) / load.inertia
            };
            let next = omega + h * alpha;
            slipping = next != 0.0 && slow && (slipping || !held) && next.abs() >= omega.abs();
            // Friction stops a motion; it does not turn it round.
            omega = if next * omega < 0.0 && held { 0.0 } else { next };
            theta += h * omega;
        }
        out.theta.push(theta);
        out.omega.push(omega);
        out.alpha.push(alpha);
        out.tau.push(tau);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    fn knob() -> Model {
        let mut model = Model::new(&[Id::Inertia, Id::Coulomb, Id::Viscous, Id::Karnopp], Axis::Rotary);
        for (name, value) in [
            ("inertia.M", 7e-5),
            ("coulomb.neg", 0.02),
            ("coulomb.pos", 0.02),
            ("viscous.neg", 1e-3),
            ("viscous.pos", 1e-3),
            ("karnopp.D_neg", 0.05),
            ("karnopp.D_pos", 0.04),
            ("karnopp.dv", 0.01),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    const HAND: Hand = Hand { stiffness: 0.5, damping: 0.005 };

    #[test]
    fn a_knob_pushed_below_breakaway_never_moves() {
        let reference: Vec<f64> = (0..20_000).map(|i| 0.07 * (f64::from(i) * 1e-3).sin()).collect();
        let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
        assert!(pushed.theta.iter().all(|theta| *theta == 0.0));
        let most = pushed.tau.iter().fold(0.0_f64, |m, tau| m.max(tau.abs()));
        assert!(most > 0.03 && most < 0.04, "the hand did push: {most}");
    }

    #[test]
    fn the_knob_breaks_away_at_the_static_friction_of_each_direction() {
        for (sign, breakaway) in [(1.0, 0.04), (-1.0, 0.05)] {
            let reference: Vec<f64> = (0..5000).map(|i| sign * f64::from(i) * 5e-5).collect();
            let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
            let moves = pushed.omega.iter().position(|omega| *omega != 0.0).unwrap();
            assert!(
                (pushed.tau[moves - 1].abs() - breakaway).abs() < 0.02 * breakaway,
                "{}",
                pushed.tau[moves - 1]
            );
        }
    }

    #[test]
    fn a_knob_that_is_let_go_comes_to_rest_and_stays() {
        let reference: Vec<f64> =
            (0..10_000).map(|i| if i < 2000 { f64::from(i) * 5e-4 } else { 1.0 }).collect();
        let pushed = push(&knob(), &reference, 2e-4, HAND).unwrap();
        assert!(pushed.omega[6000..].iter().all(|omega| *omega == 0.0));
        assert!(pushed.theta[9999] > 0.5);
    }
}
