//! The instruction set of this machine, found at run time.
//!
//! Work is a value whose `call` is inlined: the body of a closure is not sure to be compiled into the function that has
//! the instruction set.

use pulp::NullaryFnOnce;

/// Does work that is compiled for vectors of four numbers (AVX2) and for whatever the target has. Vectors of eight
/// (AVX-512) take a third copy of each kernel to compile and are no faster in a fit; only bootstrap refits were, by a
/// third.
#[inline]
pub fn dispatch<W: NullaryFnOnce>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(avx2, work);
    }
    work.call()
}
