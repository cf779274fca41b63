//! Saturation: the torque sensor reads no further than its limit.

use super::{Carrier, Context, Effect, Id, Nonlinear, Over, SensorEffect, Survey, Words};
use crate::motion::Motion;
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// tau, cut at -limit and +limit.
pub struct Saturation;

impl Effect<1> for Saturation {
    const ID: &'static str = "saturation";
    const LAW: &'static str = "clamp(tau, -limit, limit)";
    const SOURCE: &'static str = "range of the torque sensor; 180 mN m on the rig of the haptic-camera paper";
    const SHOWS: &'static str = "at the largest torques";
    const CONFUSED: &'static [&'static str] = &["quadratic_drag", "end_stop"];
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::Everything);
    const WORDS: Words = Words {
        name: "the torque sensor is at its limit",
        about: "Torques beyond the sensor's range all read the same.",
        causes: &[
            "a sensor of too small a range",
            "a gain that is set too high",
            "impacts at a stop or in backlash",
        ],
        remedies: &[
            "use a sensor of a larger range, or a lower gain",
            "move more gently, or stay off the stops",
            "leave the clipped samples out, which is done unless this effect is asked for",
        ],
        latex: r"\operatorname{clamp}(\tau,\,-\tau_{\max},\,\tau_{\max})",
    };
    const OVER: Over = Over::Torque;
    const CLIPS: bool = true;
    const PARAMS: [Param; 1] =
        [Param::shape("limit", Unit::of(1, 0, 0), [1e-9, 1e9], 1e9, "largest reading")];

    fn starts(survey: &Survey) -> Vec<[f64; 1]> {
        // Noise reaches beyond the limit, so the largest reading is not it.
        [0.995, 0.97, 0.9].into_iter().map(|q| [Survey::quantile(&survey.torque, q).max(1e-9)]).collect()
    }

    /// Beside another effect a limit can hide that one's misfit; readings that repeat at it are the proof.
    fn implausible(_: &[f64; 1], context: &Context) -> Vec<String> {
        if context.first || context.clipped {
            return Vec::new();
        }
        vec!["no reading repeats at such a limit".into()]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        // By the share of the samples that it cuts off.
        carrier.sized(Id::Saturation, [0.005, 0.35], |cut| {
            [Survey::quantile(&carrier.survey.torque, 1.0 - cut).max(1e-9)]
        })
    }
}

impl SensorEffect<1> for Saturation {
    #[inline(always)]
    fn sense<T: Scalar>([limit]: &[T; 1], _: &Motion<T>, tau: T) -> T {
        tau.min(*limit).max(-*limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensor_reads_true_within_its_range_and_its_limit_beyond() {
        let read = |tau: f64| Saturation::sense(&[0.18], &Motion::exact(0.0, 0.0, 1.0, 0.0), tau);
        assert_eq!((read(0.1), read(0.3), read(-0.3)), (0.1, 0.18, -0.18));
    }
}
