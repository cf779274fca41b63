//! Hann-tapered periodograms of stretches of a column, several at a time.

use crate::fourier::Transform;
use crate::isa;
use crate::scalar::{Packed, Scalar, WIDE, Wide};
use pulp::Simd;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Where half-overlapping windows of these stretches begin.
pub fn windows(stretches: &[Range<usize>], window: usize) -> Vec<usize> {
    let of = |stretch: &Range<usize>| {
        let end = stretch.end;
        stretch.clone().step_by(window / 2).take_while(move |start| start + window <= end)
    };
    stretches.iter().flat_map(of).collect()
}

/// Periodograms of one length, a power of two.
pub struct Periodogram {
    transform: Arc<Transform>,
    taper: Vec<f64>,
    energy: f64,
}

/// Power per bin of each window; the mean over the bins of white noise is its variance.
pub struct Powers {
    bins: usize,
    /// Window after window.
    powers: Vec<f64>,
}

impl Periodogram {
    /// Of so many samples; made once per length and process.
    pub fn of(samples: usize) -> Arc<Self> {
        static MADE: Mutex<BTreeMap<usize, Arc<Periodogram>>> = Mutex::new(BTreeMap::new());
        let make = || {
            let weight = |i: usize| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / samples as f64).cos();
            let taper: Vec<f64> = (0..samples).map(weight).collect();
            let energy = taper.iter().map(|w| w * w).sum();
            Arc::new(Self { transform: Transform::of(samples), taper, energy })
        };
        // Whoever stopped in the middle of this has at worst left one periodogram less.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(made.entry(samples).or_insert_with(make))
    }

    /// Bins of all frequencies.
    pub fn bins(&self) -> Range<usize> {
        0..self.taper.len() / 2 + 1
    }

    /// The powers in these bins of the windows of a column that begin here.
    pub fn powers(&self, column: &[f64], starts: &[usize], bins: Range<usize>) -> Powers {
        let n = bins.len();
        let mut powers = vec![0.0; starts.len() * n];
        let mut rows = self.transform.rows(WIDE);
        for (few, out) in starts.chunks(WIDE).zip(powers.chunks_mut(WIDE * n)) {
            self.side_by_side(column, few, &mut rows);
            isa::dispatch_wide(Tapered { taper: &self.taper, rows: &mut rows });
            let mut spectra = self.transform.forward(WIDE, &mut rows, bins.clone());
            isa::dispatch_wide(Squared { spectra: &mut spectra, scale: 1.0 / self.energy });
            for (lane, own) in out.chunks_exact_mut(n.max(1)).enumerate() {
                for (own, powers) in own.iter_mut().zip(spectra[0].as_chunks::<WIDE>().0) {
                    *own = powers[lane];
                }
            }
        }
        Powers { bins: n, powers }
    }

    /// The even rows of windows, and the odd ones. Not compiled for a machine's own instructions: with those that gather and
    /// scatter it takes several times as long.
    fn side_by_side(&self, column: &[f64], starts: &[usize], [even, odd]: &mut [Vec<f64>; 2]) {
        for (lane, start) in starts.iter().enumerate() {
            let pairs = column[*start..*start + self.taper.len()].as_chunks::<2>().0;
            let even = even.as_chunks_mut::<WIDE>().0.iter_mut();
            for ((even, odd), [first, second]) in even.zip(odd.as_chunks_mut::<WIDE>().0).zip(pairs) {
                (even[lane % WIDE], odd[lane % WIDE]) = (*first, *second);
            }
        }
    }
}

/// Takes the mean off windows side by side, and tapers them.
struct Tapered<'a> {
    taper: &'a [f64],
    rows: &'a mut [Vec<f64>; 2],
}

impl pulp::WithSimd for Tapered<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [even, odd] = self.rows;
        let (even, odd) = (S::as_mut_simd_f64s(even).0, S::as_mut_simd_f64s(odd).0);
        let packs = WIDE / S::F64_LANES;
        let scale = simd.splat_f64s(1.0 / self.taper.len() as f64);
        for pack in 0..packs {
            let mut sums = [simd.splat_f64s(0.0); 2];
            for (even, odd) in even.iter().zip(odd.iter()).skip(pack).step_by(packs) {
                sums = [simd.add_f64s(sums[0], *even), simd.add_f64s(sums[1], *odd)];
            }
            let mean = simd.mul_f64s(scale, simd.add_f64s(sums[0], sums[1]));
            let rows = even.iter_mut().zip(odd.iter_mut()).skip(pack).step_by(packs);
            for ((even, odd), [first, second]) in rows.zip(self.taper.as_chunks::<2>().0) {
                *even = simd.mul_f64s(simd.sub_f64s(*even, mean), simd.splat_f64s(*first));
                *odd = simd.mul_f64s(simd.sub_f64s(*odd, mean), simd.splat_f64s(*second));
            }
        }
    }
}

