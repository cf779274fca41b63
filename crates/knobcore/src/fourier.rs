//! Fourier transforms of real columns whose length is a power of two, several of them side by side.
//!
//! By fours, decimating in frequency, in place (Gentleman & Sande 1966, "Fast Fourier transforms: for fun and profit").
//! Columns lie side by side, a lane each, so that all of it is vector instructions however short a column is.

use crate::isa;
use num_complex::Complex64;
use pulp::Simd;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// The transform of one length.
pub struct Transform {
    /// Where the complex transform of half the length leaves each frequency.
    places: Vec<usize>,
    /// exp(-2 pi i k / length) for k up to half the length.
    turns: Vec<Complex64>,
}

impl Transform {
    /// The transform of the power of two from `length` on; made once per length and process.
    pub fn of(length: usize) -> Arc<Self> {
        static MADE: Mutex<BTreeMap<usize, Arc<Transform>>> = Mutex::new(BTreeMap::new());
        let length = length.next_power_of_two().max(2);
        let make = || {
            let turn = |k: usize| Complex64::cis(-TAU * k as f64 / length as f64);
            let places = (0..length / 2).map(|k| place(k, length / 2)).collect();
            Arc::new(Self { places, turns: (0..=length / 2).map(turn).collect() })
        };
        // Whoever stopped in the middle of this has at worst left one transform less.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(made.entry(length).or_insert_with(make))
    }

    /// Room for `lanes` columns side by side: their even rows, and their odd ones.
    pub fn rows(&self, lanes: usize) -> [Vec<f64>; 2] {
        let rows = self.places.len() * lanes;
        [vec![0.0; rows], vec![0.0; rows]]
    }

    /// Sum of x_n exp(-2 pi i k n / length) over the `rows` of columns side by side, for these k of at most half the length:
    /// real parts, and imaginary ones. The rows are worked in.
    pub fn forward(&self, lanes: usize, rows: &mut [Vec<f64>; 2], bins: Range<usize>) -> [Vec<f64>; 2] {
        isa::dispatch_wide(Forward { transform: self, lanes, rows, bins })
    }
}

/// Where the transform of a length leaves a frequency: digit by digit, the last one first.
fn place(frequency: usize, length: usize) -> usize {
    let (mut place, mut k, mut size) = (0, frequency, length);
    while size > 1 {
        let parts = size.min(4);
        size /= parts;
        place += k % parts * size;
        k /= parts;
    }
    place
}

/// Even rows as real and odd ones as imaginary parts: half as many complex numbers.
struct Forward<'a> {
    transform: &'a Transform,
    lanes: usize,
    rows: &'a mut [Vec<f64>; 2],
    bins: Range<usize>,
}

impl pulp::WithSimd for Forward<'_> {
    type Output = [Vec<f64>; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { transform, lanes, rows, bins } = self;
        if !lanes.is_multiple_of(S::F64_LANES) {
            return Forward { transform, lanes, rows, bins }.with_simd(pulp::Scalar);
        }
        let Transform { places, turns } = transform;
        let (half, packs) = (places.len(), lanes / S::F64_LANES);
        let [re, im] = rows;
        let (re, im) = (S::as_mut_simd_f64s(re).0, S::as_mut_simd_f64s(im).0);
        let mut size = half;
        while size >= 4 {
            let step = turns.get(..half).unwrap_or(&[]);
            for (re, im) in re.chunks_exact_mut(size * packs).zip(im.chunks_exact_mut(size * packs)) {
                by_four(simd, (step, 2 * half / size, packs), re, im);
            }
            size /= 4;
        }
        if size == 2 {
            for part in [&mut *re, &mut *im] {
                for pair in part.chunks_exact_mut(2 * packs) {
                    let (first, second) = pair.split_at_mut(packs);
                    for (a, b) in first.iter_mut().zip(second) {
                        (*a, *b) = (simd.add_f64s(*a, *b), simd.sub_f64s(*a, *b));
                    }
                }
            }
        }
        let bins = bins.start..bins.end.min(half + 1);
        let mut out = [vec![0.0; bins.len() * lanes], vec![0.0; bins.len() * lanes]];
        let [out_re, out_im] = &mut out;
        let (out_re, out_im) = (S::as_mut_simd_f64s(out_re).0, S::as_mut_simd_f64s(out_im).0);
        let halved = simd.splat_f64s(0.5);
        for (at, k) in bins.enumerate() {
            let (one, other) = (places[k % half] * packs, places[(half - k) % half] * packs);
            let turn = splat(simd, turns[k]);
            for lane in 0..packs {
                let (a, b, c, d) = (re[one + lane], im[one + lane], re[other + lane], im[other + lane]);
                let odd = times(simd, [simd.add_f64s(b, d), simd.sub_f64s(c, a)], turn);
                let even = [simd.add_f64s(a, c), simd.sub_f64s(b, d)];
                out_re[at * packs + lane] = simd.mul_f64s(halved, simd.add_f64s(even[0], odd[0]));
                out_im[at * packs + lane] = simd.mul_f64s(halved, simd.add_f64s(even[1], odd[1]));
            }
        }
        out
    }
}

