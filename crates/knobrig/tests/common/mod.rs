//! A rig as tests emulate it.
#![allow(dead_code, reason = "each test takes what it needs")]

use knobrig::emulate::{Fixture, Sensors, Setup, Track};
use knobrig::wire::{Channel, Descriptor, Serial, Unit};

pub mod models;
pub mod seen;

pub const RATE: f64 = 5000.0;

/// A motion from rest and back to it, of so many samples.
pub fn track(samples: usize) -> Track {
    let mut track = Track::default();
    for i in 0..samples {
        let w = 2.0 * std::f64::consts::PI;
        let (sin, cos) = (w * i as f64 / RATE).sin_cos();
        track.theta.push(1.0 - cos);
        track.omega.push(w * sin);
        track.alpha.push(w * w * cos);
    }
    track
}

/// A rig with nothing in its gripper, in a hand that repeats a motion of so many samples.
pub fn setup(samples: usize) -> Setup {
    let channel = |scale, unit, most: i16| Channel { scale, offset: 0.0, unit, lower: -most, upper: most };
    Setup {
        descriptor: Descriptor {
            serial: Serial::from("EMU-1").unwrap(),
            firmware_major: 1,
            firmware_minor: 0,
            rate_hz: RATE,
            counts_per_rad: 1e5,
            omega: channel(4e-4, Unit::RadPerSecond, 32767),
            alpha: channel(3e-4, Unit::Volt, 32767),
            tau: channel(1e-5, Unit::NewtonMetre, 20_000),
            c_cal: 1148.0,
            torque_limit: 0.5,
            torque_rate_limit: 1e6,
            inertia: 5e-5,
            damping: 1e-4,
            anchor_stiffness: 100.0,
            delay_samples: 0,
            heartbeat_ms: 100,
            motion_capacity: 1_000_000,
            model_capacity: 65_536,
            window: 4,
            capabilities: 15,
        },
        fixture: Fixture::Free,
        sensors: Sensors { omega_sd: 0.0, alpha_sd: 0.0, tau_sd: 0.0, c_cal: 1148.0 },
        hand: track(samples),
        seed: 1,
    }
}
