//! crank: say in one line what it is.

use super::{Effect, LoadEffect, Survey, Words, formula};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// m alpha cos(theta)^2 - h omega^2 sin(2 theta) + g max(theta - c, 0).
///
/// Say why that is the law, and what it leaves out.
pub struct Crank;

impl Effect<4> for Crank {
    const ID: &'static str = "crank";
    const LAW: &'static str = "m alpha cos(theta)^2 - h omega^2 sin(2 theta) + g max(theta - c, 0)";
    const SOURCE: &'static str = "author, year and equation";
    const SHOWS: &'static str = "where in a measurement";
    const TOUCHES: &'static [Channel] = &[Channel::Drive, Channel::Inertia];
    const WORDS: Words = Words {
        title: "crank",
        name: "what a person would say is there (crank)",
        about: "One sentence of what it is.",
        causes: &["what usually brings it about"],
        remedies: &["what takes it away"],
        latex: r"m alpha cos(theta)^2 - h omega^2 sin(2 theta) + g max(theta - c, 0)",
    };
    const PARAMS: [Param; 4] = [
        Param::linear("m", Unit::of(1, -1, 2), "m"),
        Param::linear("h", Unit::of(1, -2, 2), "h"),
        Param::linear("g", Unit::of(1, -1, 0), "g"),
        Param::shape("c", Unit::of(0, 1, 0), [f64::NEG_INFINITY, f64::INFINITY], 1.0, "c"),
    ];

    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; 4]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
}

impl LoadEffect<4> for Crank {
    /// What is in proportion to the acceleration is an inertia.
    #[inline(always)]
    fn load<T: Scalar>(p: &[T; 4], motion: &Motion<T>) -> Load<T> {
        let drive = Self::torque(p, &Motion { alpha: T::of(0.0), ..*motion });
        let inertia = Self::torque(p, &Motion { alpha: T::of(1.0), ..*motion }) - drive;
        Load { drive, inertia, ..Load::none() }
    }
}

impl Crank {
    #[inline(always)]
    fn torque<T: Scalar>(&[m, h, g, c]: &[T; 4], motion: &Motion<T>) -> T {
        m * motion.alpha * formula::raised(motion.theta.sin_cos().1, 2.0)
            - h * (motion.omega * motion.omega) * (T::of(2.0) * motion.theta).sin_cos().0
            + g * (motion.theta - c).max(T::of(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_answers_what_the_formula_did_that_it_was_written_from() {
        for ([t, theta, omega, alpha], answer) in [
            ([0.028, -0.456, 0.412, -15.186], -0.0009739249562208134),
            ([0.432, -2.123, -4.931, 19.251], -0.0004449348587404713),
            ([0.374, 1.308, 8.133, 25.422], -0.002398228222818077),
            ([1.509, -0.52, 10.006, -26.035], 0.0018851799152439933),
            ([1.26, -3.257, -0.049, -9.309], -0.000734823168359187),
            ([0.142, -1.887, 1.129, 24.315], 0.00015795712330868666),
        ] {
            let motion = Motion::exact(t, theta, omega, alpha);
            let own: f64 = {
                let load = Crank::load(&[8e-5, 4e-5, -0.001, 0.1], &motion);
                load.drive + load.inertia * alpha
            };
            assert!((own - answer).abs() <= 1e-12 * answer.abs(), "{own} {answer}");
        }
    }
}
