//! Friction spent over a block, where all loads have come together.

use super::block::{BLOCK, CHANNELS, Channels, PLAIN, SCALE, SHAPED, Totals, load_of};
use super::gradient::Gradient;
use crate::isa;
use crate::motion::Motion;
use crate::scalar::{Dual, Known, LANES, Pack, Scalar, lane_by_lane};
use pulp::NullaryFnOnce;

impl<'a> Totals<'a> {
    /// Spends the friction budget: the torque over the block, and its gradient to each channel.
    pub(crate) fn spend<'b>(
        self,
        torque: &mut [f64],
        slopes: &'b mut [Vec<f64>],
        [by, own]: &'b mut [Channels; 2],
    ) -> Gradient<'b>
    where
        'a: 'b,
    {
        let mut block = [0.0; BLOCK];
        let by_channels = (!slopes.is_empty()).then_some(&mut *by);
        isa::dispatch(Spent { totals: &self, torque: &mut block, by: by_channels });
        torque[self.block.clone()].iter_mut().zip(block).for_each(|(torque, own)| *torque = own);
        Gradient { totals: self, by, own, slopes }
    }
}

/// The spending as a value, so that its body is compiled for the machine's instruction set.
struct Spent<'a, 'b> {
    totals: &'a Totals<'b>,
    torque: &'a mut [f64; BLOCK],
    by: Option<&'a mut Channels>,
}

impl NullaryFnOnce for Spent<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { totals, torque, by } = self;
        match by {
            None if !totals.by_load => totals.spend_by::<SHAPED, 0>(torque, &mut []),
            None => totals.spend_by::<CHANNELS, 0>(torque, &mut []),
            Some(by) if totals.plain => totals.spend_by::<PLAIN, PLAIN>(torque, by),
            Some(by) if !totals.by_load => totals.spend_by::<SHAPED, SHAPED>(torque, by),
            Some(by) => totals.spend_by::<CHANNELS, CHANNELS>(torque, by),
        }
    }
}

impl Totals<'_> {
    /// The torque where only the first `C` channels differ from those of no load, and its derivatives by the first `D`.
    #[inline(always)]
    fn spend_by<const C: usize, const D: usize>(&self, torque: &mut [f64], by: &mut [[f64; BLOCK]]) {
        for at in (0..self.block.len()).step_by(LANES) {
            let mut loads: [Dual<Known<Pack>, D>; CHANNELS] = [Dual::ZERO; CHANNELS];
            loads[SCALE] = Dual::of(1.0);
            lane_by_lane!(C, channel => {
                if let (Some(load), Some(column)) = (loads.get_mut(channel), self.channels.get(channel)) {
                    load.v = Known::any(Pack::of_packs(column, at));
                    if let Some(slope) = load.d.get_mut(channel) {
                        *slope = Known::of(1.0);
                    }
                }
            });
            let motion: Motion<Pack> = self.motion(at);
            let tau = load_of(loads).sliding(&motion.map(|x| Dual::constant(Known::any(x))));
            tau.v.x.into_packs(torque, at);
            for (column, slope) in by.iter_mut().zip(tau.slopes(|slope| slope.x)) {
                slope.into_packs(column, at);
            }
        }
    }
}
