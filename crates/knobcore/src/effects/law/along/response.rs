//! Whole columns of samples with exact derivatives, and how they pass through a sensor.

use super::block::{BLOCK, filled};
use crate::effects::law::seeded;
use crate::effects::{LateEffect, SensorEffect};
use crate::motion::Motion;
use crate::scalar::{Dual, Known, LANES, Pack, Scalar};

/// Derivative columns that pass through a late sensor at a time.
const AT_ONCE: usize = 4;

/// Columns of a motion, and what a chain of effects makes of them.
///
/// All columns have the length of the torque. A parameter with a column has its derivative there.
pub struct Response<'a> {
    /// t, theta, omega, alpha, forward: the fields of [`Motion`].
    pub motion: [&'a [f64]; 5],
    /// Sampling interval, s.
    pub dt: f64,
    /// Torque, N m.
    pub torque: &'a mut [f64],
    /// Derivatives of the torque, N m per unit of their parameter.
    pub slopes: &'a mut [Vec<f64>],
}

impl Response<'_> {
    /// A sensor without memory: the chain rule by its own derivative to the torque, which is the last of the `L`
    /// lanes.
    #[inline(always)]
    pub(super) fn sense<const N: usize, const L: usize, E: SensorEffect<N>>(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
    ) {
        let p: [Dual<Known<Pack>, L>; N] = seeded(p, 0);
        let (mut end, mut torque, mut by) = ([[0.0; BLOCK]; 5], [0.0; BLOCK], [[0.0; BLOCK]; L]);
        for start in (0..self.torque.len()).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(self.torque.len());
            let motion = filled(self.motion.map(|column| &column[block.clone()]), &mut end);
            let own = &mut self.torque[block.clone()];
            torque[..own.len()].copy_from_slice(own);
            for at in (0..own.len()).step_by(LANES) {
                let constant = |x: Pack| Dual::<Known<Pack>, L>::constant(Known::any(x));
                let mut tau = constant(Pack::of_packs(&torque, at));
                tau.d[L - 1] = Known::of(1.0);
                let sensed = E::sense(&p, &Motion::over(&motion, at).map(constant), tau);
                sensed.v.x.into_packs(&mut torque, at);
                for (by, slope) in by.iter_mut().zip(sensed.slopes(|slope| slope.x)) {
                    slope.into_packs(by, at);
                }
            }
            own.iter_mut().zip(torque).for_each(|(own, torque)| *own = torque);
            if let Some((through, by)) = by.split_last() {
                for column in self.slopes.iter_mut() {
                    column[block.clone()].iter_mut().zip(through).for_each(|(slope, by)| *slope *= by);
                }
                for (column, by) in columns.iter().zip(by) {
                    if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                        column[block.clone()].iter_mut().zip(by).for_each(|(slope, by)| *slope += by);
                    }
                }
            }
        }
    }

    /// A sensor with memory: each derivative column goes through it beside the torque.
    pub(super) fn late<const N: usize, E: LateEffect<N>>(&mut self, p: &[f64], columns: &[Option<usize>]) {
        let own: [Dual<f64, N>; N] = seeded(p, 0);
        let torque: Vec<Dual<f64, N>> = self.torque.iter().map(|tau| Dual::constant(*tau)).collect();
        let fixed: [Dual<f64, AT_ONCE>; N] =
            core::array::from_fn(|i| Dual::constant(p.get(i).copied().unwrap_or(0.0)));
        for few in self.slopes.chunks_mut(AT_ONCE) {
            let beside: Vec<Dual<f64, AT_ONCE>> = (0..torque.len())
                .map(|at| Dual {
                    v: torque[at].v,
                    d: core::array::from_fn(|i| few.get(i).map_or(0.0, |column| column[at])),
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
