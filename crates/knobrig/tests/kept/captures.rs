//! Small captures of knobs whose physics is written down here once more: what a fault in the crates does to it shows.

use knobcore::model::Run;
use knobcore::param::Axis;
use knobcore::prepare::{Preparation, Prepared, Recording, prepare};
use std::f64::consts::TAU;

pub const RATE_HZ: f64 = 1000.0;

/// Numbers that look like chance (Steele, Lea & Flood 2014, splitmix64).
pub struct Chance(pub u64);

impl Chance {
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// A capture as it was recorded.
#[derive(Clone)]
pub struct Recorded {
    pub axis: Axis,
    pub t: Vec<f64>,
    pub theta: Vec<f64>,
    pub omega: Option<Vec<f64>>,
    pub alpha: Option<Vec<f64>>,
    pub tau: Vec<f64>,
    pub after_gap: Vec<bool>,
    pub measured: Vec<bool>,
}

/// Amplitudes (rad) and angular frequencies (rad/s) of a motion.
pub type Waves<'a> = &'a [[f64; 2]];

pub const WAVES: [[f64; 2]; 3] = [[0.9, 5.1], [0.3, 13.3], [0.05, 47.0]];

/// Where a motion is: angle, speed, acceleration.
pub fn at(waves: Waves, t: f64) -> [f64; 3] {
    waves.iter().fold([0.0; 3], |[theta, omega, alpha], [a, w]| {
        let (sin, cos) = (w * t + a).sin_cos();
        [theta + a * sin, omega + a * w * cos, alpha - a * w * w * sin]
    })
}

/// Inertia, dry and viscous friction: what every knob here has.
pub fn base([_, omega, alpha]: [f64; 3]) -> f64 {
    let dry = if omega > 0.0 { 9e-3 + 5e-4 * omega } else { -8e-3 + 4e-4 * omega };
    1e-4 * alpha + dry
}

/// So many samples of a motion and the torque that goes with it, each as its sensor sees it. `colour` is how much of the
/// torque's noise is left after a sample.
pub fn recorded(
    count: usize,
    waves: Waves,
    colour: f64,
    seed: u64,
    mut torque: impl FnMut(f64, [f64; 3]) -> f64,
) -> Recorded {
    let mut chance = Chance(seed);
    let t: Vec<f64> = (0..count).map(|i| i as f64 / RATE_HZ).collect();
    let motion: Vec<[f64; 3]> = t.iter().map(|t| at(waves, *t)).collect();
    let mut noise = 0.0;
    let mut tau = Vec::new();
    for (t, motion) in t.iter().zip(&motion) {
        noise = colour * noise + 1e-3 * (1.0 - colour * colour).sqrt() * chance.normal();
        tau.push(torque(*t, *motion) + noise);
    }
    let mut seen = |which: usize, sd: f64| -> Vec<f64> {
        motion.iter().map(|motion| motion[which] + sd * chance.normal()).collect()
    };
    Recorded {
        axis: Axis::Rotary,
        theta: seen(0, 2e-5),
        omega: Some(seen(1, 2e-3)),
        alpha: Some(seen(2, 0.5)),
        t,
        tau,
        after_gap: vec![false; count],
        measured: vec![true; count],
    }
}

/// The torque on a shaft behind which a knob hangs by a spring and a damper with a gap between, so many steps a sample.
pub fn joined(gap: f64, [k, d]: [f64; 2]) -> impl FnMut(f64, [f64; 3]) -> f64 {
    const STEPS: usize = 40;
    let mut knob: Option<[f64; 2]> = None;
    move |_, [theta, omega, alpha]| {
        let [mut there, mut speed] = knob.unwrap_or([theta, omega]);
        let h = 1.0 / RATE_HZ / STEPS as f64;
        let force = |twist: f64, rate: f64| {
            let beyond = (twist.abs() - 0.5 * gap).max(0.0) * twist.signum();
            if beyond == 0.0 && gap > 0.0 { 0.0 } else { k * beyond + d * rate }
        };
        for step in 0..STEPS {
            let ahead = (step as f64 + 1.0 - STEPS as f64) * h;
            let shaft = [theta + ahead * (omega + 0.5 * ahead * alpha), omega + ahead * alpha];
            let rubs = 8e-3 * (speed / 0.02).tanh() + 4e-4 * speed;
            speed += h * (force(shaft[0] - there, shaft[1] - speed) - rubs) / 7e-5;
            there += h * speed;
        }
        knob = Some([there, speed]);
        3e-5 * alpha + force(theta - there, omega - speed)
    }
}

impl Recorded {
    pub fn prepared(&self, name: &str, how: &Preparation) -> Prepared {
        let run = Run { name: name.into(), fingerprint: name.into() };
        let recording = Recording {
            run: &run,
            axis: self.axis,
            rate_hz: RATE_HZ,
            t: &self.t,
            theta: &self.theta,
            omega: self.omega.as_deref(),
            alpha: self.alpha.as_deref(),
            tau: &self.tau,
            after_gap: &self.after_gap,
            measured: &self.measured,
        };
        prepare(&recording, how).unwrap()
    }

    pub fn smooth(&self, name: &str) -> Prepared {
        self.prepared(name, &Preparation::smooth(RATE_HZ))
    }
}
