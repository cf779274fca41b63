//! From the torque to the motion: the chain driven by the torque that was measured, beside the motion that was.

use crate::chain::{Drive, Driven, sensors, steps};
use crate::effects::Place;
use crate::effects::law::Response;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::signals::Signals;
use std::ops::Range;

/// Passes that take off what a sensor did (van Cittert 1931). A lag T is right up to (2 pi f T)^4; more passes would
/// raise the noise that a delay cannot be parted from.
const PASSES: usize = 3;

/// Travels of the measured motion beyond which a simulated one has run away.
const FARTHEST: f64 = 1e3;

/// A motion that a measured torque makes.
#[derive(Debug, Clone, Default)]
pub struct Forward {
    /// Angle of the shaft, rad, at every sample; NaN outside of every segment.
    pub theta: Vec<f64>,
    /// Samples at which the simulation took over the measured angle and speed.
    pub starts: Vec<usize>,
}

/// Simulates the motion that the measured torque makes, from the measured state at the start of each segment and, with
/// a horizon (s), anew from the measured state after each.
///
/// The torque is straight between samples. What the model's sensors do to it is taken off first.
///
/// # Errors
/// A model without inertia, a horizon that is no time, a motion that grows beyond all bounds.
pub fn forward(model: &Model, signals: &Signals, horizon_s: Option<f64>) -> Result<Forward> {
    if horizon_s.is_some_and(|horizon| !horizon.is_finite() || horizon <= 0.0) {
        return Err(Error::invalid("horizon", "must be a time above 0 s; leave it out for one run"));
    }
    let model = &model.among(&[&signals.run]);
    let p = model.values();
    let mut out = Forward { theta: vec![f64::NAN; signals.len()], starts: Vec::new() };
    for segment in &signals.segments {
        let torque = on_shaft(model, &p, signals, segment);
        let travel = travel(&signals.theta[segment.clone()]);
        let mut driven = Driven::new(model, &p, signals.theta[segment.start], signals.omega[segment.start])?;
        out.theta[segment.start] = driven.shaft.theta;
        out.starts.push(segment.start);
        let mut started = signals.t[segment.start];
        for (at, pair) in (segment.start..).zip(torque.windows(2)) {
            let (from, to) = (signals.t[at], signals.t[at + 1]);
            // Half a sample of grace: stamps are rounded.
            if horizon_s.is_some_and(|horizon| from - started >= horizon - 0.5 / signals.rate_hz) {
                driven.put(signals.theta[at], signals.omega[at]);
                out.starts.push(at);
                started = from;
            }
            let steps = steps(to - from);
            let h = (to - from) / steps as f64;
            for step in 0..steps {
                let share = (step as f64 + 0.5) / steps as f64;
                let torque = pair[0] + share * (pair[1] - pair[0]);
                driven.step(from + step as f64 * h, h, &Drive::Torque(torque));
            }
            let strayed = (driven.shaft.theta - signals.theta[at + 1]).abs();
            if strayed.is_nan() || strayed > FARTHEST * travel {
                return Err(Error::invalid(
                    "model",
                    format!(
                        "makes a motion that runs away by {to:.3} s: friction that drives, or too long a run; give a \
                         shorter horizon, or a model whose friction opposes motion"
                    ),
                ));
            }
            out.theta[at + 1] = driven.shaft.theta;
        }
    }
    Ok(out)
}

/// The range of angles that a motion goes through.
fn travel(theta: &[f64]) -> f64 {
    let ends = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
    let (low, high) = theta.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    high - low
}

