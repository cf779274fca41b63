//! What a law may call, over numbers, packs of samples, or either with derivatives. What [`Scalar`] has is called there.

use super::{Function, Op};
#[cfg(not(feature = "std"))]
use crate::prelude::*;
use crate::scalar::Scalar;

/// A function of one number.
#[inline(always)]
pub(super) fn called<T: Scalar>(function: Function, x: T) -> T {
    match function {
        Function::Sin => x.sin_cos().0,
        Function::Cos => x.sin_cos().1,
        Function::Tan => tan(x),
        Function::Exp => x.exp(),
        Function::Log => log(x),
        Function::Sqrt => raised(x, 0.5),
        Function::Abs => x.abs(),
        Function::Sign => sign(x),
        Function::Tanh => tanh(x),
        Function::Min | Function::Max => x,
    }
}

/// The tangent.
#[inline(always)]
pub(crate) fn tan<T: Scalar>(x: T) -> T {
    let (sin, cos) = x.sin_cos();
    sin / cos
}

/// The natural logarithm; of a number that is not positive it is none.
#[inline(always)]
pub(crate) fn log<T: Scalar>(x: T) -> T {
    x.where_positive(x.ln(), T::of(f64::NAN))
}

/// -1, 0 or 1.
#[inline(always)]
pub(crate) fn sign<T: Scalar>(x: T) -> T {
    let one = T::of(1.0);
    x.where_positive(one, (-x).where_positive(-one, T::of(0.0)))
}

/// The hyperbolic tangent.
#[inline(always)]
pub(crate) fn tanh<T: Scalar>(x: T) -> T {
    let one = T::of(1.0);
    let e = (x.abs() * T::of(-2.0)).exp();
    sign(x) * (one - e) / (one + e)
}

/// x to a power that is known: whole ones by multiplication.
#[inline(always)]
pub(crate) fn raised<T: Scalar>(x: T, exponent: f64) -> T {
    let times = exponent.abs();
    if times.fract() != 0.0 || times > 16.0 {
        return power(x, T::of(exponent));
    }
    let product = (0..times as usize).fold(T::of(1.0), |product, _| product * x);
    if exponent < 0.0 { T::of(1.0) / product } else { product }
}

/// x^y of a number from 0 on; of one below it is none.
#[inline(always)]
pub(crate) fn power<T: Scalar>(x: T, y: T) -> T {
    // The logarithm of nothing is kept from the derivatives.
    let base = x.where_positive(x, T::of(1.0));
    let zero = y.where_positive(T::of(0.0), (-y).where_positive(T::of(f64::INFINITY), T::of(1.0)));
    x.where_positive((base.ln() * y).exp(), (-x).where_positive(T::of(f64::NAN), zero))
}

/// A sum of cubic B-splines (Schoenberg 1946), one at each whole number from 0 on, so many times high: nought from two
/// beyond the first and the last on.
#[inline(always)]
pub(crate) fn spline<T: Scalar>(high: &[f64], x: T) -> T {
    let cubed = |x: T| x * x * x;
    let (mut sum, mut from) = (T::ZERO, x);
    for high in high {
        let far = from.abs();
        let wide = cubed((T::of(2.0) - far).max(T::ZERO));
        let narrow = cubed((T::of(1.0) - far).max(T::ZERO));
        sum = sum + (wide - narrow * T::of(4.0)) * T::of(high / 6.0);
        from = from - T::of(1.0);
    }
    sum
}

/// One operation, of the first number alone where it takes no other.
pub(super) fn applied(op: Op, left: f64, right: f64) -> f64 {
    match op {
        Op::Add => left + right,
        Op::Subtract => left - right,
        Op::Multiply => left * right,
        Op::Divide => left / right,
        Op::Negate => -left,
        Op::Raise(exponent) => raised(left, exponent),
        Op::Power => power(left, right),
        Op::Call(Function::Min) => Scalar::min(left, right),
        Op::Call(Function::Max) => Scalar::max(left, right),
        Op::Call(function) => called(function, left),
        Op::Number(x) => x,
        Op::Motion(_) | Op::Parameter(_) | Op::Spline(_) => f64::NAN,
    }
}
