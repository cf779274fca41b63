//! Effects over whole columns of samples, with exact derivatives.
//!
//! Block by block: first all loads come together, then the friction budget is spent once, with its gradient to
//! every channel of the load; by the chain rule each effect then needs derivatives to its own parameters only,
//! however the loads act on each other.

use super::gradient::Gradient;
use super::{Id, LateEffect, LoadEffect, MemoryEffect, SensorEffect};
use crate::motion::{Channel, Load, Motion};
use crate::scalar::{Dual, LANES, Pack, Scalar};
use std::ops::Range;

/// Samples that are evaluated at a time: their channels stay in the first cache.
pub(super) const BLOCK: usize = 256;
/// Channels of a load that a moving knob feels: drive, inertia, dry friction backward and forward; press, level,
/// friction per press, lag.
pub(super) const CHANNELS: usize = Channel::ALL.len();
/// The first of them, which suffice where nothing shapes the friction.
pub(super) const PLAIN: usize = 4;
/// The channel that multiplies.
pub(super) const LEVEL: usize = Channel::Level as usize;
/// Derivatives of a sensor: its parameters (fewer than this), and last the torque that it senses.
const SENSOR_LANES: usize = 12;
/// Derivative columns that pass through a late sensor at a time.
const AT_ONCE: usize = 4;

/// Columns of a motion, and what a chain of effects makes of them.
///
/// All columns have the length of the torque. A parameter with a column has its derivative there.
pub struct Sweep<'a> {
    /// t, theta, omega, alpha, forward: the fields of [`Motion`].
    pub motion: [&'a [f64]; 5],
    /// Sampling interval, s.
    pub dt: f64,
    /// Torque, N m.
    pub torque: &'a mut [f64],
    /// Derivatives of the torque, N m per unit of their parameter.
    pub slopes: &'a mut [Vec<f64>],
}

/// One effect of a chain: which, its parameters, and the column of each.
pub type Part<'a> = (Id, &'a [f64], &'a [Option<usize>]);

impl Sweep<'_> {
    /// Torque and derivatives of loads on the moving knob; what the columns held is replaced.
    #[inline(always)]
    pub fn loads(&mut self, parts: &[Part<'_>]) {
        let plain = !parts.iter().any(|(id, ..)| id.info().shapes_friction);
        let samples = self.torque.len();
        let mut valued: Vec<Vec<f64>> = parts.iter().map(|part| self.kept(part, 0)).collect();
        let mut sloped: Vec<Vec<f64>> = parts.iter().map(|part| self.kept(part, part.1.len())).collect();
        let (mut channels, mut by) = ([[0.0; BLOCK]; CHANNELS], [[0.0; BLOCK]; CHANNELS]);
        for start in (0..samples).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(samples);
            let mut totals = Totals::new(self.motion, block, plain, &mut channels);
            for ((id, p, _), state) in parts.iter().zip(&mut valued) {
                id.total(p, state, &mut totals);
            }
            let mut gradient = totals.spend(self.torque, self.slopes, &mut by);
            if gradient.slopes.is_empty() {
                continue;
            }
            for ((id, p, columns), state) in parts.iter().zip(&mut sloped) {
                id.slopes(p, columns, state, &mut gradient);
            }
        }
    }

    /// What is kept for an effect from block to block, with `slopes` derivatives: the state of one that
    /// remembers; of a user's, which is called once for all blocks, its torque or its derivatives.
    fn kept(&self, (id, p, columns): &Part<'_>, slopes: usize) -> Vec<f64> {
        match id {
            Id::User(user) if slopes == 0 => user.over(p, self.motion),
            Id::User(user) if !self.slopes.is_empty() => {
                let asked = columns.iter().enumerate().filter(|(_, column)| column.is_some());
                asked.flat_map(|(i, _)| user.slope(p, i, self.motion)).collect()
            }
            _ => vec![0.0; id.states() * (1 + slopes)],
        }
    }

    /// Passes torque and derivatives through the sensors of a chain.
    #[inline(always)]
    pub fn sensors(&mut self, parts: &[Part<'_>]) {
        for (id, p, columns) in parts {
            id.pass(p, columns, self);
        }
    }

    /// A sensor without memory: the chain rule by its own derivative to the torque.
    #[inline(always)]
    pub(super) fn sense<const N: usize, E: SensorEffect<N>>(&mut self, p: &[f64], columns: &[Option<usize>]) {
        let p: [Dual<Pack, SENSOR_LANES>; N] = seeded(p);
        for at in (0..self.torque.len()).step_by(LANES) {
            let mut tau = Dual::constant(Pack::load(self.torque, at));
            tau.d[SENSOR_LANES - 1] = Pack::of(1.0);
            let motion = constant_motion(self.motion, at);
            let sensed = E::sense(&p, &motion, tau);
            sensed.v.store(self.torque, at);
            for column in self.slopes.iter_mut() {
                (Pack::load(column, at) * sensed.d[SENSOR_LANES - 1]).store(column, at);
            }
            add(self.slopes, columns, at, &sensed.d);
        }
    }

    /// A sensor with memory: each derivative column goes through it beside the torque.
    pub(super) fn late<const N: usize, E: LateEffect<N>>(&mut self, p: &[f64], columns: &[Option<usize>]) {
        let own: [Dual<f64, N>; N] = seeded(p);
        let torque: Vec<Dual<f64, N>> = self.torque.iter().map(|tau| Dual::constant(*tau)).collect();
        let fixed: [Dual<f64, AT_ONCE>; N] =
            std::array::from_fn(|i| Dual::constant(p.get(i).copied().unwrap_or(0.0)));
        for few in self.slopes.chunks_mut(AT_ONCE) {
            let beside: Vec<Dual<f64, AT_ONCE>> = (0..torque.len())
                .map(|at| Dual {
                    v: torque[at].v,
                    d: std::array::from_fn(|i| few.get(i).map_or(0.0, |column| column[at])),
                })
                .collect();
            for (at, late) in E::late(&fixed, self.dt, &beside).iter().enumerate() {
                few.iter_mut().zip(late.d).for_each(|(column, slope)| column[at] = slope);
            }
        }
        for (at, late) in E::late(&own, self.dt, &torque).iter().enumerate() {
            self.torque[at] = late.v;
            for (column, slope) in columns.iter().zip(late.d) {
                if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                    column[at] += slope;
                }
            }
        }
    }
}

