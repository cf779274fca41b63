//! hum: say in one line what it is.

use super::{Effect, SensorEffect, Survey, Words, formula};
use crate::motion::Motion;
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// (a sin(v t) + c cos(v t)) exp(-t/T) - k sqrt(1 + |omega|/T2).
///
/// Say why that is the law, and what it leaves out.
pub struct Hum;

impl Effect<6> for Hum {
    const ID: &'static str = "hum";
    const LAW: &'static str = "(a sin(v t) + c cos(v t)) exp(-t/T) - k sqrt(1 + |omega|/T2)";
    const SOURCE: &'static str = "author, year and equation";
    const SHOWS: &'static str = "where in a measurement";
    const WORDS: Words = Words {
        title: "hum",
        name: "what a person would say is there (hum)",
        about: "One sentence of what it is.",
        causes: &["what usually brings it about"],
        remedies: &["what takes it away"],
        latex: r"(a sin(v t) + c cos(v t)) exp(-t/T) - k sqrt(1 + |omega|/T2)",
    };
    const PARAMS: [Param; 6] = [
        Param::linear("a", Unit::of(1, 0, 0), "a"),
        Param::shape("v", Unit::of(0, 0, -1), [f64::NEG_INFINITY, f64::INFINITY], 1.0, "v"),
        Param::linear("c", Unit::of(1, 0, 0), "c"),
        Param::shape("T", Unit::of(0, 0, 1), [f64::NEG_INFINITY, f64::INFINITY], 1.0, "T"),
        Param::linear("k", Unit::of(1, 0, 0), "k"),
        Param::shape("T2", Unit::of(0, 1, -1), [f64::NEG_INFINITY, f64::INFINITY], 1.0, "T2"),
    ];

    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; 6]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
}

impl SensorEffect<6> for Hum {
    #[inline(always)]
    fn sense<T: Scalar>(&[a, v, c, t, k, t2]: &[T; 6], motion: &Motion<T>, tau: T) -> T {
        let part_1 = v * motion.t;
        tau + (a * part_1.sin_cos().0 + c * part_1.sin_cos().1) * (-motion.t / t).exp()
            - k * formula::raised(T::of(1.0) + motion.omega.abs() / t2, 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_answers_what_the_formula_did_that_it_was_written_from() {
        for ([t, theta, omega, alpha], answer) in [
            ([0.028, -0.456, 0.412, -15.186], 0.002924673959564903),
            ([0.432, -2.123, -4.931, 19.251], -0.004990112916030981),
            ([0.374, 1.308, 8.133, 25.422], -0.0002150431541999443),
            ([1.509, -0.52, 10.006, -26.035], -0.0038687314181957318),
            ([1.26, -3.257, -0.049, -9.309], -8.540781943328676e-5),
            ([0.142, -1.887, 1.129, 24.315], -0.002538895228176003),
        ] {
            let motion = Motion::exact(t, theta, omega, alpha);
            let own: f64 = Hum::sense(&[0.004, 40.0, 0.001, 2.5, 0.001, 3.0], &motion, 0.0);
            assert!((own - answer).abs() <= 1e-12 * answer.abs(), "{own} {answer}");
        }
    }
}
