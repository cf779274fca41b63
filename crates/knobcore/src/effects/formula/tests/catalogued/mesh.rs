//! mesh: say in one line what it is.

use super::{Effect, LoadEffect, Nonlinear, Survey, Words, formula};
use crate::motion::{Channel, Load, Motion};
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// a (1 + b exp(-|omega|/w)) |load| sign(omega).
///
/// Say why that is the law, and what it leaves out.
pub struct Mesh;

impl Effect<3> for Mesh {
    const ID: &'static str = "mesh";
    const LAW: &'static str = "a (1 + b exp(-|omega|/w)) |load| sign(omega)";
    const SOURCE: &'static str = "author, year and equation";
    const SHOWS: &'static str = "where in a measurement";
    const TOUCHES: &'static [Channel] = &[Channel::Mu, Channel::PositionShare, Channel::InertiaShare];
    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::ByLoad);
    const WORDS: Words = Words {
        title: "mesh",
        name: "what a person would say is there (mesh)",
        about: "One sentence of what it is.",
        causes: &["what usually brings it about"],
        remedies: &["what takes it away"],
        latex: r"a (1 + b exp(-|omega|/w)) |load| sign(omega)",
    };
    const PARAMS: [Param; 3] = [
        Param::linear("a", Unit::NUMBER, "a"),
        Param::shape("b", Unit::NUMBER, [f64::NEG_INFINITY, f64::INFINITY], 1.0, "b"),
        Param::shape("w", Unit::of(0, 1, -1), [0.1, 50.0], 1.0, "w"),
    ];

    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; 3]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
}

impl LoadEffect<3> for Mesh {
    #[inline(always)]
    fn load<T: Scalar>(&[a, b, w]: &[T; 3], motion: &Motion<T>) -> Load<T> {
        Load {
            mu: a * (T::of(1.0) + b * (-motion.omega.abs() / w).exp()),
            position_share: T::of(1.0),
            inertia_share: T::of(1.0),
            ..Load::none()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_answers_what_the_formula_did_that_it_was_written_from() {
        for ([t, theta, omega, alpha], answer) in [
            ([0.028, -0.456, 0.412, -15.186], 0.14069165381414603),
            ([0.432, -2.123, -4.931, 19.251], -0.10424831742874241),
            ([0.374, 1.308, 8.133, 25.422], 0.10085686320442022),
            ([1.509, -0.52, 10.006, -26.035], 0.10033588817242758),
            ([1.26, -3.257, -0.049, -9.309], -0.14878988444592037),
            ([0.142, -1.887, 1.129, 24.315], 0.128432219894389),
        ] {
            let motion = Motion::exact(t, theta, omega, alpha);
            let own: f64 = motion.direction() * Mesh::load(&[0.1, 0.5, 2.0], &motion).mu;
            assert!((own - answer).abs() <= 1e-12 * answer.abs(), "{own} {answer}");
        }
    }
}
