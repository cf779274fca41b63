//! The second half of a response: each effect's own derivatives, by the chain rule through the channels of its load.

use super::block::{BLOCK, CHANNELS, Channels, PLAIN, SCALE, Totals, channels};
use crate::effects::LoadEffect;
use crate::effects::law::seeded;
use crate::motion::{Channel, Load, Touched};
use crate::scalar::{Dual, Known, Packed, Scalar, lane_by_lane};

/// The gradient of the torque to the channels of the load over a block.
pub struct Gradient<'a> {
    pub(super) totals: Totals<'a>,
    pub(super) by: &'a mut Channels,
    /// Derivatives by an effect's own parameters over the block, before they come to their columns.
    pub(super) own: &'a mut Channels,
    pub(super) slopes: &'a mut [Vec<f64>],
}

impl Gradient<'_> {
    /// Chain rule: derivatives of the torque where those of an effect's own load are given.
    #[inline(always)]
    pub(super) fn through<V: Differentiates<W>, const W: usize, const N: usize>(
        &self,
        at: usize,
        load: &Load<Dual<V, N>>,
        touches: Touched,
    ) -> [Packed<W>; N] {
        if self.totals.plain {
            self.summed::<V, W, N, PLAIN>(at, load, touches)
        } else {
            self.summed::<V, W, N, CHANNELS>(at, load, touches)
        }
    }

    /// The chain rule over the first `C` channels.
    #[inline(always)]
    fn summed<V: Differentiates<W>, const W: usize, const N: usize, const C: usize>(
        &self,
        at: usize,
        load: &Load<Dual<V, N>>,
        touches: Touched,
    ) -> [Packed<W>; N] {
        let own = channels(load);
        let mut sums = Dual::<V, N>::ZERO;
        lane_by_lane!(C, channel => {
            if let (true, Some(own), Some(by)) = (touches[channel], own.get(channel), self.by.get(channel)) {
                let mut by = Packed::of_packs(by, at);
                if channel == SCALE {
                    // The derivative of a product by one of its factors.
                    by = by * Packed::of_packs(&self.totals.channels[SCALE], at) / own.v.pack();
                }
                sums = sums + *own * Dual::constant(V::of_pack(by));
            }
        });
        sums.slopes(V::pack)
    }

    /// The derivatives of a load, `L` parameters and `W` samples at a time.
    #[inline(always)]
    pub(super) fn chain<const W: usize, const N: usize, const L: usize, E: LoadEffect<N>>(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
    ) {
        if N == L {
            return self.some::<Known<Packed<W>>, W, N, L, E>(p, columns, 0);
        }
        for first in (0..N).step_by(L) {
            self.some::<Packed<W>, W, N, L, E>(p, columns, first);
        }
    }

    /// The derivatives by the `L` parameters from `first` on.
    #[inline(always)]
    fn some<V: Differentiates<W>, const W: usize, const N: usize, const L: usize, E: LoadEffect<N>>(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
        first: usize,
    ) {
        let columns = columns.get(first..).unwrap_or(&[]);
        let p: [Dual<V, L>; N] = seeded(p, first);
        for at in (0..self.totals.block.len()).step_by(W) {
            let motion = self.totals.motion(at).map(|x| Dual::constant(V::of_pack(x)));
            let slopes = self.through(at, &E::load(&p, &motion), const { Channel::among(E::TOUCHES) });
            lane_by_lane!(L, lane => {
                self.put(lane, at, slopes[lane]);
            });
        }
        self.add(columns, L);
    }

    /// Derivatives by the parameter at `place` over a pack of samples.
    #[inline(always)]
    pub(super) fn put<const W: usize>(&mut self, place: usize, at: usize, slope: Packed<W>) {
        if let Some(own) = self.own.get_mut(place) {
            slope.into_packs(own, at);
        }
    }

    /// Adds what was put at the first places to these columns.
    #[inline(always)]
    pub(super) fn add(&mut self, columns: &[Option<usize>], places: usize) {
        for (column, own) in columns.iter().zip(self.own.iter().take(places)) {
            if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                column[self.totals.block.clone()].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            }
        }
    }

    /// Chain rule through one channel over the block: an effect's derivatives there by the parameters whose columns
    /// these are, each with a weight, of a factor its inverse.
    pub(super) fn chain_block(
        &mut self,
        channel: Channel,
        columns: &[Option<usize>],
        weight: &[f64; BLOCK],
        slopes: &[[f64; BLOCK]],
    ) {
        let (mut through, scale) = (self.by[channel as usize], &self.totals.channels[SCALE]);
        through.iter_mut().zip(weight).for_each(|(by, weight)| *by *= weight);
        if channel == Channel::FrictionScale {
            // The derivative of a product by one of its factors.
            through.iter_mut().zip(scale).for_each(|(by, scale)| *by *= scale);
        }
        for (column, own) in columns.iter().zip(slopes) {
            if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                let sums = column[self.totals.block.clone()].iter_mut().zip(own).zip(&through);
                sums.for_each(|((sum, own), by)| *sum += own * by);
            }
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
}

/// What loads are differentiated with: packs of samples. Where each parameter has a lane of its own, which lanes vanish is
/// known; where they take turns, it changes.
pub(super) trait Differentiates<const W: usize>: Scalar {
    fn of_pack(x: Packed<W>) -> Self;
    fn pack(self) -> Packed<W>;
}

impl<const W: usize> Differentiates<W> for Packed<W> {
    #[inline(always)]
    fn of_pack(x: Packed<W>) -> Self {
        x
    }
    #[inline(always)]
    fn pack(self) -> Packed<W> {
        self
    }
}

impl<const W: usize> Differentiates<W> for Known<Packed<W>> {
    #[inline(always)]
    fn of_pack(x: Packed<W>) -> Self {
        Self::any(x)
    }
    #[inline(always)]
    fn pack(self) -> Packed<W> {
        self.x
    }
}