/// Makes powers of real parts.
struct Squared<'a> {
    spectra: &'a mut [Vec<f64>; 2],
    scale: f64,
}

impl pulp::WithSimd for Squared<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [re, im] = self.spectra;
        let scale = simd.splat_f64s(self.scale);
        for (re, im) in S::as_mut_simd_f64s(re).0.iter_mut().zip(S::as_simd_f64s(im).0) {
            *re = simd.mul_f64s(scale, simd.mul_add_e_f64s(*re, *re, simd.mul_f64s(*im, *im)));
        }
    }
}

impl Powers {
    /// The powers of one window after the other.
    pub fn windows(&self) -> impl Iterator<Item = &[f64]> {
        self.powers.chunks_exact(self.bins.max(1))
    }

    /// The mean over all windows, each with this weight.
    pub fn mean(&self, weights: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
        let mut sums = vec![0.0; self.bins];
        for (window, weight) in self.windows().zip(weights.clone()) {
            sums.iter_mut().zip(window).for_each(|(sum, power)| *sum += weight * power);
        }
        let total: f64 = weights.take(self.windows().count()).sum();
        sums.iter_mut().for_each(|sum| *sum /= total);
        sums
    }

    /// A quantile over all windows of every bin; zero where there is no window.
    pub fn quantile(&self, quantile: f64) -> Vec<f64> {
        isa::dispatch_wide(Quantile { powers: self, quantile })
    }
}

struct Quantile<'a> {
    powers: &'a Powers,
    quantile: f64,
}

impl pulp::NullaryFnOnce for Quantile<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn call(self) -> Vec<f64> {
        let Self { powers, quantile } = self;
        let mut out = vec![0.0; powers.bins];
        for bin in (0..powers.bins).step_by(WIDE) {
            let mut column: Vec<Wide> = powers.windows().map(|window| Packed::load(window, bin)).collect();
            sort(&mut column);
            if let Some(at) = column.get((quantile * column.len() as f64) as usize) {
                at.store(&mut out, bin);
            }
        }
        out
    }
}

/// Sorts every lane: Batcher's merge exchange (Knuth 1998, "Sorting and Searching", algorithm 5.2.2M), which compares the
/// same places whatever is in them.
#[inline(always)]
fn sort(column: &mut [Wide]) {
    let most = column.len().next_power_of_two() / 2;
    let mut merged = most;
    while merged > 0 {
        let (mut apart, mut step, mut bit) = (merged, most, 0);
        loop {
            for at in 0..column.len().saturating_sub(apart) {
                if at & merged == bit {
                    let (low, high) = (column[at], column[at + apart]);
                    column[at] = low.where_above(high, high, low);
                    column[at + apart] = low.where_above(high, low, high);
                }
            }
            if step == merged {
                break;
            }
            (apart, step, bit) = (step - merged, step / 2, merged);
        }
        merged /= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    #[test]
    fn the_mean_over_all_bins_of_noise_is_its_variance() {
        let mut noise = Noise::new(4);
        let column: Vec<f64> = (0..40_000).map(|_| 3.0 + 2.0 * noise.normal()).collect();
        let starts: Vec<usize> = (0..300).map(|i| 130 * i).collect();
        let powers = Periodogram::of(128).powers(&column, &starts, 2..63);
        assert_eq!(powers.windows().count(), 300);
        let level = powers.mean(std::iter::repeat(1.0));
        assert!((level.iter().sum::<f64>() / 61.0 - 4.0).abs() < 0.1, "{level:?}");
        let single = powers.mean((0..300).map(|i| f64::from(i == 7)));
        assert_eq!(single, powers.windows().nth(7).unwrap());
    }

    #[test]
    fn a_quantile_is_that_of_the_sorted_powers() {
        let mut noise = Noise::new(5);
        for windows in [0, 1, 2, 3, 58, 100] {
            let mut powers = Powers { bins: 9, powers: (0..9 * windows).map(|_| noise.normal()).collect() };
            powers.powers.iter_mut().skip(3).step_by(7).for_each(|power| *power = 0.5);
            let found = powers.quantile(0.35);
            for (bin, found) in found.iter().enumerate() {
                let mut sorted: Vec<f64> = powers.windows().map(|window| window[bin]).collect();
                sorted.sort_by(f64::total_cmp);
                let expected = sorted.get((0.35 * f64::from(windows as u32)) as usize).copied();
                assert_eq!(*found, expected.unwrap_or(0.0));
            }
        }
    }
}