/// The motion of eight samples, without derivatives.
#[inline(always)]
fn constant_motion<const L: usize>(columns: [&[f64]; 5], at: usize) -> Motion<Dual<Pack, L>> {
    let [t, theta, omega, alpha, forward] = columns.map(|column| Dual::constant(Pack::load(column, at)));
    Motion { t, theta, omega, alpha, forward }
}

/// Adds derivatives of eight samples to their columns.
#[inline(always)]
fn add(slopes: &mut [Vec<f64>], columns: &[Option<usize>], at: usize, more: &[Pack]) {
    for (column, slope) in columns.iter().zip(more) {
        if let Some(column) = column.and_then(|c| slopes.get_mut(c)) {
            (Pack::load(column, at) + *slope).store(column, at);
        }
    }
}

/// Parameters that are differentiated by, one lane each.
#[inline(always)]
pub(super) fn seeded<V: Scalar, const N: usize, const L: usize>(p: &[f64]) -> [Dual<V, L>; N] {
    std::array::from_fn(|i| Dual::seeded(p.get(i).copied().unwrap_or(0.0), Some(i)))
}

#[inline(always)]
pub(super) fn channels<T: Scalar>(load: &Load<T>) -> [T; CHANNELS] {
    let [back, forth] = load.resist;
    [load.drive, load.inertia, back, forth, load.press, load.level, load.mu, load.lag]
}

#[inline(always)]
pub(super) fn load_of<T: Scalar>(
    [drive, inertia, back, forth, press, level, mu, lag]: [T; CHANNELS],
) -> Load<T> {
    Load { drive, inertia, resist: [back, forth], press, level, mu, lag, ..Load::none() }
}

/// A block of every channel.
pub(super) type Channels = [[f64; BLOCK]; CHANNELS];

