//! A formula as a [`Law`]: by the same numbers as the catalogue's functions, wherever those are evaluated.

use super::block::{BLOCK, Totals, filled};
use super::gradient::Gradient;
use super::response::Response;
use super::{D, LEAST, Law, NARROW};
use crate::effects::formula::{Formula, Room, STATES, follow, starts};
use crate::effects::{Carrier, Info, Place, Survey};
use crate::motion::{Channel, Load, Motion};
use crate::scalar::Scalar;
use std::cell::Cell;
use std::ops::Range;

/// Parameters by which it is differentiated at a time.
const LANES: usize = 2;
/// Parameter values that are kept of what fails.
const TOLD: usize = 12;
/// Columns of a motion.
const ALPHA: usize = 3;
const FORWARD: usize = 4;
/// A block of one number.
const NOUGHT: [f64; BLOCK] = [0.0; BLOCK];
const ONE: [f64; BLOCK] = [1.0; BLOCK];

/// Where a law had no value: which, what it answered, its motion and parameters. In place, since a rendered step may
/// neither allocate nor wait.
#[derive(Clone, Copy)]
struct Failure {
    of: *const Info,
    answer: f64,
    theta: f64,
    omega: f64,
    p: [f64; TOLD],
}

thread_local! {
    /// What went wrong last on this thread: two fits at a time do not see each other's.
    static FAILED: Cell<Option<Failure>> = const { Cell::new(None) };
}

/// What a law brings into a channel: how many times what it answers, and in which motion if not in that of the block.
type Brought = (Channel, f64, Option<(usize, &'static [f64; BLOCK])>);

/// An effect that is written as a formula: a load, friction under one, a factor on the dry friction, or what a sensor adds.
pub struct Stated {
    info: &'static Info,
    /// Its formula.
    pub law: Formula,
}

impl Stated {
    /// The effect of this row of the catalogue.
    pub(crate) fn new(info: &'static Info, law: Formula) -> Self {
        Self { info, law }
    }

    fn loads(&self) -> bool {
        self.info.place == Place::Load
    }

    fn channel(&self) -> Channel {
        self.info.touches.first().copied().unwrap_or(Channel::Drive)
    }

    /// Where it had no value since this was last asked on this thread.
    pub(crate) fn failure(&self) -> Option<String> {
        let failed = FAILED.get().filter(|failed| std::ptr::eq(failed.of, self.info))?;
        FAILED.set(None);
        let Failure { answer, theta, omega, p, .. } = failed;
        let values = self.info.with_values(&p);
        Some(format!("returned {answer} at theta = {theta}, omega = {omega} (with {values}); {NARROW}"))
    }

    /// That parameters are no numbers is no failure of the law.
    #[cold]
    fn fail(&self, p: &[f64], answer: f64, [theta, omega]: [f64; 2]) {
        let told = FAILED.get().is_some_and(|failed| std::ptr::eq(failed.of, self.info));
        if !told && p.iter().all(|x| x.is_finite()) {
            let p = std::array::from_fn(|i| p.get(i).copied().unwrap_or(0.0));
            FAILED.set(Some(Failure { of: self.info, answer, theta, omega, p }));
        }
    }

    /// Whether it has an inertia: the slope over the acceleration, which it is straight over.
    fn stores(&self) -> bool {
        self.info.touches.contains(&Channel::Inertia)
    }

    /// Brings its load at one instant into a sum. What is no number stays none, so that who goes on from there notices.
    #[inline(always)]
    fn add<T: Scalar>(&self, p: &[T], state: &mut [T], motion: &Motion<T>, sum: &mut Load<T>) {
        let distance = if self.law.remembers() { follow(state, motion) } else { T::ZERO };
        let mut room = Room::new();
        let own = if self.channel() == Channel::Mu {
            self.law.worked(&mut room, p, &Motion { forward: T::of(1.0), ..*motion }, distance)
        } else if self.stores() {
            let at = Motion { alpha: T::ZERO, ..*motion };
            let still = self.law.worked(&mut room, p, &at, distance);
            let at = Motion { alpha: T::of(1.0), ..at };
            sum.inertia = sum.inertia + self.law.worked(&mut room, p, &at, distance) - still;
            still
        } else {
            self.law.worked(&mut room, p, motion, distance)
        };
        let value = own.value();
        if !value.is_finite() {
            let mut values = [0.0; TOLD];
            values.iter_mut().zip(p).for_each(|(value, p)| *value = p.value());
            self.fail(&values, value, [motion.theta.value(), motion.omega.value()]);
        }
        match self.channel() {
            Channel::FrictionScale => {
                let factor = if value.is_finite() { own.max(T::of(LEAST)) } else { own };
                sum.friction_scale = sum.friction_scale * factor;
            }
            Channel::Mu => {
                sum.mu = sum.mu + own;
                sum.position_share = sum.position_share + T::of(1.0);
                sum.inertia_share = sum.inertia_share + T::of(1.0);
            }
            _ => sum.drive = sum.drive + own,
        }
    }

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
        let of: [Option<usize>; L] = std::array::from_fn(|i| columns[*few.get(i)?]);
        take(&of, &slopes);
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

impl Law for Stated {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn starts(&self, survey: &Survey) -> Vec<Vec<f64>> {
        starts(self.info.params, survey)
    }

    fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64> {
        carrier.by_unit(self.info.params)
    }

    fn states(&self) -> usize {
        if self.loads() && self.law.remembers() { STATES } else { 0 }
    }

    fn remembers(&self) -> bool {
        self.law.remembers()
    }

    /// The distances along the motion.
    fn kept(&self, _: &[f64], _: &[Option<usize>], motion: [&[f64]; 5]) -> Vec<f64> {
        if self.loads() { self.law.distance(&motion) } else { Vec::new() }
    }

    fn load(&self, p: &[f64], state: &mut [f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        if self.loads() {
            self.add(p, state, motion, sum);
        }
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
