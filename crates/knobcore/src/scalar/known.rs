//! Numbers of which it is known at compile time whether they vanish, so that what is multiplied by them costs nothing.
//!
//! Derivatives are made of it: of a sum of products each parameter is in few, and a motion that is prescribed has
//! none. What a compiler may not leave out of itself (zero times infinity is no zero) is left out here.

use super::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or a zero that every operation knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known<V> {
    /// The number.
    pub x: V,
    /// Not a truth value: what is copied must not have gaps, or the gaps are copied beside the numbers.
    zero: u64,
}

impl<V: Scalar> Known<V> {
    /// Any number.
    #[inline(always)]
    pub fn any(x: V) -> Self {
        Self { x, zero: 0 }
    }

    #[inline(always)]
    fn vanishes(self) -> bool {
        self.zero != 0
    }
}

impl<V: Scalar> Add for Known<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        match (self.vanishes(), o.vanishes()) {
            (true, _) => o,
            (_, true) => self,
            _ => Self::any(self.x + o.x),
        }
    }
}
impl<V: Scalar> Sub for Known<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        match (self.vanishes(), o.vanishes()) {
            (true, _) => -o,
            (_, true) => self,
            _ => Self::any(self.x - o.x),
        }
    }
}
impl<V: Scalar> Mul for Known<V> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        if self.vanishes() || o.vanishes() { Self::ZERO } else { Self::any(self.x * o.x) }
    }
}
impl<V: Scalar> Div for Known<V> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        if self.vanishes() { self } else { Self::any(self.x / o.x) }
    }
}
impl<V: Scalar> Neg for Known<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        if self.vanishes() { self } else { Self::any(-self.x) }
    }
}

impl<V: Scalar> Scalar for Known<V> {
    const ZERO: Self = Self { x: V::ZERO, zero: 1 };

    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::any(V::of(x))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.x.sin_cos();
        (Self::any(s), Self::any(c))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self::any(self.x.exp())
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self::any(self.x.ln())
    }

    #[inline(always)]
    fn where_positive(self, yes: Self, no: Self) -> Self {
        let x = self.x.where_positive(yes.x, no.x);
        Self { x, zero: yes.zero & no.zero }
    }

    #[inline(always)]
    fn where_above(self, other: Self, yes: Self, no: Self) -> Self {
        let x = self.x.where_above(other.x, yes.x, no.x);
        Self { x, zero: yes.zero & no.zero }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.x.value()
    }

    #[inline]
    fn is_positive(self) -> bool {
        self.x.is_positive()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Dual;
    use super::*;

    #[test]
    fn derivatives_that_are_known_to_vanish_are_those_that_do() {
        fn law<T: Scalar>(x: T, y: T, z: T) -> T {
            let (s, c) = (x * y).sin_cos();
            let bent = (s / (y + T::of(3.0)) - c * x).abs().max(-x).min(T::of(9.0));
            bent + (-y).where_positive(x, x * y * y) + (x * x).powf(y) * (-x).exp() + (z - x) / z
        }
        for (x, y, z) in [(0.3, 0.7, 1.9), (-1.2, 0.4, -0.3), (2.5, -1.1, 4.0)] {
            let dense = law(Dual::<f64, 2>::seeded(x, Some(0)), Dual::seeded(y, Some(1)), Dual::constant(z));
            let known = law(
                Dual::<Known<f64>, 2>::seeded(x, Some(0)),
                Dual::seeded(y, Some(1)),
                Dual::constant(Known::any(z)),
            );
            assert_eq!(known.v.x, dense.v);
            for (known, dense) in known.d.iter().zip(dense.d) {
                assert!((known.x - dense).abs() <= 1e-15 * dense.abs(), "{known:?} {dense}");
            }
            let constant = Dual::<Known<f64>, 2>::constant(Known::any(x)).sin_cos().0;
            assert!(constant.d.iter().all(|d| *d == Known::ZERO));
        }
    }
}
