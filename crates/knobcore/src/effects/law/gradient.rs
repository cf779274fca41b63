//! The second half of a response: each effect's own derivatives, by the chain rule through the channels of its load.

use super::block::{CHANNELS, Channels, PLAIN, SCALE, Totals, channels, load_of};
use super::seeded;
use crate::effects::{LoadEffect, MemoryEffect};
use crate::motion::{Channel, Load, Motion, Touched};
use crate::scalar::{Dual, LANES, Pack, Packed, Scalar};

/// The gradient of the torque to the channels of the load over a block.
pub struct Gradient<'a> {
    pub(super) totals: Totals<'a>,
    pub(super) by: &'a mut Channels,
    pub(super) slopes: &'a mut [Vec<f64>],
}

impl Gradient<'_> {
    /// Chain rule: derivatives of the torque where those of an effect's own load are given.
    #[inline(always)]
    fn through<const N: usize>(&self, at: usize, load: &Load<Dual<Pack, N>>, touches: Touched) -> [Pack; N] {
        if self.totals.plain {
            self.summed::<N, PLAIN>(at, load, touches)
        } else {
            self.summed::<N, CHANNELS>(at, load, touches)
        }
    }

    /// The chain rule over the first `C` channels.
    #[inline(always)]
    fn summed<const N: usize, const C: usize>(
        &self,
        at: usize,
        load: &Load<Dual<Pack, N>>,
        touches: Touched,
    ) -> [Pack; N] {
        let own = channels(load);
        let mut sums = [Pack::of(0.0); N];
        for (channel, own) in own.iter().enumerate().take(C) {
            if !touches[channel] {
                continue;
            }
            let mut by = Pack::load(&self.by[channel], at);
            if channel == SCALE {
                // The derivative of a product by one of its factors.
                by = by * Pack::load(&self.totals.channels[SCALE], at) / own.v;
            }
            for (sum, slope) in sums.iter_mut().zip(own.d) {
                *sum = *sum + by * slope;
            }
        }
        sums
    }

    /// The derivatives of a load, `L` parameters at a time.
    #[inline(always)]
    pub(super) fn chain<const N: usize, const L: usize, E: LoadEffect<N>>(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
    ) {
        for first in (0..N).step_by(L) {
            let columns = columns.get(first..).unwrap_or(&[]);
            let p: [Dual<Pack, L>; N] = seeded(p, first);
            for at in (0..self.totals.block.len()).step_by(LANES) {
                let load = E::load(&p, &self.totals.motion(at).map(Dual::constant));
                let slopes = self.through(at, &load, const { Channel::among(E::TOUCHES) });
                self.add(columns, at, &slopes);
            }
        }
    }

    #[inline(always)]
    pub(super) fn chain_remembering<const N: usize, const M: usize, E: MemoryEffect<N, M>>(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
        state: &mut [f64],
    ) {
        let p: [Dual<f64, N>; N] = seeded(p, 0);
        let mut own: [Dual<f64, N>; M] = std::array::from_fn(|m| dual_from(&state[m * (1 + N)..]));
        let touches = const { Channel::among(E::TOUCHES) };
        for at in (0..self.totals.block.len()).step_by(LANES) {
            let motion: Motion<Pack> = self.totals.motion(at);
            let loads: [Load<Dual<f64, N>>; LANES] =
                std::array::from_fn(|lane| E::load(&p, &mut own, &motion.map(|x| Dual::constant(x.0[lane]))));
            let loads = loads.map(|load| channels(&load));
            let packs: [Dual<Pack, N>; CHANNELS] = std::array::from_fn(|c| {
                if !touches[c] {
                    return Dual::constant(Pack::of(0.0));
                }
                Dual {
                    v: Packed(std::array::from_fn(|lane| loads[lane][c].v)),
                    d: std::array::from_fn(|i| Packed(std::array::from_fn(|lane| loads[lane][c].d[i]))),
                }
            });
            let slopes = self.through(at, &load_of(packs), touches);
            self.add(columns, at, &slopes);
        }
        for (slots, value) in state.chunks_mut(1 + N).zip(own) {
            slots[0] = value.v;
            slots[1..].copy_from_slice(&value.d);
        }
    }

    /// Derivatives through one channel that were worked out for the whole motion at once, after its values there:
    /// columns one after the other, those of the parameters that are asked for.
    pub(super) fn chain_columns(&mut self, channel: Channel, columns: &[Option<usize>], kept: &[f64]) {
        let block = self.totals.block.clone();
        let mut kept = kept.chunks(self.totals.whole[0].len().max(1));
        let Some(values) = kept.next() else { return };
        let weight = |i: usize| {
            let by = self.by[channel as usize][i];
            match values[block.start + i] {
                own if channel == Channel::FrictionScale => by * self.totals.channels[SCALE][i] / own,
                _ => by,
            }
        };
        for (column, own) in columns.iter().filter_map(|column| *column).zip(kept) {
            let Some(column) = self.slopes.get_mut(column) else { continue };
            for (i, at) in block.clone().enumerate() {
                column[at] += weight(i) * own[at];
            }
        }
    }

    #[inline(always)]
    fn add(&mut self, columns: &[Option<usize>], at: usize, more: &[Pack]) {
        let block = self.totals.block.clone();
        for (column, slope) in columns.iter().zip(more) {
            if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                let column = &mut column[block.clone()];
                (Pack::load(column, at) + *slope).store(column, at);
            }
        }
    }
}

fn dual_from<const N: usize>(slots: &[f64]) -> Dual<f64, N> {
    let slot = |i: usize| slots.get(i).copied().unwrap_or(0.0);
    Dual { v: slot(0), d: std::array::from_fn(|i| slot(1 + i)) }
}
