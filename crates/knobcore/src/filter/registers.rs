//! Registers of several doubles: which instructions this machine has for them.

use pulp::{Scalar256b, Simd};

/// Arithmetic on four or eight lanes.
pub(super) trait Registers: Simd {
    /// `a b + c`, rounded once or twice, whichever is fast.
    fn multiply_add(self, a: Self::f64s, b: Self::f64s, c: Self::f64s) -> Self::f64s;
}

#[cfg(target_arch = "x86_64")]
impl Registers for pulp::x86::V3 {
    #[inline(always)]
    fn multiply_add(self, a: Self::f64s, b: Self::f64s, c: Self::f64s) -> Self::f64s {
        self.mul_add_f64s(a, b, c)
    }
}

#[cfg(target_arch = "x86_64")]
impl Registers for pulp::x86::V4 {
    #[inline(always)]
    fn multiply_add(self, a: Self::f64s, b: Self::f64s, c: Self::f64s) -> Self::f64s {
        self.mul_add_f64s(a, b, c)
    }
}

/// Plain arrays. Rounded twice: a fused multiply-add without its instruction is a library call,
/// twenty times slower.
impl Registers for Scalar256b {
    #[inline(always)]
    fn multiply_add(self, a: Self::f64s, b: Self::f64s, c: Self::f64s) -> Self::f64s {
        self.add_f64s(self.mul_f64s(a, b), c)
    }
}

/// Work that is compiled once for each kind of registers.
pub(super) trait Work {
    /// Does it. To be `#[inline(always)]`, and so all that it calls: only what is inlined gets the
    /// instructions.
    fn run<R: Registers>(self, registers: R);
}

/// Does `work` with the widest registers of the machine that runs this: AVX-512, AVX2 with FMA, or
/// what every machine has.
pub(super) fn with_best_registers(work: impl Work) {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(avx512) = pulp::x86::V4::try_new() {
            return avx512.vectorize(On(avx512, work));
        }
        if let Some(avx2) = pulp::x86::V3::try_new() {
            return avx2.vectorize(On(avx2, work));
        }
    }
    work.run(Scalar256b);
}

#[cfg(target_arch = "x86_64")]
struct On<R, W>(R, W);

#[cfg(target_arch = "x86_64")]
impl<R: Registers, W: Work> pulp::NullaryFnOnce for On<R, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.1.run(self.0);
    }
}