/// The loads over a block, coming together.
pub(super) struct Totals<'a> {
    pub whole: [&'a [f64]; 5],
    pub motion: [&'a [f64]; 5],
    pub block: Range<usize>,
    pub channels: &'a mut Channels,
    pub plain: bool,
}

impl<'a> Totals<'a> {
    #[inline(always)]
    pub(super) fn new(
        whole: [&'a [f64]; 5],
        block: Range<usize>,
        plain: bool,
        channels: &'a mut Channels,
    ) -> Self {
        for (channel, column) in channels.iter_mut().enumerate().take(if plain { PLAIN } else { CHANNELS }) {
            column.fill(if channel == LEVEL { 1.0 } else { 0.0 });
        }
        if plain {
            channels[LEVEL].fill(1.0);
        }
        let motion = whole.map(|column| &column[block.clone()]);
        Self { whole, motion, block, channels, plain }
    }

    #[inline(always)]
    fn join(&mut self, at: usize, load: &Load<Pack>, touches: [bool; CHANNELS]) {
        if self.plain {
            self.joined::<PLAIN>(at, load, touches)
        } else {
            self.joined::<CHANNELS>(at, load, touches)
        }
    }

    #[inline(always)]
    fn joined<const C: usize>(&mut self, at: usize, load: &Load<Pack>, touches: [bool; CHANNELS]) {
        let own = channels(load);
        for (channel, (column, own)) in self.channels.iter_mut().zip(own).take(C).enumerate() {
            if !touches[channel] {
                continue;
            }
            let before = Pack::load(column, at);
            (if channel == LEVEL { before * own } else { before + own }).store(column, at);
        }
    }

    #[inline(always)]
    pub(super) fn motion(&self, at: usize) -> Motion<Pack> {
        let [t, theta, omega, alpha, forward] = self.motion.map(|column| Pack::load(column, at));
        Motion { t, theta, omega, alpha, forward }
    }

    #[inline(always)]
    pub(super) fn add<const N: usize, E: LoadEffect<N>>(&mut self, p: &[f64]) {
        let p: [Pack; N] = std::array::from_fn(|i| Pack::of(p.get(i).copied().unwrap_or(0.0)));
        for at in (0..self.block.len()).step_by(LANES) {
            let load = E::load(&p, &self.motion(at));
            self.join(at, &load, const { Channel::among(E::TOUCHES) });
        }
    }

    #[inline(always)]
    pub(super) fn add_remembering<const N: usize, const M: usize, E: MemoryEffect<N, M>>(
        &mut self,
        p: &[f64],
        state: &mut [f64],
    ) {
        let p: [f64; N] = super::take(p);
        for at in (0..self.block.len()).step_by(LANES) {
            let motion = self.motion(at);
            let loads: [Load<f64>; LANES] = super::keep(state, |state: &mut [f64; M]| {
                std::array::from_fn(|lane| E::load(&p, state, &motion.map(|x| x.0[lane])))
            });
            let own: [[f64; CHANNELS]; LANES] = loads.map(|load| channels(&load));
            let packs = std::array::from_fn(|c| Pack(std::array::from_fn(|lane| own[lane][c])));
            self.join(at, &load_of(packs), const { Channel::among(E::TOUCHES) });
        }
    }

    pub(super) fn add_user(&mut self, torque: &[f64]) {
        for (total, tau) in self.channels[0].iter_mut().zip(&torque[self.block.clone()]) {
            *total += tau;
        }
    }

    /// Spends the friction budget: the torque over the block, and its gradient to each channel.
    #[inline(always)]
    fn spend<'b>(self, torque: &mut [f64], slopes: &'b mut [Vec<f64>], by: &'b mut Channels) -> Gradient<'b>
    where
        'a: 'b,
    {
        let torque = &mut torque[self.block.clone()];
        for at in (0..self.block.len()).step_by(LANES) {
            let packs: [Pack; CHANNELS] = std::array::from_fn(|c| Pack::load(&self.channels[c], at));
            let motion = self.motion(at);
            if slopes.is_empty() {
                load_of(packs).sliding(&motion).store(torque, at);
            } else if self.plain {
                spend_by::<PLAIN>(packs, &motion, torque, by, at);
            } else {
                spend_by::<CHANNELS>(packs, &motion, torque, by, at);
            }
        }
        Gradient { totals: self, by, slopes }
    }
}

#[inline(always)]
fn spend_by<const C: usize>(
    packs: [Pack; CHANNELS],
    motion: &Motion<Pack>,
    torque: &mut [f64],
    by: &mut Channels,
    at: usize,
) {
    let mut seeds: [Dual<Pack, C>; CHANNELS] = packs.map(Dual::constant);
    for (lane, seed) in seeds.iter_mut().enumerate().take(C) {
        seed.d[lane] = Pack::of(1.0);
    }
    let tau = load_of(seeds).sliding(&motion.map(Dual::constant));
    tau.v.store(torque, at);
    for (column, slope) in by.iter_mut().zip(tau.d) {
        slope.store(column, at);
    }
}
