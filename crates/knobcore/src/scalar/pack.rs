//! Four samples side by side, so that a memoryless effect runs on whole vector registers.
#![expect(clippy::needless_range_loop, reason = "a count known to the compiler becomes vector instructions")]

use super::{Scalar, elementary};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Samples in a [`Pack`]: one AVX2 register. Two of them hide the latency of one, but fill the registers that
/// derivatives need, and take twice as long to compile.
pub const LANES: usize = 4;

/// Values of one quantity at as many consecutive samples.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Pack(pub [f64; LANES]);

impl Pack {
    /// The samples of `x` from `at` on; lanes beyond the end repeat the last sample.
    #[inline(always)]
    pub fn load(x: &[f64], at: usize) -> Self {
        if let Some(lanes) = x.get(at..at + LANES).and_then(|s| s.first_chunk::<LANES>()) {
            return Self(*lanes);
        }
        let last = x.len().saturating_sub(1);
        Self(std::array::from_fn(|i| x.get((at + i).min(last)).copied().unwrap_or(0.0)))
    }

    /// Writes as many lanes as `out` has room for from `at` on.
    #[inline(always)]
    pub fn store(self, out: &mut [f64], at: usize) {
        if let Some(lanes) = out.get_mut(at..at + LANES).and_then(|s| s.first_chunk_mut::<LANES>()) {
            *lanes = self.0;
        } else {
            for (slot, value) in out.iter_mut().skip(at).zip(self.0) {
                *slot = value;
            }
        }
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f(self.0[i], other.0[i]);
        }
        Self(out)
    }
}

impl Add for Pack {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
}
impl Sub for Pack {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
}
impl Mul for Pack {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }
}
impl Div for Pack {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.zip(o, |a, b| a / b)
    }
}
impl Neg for Pack {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}

impl Scalar for Pack {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            (s[i], c[i]) = elementary::sin_cos(self.0[i]);
        }
        (Self(s), Self(c))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = elementary::exp(self.0[i]);
        }
        Self(out)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = elementary::ln(self.0[i]);
        }
        Self(out)
    }

    #[inline(always)]
    fn where_positive(self, yes: Self, no: Self) -> Self {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = if self.0[i] > 0.0 { yes.0[i] } else { no.0[i] };
        }
        Self(out)
    }

    #[inline]
    fn is_positive(self) -> bool {
        self.0.iter().all(|x| *x > 0.0)
    }
}
