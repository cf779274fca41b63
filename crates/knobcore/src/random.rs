//! Seeded noise for tests and simulated sensors (splitmix64, Steele, Lea & Flood 2014; Box & Muller 1958).

use crate::isa;
use pulp::{Simd, WithSimd};

/// From each state to the next, whatever it is.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Noise(u64);

impl Noise {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The same stream after so many numbers more.
    pub fn ahead(&self, numbers: u64) -> Self {
        Self(self.0.wrapping_add(numbers.wrapping_mul(STEP)))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        mixed(self.0)
    }

    /// Uniform on (0, 1).
    pub fn uniform(&mut self) -> f64 {
        unit(self.bits())
    }

    /// So many of [`Noise::uniform`], in their order, with mean nought and unit variance.
    pub fn even(&mut self, count: usize) -> Vec<f64> {
        let mut out = vec![0.0; count];
        isa::dispatch_wide(Even { state: self.0, out: &mut out });
        *self = self.ahead(count as u64);
        out
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[inline(always)]
fn mixed(state: u64) -> u64 {
    let mut z = state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[inline(always)]
fn unit(bits: u64) -> f64 {
    ((bits >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// Several at a time: each state is known without the one before.
struct Even<'a> {
    state: u64,
    out: &'a mut [f64],
}

impl WithSimd for Even<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let scale = 12.0_f64.sqrt();
        for (at, out) in (1_u64..).zip(self.out) {
            *out = scale * (unit(mixed(self.state.wrapping_add(at.wrapping_mul(STEP)))) - 0.5);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Noise;

    #[test]
    fn several_at_a_time_are_those_that_come_one_by_one() {
        let (mut together, mut alone) = (Noise::new(7), Noise::new(7));
        for count in [0, 1, 37] {
            let one_by_one: Vec<f64> =
                (0..count).map(|_| 12.0_f64.sqrt() * (alone.uniform() - 0.5)).collect();
            assert_eq!(together.even(count), one_by_one);
        }
        let many = together.even(100_000);
        let [mean, square] = [1, 2].map(|power| many.iter().map(|x| x.powi(power)).sum::<f64>() / 1e5);
        assert!(mean.abs() < 0.01 && (square - 1.0).abs() < 0.01, "{mean} {square}");
    }
}