/// The torque on the shaft over a segment: what was read, less what the sensors of the model did to it.
fn on_shaft(model: &Model, p: &[f64], signals: &Signals, segment: &Range<usize>) -> Vec<f64> {
    let read = &signals.tau_raw[segment.clone()];
    let mut torque = read.to_vec();
    if model.at(Place::Sensor).next().is_none() {
        return torque;
    }
    let (columns, dt) = (vec![None; p.len()], 1.0 / signals.rate_hz);
    for _ in 0..PASSES {
        let mut sensed = torque.clone();
        let motion = signals.motion_columns(segment.clone());
        sensors(model, p, &columns, &mut Response { motion, dt, torque: &mut sensed, slopes: &mut [] });
        torque
            .iter_mut()
            .zip(&sensed)
            .zip(read)
            .for_each(|((torque, sensed), read)| *torque += read - sensed);
    }
    torque
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;
    use crate::predict;

    const RATE_HZ: f64 = 1000.0;

    fn knob(more: &[Id]) -> Model {
        let effects: Vec<_> = [Id::Inertia, Id::Coulomb, Id::Viscous].iter().chain(more).copied().collect();
        let mut model = Model::new(&effects, Axis::Rotary);
        for (name, value) in [
            ("inertia.M", 7e-5),
            ("coulomb.neg", 0.002),
            ("coulomb.pos", 0.003),
            ("viscous.neg", 1e-3),
            ("viscous.pos", 1e-3),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    /// A swing of 3 s with the torque that the model takes for it.
    fn swung(model: &Model) -> Signals {
        let n = 3000;
        let t: Vec<f64> = (0..n).map(|i| f64::from(i) / RATE_HZ).collect();
        let of = |f: fn(f64) -> f64| t.iter().map(|t| f(5.0 * t)).collect::<Vec<_>>();
        let omega = of(|x| 5.0 * x.cos());
        let mut signals = Signals {
            rate_hz: RATE_HZ,
            theta: of(f64::sin),
            alpha: of(|x| -25.0 * x.sin()),
            forward: omega.iter().map(|w| if *w > 0.0 { 1.0 } else { 0.0 }).collect(),
            omega,
            segments: vec![0..t.len(); 1],
            substeps: 4,
            t,
            ..Signals::default()
        };
        signals.tau_raw = predict::torque_raw(model, &signals);
        signals
    }

    fn apart(signals: &Signals, forward: &Forward) -> f64 {
        signals.theta.iter().zip(&forward.theta).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_torque_of_a_motion_makes_that_motion() {
        let model = knob(&[]);
        let signals = swung(&model);
        let forward = forward(&model, &signals, None).unwrap();
        assert_eq!(forward.starts, [0]);
        assert!(apart(&signals, &forward) < 2e-3, "{}", apart(&signals, &forward));
    }

    #[test]
    fn what_a_sensor_does_to_the_torque_does_not_reach_the_motion() {
        let mut model = knob(&[Id::TorqueDrift, Id::TorqueLag]);
        model.set("torque_drift.d", 0.01).unwrap();
        model.set("torque_lag.lag", 5e-3).unwrap();
        let signals = swung(&model);
        assert!(apart(&signals, &forward(&model, &signals, None).unwrap()) < 5e-3);
        let bare = forward(&knob(&[]), &signals, None).unwrap();
        assert!(apart(&signals, &bare) > 1.0, "the drift is felt: {}", apart(&signals, &bare));
    }

    #[test]
    fn a_horizon_begins_anew_from_the_measured_state_and_a_wrong_model_strays_less() {
        let mut wrong = knob(&[]);
        let signals = swung(&wrong);
        wrong.set("viscous.pos", 2e-3).unwrap();
        let once = apart(&signals, &forward(&wrong, &signals, None).unwrap());
        let often = forward(&wrong, &signals, Some(0.5)).unwrap();
        assert_eq!(often.starts, [0, 500, 1000, 1500, 2000, 2500]);
        assert!(apart(&signals, &often) < 0.5 * once, "{} {once}", apart(&signals, &often));
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_with_the_way_out() {
        let signals = swung(&knob(&[]));
        let massless = Model::new(&[Id::Coulomb], Axis::Rotary);
        let error = forward(&massless, &signals, None).unwrap_err().to_string();
        assert!(error.contains("inertia"), "{error}");
        let mut gives = knob(&[]);
        gives.set("viscous.pos", -5e-3).unwrap();
        gives.set("viscous.neg", -5e-3).unwrap();
        let error = forward(&gives, &signals, None).unwrap_err().to_string();
        assert!(error.contains("runs away") && error.contains("horizon"), "{error}");
        for horizon in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                forward(&knob(&[]), &signals, Some(horizon)).unwrap_err().to_string().contains("horizon")
            );
        }
    }
}
