//! What a model asks of the device that renders it: how heavy, stiff and damped it is at most.

use super::sliding::{at_rest, braked};
use knobcore::model::Model;
use knobcore::motion::{Load, Motion};
use knobcore::prelude::*;
use knobcore::scalar::Scalar;

/// Extremes of a model over angles and speeds; SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nature {
    /// Inertia, kg m^2.
    pub inertia: f64,
    /// Greatest slope of torque over acceleration, kg m^2: the inertia, and the friction that its torque makes.
    pub surge: f64,
    /// Least torque that holds a knob at rest, of both directions, N m.
    pub hold: f64,
    /// Greatest slope of torque over angle, rising or falling, N m/rad.
    pub stiffness: f64,
    /// Greatest slope of torque over speed, N m s/rad.
    pub damping: f64,
    /// Whether what depends on the motion brakes it everywhere, so that no guard is needed.
    pub dissipates: bool,
}

const ANGLES: usize = 256;
const SPEEDS: usize = 24;
/// Angles that are looked at, rad to both sides of zero.
const REACH: f64 = 4.0 * core::f64::consts::PI;

impl Nature {
    /// Looks at a grid of angles and of speeds up to `speed` (rad/s), at the start of time.
    pub fn of(model: &Model, p: &[f64], speed: f64) -> Self {
        let state = vec![0.0; model.states()];
        let mut scratch = state.clone();
        let mut load = |motion: &Motion<f64>| {
            scratch.copy_from_slice(&state);
            model.load(p, &mut scratch, motion)
        };
        let still = |theta: f64| Motion::exact(0.0, theta, 0.0, 0.0);
        let start = load(&still(0.0));
        let mut nature = Self {
            inertia: start.inertia,
            surge: start.inertia * (1.0 + (start.mu * start.carried()).abs()),
            hold: f64::INFINITY,
            stiffness: 0.0,
            damping: 0.0,
            dissipates: true,
        };
        for i in 0..ANGLES {
            // Golden-ratio steps meet every phase of any detent.
            let theta = REACH * (2.0 * (0.618_033_988_75 * i as f64).fract() - 1.0);
            let here = load(&still(theta));
            let h = 1e-6;
            let slope = (load(&still(theta + h)).drive - load(&still(theta - h)).drive) / (2.0 * h);
            nature.stiffness = nature.stiffness.max(slope.abs());
            nature.hold = nature.hold.min(held(&here));
            for k in 0..SPEEDS {
                let fast = speed * Scalar::powf(0.5, 0.75 * k as f64);
                for omega in [fast, -fast] {
                    let motion = Motion::exact(0.0, theta, omega, 0.0);
                    let (now, more) = (load(&motion), load(&Motion { omega: 1.001 * omega, ..motion }));
                    let torque = |load: &Load<f64>| load.drive + load.friction(motion.forward, motion.alpha);
                    nature.damping = nature.damping.max((torque(&more) - torque(&now)) / (0.001 * omega));
                    nature.surge = nature.surge.max(start.inertia * (1.0 + (now.mu * now.carried()).abs()));
                    nature.dissipates &= braked(&now, &motion, load(&at_rest(&motion)).drive) == now.drive;
                }
            }
        }
        nature
    }
}

/// What holds a knob at rest in the direction where it is held least, N m.
fn held(load: &Load<f64>) -> f64 {
    let back = load.hold[0].max(-load.friction(0.0, 0.0));
    back.min(load.hold[1].max(load.friction(1.0, 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use knobcore::effects::Id;
    use knobcore::param::Axis;

    #[test]
    fn damping_is_that_of_the_highest_speed_or_the_slowest_whichever_is_more() {
        let mut knob = Model::new(&[Id::Inertia, Id::Coulomb, Id::QuadraticDrag], Axis::Rotary);
        for (name, value) in
            [("inertia.M", 1e-4), ("coulomb.neg", 0.01), ("coulomb.pos", 0.02), ("quadratic_drag.d", 3e-3)]
        {
            knob.set(name, value).unwrap();
        }
        for speed in [2.0, 8.0] {
            let of = |knob: &Model| Nature::of(knob, &knob.values(), speed);
            // The slope of d omega |omega|.
            let (damping, right) = (of(&knob).damping, 2.0 * 3e-3 * speed);
            assert!((damping / right - 1.0).abs() < 1e-2, "{damping} {right}");
            assert!((of(&knob).hold, of(&knob).inertia) == (0.01, 1e-4) && of(&knob).dissipates);
            let mut viscous = knob.with(Id::Viscous).unwrap();
            for (name, value) in [("viscous.neg", 0.02), ("viscous.pos", 0.03), ("quadratic_drag.d", -1e-4)] {
                viscous.set(name, value).unwrap();
            }
            // What is slower has more of it: the slowest speed that is looked at is a small part of it.
            let found = of(&viscous).damping;
            assert!(found < 0.03 && found > 0.03 - 0.5e-4 * speed, "{found}");
        }
    }
}
