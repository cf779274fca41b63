//! The instruction set of this machine, found at run time.
//!
//! Work is a value whose `call` is inlined: the body of a closure is not sure to be compiled into the function that has
//! the instruction set.

use pulp::NullaryFnOnce;

/// Does work that is compiled for vectors of eight numbers (AVX-512), of four (AVX2), and for whatever the target has.
#[inline]
pub fn dispatch<W: NullaryFnOnce>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

/// The same without vectors of eight: what carries derivatives from step to step gains nothing by them, and takes as
/// long again to compile.
#[inline]
pub fn dispatch_narrow<W: NullaryFnOnce>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(avx2, work);
    }
    work.call()
}
