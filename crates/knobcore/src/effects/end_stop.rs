//! End stop: a stiff ramp beyond an angle, on each side.

use super::{Carrier, Context, Effect, Id, LoadEffect, Over, Section, Survey, Words};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::prelude::*;
use crate::scalar::Scalar;

/// Beyond an angle a spring that may grow stiffer and a damper push back: k x (1 + g x) + d dx/dt at the depth x,
/// and never less than nothing.
pub struct EndStop;

/// Share of the samples: stops that hold more are a spring.
const INSIDE: f64 = 0.6;

impl Effect<6> for EndStop {
    const ID: &'static str = "end_stop";
    const LAW: &'static str =
        "max(0, k x (1 + g x) + d dx/dt) against the stop, x = theta - hi with k_hi, lo - theta with k_lo";
    const SOURCE: &'static str =
        "unilateral spring and damper; Hunt & Crossley 1975; Colgate & Schenkel 1997 (virtual wall)";
    const SHOWS: &'static str = "over position, at the ends of the range";
    const CONFUSED: &'static [&'static str] = &["position_polynomial", "return_spring"];
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::PositionLoad];
    const WORDS: Words = Words {
        title: "end stop",
        name: "the motion runs into a stop",
        about: "At an end of the range the knob meets something stiff that pushes it back.",
        causes: &[
            "a mechanical stop of the knob",
            "a cable that is at its end",
            "a knob that touches its housing",
        ],
        remedies: &[
            "record within the stops, if they are not of interest",
            "record into both stops slowly, if they are",
            "look for what touches at the ends",
        ],
        latex: concat!(
            r"\max\bigl(0,\ k\,x\,(1 + g\,x) + d\,\dot x\bigr),\quad x = \theta - ",
            r"\theta_{\text{hi}}\ \text{or}\ \theta_{\text{lo}} - \theta",
        ),
    };
    const OVER: Over = Over::Position;
    const SECTION: Option<Section> = Some(Section::Stops);
    const PARAMS: [Param; 6] = [
        Param::shape("k_lo", Unit::of(1, -1, 0), [0.0, 1e9], 0.0, "stiffness of the lower stop"),
        Param::shape("lo", Unit::of(0, 1, 0), [-1e6, 1e6], -1e6, "where the lower stop begins"),
        Param::shape("k_hi", Unit::of(1, -1, 0), [0.0, 1e9], 0.0, "stiffness of the upper stop"),
        Param::shape("hi", Unit::of(0, 1, 0), [-1e6, 1e6], 1e6, "where the upper stop begins"),
        Param::shape("d", Unit::of(1, -1, 1), [0.0, 1e6], 0.0, "damping within a stop"),
        Param::shape("g", Unit::of(0, -1, 0), [0.0, 1e6], 0.0, "growth of the stiffness with depth"),
    ];

    /// Stops are where the way ends.
    fn implausible(&[k_lo, lo, k_hi, hi, _, _]: &[f64; 6], context: &Context) -> Vec<String> {
        let overlap = k_lo > 0.0 && k_hi > 0.0 && lo >= hi;
        let overlap =
            overlap.then(|| "its stops overlap: between them they are a spring and no stops".to_owned());
        let inside = context.share(|theta| k_hi > 0.0 && theta > hi || k_lo > 0.0 && theta < lo);
        let inside = (inside > INSIDE)
            .then(|| format!("{:.0} % of the samples lie in its stops: it is a spring", 100.0 * inside));
        overlap.into_iter().chain(inside).collect()
    }

    fn starts(survey: &Survey) -> Vec<[f64; 6]> {
        let (low, range) = (Survey::quantile(&survey.theta, 0.0), survey.range().max(1e-9));
        let at = |share: f64| low + share * range;
        // A stop that is not pressed has no derivative: each begins with a little of the torque.
        let stiff = |share: f64| 0.2 * Survey::quantile(&survey.torque, 0.5) / (share * range);
        // Each side on its own: a motion may go far into one stop and hardly into the other.
        let shares = [None, Some(0.03), Some(0.08), Some(0.15), Some(0.25), Some(0.4)];
        let sides = |lower: Option<f64>| shares.map(|upper| [lower, upper]);
        shares
            .into_iter()
            .flat_map(sides)
            .filter(|sides| sides.iter().any(Option::is_some))
            .map(|[lower, upper]| {
                let [k_lo, k_hi] = [lower, upper].map(|share| share.map_or(0.0, stiff));
                // A side without a stop starts where the other has its own.
                let [lo, hi] = [lower.or(upper), upper.or(lower)].map(Option::unwrap_or_default);
                [k_lo, at(lo), k_hi, at(1.0 - hi), 0.0, 0.0]
            })
            .collect()
    }

    fn typical(carrier: &Carrier<'_>) -> [f64; 6] {
        // Within the last of the way at each end, damped as a rubber stop is.
        let (low, range) = (Survey::quantile(&carrier.survey.theta, 0.0), carrier.survey.range().max(1e-9));
        let (lo, hi, slow) = (low + 0.15 * range, low + 0.85 * range, 0.15 * range / carrier.fastest());
        carrier.sized(Id::EndStop, [carrier.floor, 1e3 * carrier.floor], |torque| {
            let k = torque / (0.15 * range);
            [k, lo, 1.2 * k, hi, 0.05 * k * slow, 0.5 / range]
        })
    }
}

impl LoadEffect<6> for EndStop {
    #[inline(always)]
    fn load<T: Scalar>([k_lo, lo, k_hi, hi, d, g]: &[T; 6], motion: &Motion<T>) -> Load<T> {
        let above = pressed([*k_hi, *d, *g], motion.theta - *hi, motion.omega);
        let below = pressed([*k_lo, *d, *g], *lo - motion.theta, -motion.omega);
        Load::position(above - below)
    }
}

/// What a stop answers that is pressed in so far and so fast.
#[inline(always)]
fn pressed<T: Scalar>([k, d, g]: [T; 3], depth: T, rate: T) -> T {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let force = k * depth * (one + g * depth) + d * rate;
    k.where_positive(depth.where_positive(force.max(zero), zero), zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_silent_between_and_pushes_back_beyond() {
        let torque = |theta: f64| {
            EndStop::load(&[2.0, -1.0, 3.0, 1.0, 0.0, 0.0], &Motion::exact(0.0, theta, 0.5, 0.0)).drive
        };
        assert_eq!((torque(-1.0), torque(0.3), torque(1.0)), (0.0, 0.0, 0.0));
        assert_eq!((torque(-1.5), torque(2.0)), (-1.0, 3.0));
    }

    #[test]
    fn a_knob_that_bounces_off_leaves_energy_in_the_stop() {
        let torque = |omega: f64| {
            EndStop::load(&[2.0, -1.0, 3.0, 1.0, 0.4, 0.0], &Motion::exact(0.0, 1.5, omega, 0.0)).drive
        };
        assert!((torque(0.5) - 1.7).abs() < 1e-12 && (torque(-0.5) - 1.3).abs() < 1e-12);
        assert_eq!(torque(-10.0), 0.0, "a stop never holds back");
    }
}
