//! The motor that drives a knob along a motion: it gives what the motion asks for, within its limits.

use knobrender::Limits;

/// How fast the position control catches up with a motion that the knob fell behind, rad/s.
const CATCHES_UP: f64 = 200.0;
/// How far behind a knob may be, rad.
const TOO_FAR: f64 = 0.05;

/// A motor with its position control. As long as its limits do not matter the knob is exactly on its motion.
#[derive(Debug, Clone)]
pub(super) struct Servo {
    limits: Limits,
    inertia: f64,
    dt: f64,
    /// How far the knob is from its motion, rad, and how fast that changes, rad/s.
    off: [f64; 2],
    given: f64,
}

impl Servo {
    /// A motor at rest that moves so much inertia, kg m^2, in samples of `dt` seconds.
    pub fn new(limits: Limits, inertia: f64, dt: f64) -> Self {
        Self { limits, inertia, dt, off: [0.0; 2], given: 0.0 }
    }

    /// The torque of a sample in which the motion asks for `asked`, N m, and how far angle, speed and acceleration are
    /// from the motion then.
    pub fn give(&mut self, asked: f64) -> (f64, [f64; 3]) {
        let [off, speed] = self.off;
        // What is anchored has no inertia that could be moved, and is never off.
        let w = CATCHES_UP;
        let back = if off == 0.0 && speed == 0.0 { 0.0 } else { self.inertia * w * (w * off + 2.0 * speed) };
        self.given = self.limits.cut(asked - back, self.given, self.dt);
        let lacks = (self.given - asked) / self.inertia;
        let there = [off, speed, lacks];
        self.off[1] += lacks * self.dt;
        self.off[0] += self.off[1] * self.dt;
        (self.given, there)
    }

    /// How far the knob is from its motion, rad.
    pub fn off(&self) -> f64 {
        self.off[0]
    }

    /// Whether it is too far from it.
    pub fn is_lost(&self) -> bool {
        self.off[0].is_nan() || self.off[0].abs() > TOO_FAR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo(torque: f64) -> Servo {
        Servo::new(Limits { torque, torque_rate: 2000.0, speed: 100.0 }, 1e-4, 2e-4)
    }

    #[test]
    fn a_motion_within_the_limits_is_followed_exactly() {
        let mut servo = servo(0.5);
        for i in 0..5000 {
            let asked = 0.1 * (0.01 * f64::from(i)).sin();
            assert_eq!(servo.give(asked), (asked, [0.0; 3]));
        }
    }

    #[test]
    fn a_motor_that_is_too_weak_falls_behind_and_catches_up_again() {
        let mut servo = servo(0.01);
        for _ in 0..20 {
            servo.give(0.012);
        }
        let behind = servo.off();
        assert!(behind < 0.0 && !servo.is_lost());
        let most = (0..2000).map(|_| servo.give(0.0).0.abs()).fold(0.0, f64::max);
        assert!(most <= 0.01 && servo.off().abs() < 1e-3 * behind.abs(), "{most} {}", servo.off());
        for _ in 0..500 {
            servo.give(0.05);
        }
        assert!(servo.is_lost());
    }
}
