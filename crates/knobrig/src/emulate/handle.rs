//! A force-feedback handle in somebody's hand: an inertia, a motor that acts late, sensors that resolve so much.

use knobcore::chain::{Acts, Body};
use knobrender::{Device, Sensed};

/// Steps of the integrator per sample.
const SUBSTEPS: usize = 20;

/// The handle of a device: what its motor and a hand do to it.
#[derive(Debug, Clone)]
pub struct Handle {
    device: Device,
    dt: f64,
    body: Body<f64>,
    alpha: f64,
    /// Torques that were commanded and do not act yet, the oldest first.
    late: std::collections::VecDeque<f64>,
}

impl Handle {
    /// A handle at rest at `theta`, sampled every `dt` seconds.
    pub fn new(device: Device, dt: f64, theta: f64) -> Self {
        let late = std::iter::repeat_n(0.0, device.delay).collect();
        Self { device, dt, body: Body::at(theta, 0.0), alpha: 0.0, late }
    }

    /// Angle, speed, and mean acceleration over the sample before: rad, rad/s, rad/s^2.
    pub fn motion(&self) -> [f64; 3] {
        [self.body.theta, self.body.omega, self.alpha]
    }

    /// Gives it a speed, rad/s.
    pub fn kick(&mut self, omega: f64) {
        self.body.omega = omega;
    }

    /// What its sensors say, with the torque of the hand if it measures that.
    pub fn sensed(&self, hand: Option<f64>) -> Sensed {
        let Body { theta, omega, .. } = self.body;
        Sensed { theta: self.device.counted(theta), omega, alpha: self.alpha, hand }
    }

    /// One sample goes by: the motor is told to apply `motor` (N m), and the hand's torque goes from one value to
    /// another. Returns the work of the hand, J.
    pub fn push(&mut self, motor: f64, hand: [f64; 2]) -> f64 {
        self.late.push_back(motor.max(-self.device.torque_limit).min(self.device.torque_limit));
        let acts = self.late.pop_front().unwrap_or(0.0);
        self.turn(self.dt, acts, |share, _| hand[0] + share * (hand[1] - hand[0]))
    }

    /// Time goes by, s, under a torque of the motor that acts at once, and under that of a hand, which answers the
    /// share of the time that is over and the angle and speed then. Returns the work of the hand, J.
    pub fn turn(&mut self, seconds: f64, motor: f64, hand: impl Fn(f64, [f64; 2]) -> f64) -> f64 {
        let steps = (SUBSTEPS as f64 * seconds / self.dt).ceil().max(1.0);
        let (h, start, mut work) = (seconds / steps, self.body.omega, 0.0);
        let Device { inertia, damping, .. } = self.device;
        for step in 0..steps as usize {
            let Body { theta, omega, .. } = self.body;
            let tau = hand((step as f64 + 0.5) / steps, [theta, omega]);
            let acts = Acts { inertia, push: 0.5 * damping * omega - motor, friction: 0.0, pressed: None };
            let next = self.body.moved(self.body.slid(&acts, tau, 0.5 * damping, h), h);
            work += tau * (next.theta - theta);
            self.body = next;
        }
        self.alpha = (self.body.omega - start) / seconds;
        work
    }

    /// Kinetic energy, J.
    pub fn energy(&self) -> f64 {
        0.5 * self.device.inertia * self.body.omega * self.body.omega
    }
}
