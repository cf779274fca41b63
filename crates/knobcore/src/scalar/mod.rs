//! The number that physics is written over.
//!
//! Every effect is one generic function. Instantiated with `f64` it renders, with [`Pack`] it runs over
//! several samples at once, with [`Dual`] it carries exact derivatives, and with a `Dual` of `Pack` both.
//! No derivative is written by hand and no formula twice.

mod branches;
mod dual;
mod elementary;
mod known;
mod pack;

pub use branches::{Branches, Lanes};
pub use dual::Dual;
pub(crate) use dual::lane_by_lane;
pub use known::Known;
pub(crate) use pack::each;
pub use pack::{LANES, Pack, Packed, WIDE, Wide};

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, a pack of them, or either with derivatives.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero, known to be where that can be: a derivative that vanishes. A constant: what a call gives would be written to
    /// an array in a loop.
    const ZERO: Self;
    /// The constant `x`, the same in every lane and without derivatives.
    fn of(x: f64) -> Self;
    /// (sin, cos), to about one unit in the last place for |x| < 1e6.
    fn sin_cos(self) -> (Self, Self);
    /// e^x, to about one unit in the last place; |x| is cut at 700.
    fn exp(self) -> Self;
    /// The natural logarithm of a positive normal number, to about one unit in the last place.
    fn ln(self) -> Self;
    /// `yes` in the lanes where `self` is positive, `no` in the others; derivatives follow the branch.
    fn where_positive(self, yes: Self, no: Self) -> Self;
    /// `yes` in the lanes where `self` is greater than `other`, `no` in the others.
    #[inline(always)]
    fn where_above(self, other: Self, yes: Self, no: Self) -> Self {
        (self - other).where_positive(yes, no)
    }

    /// self^y of a positive number; itself and the square without a logarithm where no derivative by the exponent is asked
    /// for.
    #[inline(always)]
    fn powf(self, y: Self) -> Self {
        (self.ln() * y).exp()
    }

    /// The number without derivatives (of a pack the first).
    fn value(self) -> f64;

    /// Whether it is positive (a pack: all of it).
    fn is_positive(self) -> bool;

    /// The magnitude; its derivative at zero is that of the negative branch.
    #[inline(always)]
    fn abs(self) -> Self {
        self.where_positive(self, -self)
    }

    /// The smaller of the two.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.where_above(other, other, self)
    }

    /// The larger of the two.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.where_above(other, self, other)
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    #[inline(always)]
    fn powf(self, y: Self) -> Self {
        match y {
            1.0 => self,
            2.0 => self * self,
            _ => elementary::exp(elementary::ln(self) * y),
        }
    }
    #[inline(always)]
    fn where_positive(self, yes: Self, no: Self) -> Self {
        if self > 0.0 { yes } else { no }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn where_above(self, other: Self, yes: Self, no: Self) -> Self {
        if self > other { yes } else { no }
    }
    #[inline(always)]
    fn is_positive(self) -> bool {
        self > 0.0
    }
}
