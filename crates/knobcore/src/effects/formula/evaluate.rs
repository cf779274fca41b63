//! A law at work: act by act over numbers, packs of samples, or either with derivatives, without allocation.

use super::distance::distance;
use super::functions::{called, power, raised, spline};
use super::parse::PARAMETERS;
use super::program::{Act, KEPT, Source};
use super::{Formula, Variable};
use crate::effects::law::block::{BLOCK, filled};
use crate::isa;
use crate::motion::Motion;
use crate::scalar::{Dual, Scalar, WIDE, Wide};
use pulp::NullaryFnOnce;

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

    /// What it answers over columns (t, theta, omega, alpha, forward) of one length.
    pub fn over(&self, p: &[f64], columns: &[&[f64]; 5]) -> Vec<f64> {
        let mut answer = vec![0.0; columns[0].len()];
        let distance = self.distance(columns);
        for start in (0..answer.len()).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(answer.len());
            let part = columns.map(|column| &column[block.clone()]);
            let (mut end, mut out) = ([[0.0; BLOCK]; 5], [0.0; BLOCK]);
            let motion = filled(part, &mut end);
            self.over_block(p, &motion, distance.get(block.clone()), &mut out);
            answer[block.clone()].copy_from_slice(&out[..block.len()]);
        }
        answer
    }

    /// The derivative of that by a parameter.
    pub fn slope(&self, p: &[f64], by: usize, columns: &[&[f64]; 5]) -> Vec<f64> {
        let mut slope = vec![0.0; columns[0].len()];
        let distance = self.distance(columns);
        for start in (0..slope.len()).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(slope.len());
            let part = columns.map(|column| &column[block.clone()]);
            let (mut end, mut out) = ([[0.0; BLOCK]; 5], [[0.0; BLOCK]; 1]);
            let motion = filled(part, &mut end);
            self.slopes_block(p, &[by], &motion, distance.get(block.clone()), &mut out);
            slope[block.clone()].copy_from_slice(&out[0][..block.len()]);
        }
        slope
    }

    /// How far the knob has gone since it turned round, along columns; empty where the law does not ask.
    pub(crate) fn distance(&self, [_, theta, _, _, forward]: &[&[f64]; 5]) -> Vec<f64> {
        if !self.remembers() {
            return Vec::new();
        }
        distance(theta, forward)
    }

    /// What it answers over packs side by side, and the distance of their samples.
    pub(crate) fn over_block(
        &self,
        p: &[f64],
        motion: &[&[f64]; 5],
        distance: Option<&[f64]>,
        out: &mut [f64; BLOCK],
    ) {
        let distance = padded(distance);
        isa::dispatch_wide(Answered { law: self, p, motion, distance: &distance, out });
    }

    /// The derivatives of that by some parameters, as many as there is room for.
    pub(crate) fn slopes_block<const L: usize>(
        &self,
        p: &[f64],
        by: &[usize],
        motion: &[&[f64]; 5],
        distance: Option<&[f64]>,
        out: &mut [[f64; BLOCK]; L],
    ) {
        let distance = padded(distance);
        isa::dispatch_wide(Differentiated { law: self, p, by, motion, distance: &distance, out });
    }
}

fn padded(distance: Option<&[f64]>) -> [f64; BLOCK] {
    let mut padded = [0.0; BLOCK];
    padded.iter_mut().zip(distance.unwrap_or_default()).for_each(|(own, distance)| *own = *distance);
    padded
}

/// Work as a value, so that its body is compiled for the machine's instruction set.
struct Answered<'a> {
    law: &'a Formula,
    p: &'a [f64],
    motion: &'a [&'a [f64]; 5],
    distance: &'a [f64; BLOCK],
    out: &'a mut [f64; BLOCK],
}

impl NullaryFnOnce for Answered<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let p: [Wide; PARAMETERS] = std::array::from_fn(|i| Wide::of(self.p.get(i).copied().unwrap_or(0.0)));
        let mut room = Room::new();
        for at in (0..self.motion[0].len()).step_by(WIDE) {
            let (motion, distance) = (Motion::over(self.motion, at), Wide::of_packs(self.distance, at));
            self.law.worked(&mut room, &p, &motion, distance).into_packs(self.out, at);
        }
    }
}

struct Differentiated<'a, const L: usize> {
    law: &'a Formula,
    p: &'a [f64],
    by: &'a [usize],
    motion: &'a [&'a [f64]; 5],
    distance: &'a [f64; BLOCK],
    out: &'a mut [[f64; BLOCK]; L],
}

impl<const L: usize> NullaryFnOnce for Differentiated<'_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let lane = |i: usize| self.by.iter().position(|by| *by == i);
        let p: [Dual<Wide, L>; PARAMETERS] =
            std::array::from_fn(|i| Dual::seeded(self.p.get(i).copied().unwrap_or(0.0), lane(i)));
        let mut room = Room::new();
        for at in (0..self.motion[0].len()).step_by(WIDE) {
            let motion: Motion<Wide> = Motion::over(self.motion, at);
            let distance = Dual::constant(Wide::of_packs(self.distance, at));
            let answer = self.law.worked(&mut room, &p, &motion.map(Dual::constant), distance);
            for (column, slope) in self.out.iter_mut().zip(answer.d) {
                slope.into_packs(column, at);
            }
        }
    }
}
