//! Residuals at 5 kHz are not independent: their serial correlation, and what it does to the intervals.
//!
//! The residual is modelled as autoregressive, r = e / A(z), of an order chosen by BIC; the covariance of
//! the parameters is the sandwich (J'J)^-1 J' Sigma J (J'J)^-1 with that model's Sigma. Source: den Haan &
//! Levin 1997 ("VARHAC"), for one series. J' Sigma J needs no matrix of the length of the capture: it is
//! the product of the columns after they went through the same recursion 1 / A(z). All of it is done with as many
//! samples as the measurement filter's bandwidth needs: with more of them the recursion would be long and nearly
//! unstable, to say that nothing is above it.

use super::moments::Evaluated;
use crate::isa;
use crate::noise::{MOST, Noise};
use crate::scalar::{LANES, Pack, Packed, Scalar};
use pulp::Simd;

/// Which samples of a chunk are looked at: of those that count one of `every`.
pub fn thinned<'a>(evaluated: &'a Evaluated<'_>, every: usize) -> impl Iterator<Item = usize> + 'a {
    let weight = &evaluated.signals.weight[evaluated.rows.clone()];
    (0..weight.len()).filter(|row| weight[*row] > 0.0).step_by(every)
}

/// The noise that residuals are; lags are counted in the samples that are given.
pub fn serial(residuals: &[&[f64]]) -> Noise {
    let n: usize = residuals.iter().map(|r| r.len()).sum();
    let mut covariance = vec![0.0; MOST.min(n / 10) + 1];
    for r in residuals {
        isa::dispatch_wide(Lagged { column: r, sums: &mut covariance });
    }
    covariance.iter_mut().for_each(|sum| *sum /= n.max(1) as f64);
    Noise::autoregressive(&covariance, n.max(1) as f64)
}

/// Adds the products of a column with itself, later by 0, 1, ... rows.
struct Lagged<'a> {
    column: &'a [f64],
    sums: &'a mut [f64],
}

/// Lags that are summed at a time, so that the column is read once for all.
const LAGS: usize = 6;

impl pulp::WithSimd for Lagged<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.column.len();
        for (few, out) in self.sums.chunks_mut(LAGS).enumerate() {
            let first = few * LAGS;
            // What all of these lags have, and what is left of each.
            let packs = n.saturating_sub(first + LAGS) / S::F64_LANES;
            let later = |lag: usize| &S::as_simd_f64s(&self.column[(first + lag).min(n)..]).0[..packs];
            let (now, a, b) = (&S::as_simd_f64s(self.column).0[..packs], later(0), later(1));
            let (c, d, e, f) = (later(2), later(3), later(4), later(5));
            let mut sums = [simd.splat_f64s(0.0); LAGS];
            for at in 0..packs {
                sums[0] = simd.mul_add_e_f64s(now[at], a[at], sums[0]);
                sums[1] = simd.mul_add_e_f64s(now[at], b[at], sums[1]);
                sums[2] = simd.mul_add_e_f64s(now[at], c[at], sums[2]);
                sums[3] = simd.mul_add_e_f64s(now[at], d[at], sums[3]);
                sums[4] = simd.mul_add_e_f64s(now[at], e[at], sums[4]);
                sums[5] = simd.mul_add_e_f64s(now[at], f[at], sums[5]);
            }
            for (lag, (out, sum)) in (first..n).zip(out.iter_mut().zip(sums)) {
                let (now, later) = (&self.column[packs * S::F64_LANES..n - lag], &self.column[lag..]);
                let rest = now.iter().zip(&later[packs * S::F64_LANES..]).map(|(a, b)| a * b).sum::<f64>();
                *out += simd.reduce_sum_f64s(sum) + rest;
            }
        }
    }
}

/// Accumulates J' Sigma J over a pass.
pub struct Meat<'a> {
    serial: &'a Noise,
    k: usize,
    every: usize,
    /// For every pack of columns their last values after the recursion, oldest first.
    past: Vec<Vec<Pack>>,
    capture: usize,
    /// k x k, row by row.
    pub products: Vec<f64>,
}

