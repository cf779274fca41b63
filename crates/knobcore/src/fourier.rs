//! Fourier transforms of real columns whose length is a power of two.

use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftDirection, Length};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

/// The transform of one length. Of the library one algorithm: its planner would bring in all of them, a fifth of this
/// crate's machine code.
pub struct Transform {
    /// Even samples as real and odd ones as imaginary parts: half as many complex numbers.
    halves: Radix4<f64>,
    /// exp(-2 pi i k / length).
    turns: Vec<Complex64>,
}

impl Transform {
    /// The transform of the power of two from `length` on; made once per length and process.
    pub fn of(length: usize) -> Arc<Self> {
        static MADE: Mutex<BTreeMap<usize, Arc<Transform>>> = Mutex::new(BTreeMap::new());
        let length = length.next_power_of_two().max(2);
        let make = || {
            let turn = |k: usize| Complex64::cis(-TAU * k as f64 / length as f64);
            let halves = Radix4::new(length / 2, FftDirection::Forward);
            Arc::new(Self { halves, turns: (0..=length / 2).map(turn).collect() })
        };
        // Whoever stopped in the middle of this has at worst left one transform less.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(made.entry(length).or_insert_with(make))
    }

    /// Sum of x_n exp(-2 pi i k n / length) for k up to half the length; a shorter column is filled up with zeros.
    pub fn forward(&self, column: &[f64]) -> Vec<Complex64> {
        let half = self.halves.len();
        let pair = |two: &[f64]| Complex64::new(two[0], two.get(1).copied().unwrap_or(0.0));
        let mut z: Vec<Complex64> = column.chunks(2).take(half).map(pair).collect();
        z.resize(half, Complex64::default());
        self.halves.process(&mut z);
        let split = |(k, turn): (usize, &Complex64)| {
            let (one, other) = (z[k % half], z[(half - k) % half].conj());
            let odd = Complex64::new(one.im - other.im, other.re - one.re);
            (one + other + turn * odd) * 0.5
        };
        self.turns.iter().enumerate().map(split).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_the_sum_that_it_stands_for() {
        for length in [2, 4, 8, 64] {
            let column: Vec<f64> = (0..length).map(|n| (n as f64 * 1.7).sin() + 0.3 * n as f64).collect();
            let fast = Transform::of(length).forward(&column);
            assert_eq!(fast.len(), length / 2 + 1);
            for (k, fast) in fast.iter().enumerate() {
                let term = |(n, x): (usize, &f64)| x * Complex64::cis(-TAU * (k * n) as f64 / length as f64);
                let sum: Complex64 = column.iter().enumerate().map(term).sum();
                assert!((fast - sum).norm() < 1e-12 * length as f64, "{length} {k}: {fast} {sum}");
            }
        }
    }

    #[test]
    fn a_short_column_is_filled_up_with_zeros() {
        let [short, filled] = [vec![1.0, 2.0, 3.0], vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
        let transform = Transform::of(8);
        assert_eq!(transform.forward(&short), transform.forward(&filled));
    }
}