/// Makes of numbers the four parts whose transforms are every fourth frequency of theirs.
#[inline(always)]
fn by_four<S: Simd>(
    simd: S,
    (turns, step, packs): (&[Complex64], usize, usize),
    re: &mut [S::f64s],
    im: &mut [S::f64s],
) {
    let quarter = re.len() / 4;
    let (re0, rest) = re.split_at_mut(quarter);
    let (re1, rest) = rest.split_at_mut(quarter);
    let (re2, re3) = rest.split_at_mut(quarter);
    let (im0, rest) = im.split_at_mut(quarter);
    let (im1, rest) = rest.split_at_mut(quarter);
    let (im2, im3) = rest.split_at_mut(quarter);
    for (at, turn) in turns.iter().step_by(step).enumerate().take(quarter / packs) {
        let twice = *turn * *turn;
        let [w1, w2, w3] = [splat(simd, *turn), splat(simd, twice), splat(simd, *turn * twice)];
        for q in at * packs..(at + 1) * packs {
            let (sum, difference) = both(simd, [re0[q], im0[q]], [re2[q], im2[q]]);
            let (other, [re, im]) = both(simd, [re1[q], im1[q]], [re3[q], im3[q]]);
            let (even, odd) = both(simd, sum, other);
            // The other difference times i.
            let (plus, minus) = both(simd, difference, [simd.neg_f64s(im), re]);
            [re0[q], im0[q]] = even;
            [re1[q], im1[q]] = times(simd, minus, w1);
            [re2[q], im2[q]] = times(simd, odd, w2);
            [re3[q], im3[q]] = times(simd, plus, w3);
        }
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, turn: Complex64) -> [S::f64s; 2] {
    [simd.splat_f64s(turn.re), simd.splat_f64s(turn.im)]
}

/// Sum and difference.
#[inline(always)]
fn both<S: Simd>(simd: S, [a, b]: [S::f64s; 2], [c, d]: [S::f64s; 2]) -> ([S::f64s; 2], [S::f64s; 2]) {
    ([simd.add_f64s(a, c), simd.add_f64s(b, d)], [simd.sub_f64s(a, c), simd.sub_f64s(b, d)])
}

/// The product.
#[inline(always)]
fn times<S: Simd>(simd: S, [a, b]: [S::f64s; 2], [re, im]: [S::f64s; 2]) -> [S::f64s; 2] {
    let (x, y) = (simd.mul_f64s(b, im), simd.mul_f64s(b, re));
    [simd.sub_f64s(simd.mul_f64s(a, re), x), simd.mul_add_e_f64s(a, im, y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_the_sum_that_it_stands_for_in_every_lane() {
        for (length, lanes) in [(2, 1), (4, 8), (8, 8), (16, 1), (64, 8), (128, 16)] {
            let value = |n: usize, lane: usize| (n as f64 * 1.7 + lane as f64).sin() + 0.3 * n as f64;
            let transform = Transform::of(length);
            let mut rows = transform.rows(lanes);
            for n in 0..length {
                for lane in 0..lanes {
                    rows[n % 2][n / 2 * lanes + lane] = value(n, lane);
                }
            }
            let bins = 1..length / 2 + 1;
            let [re, im] = transform.forward(lanes, &mut rows, bins.clone());
            assert_eq!((re.len(), im.len()), (bins.len() * lanes, bins.len() * lanes));
            for (at, (re, im)) in re.into_iter().zip(im).enumerate() {
                let turn =
                    |n: usize| Complex64::cis(-TAU * ((bins.start + at / lanes) * n) as f64 / length as f64);
                let sum: Complex64 = (0..length).map(|n| value(n, at % lanes) * turn(n)).sum();
                let fast = Complex64::new(re, im);
                assert!((fast - sum).norm() < 1e-12 * length as f64, "{length} {at}: {fast} {sum}");
            }
        }
    }
}
