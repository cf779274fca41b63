//! tooth: say in one line what it is.

use super::{Effect, LoadEffect, Survey, Words, formula};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// 1 + h exp(-((theta - c)/b)^2) (2 + sign(theta) tanh(3 n)).
///
/// Say why that is the law, and what it leaves out.
pub struct Tooth;

impl Effect<4> for Tooth {
    const ID: &'static str = "tooth";
    const LAW: &'static str = "1 + h exp(-((theta - c)/b)^2) (2 + sign(theta) tanh(3 n))";
    const SOURCE: &'static str = "author, year and equation";
    const SHOWS: &'static str = "where in a measurement";
    const TOUCHES: &'static [Channel] = &[Channel::FrictionScale];
    const WORDS: Words = Words {
        title: "tooth",
        name: "what a person would say is there (tooth)",
        about: "One sentence of what it is.",
        causes: &["what usually brings it about"],
        remedies: &["what takes it away"],
        latex: r"1 + h exp(-((theta - c)/b)^2) (2 + sign(theta) tanh(3 n))",
    };
    const PARAMS: [Param; 4] = [
        Param::shape("h", Unit::NUMBER, [f64::NEG_INFINITY, f64::INFINITY], 0.0, "h"),
        Param::shape("c", Unit::of(0, 1, 0), [f64::NEG_INFINITY, f64::INFINITY], 1.0, "c"),
        Param::shape("b", Unit::of(0, 1, 0), [0.01, 3.0], 1.0, "b"),
        Param::shape("n", Unit::NUMBER, [f64::NEG_INFINITY, f64::INFINITY], 1.0, "n"),
    ];

    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; 4]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
}

impl LoadEffect<4> for Tooth {
    #[inline(always)]
    fn load<T: Scalar>(&[h, c, b, n]: &[T; 4], motion: &Motion<T>) -> Load<T> {
        Load::friction_scale(
            (T::of(1.0)
                + h * (-formula::raised((motion.theta - c) / b, 2.0)).exp()
                    * (T::of(2.0) + formula::sign(motion.theta) * formula::tanh(T::of(3.0) * n)))
            .max(T::of(0.001)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_answers_what_the_formula_did_that_it_was_written_from() {
        for ([t, theta, omega, alpha], answer) in [
            ([0.028, -0.456, 0.412, -15.186], 1.0048889240655192),
            ([0.432, -2.123, -4.931, 19.251], 1.0),
            ([0.374, 1.308, 8.133, 25.422], 1.0000016874517073),
            ([1.509, -0.52, 10.006, -26.035], 1.0018376422478181),
            ([1.26, -3.257, -0.049, -9.309], 1.0),
            ([0.142, -1.887, 1.129, 24.315], 1.0),
        ] {
            let motion = Motion::exact(t, theta, omega, alpha);
            let own: f64 = Tooth::load(&[0.5, 0.2, 0.3, 0.4], &motion).friction_scale;
            assert!((own - answer).abs() <= 1e-12 * answer.abs(), "{own} {answer}");
        }
    }
}
