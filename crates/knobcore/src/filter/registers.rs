//! Registers of four doubles: which instructions this machine has for them.

use pulp::{Scalar256b, Simd};

/// Arithmetic on four lanes.
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

/// Does `work` with AVX2 and FMA where the machine that runs this has them; with AVX-512 it has
/// twice as many registers of the same width.
pub(super) fn with_best_registers(work: impl Work) {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(avx512) = pulp::x86::V4::try_new() {
            return avx512.vectorize(OnAvx2(*avx512, work));
        }
        if let Some(avx2) = pulp::x86::V3::try_new() {
            return avx2.vectorize(OnAvx2(avx2, work));
        }
    }
    work.run(Scalar256b);
}

#[cfg(target_arch = "x86_64")]
struct OnAvx2<W>(pulp::x86::V3, W);

#[cfg(target_arch = "x86_64")]
impl<W: Work> pulp::NullaryFnOnce for OnAvx2<W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.1.run(self.0);
    }
}
