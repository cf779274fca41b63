//! Actuation delay: the recorded torque is a command, and acts later than it is logged.

use super::shifted::shifted;
use super::{Carrier, Effect, Id, LateEffect, Survey, TakenUp, Words};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// The command stands in the log `delay` before the torque that it makes.
///
/// After the last sample the torque is taken to stay what it is there.
pub struct ActuationDelay;

/// Longest delay that is looked for, s.
const LONGEST: f64 = 0.05;

impl Effect<1> for ActuationDelay {
    const ID: &'static str = "actuation_delay";
    const LAW: &'static str = "the log has the command tau(t + delay)";
    const SOURCE: &'static str = "dead time of an actuator between its command and its torque";
    const SHOWS: &'static str = "against the rate of the torque: the log is ahead of the motion";
    const CONFUSED: &'static [&'static str] = &["torque_lag", "directional_detent", "compliance"];
    const WORDS: Words = Words {
        title: "command delay",
        name: "the recorded torque is a command that acts later",
        about: "What is logged as torque is what was asked for; it acts only after the bus, the drive and the \
                current loop have passed it on, so that the log is ahead of the motion.",
        causes: &[
            "a torque or current that is commanded and not measured",
            "a control loop that logs its output before the drive has it",
            "motion channels that are filtered or come late over a bus",
        ],
        remedies: &[
            "log the measured current or torque instead of the command",
            "log command and motion with the time at which each holds",
            "give the delay that was found to whatever reads the log",
        ],
        latex: r"\tau_{\text{read}}(t) = \tau(t + t_d)",
    };
    const TAKEN_UP: Option<TakenUp> = Some(TakenUp {
        by: &["torque_lag.lag"],
        why: "a torque that is read late is not ahead too: a shorter lag does the same",
    });
    const PARAMS: [Param; 1] = [
        // One at the end of its range stands in for a memory of another kind.
        Param::shape("delay", Unit::of(0, 0, 1), [0.0, LONGEST], 0.0, "dead time")
            .plausibly(0.0, 0.9 * LONGEST),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 1]> {
        // No delay at all is a bound, where a search may get caught.
        let sample = 1.0 / survey.rate_hz;
        [0.5, 2.0, 6.0, 18.0].map(|samples| [samples * sample]).to_vec()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        let sample = 1.0 / carrier.survey.rate_hz;
        carrier.sized(Id::ActuationDelay, [sample, 50.0 * sample], |delay| [delay])
    }
}

impl LateEffect<1> for ActuationDelay {
    fn late<T: Scalar>([delay]: &[T; 1], dt: f64, tau: &[T]) -> Vec<T> {
        shifted(tau, -(*delay / T::of(dt)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_ramp_is_read_ahead_by_the_delay() {
        let ramp: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.1).collect();
        for delay in [1e-3, 0.73e-3] {
            let read = ActuationDelay::late(&[delay], 2e-4, &ramp);
            let ahead = (read[150] - ramp[150]) / 0.1 * 2e-4;
            assert!((ahead - delay).abs() < 1e-9, "{delay}: {ahead}");
        }
    }

    #[test]
    fn no_delay_changes_nothing() {
        let tau: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
        assert_eq!(ActuationDelay::late(&[0.0], 2e-4, &tau), tau);
    }
}
