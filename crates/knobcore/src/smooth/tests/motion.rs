//! Motions of which everything is known, and sensors that see them.

use crate::random::Noise;
use crate::smooth::Sensors;
use std::f64::consts::TAU;

/// Noise of the sensors, SI: that of the knob rig's raw channels.
pub const THETA_NOISE: f64 = 9.4e-6;
pub const OMEGA_NOISE: f64 = 5e-3;
pub const ALPHA_NOISE: f64 = 0.41;

/// Theta, omega and alpha at times t, SI.
pub struct Motion {
    pub t: Vec<f64>,
    pub theta: Vec<f64>,
    pub omega: Vec<f64>,
    pub alpha: Vec<f64>,
}

impl Motion {
    pub fn of(t: Vec<f64>, at: impl Fn(f64) -> [f64; 3]) -> Self {
        let states: Vec<[f64; 3]> = t.iter().map(|&t| at(t)).collect();
        let column = |i: usize| states.iter().map(|state| state[i]).collect();
        Self { theta: column(0), omega: column(1), alpha: column(2), t }
    }

    /// Noisy sensors of all three, theta rounded to `count`.
    pub fn seen(&self, seed: u64, count: f64) -> Self {
        let mut normal = Noise::new(seed);
        let mut noisy = |column: &[f64], sd: f64| -> Vec<f64> {
            column.iter().map(|value| value + sd * normal.normal()).collect()
        };
        let theta =
            noisy(&self.theta, THETA_NOISE).iter().map(|theta| (theta / count).round() * count).collect();
        let (omega, alpha) = (noisy(&self.omega, OMEGA_NOISE), noisy(&self.alpha, ALPHA_NOISE));
        Self { t: self.t.clone(), theta, omega, alpha }
    }

    pub fn sensors(&self) -> Sensors<'_> {
        Sensors { t: &self.t, theta: &self.theta, omega: Some(&self.omega), alpha: Some(&self.alpha) }
    }

    pub fn theta_alone(&self) -> Sensors<'_> {
        Sensors { t: &self.t, theta: &self.theta, omega: None, alpha: None }
    }
}

/// `n` times at 5 kHz.
pub fn even(n: u32) -> Vec<f64> {
    (0..n).map(|k| f64::from(k) * 2e-4).collect()
}

/// Sines of 0.3 to 6 Hz.
pub fn multisine(t: f64) -> [f64; 3] {
    [(0.3, 1.0), (0.7, 0.5), (1.3, 0.2), (2.9, 0.06), (6.1, 0.01)].iter().enumerate().fold(
        [0.0; 3],
        |[theta, omega, alpha], (i, (frequency, size))| {
            let w = TAU * frequency;
            let (sin, cos) = (w * t + i as f64).sin_cos();
            [theta + size * sin, omega + size * w * cos, alpha - size * w * w * sin]
        },
    )
}

/// 0.2 rad, from 0.5 Hz, 0.6 Hz more every second.
pub fn chirp(t: f64) -> [f64; 3] {
    let (rate, sweep) = (TAU * (0.5 + 0.6 * t), TAU * 0.6);
    let (sin, cos) = (TAU * (0.5 * t + 0.3 * t * t)).sin_cos();
    [0.2 * sin, 0.2 * rate * cos, 0.2 * (sweep * cos - rate * rate * sin)]
}

/// Turns to and fro at up to 12 rad/s, with rests between.
pub fn fast_turns(t: f64) -> [f64; 3] {
    let (period, width, speed) = (0.8, 0.08, 12.0);
    let turn = (t / period).floor();
    let u = (t - (turn + 0.5) * period) / width;
    let sign = if turn as i64 % 2 == 0 { 1.0 } else { -1.0 };
    let bell = sign * speed * (-0.5 * u * u).exp();
    [angle_turned(u) * sign * speed * width, bell, -bell * u / width]
}

/// Integral of exp(-u^2 / 2) from minus infinity, less half of all for a to-and-fro that closes on itself.
fn angle_turned(u: f64) -> f64 {
    let steps = 64;
    let h = u / f64::from(steps);
    let f = |x: f64| (-0.5 * x * x).exp();
    let simpson = |i: i32| f(f64::from(i) * h) + 4.0 * f((f64::from(i) + 0.5) * h) + f(f64::from(i + 1) * h);
    (0..steps).map(simpson).sum::<f64>() * h / 6.0
}

/// A slow hand: acceleration is white noise through three low-passes of 5 Hz and a leak that keeps the speed
/// small; between samples it is linear in time, so that theta and omega follow exactly.
pub fn slow_hand(n: u32, seed: u64) -> Motion {
    let (h, cut) = (2e-4, TAU * 5.0);
    let mut normal = Noise::new(seed);
    let mut stages = [0.0; 3];
    let (mut theta, mut omega) = (0.0, 0.0);
    let mut states = Vec::new();
    for _ in 0..n {
        let before = stages[2];
        let mut drive = 150.0 * normal.normal() - 4.0 * omega;
        for stage in &mut stages {
            *stage += cut * h * (drive - *stage);
            drive = *stage;
        }
        states.push([theta, omega, before]);
        theta += h * omega + h * h * (2.0 * before + stages[2]) / 6.0;
        omega += h * (before + stages[2]) / 2.0;
    }
    let column = |i: usize| states.iter().map(|state: &[f64; 3]| state[i]).collect();
    Motion { t: even(n), theta: column(0), omega: column(1), alpha: column(2) }
}

/// Root mean square of a - b, each divided by `unit`.
pub fn rms(a: &[f64], b: &[f64], unit: impl Fn(usize) -> f64) -> f64 {
    let squares = a.iter().zip(b).enumerate().map(|(k, (a, b))| ((a - b) / unit(k)).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}
