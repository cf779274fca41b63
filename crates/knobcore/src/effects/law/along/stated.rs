//! A formula along whole columns, and with derivatives.

use super::Along;
use super::block::{BLOCK, Totals, filled};
use super::gradient::Gradient;
use super::response::Response;
use crate::effects::formula::starts;
use crate::effects::law::stated::Stated;
use crate::effects::law::{D, LEAST};
use crate::effects::{Carrier, Survey};
use crate::motion::{Channel, Load, Motion};
use core::ops::Range;

/// Parameters by which it is differentiated at a time.
const LANES: usize = 2;
/// Columns of a motion.
const ALPHA: usize = 3;
const FORWARD: usize = 4;
/// A block of one number.
const NOUGHT: [f64; BLOCK] = [0.0; BLOCK];
const ONE: [f64; BLOCK] = [1.0; BLOCK];

/// What a law brings into a channel: how many times what it answers, and in which motion if not in that of the block.
type Brought = (Channel, f64, Option<(usize, &'static [f64; BLOCK])>);

impl Stated {
    /// What it brings into which channels.
    fn brings(&self) -> &'static [Brought] {
        match self.channel() {
            Channel::FrictionScale => &[(Channel::FrictionScale, 1.0, None)],
            // Friction per load, to which the direction comes with what there is of it both ways.
            Channel::Mu => &[(Channel::Mu, 1.0, Some((FORWARD, &ONE)))],
            _ if self.stores() => &[
                (Channel::Drive, 1.0, Some((ALPHA, &NOUGHT))),
                (Channel::Inertia, 1.0, Some((ALPHA, &ONE))),
                (Channel::Inertia, -1.0, Some((ALPHA, &NOUGHT))),
            ],
            _ => &[(Channel::Drive, 1.0, None)],
        }
    }

    /// What it answers over a block, packs side by side; where it has no value, what changes nothing.
    fn block(&self, p: &[f64], motion: &[&[f64]; 5], distance: Option<&[f64]>, out: &mut [f64; BLOCK]) {
        self.law.over_block(p, motion, distance, out);
        let factor = self.loads() && self.channel() == Channel::FrictionScale;
        let neutral = f64::from(u8::from(factor));
        let [_, theta, omega, ..] = motion;
        for (at, own) in out.iter_mut().enumerate().take(theta.len()) {
            if !own.is_finite() {
                self.fail(p, *own, [theta[at], omega[at]]);
                *own = neutral;
            } else if factor {
                *own = own.max(LEAST);
            }
        }
    }

    /// The derivatives of that by the parameters that have a column, some at a time; `take` gets those columns.
    fn differentiate(
        &self,
        p: &[f64],
        columns: &[Option<usize>],
        over: (&[&[f64]; 5], Option<&[f64]>),
        mut take: impl FnMut(&[Option<usize>], &[[f64; BLOCK]]),
    ) {
        let asked: Vec<usize> = (0..columns.len()).filter(|i| columns[*i].is_some()).collect();
        for few in asked.chunks(LANES) {
            match few {
                [_] => self.by_some::<1>(p, columns, few, over, &mut take),
                _ => self.by_some::<LANES>(p, columns, few, over, &mut take),
            }
        }
    }

    fn by_some<const L: usize>(
        &self,
        p: &[f64],
        columns: &[Option<usize>],
        few: &[usize],
        (motion, distance): (&[&[f64]; 5], Option<&[f64]>),
        take: &mut impl FnMut(&[Option<usize>], &[[f64; BLOCK]]),
    ) {
        let mut slopes = [[0.0; BLOCK]; L];
        self.law.slopes_block(p, few, motion, distance, &mut slopes);
        for slope in slopes.iter_mut().flatten() {
            // What cannot be worked out is told where its value is.
            *slope = if slope.is_finite() { *slope } else { 0.0 };
        }
        let of: [Option<usize>; L] = core::array::from_fn(|i| columns[*few.get(i)?]);
        take(&of, &slopes);
    }
}

impl Along for Stated {
    fn starts(&self, survey: &Survey) -> Vec<Vec<f64>> {
        starts(self.info.params, survey)
    }

    fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64> {
        carrier.by_unit(self.info.params)
    }

    /// The distances along the motion.
    fn kept(&self, _: &[f64], _: &[Option<usize>], motion: [&[f64]; 5]) -> Vec<f64> {
        if self.loads() { self.law.distance(&motion) } else { Vec::new() }
    }

    fn load_carried(&self, p: &[D], state: &mut [D], motion: &Motion<D>, sum: &mut Load<D>) {
        if self.loads() {
            self.add(p, state, motion, sum);
        }
    }

    fn total(&self, p: &[f64], kept: &mut [f64], totals: &mut Totals<'_>) {
        if self.loads() {
            let (motion, distance) = (totals.motion, part(kept, totals.block.clone()));
            for (channel, times, other) in self.brings() {
                let mut own = [0.0; BLOCK];
                self.block(p, &changed(motion, *other), distance, &mut own);
                own.iter_mut().for_each(|own| *own *= times);
                totals.add_block(*channel, &own);
            }
            if self.channel() == Channel::Mu {
                totals.add_block(Channel::PositionShare, &ONE);
                totals.add_block(Channel::InertiaShare, &ONE);
            }
        }
    }

    fn slopes(&self, p: &[f64], columns: &[Option<usize>], kept: &mut [f64], gradient: &mut Gradient<'_>) {
        if !self.loads() || columns.iter().all(Option::is_none) {
            return;
        }
        let (motion, block) = (gradient.totals.motion, gradient.totals.block.clone());
        let distance = part(kept, block);
        for (channel, times, other) in self.brings() {
            let motion = changed(motion, *other);
            // A factor is told from the others that it multiplies by itself.
            let mut weight = [*times; BLOCK];
            if *channel == Channel::FrictionScale {
                self.block(p, &motion, distance, &mut weight);
                weight.iter_mut().for_each(|own| *own = if *own > LEAST { 1.0 / *own } else { 0.0 });
            }
            self.differentiate(p, columns, (&motion, distance), |columns, slopes| {
                gradient.chain_block(*channel, columns, &weight, slopes);
            });
        }
    }

    /// It adds to what is measured.
    fn pass(&self, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
        if self.loads() {
            return;
        }
        let distance = self.law.distance(&over.motion);
        for start in (0..over.torque.len()).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(over.torque.len());
            let mut end = [[0.0; BLOCK]; 5];
            let motion = filled(over.motion.map(|column| &column[block.clone()]), &mut end);
            let (distance, mut own) = (part(&distance, block.clone()), [0.0; BLOCK]);
            self.block(p, &motion, distance, &mut own);
            over.torque[block.clone()].iter_mut().zip(own).for_each(|(torque, own)| *torque += own);
            self.differentiate(p, columns, (&motion, distance), |columns, slopes| {
                for (column, own) in columns.iter().zip(slopes) {
                    if let Some(column) = column.and_then(|c| over.slopes.get_mut(c)) {
                        column[block.clone()].iter_mut().zip(own).for_each(|(sum, own)| *sum += *own);
                    }
                }
            });
        }
    }
}

/// A motion with another column, where one is given.
fn changed<'a>(mut motion: [&'a [f64]; 5], other: Option<(usize, &'static [f64; BLOCK])>) -> [&'a [f64]; 5] {
    if let Some((at, column)) = other {
        motion[at] = column;
    }
    motion
}

/// A block of the distances, where there are some.
fn part(distance: &[f64], block: Range<usize>) -> Option<&[f64]> {
    distance.get(block)
}
