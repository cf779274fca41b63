//! Samples side by side, so that a memoryless effect runs on whole vector registers.
#![expect(clippy::needless_range_loop, reason = "a count known to the compiler becomes vector instructions")]

use super::{Scalar, elementary};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Samples in a [`Pack`]: one AVX2 register. More would fill the registers that derivatives need, and take longer to
/// compile.
pub const LANES: usize = 4;
/// Samples in a [`Wide`]: one AVX-512 register.
pub const WIDE: usize = 8;

/// Values of one quantity at as many consecutive samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Packed<const L: usize>(pub [f64; L]);

/// Samples that are differentiated side by side.
pub type Pack = Packed<LANES>;
/// Samples that are evaluated side by side.
pub type Wide = Packed<WIDE>;

/// A number for each of some places. In a loop, of which the compiler makes vector instructions: the functions that the
/// arrays of the library have for it may be called place by place, within the innermost loop of a simulation.
#[inline(always)]
pub(crate) fn each<T: Copy, const N: usize>(nothing: T, at: impl Fn(usize) -> T) -> [T; N] {
    let mut all = [nothing; N];
    for i in 0..N {
        all[i] = at(i);
    }
    all
}

impl<const L: usize> Packed<L> {
    /// The samples of `x` from `at` on; lanes beyond the end repeat the last sample.
    #[inline(always)]
    pub fn load(x: &[f64], at: usize) -> Self {
        if let Some(lanes) = x.get(at..at + L).and_then(|s| s.first_chunk::<L>()) {
            return Self(*lanes);
        }
        let last = x.len().saturating_sub(1);
        Self(each(0.0, |i| x.get((at + i).min(last)).copied().unwrap_or(0.0)))
    }

    /// Writes as many lanes as `out` has room for from `at` on.
    #[inline(always)]
    pub fn store(self, out: &mut [f64], at: usize) {
        if let Some(lanes) = out.get_mut(at..at + L).and_then(|s| s.first_chunk_mut::<L>()) {
            *lanes = self.0;
        } else {
            for (slot, value) in out.iter_mut().skip(at).zip(self.0) {
                *slot = value;
            }
        }
    }

    /// The pack that begins at `at` of packs side by side: a column that has no end to look for.
    #[inline(always)]
    pub fn of_packs(x: &[f64], at: usize) -> Self {
        Self(x.as_chunks().0.get(at / L).copied().unwrap_or([0.0; L]))
    }

    /// Writes it as the pack that begins at `at` of packs side by side.
    #[inline(always)]
    pub fn into_packs(self, out: &mut [f64], at: usize) {
        if let Some(pack) = out.as_chunks_mut().0.get_mut(at / L) {
            *pack = self.0;
        }
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(each(0.0, |i| f(self.0[i], other.0[i])))
    }
}

impl<const L: usize> Add for Packed<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
}
impl<const L: usize> Sub for Packed<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
}
impl<const L: usize> Mul for Packed<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }
}
impl<const L: usize> Div for Packed<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.zip(o, |a, b| a / b)
    }
}
impl<const L: usize> Neg for Packed<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}

impl<const L: usize> Scalar for Packed<L> {
    const ZERO: Self = Self([0.0; L]);
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x; L])
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c) = ([0.0; L], [0.0; L]);
        for i in 0..L {
            (s[i], c[i]) = elementary::sin_cos(self.0[i]);
        }
        (Self(s), Self(c))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self(each(0.0, |i| elementary::exp(self.0[i])))
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self(each(0.0, |i| elementary::ln(self.0[i])))
    }

    #[inline(always)]
    fn powf(self, y: Self) -> Self {
        if y.0.iter().all(|y| *y == 1.0) {
            self
        } else if y.0.iter().all(|y| *y == 2.0) {
            self * self
        } else {
            (self.ln() * y).exp()
        }
    }

    #[inline(always)]
    fn where_positive(self, yes: Self, no: Self) -> Self {
        Self(each(0.0, |i| if self.0[i] > 0.0 { yes.0[i] } else { no.0[i] }))
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.0[0]
    }

    #[inline(always)]
    fn where_above(self, other: Self, yes: Self, no: Self) -> Self {
        Self(each(0.0, |i| if self.0[i] > other.0[i] { yes.0[i] } else { no.0[i] }))
    }

    #[inline]
    fn is_positive(self) -> bool {
        self.0.iter().all(|x| *x > 0.0)
    }
}
