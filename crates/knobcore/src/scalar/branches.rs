//! Which way each lane of a number goes, where not all of them go the same.

use super::{Dual, Packed, Scalar, each};
use core::fmt::Debug;

/// Derivatives below this are none. Those of what dies away behind a joint do so exponentially, down to numbers of fewer
/// digits, in which they stay for ever and which take a processor a hundred times as long.
const NONE_BELOW: f64 = 1e-150;

/// A set of lanes.
pub trait Lanes: Copy + Debug + PartialEq {
    /// None of them.
    const NONE: Self;
    /// Those that are not in it.
    fn not(self) -> Self;
    /// Those that are in both.
    fn and(self, other: Self) -> Self;
    /// Whether there are some.
    fn any(self) -> bool;
    /// Whether all are.
    fn all(self) -> bool;
}

/// A number that decides lane by lane how a simulation goes on.
pub trait Branches: Scalar {
    /// A set of its lanes.
    type Lanes: Lanes;
    /// The number without derivatives.
    type Value: Branches<Value = Self::Value, Lanes = Self::Lanes>;
    /// Itself without derivatives.
    fn plain(self) -> Self::Value;
    /// Itself times a number of which no derivative is known.
    fn scaled(self, by: Self::Value) -> Self;
    /// Itself over a constant.
    #[inline(always)]
    fn over(self, by: f64) -> Self {
        self / Self::of(by)
    }
    /// The lanes where it is positive.
    fn positive(self) -> Self::Lanes;
    /// `yes` in these lanes, `no` in the others; derivatives follow the branch.
    fn choose(lanes: Self::Lanes, yes: Self, no: Self) -> Self;
    /// Itself without derivatives that died away.
    #[inline(always)]
    fn settled(self) -> Self {
        self
    }
}

impl Lanes for bool {
    const NONE: Self = false;
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

impl Branches for f64 {
    type Lanes = bool;
    type Value = Self;
    #[inline(always)]
    fn plain(self) -> Self {
        self
    }
    #[inline(always)]
    fn scaled(self, by: Self) -> Self {
        self * by
    }
    #[inline(always)]
    fn positive(self) -> bool {
        self > 0.0
    }
    #[inline(always)]
    fn choose(lanes: bool, yes: Self, no: Self) -> Self {
        if lanes { yes } else { no }
    }
}

impl<const L: usize> Branches for Dual<f64, L> {
    type Lanes = bool;
    type Value = f64;
    #[inline(always)]
    fn plain(self) -> f64 {
        self.v
    }
    #[inline(always)]
    fn scaled(self, by: f64) -> Self {
        Self { v: self.v * by, d: each(0.0, |i| self.d[i] * by) }
    }
    #[inline(always)]
    fn over(self, by: f64) -> Self {
        let inverse = 1.0 / by;
        Self { v: self.v / by, d: each(0.0, |i| self.d[i] * inverse) }
    }
    #[inline(always)]
    fn positive(self) -> bool {
        self.v > 0.0
    }
    #[inline(always)]
    fn choose(lanes: bool, yes: Self, no: Self) -> Self {
        if lanes { yes } else { no }
    }
    #[inline(always)]
    fn settled(self) -> Self {
        Self { v: self.v, d: each(0.0, |i| if self.d[i].abs() < NONE_BELOW { 0.0 } else { self.d[i] }) }
    }
}

/// Lanes of a pack, as a mask as wide as its numbers: all ones where a lane is in the set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mask<const L: usize>([u64; L]);

impl<const L: usize> Lanes for Mask<L> {
    const NONE: Self = Self([0; L]);
    #[inline(always)]
    fn not(self) -> Self {
        Self(each(0, |i| !self.0[i]))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(each(0, |i| self.0[i] & other.0[i]))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().fold(0, |any, lane| any | lane) != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        !self.not().any()
    }
}

impl<const L: usize> Branches for Packed<L> {
    type Lanes = Mask<L>;
    type Value = Self;
    #[inline(always)]
    fn plain(self) -> Self {
        self
    }
    #[inline(always)]
    fn scaled(self, by: Self) -> Self {
        self * by
    }
    #[inline(always)]
    fn positive(self) -> Mask<L> {
        Mask(each(0, |i| if self.0[i] > 0.0 { !0 } else { 0 }))
    }
    #[inline(always)]
    fn choose(lanes: Mask<L>, yes: Self, no: Self) -> Self {
        Self(each(0.0, |i| if lanes.0[i] != 0 { yes.0[i] } else { no.0[i] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_lane_of_a_pack_goes_its_own_way() {
        let (x, y) = (Packed([1.0, -1.0, 0.0, f64::NAN]), Packed([2.0; 4]));
        let positive = x.positive();
        assert_eq!(Packed::choose(positive, x, y).0, [1.0, 2.0, 2.0, 2.0]);
        assert_eq!(Packed::choose(positive.not(), x, y).0[..3], [2.0, -1.0, 0.0]);
        assert!(positive.any() && !positive.all() && !positive.and(positive.not()).any());
        assert!(y.positive().all() && !Mask::<4>::NONE.any());
    }
}
