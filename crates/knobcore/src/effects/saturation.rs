//! Saturation: the torque sensor reads no further than its limit.

use super::{Carrier, Context, Effect, Id, Nonlinear, Over, SensorEffect, Survey, Words};
use crate::motion::Motion;
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Noise in times of the range of which nothing of a limit is left: a share is taken of every torque, the same to a fiftieth.
/// While something else is missing, its error is noise too.
const TAKES_A_SHARE: f64 = 3.0;

/// What the torque and its noise read on average, cut at -limit and +limit: the sensor cuts the noise with the torque,
/// so that near its limit it reads less than the torque.
pub struct Saturation;

/// Times its limit, and standard deviations of the noise on top, that a reading may be,
const BEYOND: f64 = 1.1;
const SURE: f64 = 3.0;
/// but for this share of them, which may be spikes.
const OFTEN: f64 = 0.01;

/// Standard deviations of a normal distribution in the scale of the logistic one that is next to it (Camilli 1994).
const LOGISTIC: f64 = 1.702;
/// Scale of a noise that is none.
const NONE: f64 = 1e-12;
/// Noise of a knob that hides a limit, as a share of that.
const HARDLY_ANY: f64 = 1e-6;

impl Effect<2> for Saturation {
    const ID: &'static str = "saturation";
    const LAW: &'static str = "mean of clamp(tau + noise, -limit, limit)";
    const SOURCE: &'static str = "range of the torque sensor; 180 mN m on the rig of the haptic-camera paper";
    const SHOWS: &'static str = "at the largest torques";
    const CONFUSED: &'static [&'static str] = &["quadratic_drag", "end_stop"];
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::Everything);
    const WORDS: Words = Words {
        title: "torque saturation",
        name: "the torque reading is at its limit",
        about: "Torques beyond what can be read, or what the motor is given, all read the same.",
        causes: &[
            "a sensor of too small a range, or a drive's limit of current",
            "a gain that is set too high",
            "impacts at a stop or in backlash",
        ],
        remedies: &[
            "use a sensor of a larger range, or a lower gain",
            "move more gently, or stay off the stops",
            "leave the clipped samples out, which is done unless this effect is asked for",
        ],
        latex: r"\operatorname{E}\,\operatorname{clamp}(\tau + \sigma n,\,-\tau_{\max},\,\tau_{\max})",
    };
    const OVER: Over = Over::Torque;
    const CLIPS: bool = true;
    const PARAMS: [Param; 2] = [
        Param::shape("limit", Unit::of(1, 0, 0), [1e-9, 1e9], 1e9, "largest reading"),
        Param::shape(
            "noise",
            Unit::of(1, 0, 0),
            [0.0, 1e9],
            0.0,
            "standard deviation of the noise that is cut too",
        ),
    ];

    fn starts(survey: &Survey) -> Vec<[f64; 2]> {
        // Where readings are not cut, noise reaches beyond the limit.
        let limits = [0.995, 0.97, 0.9].map(|q| Survey::quantile(&survey.torque, q).max(1e-9));
        limits.into_iter().map(|limit| [limit, 0.02 * limit]).collect()
    }

    /// No sensor reads beyond its limit, nor has it noise of all that it reads: that takes its share of every torque, and
    /// the others grow to make up for it. Beside another effect a limit can hide that one's misfit; readings that repeat
    /// at it are the proof.
    fn implausible(&[limit, noise]: &[f64; 2], context: &Context) -> Vec<String> {
        if noise > TAKES_A_SHARE * limit {
            return vec!["it cuts far more noise than it has range: no sensor reads so".into()];
        }
        let most = BEYOND * limit + SURE * context.noise_floor.max(0.0);
        let beyond = context.torque.iter().filter(|torque| torque.abs() > most).count();
        if beyond as f64 > OFTEN * context.torque.len() as f64 {
            return vec!["readings go far beyond it: it is no limit of theirs".into()];
        }
        if context.first || context.clipped {
            return Vec::new();
        }
        vec!["no reading repeats at such a limit".into()]
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 2] {
        // By the share of the samples that it cuts off; the noise is that of the sensor, which has its own.
        carrier.sized(Id::Saturation, [0.005, 0.35], |cut| {
            let limit = Survey::quantile(&carrier.survey.torque, 1.0 - cut).max(1e-9);
            [limit, HARDLY_ANY * limit]
        })
    }
}

impl SensorEffect<2> for Saturation {
    #[inline(always)]
    fn sense<T: Scalar>([limit, noise]: &[T; 2], _: &Motion<T>, tau: T) -> T {
        let scale = (*noise / T::of(LOGISTIC)).max(T::of(NONE));
        tau - beyond(tau - *limit, scale) + beyond(-tau - *limit, scale)
    }
}

/// The mean of what reaches beyond nought of a number with logistic noise.
#[inline(always)]
fn beyond<T: Scalar>(x: T, scale: T) -> T {
    x.max(T::of(0.0)) + scale * (T::of(1.0) + (-x.abs() / scale).exp()).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    fn read(tau: f64, noise: f64) -> f64 {
        Saturation::sense(&[0.18, noise], &Motion::exact(0.0, 0.0, 1.0, 0.0), tau)
    }

    #[test]
    fn a_limit_that_readings_pass_is_none() {
        let said = |beyond: usize| {
            let torque = (0..1000).map(|i| if i < beyond { -0.3 } else { 0.17 }).collect();
            let context = Context { torque, first: true, noise_floor: f64::NAN, ..Context::default() };
            Saturation::implausible(&[0.18, 0.0], &context).len()
        };
        assert_eq!([said(0), said(9), said(11)], [0, 0, 1]);
    }

    #[test]
    fn the_sensor_reads_true_within_its_range_and_its_limit_beyond() {
        for (tau, reads) in [(0.1, 0.1), (0.3, 0.18), (-0.3, -0.18)] {
            assert!((read(tau, 0.0) - reads).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_beyond_its_range_takes_a_share_of_every_torque_and_is_no_limit() {
        let share = |tau: f64| read(tau, 30.0 * 0.18) / tau;
        assert!((share(0.01) / share(0.17) - 1.0).abs() < 1e-3);
        let said = |noise: f64| {
            Saturation::implausible(&[0.18, noise], &Context { first: true, ..Context::default() }).len()
        };
        assert_eq!([said(0.0), said(0.53), said(0.55)], [0, 0, 1]);
    }

    #[test]
    fn near_its_limit_it_reads_what_noise_that_is_cut_there_leaves_on_average() {
        let (mut random, sd) = (Noise::new(3), 0.004);
        for tau in [0.17, 0.178, 0.18, 0.182, 0.19, -0.18] {
            let readings = 200_000;
            let mean = (0..readings).map(|_| (tau + sd * random.normal()).clamp(-0.18, 0.18)).sum::<f64>()
                / f64::from(readings);
            assert!((read(tau, sd) - mean).abs() < 0.03 * sd, "{} for {mean} at {tau}", read(tau, sd));
        }
    }
}
