//! What every module has of itself where there is an operating system, for those that also run without one.

pub use alloc::borrow::ToOwned;
pub use alloc::boxed::Box;
pub use alloc::string::{String, ToString};
pub use alloc::vec::Vec;
pub use alloc::{format, vec};

#[cfg(not(feature = "std"))]
pub use bare::Float as _;

#[cfg(not(feature = "std"))]
mod bare {
    /// What `f64` has in the standard library alone. All but powers and lengths are exact, and so the same here as there.
    #[allow(missing_docs)]
    pub trait Float: Sized {
        fn sqrt(self) -> Self;
        fn round(self) -> Self;
        fn ceil(self) -> Self;
        fn fract(self) -> Self;
        fn powi(self, n: i32) -> Self;
        fn hypot(self, other: Self) -> Self;
        fn powf(self, n: Self) -> Self;
        fn ln(self) -> Self;
        fn cos(self) -> Self;
        fn atan(self) -> Self;
        fn atan2(self, x: Self) -> Self;
    }

    impl Float for f64 {
        fn sqrt(self) -> Self {
            libm::sqrt(self)
        }

        fn round(self) -> Self {
            libm::round(self)
        }

        fn ceil(self) -> Self {
            libm::ceil(self)
        }

        fn fract(self) -> Self {
            self - libm::trunc(self)
        }

        fn powi(self, n: i32) -> Self {
            libm::pow(self, f64::from(n))
        }

        fn hypot(self, other: Self) -> Self {
            libm::hypot(self, other)
        }

        fn powf(self, n: Self) -> Self {
            libm::pow(self, n)
        }

        fn ln(self) -> Self {
            libm::log(self)
        }

        fn cos(self) -> Self {
            libm::cos(self)
        }

        fn atan(self) -> Self {
            libm::atan(self)
        }

        fn atan2(self, x: Self) -> Self {
            libm::atan2(self, x)
        }
    }
}
