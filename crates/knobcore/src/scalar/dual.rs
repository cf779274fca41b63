//! Forward-mode automatic differentiation: a value with its derivatives to `L` parameters.
//!
//! Source: Wengert, R. E. (1964), "A simple automatic derivative evaluation program", CACM 7(8).

use super::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Work for each of a number of lanes. The first twelve are written out: in a loop it is not known at compile time which
/// of them vanish.
macro_rules! lane_by_lane {
    ($lanes:expr, $lane:ident => $work:block) => {
        lane_by_lane!(@ $lanes, $lane => $work, 0 1 2 3 4 5 6 7 8 9 10 11);
        for $lane in (0..$lanes).skip(12) {
            $work
        }
    };
    (@ $lanes:expr, $lane:ident => $work:block, $($at:literal)*) => {
        $(if $lanes > $at {
            let $lane: usize = $at;
            $work
        })*
    };
}

pub(crate) use lane_by_lane;

/// `v + sum_i d[i] eps_i`, with every `eps_i eps_j = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<V, const L: usize> {
    /// The value.
    pub v: V,
    /// Its derivative to each of the `L` seeded parameters.
    pub d: [V; L],
}

impl<V: Scalar, const L: usize> Dual<V, L> {
    /// A constant: no derivative.
    #[inline(always)]
    pub fn constant(v: V) -> Self {
        Self { v, d: [V::ZERO; L] }
    }

    /// The parameter that lane `lane` differentiates by.
    #[inline(always)]
    pub fn seeded(v: f64, lane: Option<usize>) -> Self {
        let mut x = Self::constant(V::of(v));
        if let Some(slot) = lane.and_then(|lane| x.d.get_mut(lane)) {
            *slot = V::of(1.0);
        }
        x
    }

    /// Parameters, of which those from `first` on are differentiated by, one lane each.
    #[inline(always)]
    pub fn seeds<const N: usize>(values: [V; N], first: usize) -> [Self; N] {
        let mut seeds = [Self::ZERO; N];
        lane_by_lane!(N, i => {
            seeds[i].v = values[i];
            if i >= first && i - first < L {
                seeds[i].d[i - first] = V::of(1.0);
            }
        });
        seeds
    }

    /// Its derivatives as plain numbers, for those that do not know which lane is which.
    #[inline(always)]
    pub fn slopes<U: Scalar>(self, plain: impl Fn(V) -> U) -> [U; L] {
        let mut slopes = [U::ZERO; L];
        lane_by_lane!(L, lane => {
            slopes[lane] = plain(self.d[lane]);
        });
        slopes
    }

    /// Chain rule: value `v`, and `slope` times each derivative.
    #[inline(always)]
    fn chain(self, v: V, slope: V) -> Self {
        self.zip(self, v, |d, _| d * slope)
    }

    #[inline(always)]
    fn zip(self, o: Self, v: V, f: impl Fn(V, V) -> V) -> Self {
        let mut d = self.d;
        lane_by_lane!(L, lane => {
            d[lane] = f(d[lane], o.d[lane]);
        });
        Self { v, d }
    }
}

impl<V: Scalar, const L: usize> Add for Dual<V, L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, self.v + o.v, |a, b| a + b)
    }
}
impl<V: Scalar, const L: usize> Sub for Dual<V, L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, self.v - o.v, |a, b| a - b)
    }
}
impl<V: Scalar, const L: usize> Mul for Dual<V, L> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule is a sum")]
    fn mul(self, o: Self) -> Self {
        self.zip(o, self.v * o.v, |a, b| a * o.v + self.v * b)
    }
}
impl<V: Scalar, const L: usize> Div for Dual<V, L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let (q, inverse) = (self.v / o.v, V::of(1.0) / o.v);
        self.zip(o, q, |a, b| (a - q * b) * inverse)
    }
}
impl<V: Scalar, const L: usize> Neg for Dual<V, L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.v, V::of(-1.0))
    }
}

impl<V: Scalar, const L: usize> Scalar for Dual<V, L> {
    const ZERO: Self = Self { v: V::ZERO, d: [V::ZERO; L] };

    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::constant(V::of(x))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.v.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.v.exp();
        self.chain(e, e)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.v.ln(), V::of(1.0) / self.v)
    }

    #[inline(always)]
    fn where_positive(self, yes: Self, no: Self) -> Self {
        let v = self.v.where_positive(yes.v, no.v);
        yes.zip(no, v, |a, b| self.v.where_positive(a, b))
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.v.value()
    }

    #[inline(always)]
    fn where_above(self, o: Self, yes: Self, no: Self) -> Self {
        let v = self.v.where_above(o.v, yes.v, no.v);
        yes.zip(no, v, |a, b| self.v.where_above(o.v, a, b))
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self.v.is_positive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_of_every_operation_equals_the_finite_difference() {
        fn law<T: Scalar>(x: T, y: T) -> T {
            let (s, c) = (x * y).sin_cos();
            let bent = (s / (y + T::of(3.0)) - c * x).abs().max(-x).min(T::of(9.0));
            bent + (-y).where_positive(x, x * y * y) + (x * x).powf(y) * (-x).exp()
        }
        for (x, y) in [(0.3, 0.7), (-1.2, 0.4), (2.5, -1.1), (-0.6, -2.2)] {
            let dual = law(Dual::<f64, 2>::seeded(x, Some(0)), Dual::seeded(y, Some(1)));
            let h = 1e-6;
            let dx = (law(x + h, y) - law(x - h, y)) / (2.0 * h);
            let dy = (law(x, y + h) - law(x, y - h)) / (2.0 * h);
            assert_eq!(dual.v, law(x, y));
            assert!((dual.d[0] - dx).abs() < 1e-8 && (dual.d[1] - dy).abs() < 1e-8, "{dual:?} {dx} {dy}");
        }
    }
}
