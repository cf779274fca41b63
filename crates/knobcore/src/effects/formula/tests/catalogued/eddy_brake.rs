//! eddy_brake: say in one line what it is.

use super::{Effect, LoadEffect, Survey, Words, formula};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// 2 a (omega/w) / (1 + (omega/w)^2).
///
/// Say why that is the law, and what it leaves out.
pub struct EddyBrake;

impl Effect<2> for EddyBrake {
    const ID: &'static str = "eddy_brake";
    const LAW: &'static str = "2 a (omega/w) / (1 + (omega/w)^2)";
    const SOURCE: &'static str = "author, year and equation";
    const SHOWS: &'static str = "where in a measurement";
    const TOUCHES: &'static [Channel] = &[Channel::Drive];
    const WORDS: Words = Words {
        title: "eddy_brake",
        name: "what a person would say is there (eddy_brake)",
        about: "One sentence of what it is.",
        causes: &["what usually brings it about"],
        remedies: &["what takes it away"],
        latex: r"2 a (omega/w) / (1 + (omega/w)^2)",
    };
    const PARAMS: [Param; 2] = [
        Param::linear("a", Unit::of(1, 0, 0), "a"),
        Param::shape("w", Unit::of(0, 1, -1), [0.1, 100.0], 1.0, "speed at which it brakes most"),
    ];

    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; 2]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
}

impl LoadEffect<2> for EddyBrake {
    #[inline(always)]
    fn load<T: Scalar>(&[a, w]: &[T; 2], motion: &Motion<T>) -> Load<T> {
        let part_1 = motion.omega / w;
        Load::drive(T::of(2.0) * a * part_1 / (T::of(1.0) + part_1 * part_1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_answers_what_the_formula_did_that_it_was_written_from() {
        for ([t, theta, omega, alpha], answer) in [
            ([0.028, -0.456, 0.412, -15.186], 0.0015809124013368688),
            ([0.432, -2.123, -4.931, 19.251], -0.0027863911689030327),
            ([0.374, 1.308, 8.133, 25.422], 0.001855110440215364),
            ([1.509, -0.52, 10.006, -26.035], 0.0015376099178452073),
            ([1.26, -3.257, -0.049, -9.309], -0.00019588242157644875),
            ([0.142, -1.887, 1.129, 24.315], 0.0034246880498596966),
        ] {
            let motion = Motion::exact(t, theta, omega, alpha);
            let own: f64 = EddyBrake::load(&[0.004, 2.0], &motion).drive;
            assert!((own - answer).abs() <= 1e-12 * answer.abs(), "{own} {answer}");
        }
    }
}
