//! A law over whole columns of a motion.

use super::distance::distance;
use super::parse::PARAMETERS;
use super::{Formula, Room};
use crate::effects::law::along::block::{BLOCK, filled};
use crate::isa;
use crate::motion::Motion;
use crate::scalar::{Dual, Scalar, WIDE, Wide};
use pulp::NullaryFnOnce;

impl Formula {
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
        let p: [Wide; PARAMETERS] = core::array::from_fn(|i| Wide::of(self.p.get(i).copied().unwrap_or(0.0)));
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
            core::array::from_fn(|i| Dual::seeded(self.p.get(i).copied().unwrap_or(0.0), lane(i)));
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
