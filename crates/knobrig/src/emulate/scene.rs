//! What goes on at the rig during a run, sample by sample.

use super::handle::Handle;
use super::servo::Servo;
use crate::wire::fault;
use knobcore::chain::SUBSTEPS;
use knobcore::model::Model;
use knobcore::motion::Motion;
use knobcore::predict;
use knobcore::signals::Signals;
use knobrender::{Device, Fault, Limits, Renderer, Sensed};

/// A motion: one angle, speed and acceleration per sample, SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// rad.
    pub theta: Vec<f64>,
    /// rad/s.
    pub omega: Vec<f64>,
    /// rad/s^2.
    pub alpha: Vec<f64>,
}

impl Track {
    /// Samples of the motion.
    pub fn len(&self) -> usize {
        self.theta.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.theta.is_empty()
    }

    pub(super) fn at(&self, i: usize) -> [f64; 3] {
        [&self.theta, &self.omega, &self.alpha].map(|column| column.get(i).copied().unwrap_or(0.0))
    }
}

/// Torque that moves a knob along a track, from a place on, N m.
pub(super) fn torque(knob: &Model, track: &Track, place: f64, rate_hz: f64) -> Vec<f64> {
    let n = track.len();
    let signals = Signals {
        rate_hz,
        substeps: SUBSTEPS,
        t: (0..n).map(|i| i as f64 / rate_hz).collect(),
        theta: track.theta.iter().map(|theta| place + theta).collect(),
        omega: track.omega.clone(),
        alpha: track.alpha.clone(),
        forward: track.omega.iter().map(|w| Motion::exact(0.0, 0.0, *w, 0.0).forward).collect(),
        omega_sd: vec![0.0; n],
        tau_raw: vec![0.0; n],
        tau: vec![0.0; n],
        weight: vec![1.0; n],
        segments: vec![0..n; 1],
        ..Signals::default()
    };
    predict::torque_raw(knob, &signals)
}

/// A hand that follows its own motion and holds the handle through a spring and a damper: N m/rad, N m s/rad.
const HAND: [f64; 2] = [0.5, 5e-3];

/// Torque of a hand that wants to be at an angle and a speed, on a handle that is at others, N m.
pub(super) fn grip([goal, speed]: [f64; 2], [theta, omega]: [f64; 2]) -> f64 {
    HAND[0] * (goal - theta) + HAND[1] * (speed - omega)
}

/// Where the torque on a free handle comes from.
#[derive(Debug, Clone)]
pub(super) enum Source {
    /// The uploaded model.
    Model(Box<Renderer>),
    /// The host's commands: the last one and what the motor gives by now, N m, within limits.
    Host { wanted: f64, given: f64, limits: Limits, dt: f64 },
}

/// A run.
#[derive(Debug, Clone)]
pub(super) enum Scene {
    /// A motion moves a knob (or none), whose torque is known ahead: by the motor, or by a hand again and again.
    Moved { track: Track, tau: Vec<f64>, place: f64, at: usize, motor: Option<Servo> },
    /// A motion moves the handle, on which a model is rendered.
    Driven { track: Track, place: f64, at: usize, knob: Box<Renderer>, device: Device },
    /// A hand holds the handle.
    Held { source: Source, handle: Handle, hand: Track, place: f64, at: usize, pushes: f64 },
}

/// What a sample has: angle, speed, acceleration, torque; and the torque that the motor applies.
pub(super) struct Instant {
    pub sensed: [f64; 4],
    pub motor: f64,
}

impl Scene {
    /// The next sample, if there is one; none when the motion is over.
    pub fn next(&mut self) -> Option<Instant> {
        match self {
            Self::Moved { track, tau, place, at, motor } => {
                if *at == track.len() && motor.is_none() && !track.is_empty() {
                    *at = 0;
                }
                let asked = *tau.get(*at)?;
                let [theta, omega, alpha] = track.at(*at);
                *at += 1;
                let (push, off) = motor.as_mut().map_or((asked, [0.0; 3]), |motor| motor.give(asked));
                let sensed = [*place + theta + off[0], omega + off[1], alpha + off[2], push];
                Some(Instant { sensed, motor: push })
            }
            Self::Driven { track, place, at, knob, device } => {
                if *at == track.len() {
                    return None;
                }
                let [theta, omega, alpha] = track.at(*at);
                let theta = *place + theta;
                *at += 1;
                let motor = knob.step(Sensed { theta: device.counted(theta), omega, alpha, hand: None });
                // Within a sample the motion is read, the motor is told, and then the torque is read.
                let own = device.inertia * alpha + device.damping * omega;
                Some(Instant { sensed: [theta, omega, alpha, motor + own], motor })
            }
            Self::Held { source, handle, hand, place, at, pushes } => {
                let target = hand.at(*at % hand.len().max(1));
                *at += 1;
                let [theta, omega, alpha] = handle.motion();
                let sensed = handle.sensed(Some(*pushes));
                let motor = match source {
                    Source::Model(knob) => -knob.step(sensed),
                    Source::Host { wanted, given, limits, dt } => {
                        *given = limits.cut(*wanted, *given, *dt);
                        *given
                    }
                };
                let before = *pushes;
                *pushes = grip([*place + target[0], target[1]], [theta, omega]);
                handle.push(motor, [before, *pushes]);
                Some(Instant { sensed: [theta, omega, alpha, before], motor })
            }
        }
    }

    /// The host commands a torque of the motor, N m.
    pub fn command(&mut self, tau: f64) {
        if let Self::Held { source: Source::Host { wanted, .. }, .. } = self {
            *wanted = tau;
        }
    }

    /// Why it cannot go on, if so: a code of FAULT, and the words.
    pub fn fault(&self) -> Option<(u16, &'static str)> {
        match self {
            Self::Driven { knob, .. } | Self::Held { source: Source::Model(knob), .. } => {
                knob.fault().map(|fault| (code(fault), fault.text()))
            }
            Self::Held { source: Source::Host { limits, .. }, handle, .. } => {
                let fault = Fault::Jump;
                (handle.motion()[1].abs() > limits.speed).then(|| (code(fault), fault.text()))
            }
            Self::Moved { motor, .. } => motor.as_ref().filter(|motor| motor.is_lost()).map(|_| {
                (fault::TRACKING, "the motion asks for more torque than ARM allows, and the knob fell behind")
            }),
        }
    }

    /// Where the knob stands, rad.
    pub fn place(&self) -> f64 {
        match self {
            Self::Moved { track, place, at, motor, .. } => {
                let off = motor.as_ref().map_or(0.0, Servo::off);
                place + track.at(at.saturating_sub(1))[0] + off
            }
            Self::Driven { track, place, at, .. } => place + track.at(at.saturating_sub(1))[0],
            Self::Held { handle, .. } => handle.motion()[0],
        }
    }
}

/// The code by which a device says why the step let go.
fn code(fault: Fault) -> u16 {
    match fault {
        Fault::NotFinite | Fault::Jump => fault::SENSOR,
        Fault::Torque => fault::TORQUE,
        Fault::Energy => fault::ENERGY,
    }
}
