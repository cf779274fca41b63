//! Torque lag: the torque channel comes late.

use super::shifted::shifted;
use super::{Carrier, Effect, Id, LateEffect, Survey, TakenUp, Words};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// A first-order lag, and a pure delay after it.
///
/// Before the first sample the torque is taken to have been what it is there.
pub struct TorqueLag;

/// Below this lag, in samples, nothing is left of a torque after one sample: e^(-1/lag) is nought.
const SHORTEST: f64 = 2e-3;
/// Longest lag that is looked for, s.
const LONGEST: f64 = 0.05;

impl Effect<2> for TorqueLag {
    const ID: &'static str = "torque_lag";
    const LAW: &'static str = "lag dy/dt + y = tau; the sensor reads y(t - delay)";
    const SOURCE: &'static str = "first-order lag and dead time of a measuring channel";
    const SHOWS: &'static str = "in proportion to the rate of the torque";
    const CONFUSED: &'static [&'static str] = &["presliding", "inertia", "backlash", "compliance"];
    const WORDS: Words = Words {
        title: "torque lag",
        name: "the torque signal comes late",
        about: "The torque channel follows the torque with a delay, so that it seems to depend on how fast \
                it changes.",
        causes: &[
            "a filter in the torque amplifier that the motion channels do not have",
            "channels that are sampled one after the other",
            "transport over a slow bus",
        ],
        remedies: &[
            "give all channels the same filter",
            "take time stamps where the sample is taken",
            "raise the amplifier's bandwidth, or correct the lag that was found",
        ],
        latex: r"T\,\dot y + y = \tau,\quad \tau_{\text{read}}(t) = y(t - t_d)",
    };
    const TAKEN_UP: Option<TakenUp> = Some(TakenUp {
        by: &["actuation_delay.delay"],
        why: "a torque that is logged ahead is not late too: a shorter delay does the same",
    });
    const PARAMS: [Param; 2] = [
        // One at the end of its range stands in for a memory of another kind.
        Param::shape("lag", Unit::of(0, 0, 1), [0.0, LONGEST], 0.0, "time constant")
            .plausibly(0.0, 0.9 * LONGEST),
        Param::shape("delay", Unit::of(0, 0, 1), [0.0, 0.02], 0.0, "dead time"),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 2]> {
        // No lag at all is a bound, where a search may get caught.
        let sample = 1.0 / survey.rate_hz;
        vec![[sample, 0.0], [4.0 * sample, 0.0], [0.5 * sample, sample]]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        let sample = 1.0 / carrier.survey.rate_hz;
        carrier.sized(Id::TorqueLag, [sample, 50.0 * sample], |lag| [lag, 0.6 * lag])
    }
}

impl LateEffect<2> for TorqueLag {
    fn late<T: Scalar>([lag, delay]: &[T; 2], dt: f64, tau: &[T]) -> Vec<T> {
        let Some(&first) = tau.first() else { return Vec::new() };
        // Exact for a torque that is straight between samples.
        let steps = *lag / T::of(dt);
        let one = T::of(1.0);
        let decay = (-one / steps.max(T::of(SHORTEST))).exp();
        let ramp = steps * (one - decay);
        let (mut y, mut before) = (first, first);
        let lagged: Vec<T> = tau
            .iter()
            .map(|x| {
                y = decay * y + (one - ramp) * *x + (ramp - decay) * before;
                before = *x;
                y
            })
            .collect();
        shifted(&lagged, *delay / T::of(dt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Vec<f64> {
        (0..200).map(|i| f64::from(i) * 0.1).collect()
    }

    #[test]
    fn a_steady_ramp_is_read_late_by_lag_and_delay() {
        for [lag, delay] in [[1e-3, 0.0], [0.0, 1e-3], [3e-4, 0.73e-3]] {
            let late = TorqueLag::late(&[lag, delay], 2e-4, &ramp());
            let behind = (ramp()[150] - late[150]) / 0.1 * 2e-4;
            assert!((behind - lag - delay).abs() < 1e-9, "{lag} {delay}: {behind}");
        }
    }

    #[test]
    fn no_lag_changes_nothing() {
        let tau: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
        let late = TorqueLag::late(&[0.0, 0.0], 2e-4, &tau);
        assert_eq!(late, tau);
    }
}
