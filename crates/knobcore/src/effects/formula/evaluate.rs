//! A law at work: act by act over numbers, packs of samples, or either with derivatives, without allocation.

use super::functions::{called, power, raised, spline};
use super::program::{Act, KEPT, Source};
use super::{Formula, Variable};
use crate::motion::Motion;
use crate::prelude::*;
use crate::scalar::Scalar;

/// What a law is worked out in: kept from sample to sample, for it is larger than what most laws compute.
#[derive(Debug)]
pub(crate) struct Room<T>([T; KEPT]);

impl<T: Scalar> Room<T> {
    /// An empty one.
    #[inline(always)]
    pub fn new() -> Self {
        Self([T::ZERO; KEPT])
    }
}

impl Formula {
    /// What it answers at one instant, where the knob has gone `distance` since it turned round.
    #[inline(always)]
    pub(crate) fn worked<T: Scalar>(
        &self,
        room: &mut Room<T>,
        p: &[T],
        motion: &Motion<T>,
        distance: T,
    ) -> T {
        let mut last = T::ZERO;
        for act in &self.program {
            let kept = &room.0;
            let from = |source: Source| match source {
                Source::Number(x) => T::of(x),
                Source::Parameter(at) => p.get(usize::from(at)).copied().unwrap_or(T::ZERO),
                Source::Kept(at) => kept[usize::from(at) % KEPT],
                Source::Motion(Variable::Time) => motion.t,
                Source::Motion(Variable::Theta) => motion.theta,
                Source::Motion(Variable::Omega) => motion.omega,
                Source::Motion(Variable::Alpha) => motion.alpha,
                Source::Motion(Variable::Direction) => motion.direction(),
                Source::Motion(Variable::Distance) => distance,
                // Who asks what friction there is per load multiplies by it.
                Source::Motion(Variable::Load) => T::of(1.0),
            };
            last = match *act {
                Act::Take(source) => from(source),
                Act::Keep(at) => {
                    room.0[usize::from(at) % KEPT] = last;
                    last
                }
                Act::Add(source) => last + from(source),
                Act::Subtract(source) => last - from(source),
                Act::From(source) => from(source) - last,
                Act::Multiply(source) => last * from(source),
                Act::Divide(source) => last / from(source),
                Act::Into(source) => from(source) / last,
                Act::Least(source) => last.min(from(source)),
                Act::Most(source) => last.max(from(source)),
                Act::Negate => -last,
                Act::Square => last * last,
                Act::Raise(exponent) => raised(last, exponent),
                Act::ToThe(source) => power(last, from(source)),
                Act::Exponent(source) => power(from(source), last),
                Act::Call(function) => called(function, last),
                Act::Spline(at) => spline(self.splines.get(usize::from(at)).map_or(&[], Vec::as_slice), last),
            };
        }
        last
    }

    /// What it answers at one instant, right after a reversal.
    #[inline]
    pub fn at<T: Scalar>(&self, p: &[T], motion: &Motion<T>) -> T {
        self.worked(&mut Room::new(), p, motion, T::ZERO)
    }
}