impl<'a> Meat<'a> {
    /// Nothing accumulated yet, for `k` columns of which one sample of `every` is looked at.
    pub fn new(serial: &'a Noise, k: usize, every: usize) -> Self {
        let past = vec![vec![Pack::of(0.0); serial.coefficients.len()]; k.div_ceil(LANES)];
        Self { serial, k, every, past, capture: usize::MAX, products: vec![0.0; k * k] }
    }

    /// J' Sigma J of white residuals: no pass is needed.
    pub fn of_white(&mut self, gram: impl Fn(usize, usize) -> f64) {
        let k = self.k;
        for (at, product) in self.products.iter_mut().enumerate() {
            *product = self.every as f64 * self.serial.innovation * gram(at / k, at % k);
        }
    }

    /// Takes the derivative columns of one chunk.
    pub fn add(&mut self, evaluated: &Evaluated<'_>) {
        if evaluated.capture != self.capture {
            self.capture = evaluated.capture;
            self.past.iter_mut().for_each(|past| past.fill(Pack::of(0.0)));
        }
        let rows: Vec<usize> = thinned(evaluated, self.every).collect();
        let order = self.serial.coefficients.len();
        let mut coloured: Vec<Vec<Pack>> = Vec::with_capacity(self.past.len());
        for (few, past) in evaluated.columns[..self.k].chunks(LANES).zip(&mut self.past) {
            let recursion =
                Recursion { coefficients: &self.serial.coefficients, columns: few, rows: &rows, past };
            let series = isa::dispatch(recursion);
            past.copy_from_slice(&series[series.len() - order..]);
            coloured.push(series);
        }
        let column = |c: usize| coloured[c / LANES][order..].iter().map(move |pack| pack.0[c % LANES]);
        for i in 0..self.k {
            for j in 0..=i {
                let product: f64 = column(i).zip(column(j)).map(|(a, b)| a * b).sum();
                // Each sample stands for its neighbours, in both columns.
                let product = product * self.serial.innovation * (self.every * self.every) as f64;
                self.products[i * self.k + j] += product;
                if i != j {
                    self.products[j * self.k + i] += product;
                }
            }
        }
    }
}

/// y_t = x_t - a_1 y_(t-1) - a_2 y_(t-2) - ... of up to a pack of columns at once, over these rows.
struct Recursion<'a> {
    coefficients: &'a [f64],
    columns: &'a [&'a [f64]],
    rows: &'a [usize],
    past: &'a [Pack],
}

impl pulp::NullaryFnOnce for Recursion<'_> {
    type Output = Vec<Pack>;

    #[inline(always)]
    fn call(self) -> Vec<Pack> {
        let order = self.coefficients.len();
        let mut y = self.past.to_vec();
        y.reserve(self.rows.len());
        for row in self.rows {
            let mut x = [0.0; LANES];
            for (lane, column) in x.iter_mut().zip(self.columns) {
                *lane = column[*row];
            }
            // Two sums side by side: each addition waits for the one before it.
            let recent = &y[y.len() - order..];
            let (mut even, mut odd) = (Packed(x), Pack::of(0.0));
            for (pair, a) in recent.rchunks(2).zip(self.coefficients.chunks(2)) {
                if let ([second, first], [a, b]) = (pair, a) {
                    even = even - *first * Pack::of(*a);
                    odd = odd - *second * Pack::of(*b);
                } else if let ([first], [a]) = (pair, a) {
                    even = even - *first * Pack::of(*a);
                }
            }
            y.push(even + odd);
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    #[test]
    fn white_residuals_need_no_memory() {
        let mut noise = random::Noise::new(7);
        let r: Vec<f64> = (0..20_000).map(|_| noise.normal()).collect();
        let serial = serial(&[&r]);
        assert!(serial.coefficients.is_empty(), "{serial:?}");
        assert!((serial.innovation - 1.0).abs() < 0.05);
    }

    #[test]
    fn an_autoregression_is_found_with_its_coefficients() {
        let mut noise = random::Noise::new(8);
        let mut r = vec![0.0, 0.0];
        for t in 2..40_000 {
            r.push(1.5 * r[t - 1] - 0.8 * r[t - 2] + noise.normal());
        }
        let serial = serial(&[&r]);
        assert!(
            (serial.coefficients[0] + 1.5).abs() < 0.03 && (serial.coefficients[1] - 0.8).abs() < 0.03,
            "{serial:?}"
        );
    }
}
