//! The instruction set of this machine, found at run time.

use pulp::NullaryFnOnce;

/// Does work that is compiled twice: for vectors of four numbers (AVX2), which all but the oldest x86 machines have, and
/// for whatever the target has anyway. Vectors of eight were measured and gain nothing here, but compile as long again.
///
/// Work is a value whose `call` is inlined: the body of a closure is not sure to be compiled into the function that has
/// the instruction set.
#[inline]
pub fn dispatch<W: NullaryFnOnce>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(avx2, work);
    }
    work.call()
}
