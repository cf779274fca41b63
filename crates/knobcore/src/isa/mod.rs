//! The instruction set of this machine, found at run time.
//!
//! Work is a value whose `call` is inlined: the body of a closure is not sure to be compiled into the function that has
//! the instruction set.

#[cfg(feature = "std")]
mod found;
#[cfg(feature = "std")]
pub use found::{NAMES, VARIABLE, dispatch, dispatch_wide, used};

#[cfg(not(feature = "std"))]
mod built {
    //! Nothing says what a processor has: what it is built for is used.
    use pulp::WithSimd;

    /// Does work as it is compiled for the target.
    #[inline]
    pub fn dispatch<W: WithSimd>(work: W) -> W::Output {
        work.with_simd(pulp::Scalar)
    }

    /// The same.
    #[inline]
    pub fn dispatch_wide<W: WithSimd>(work: W) -> W::Output {
        dispatch(work)
    }
}
#[cfg(not(feature = "std"))]
pub use built::{dispatch, dispatch_wide};
