//! Loads that remember, along whole columns. Along time each sample waits for the one before it: elements go side by side, and of all
//! derivatives only those by the parameters that they share. What they ask of the rig is then worked out like any load,
//! with samples side by side.

use super::block::{BLOCK, Totals};
use super::gradient::Gradient;
use crate::effects::MemoryEffect;
use crate::effects::law::place::BEFORE;
use crate::effects::law::{seeded, take};
use crate::motion::{Channel, Load, Motion};
use crate::scalar::{Dual, Known, LANES, Pack, Packed, Scalar, WIDE, Wide};

/// Numbers of a sample in a trace: what the elements remember, and the derivatives of that by `R` parameters.
const fn row(derivatives: usize) -> usize {
    WIDE * (1 + derivatives)
}

/// What is kept from block to block with so many derivatives: [`BEFORE`], the last row of the trace, and that of a block.
/// It begins as a state does.
pub(super) fn kept(derivatives: usize) -> Vec<f64> {
    vec![0.0; BEFORE + row(derivatives) * (1 + BLOCK)]
}

/// Whether derivatives are kept.
fn derives(kept: &[f64]) -> bool {
    kept.len() > BEFORE + row(0) * (1 + BLOCK)
}

/// The trace of the block that came last.
fn trace<const R: usize>(kept: &[f64]) -> &[f64] {
    kept.get(BEFORE + row(R)..).unwrap_or(&[])
}

/// One column of a trace over a pack of samples.
#[inline(always)]
fn across<const R: usize>(trace: &[f64], at: usize, column: usize) -> Pack {
    let rows = &trace[at * row(R)..][..LANES * row(R)];
    Packed(core::array::from_fn(|lane| rows[lane * row(R) + column]))
}

/// Follows the elements along a block of angles.
#[inline(always)]
fn follow<const R: usize, const N: usize, const S: usize, const M: usize, E: MemoryEffect<N, S, M>>(
    p: &[f64],
    kept: &mut [f64],
    theta: &[f64],
) {
    // More elements than lanes do not compile.
    let _ = const { WIDE - M };
    let Some((before, rows)) = kept.split_first_chunk_mut::<BEFORE>() else { return };
    let (last, trace) = rows.split_at_mut(row(R));
    let shared: [Dual<Known<Wide>, R>; S] = seeded(p, 0);
    let elements = Packed(core::array::from_fn(|i| E::ELEMENTS.get(i).copied().unwrap_or(1.0)));
    let constant = |x: Wide| Dual::constant(Known::any(x));
    let mut z =
        Dual { v: Wide::load(last, 0), d: core::array::from_fn(|i| Wide::load(last, WIDE * (1 + i))) };
    let [running, angle] = before;
    if let Some(first) = theta.first().filter(|_| *running == 0.0) {
        (*running, *angle) = (1.0, *first);
    }
    for (theta, row) in theta.iter().zip(trace.chunks_exact_mut(row(R))) {
        let by = constant(Wide::of(theta - *angle));
        *angle = *theta;
        let was = Dual { v: Known::any(z.v), d: z.d.map(Known::any) };
        let now = E::remember(&shared, constant(elements), was, by);
        z = Dual { v: now.v.x, d: now.d.map(|d| d.x) };
        z.v.store(row, 0);
        z.d.iter().enumerate().for_each(|(i, d)| d.store(row, WIDE * (1 + i)));
    }
    z.v.store(last, 0);
    z.d.iter().enumerate().for_each(|(i, d)| d.store(last, WIDE * (1 + i)));
}

impl Totals<'_> {
    /// Brings the load over the block in.
    #[inline(always)]
    pub(super) fn add_remembering<
        const N: usize,
        const S: usize,
        const M: usize,
        E: MemoryEffect<N, S, M>,
    >(
        &mut self,
        p: &[f64],
        kept: &mut [f64],
    ) {
        if derives(kept) {
            follow::<S, N, S, M, E>(p, kept, self.motion[1]);
            self.add_remembered::<S, N, S, M, E>(p, trace::<S>(kept));
        } else {
            follow::<0, N, S, M, E>(p, kept, self.motion[1]);
            self.add_remembered::<0, N, S, M, E>(p, trace::<0>(kept));
        }
    }

    #[inline(always)]
    fn add_remembered<
        const R: usize,
        const N: usize,
        const S: usize,
        const M: usize,
        E: MemoryEffect<N, S, M>,
    >(
        &mut self,
        p: &[f64],
        trace: &[f64],
    ) {
        let p: [f64; N] = take(p);
        let touches = const { Channel::among(E::TOUCHES) };
        for at in (0..self.block.len()).step_by(LANES) {
            let motion: Motion<Pack> = self.motion(at);
            let mut sum = Load::none();
            for i in 0..M {
                sum.join(&E::load(Pack::of(p[S + i]), across::<R>(trace, at, i), &motion), touches);
            }
            self.join(at, &sum, touches);
        }
    }
}

impl Gradient<'_> {
    /// The derivatives of the load over the block that was brought in last.
    #[inline(always)]
    pub(super) fn chain_remembering<
        const N: usize,
        const S: usize,
        const M: usize,
        E: MemoryEffect<N, S, M>,
    >(
        &mut self,
        p: &[f64],
        columns: &[Option<usize>],
        kept: &[f64],
    ) {
        let (p, trace): ([f64; N], _) = (take(p), trace::<S>(kept));
        for at in (0..self.totals.block.len()).step_by(LANES) {
            let motion = self.totals.motion(at).map(|x| Dual::constant(Known::any(x)));
            let mut shared = [Pack::of(0.0); S];
            for i in 0..M {
                // One lane for the element's own parameter, one for what it remembers.
                let values = [Pack::of(p[S + i]), across::<S>(trace, at, i)].map(Known::any);
                let [own, z]: [Dual<_, 2>; 2] = Dual::seeds(values, 0);
                let load = E::load(own, z, &motion);
                let [by_own, by_z] = self.through(at, &load, const { Channel::among(E::TOUCHES) });
                self.put(S + i, at, by_own);
                for (s, sum) in shared.iter_mut().enumerate() {
                    *sum = *sum + by_z * across::<S>(trace, at, WIDE * (1 + s) + i);
                }
            }
            for (s, sum) in shared.into_iter().enumerate() {
                self.put(s, at, sum);
            }
        }
        self.add(columns, N);
    }
}
