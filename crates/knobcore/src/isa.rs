//! The instruction set of this machine, found at run time.
//!
//! Work is a value whose `call` is inlined: the body of a closure is not sure to be compiled into the function that has
//! the instruction set.

use pulp::WithSimd;

/// Does work that is compiled for vectors of four numbers (AVX2) and for whatever the target has.
#[inline]
pub fn dispatch<W: WithSimd>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(avx2, work);
    }
    work.with_simd(pulp::Scalar)
}

/// Does work that is compiled for vectors of eight numbers (AVX-512) too. That is a third copy to compile: for what is
/// short, and waits for what it has computed last.
#[inline]
pub fn dispatch_wide<W: WithSimd>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = pulp::x86::V4::try_new() {
        return pulp::Simd::vectorize(avx512, work);
    }
    dispatch(work)
}
