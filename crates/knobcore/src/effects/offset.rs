//! Offset: the zero of the torque sensor.

use super::{Carrier, Effect, Over, SensorEffect, TakenUp, Words};
use crate::motion::Motion;
use crate::param::{Param, Unit};
use crate::scalar::Scalar;

/// tau + tau0.
///
/// A constant torque is the same column as the difference of `coulomb` pos and neg, so it is determined
/// only where those are tied (`neg = "coulomb.pos"` in the model file).
pub struct Offset;

impl Effect<1> for Offset {
    const ID: &'static str = "offset";
    const LAW: &'static str = "tau + tau0";
    const SOURCE: &'static str = "P0 of the polynomials named beside Equation 1 of the haptic-camera paper";
    const SHOWS: &'static str = "everywhere alike";
    const WORDS: Words = Words {
        title: "torque offset",
        name: "the zero of the torque reading is off",
        about: "A constant torque is read where there is none.",
        causes: &[
            "a sensor whose zero was not set",
            "the weight of a part that hangs on the sensor",
            "a mount under strain",
        ],
        remedies: &["set the zero with the knob taken off", "mount the sensor without strain"],
        latex: r"\tau + \tau_0",
    };
    const OVER: Over = Over::Torque;
    const TAKEN_UP: Option<TakenUp> = Some(TakenUp {
        by: &["coulomb.neg", "coulomb.pos"],
        why: "a constant torque is what dry friction that differs between the directions makes",
    });
    const EVERY_RUN: bool = true;
    const PARAMS: [Param; 1] = [Param::linear("tau0", Unit::of(1, 0, 0), "constant torque").of_a_run()];

    fn typical(carrier: &Carrier<'_>) -> [f64; 1] {
        [4.0 * carrier.floor]
    }
}

impl SensorEffect<1> for Offset {
    #[inline(always)]
    fn sense<T: Scalar>([tau0]: &[T; 1], _: &Motion<T>, tau: T) -> T {
        tau + *tau0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_shifts_every_reading_alike() {
        let motion = Motion::exact(0.0, 0.0, 1.0, 0.0);
        assert_eq!(Offset::sense(&[-3.0], &motion, 5.0), 2.0);
        assert_eq!(Offset::sense(&[-3.0], &motion, -5.0), -8.0);
    }
}
