//! One effect as the chain meets it: an object, behind which its function is compiled for numbers, for a pack
//! of samples and with derivatives.
//!
//! Each effect is compiled by itself, for each instruction set, and called once a block: nothing is inlined across
//! effects, so that a build grows with their number and not with its square.

mod own;
mod place;
mod stated;

#[cfg(feature = "std")]
pub(crate) mod along;

pub(crate) use place::{Couples, Delays, Loads, Remembers, Senses};
pub use stated::Stated;

#[cfg(feature = "std")]
pub(crate) use along::block::{BLOCK, CHANNELS, Channels, Motions, PLAIN, SCALE, Scratch, load_of};
#[cfg(feature = "std")]
pub use along::{Along, Response, Totals};

use super::{Info, Joint};
use crate::motion::{Load, Motion};
use crate::scalar::{Branches, Dual, Scalar, Wide, each};

/// The least that a factor on the dry friction leaves of it: friction never pushes.
pub(super) const LEAST: f64 = 1e-3;
/// The way out where a law has no value.
pub(super) const NARROW: &str = "narrow the bounds of its parameters";

/// What every effect can do at one instant, wherever in the chain it acts. What it does not do does nothing.
pub trait Law: Along + Sync {
    /// Its row of the catalogue.
    fn info(&self) -> &'static Info;

    /// Numbers that it remembers from sample to sample.
    fn states(&self) -> usize {
        0
    }

    /// Whether what it does depends on more than the present sample.
    fn remembers(&self) -> bool {
        false
    }

    /// Lets friction that builds up begin so far in a state, or in what is kept from block to block: 1 after a motion
    /// forward, -1 after one backward.
    fn bend(&self, _state: &mut [f64], _bent: f64) {}

    /// Over which distance its friction builds up after a reversal, rad or m.
    fn builds_up_over(&self, _p: &[f64]) -> Option<f64> {
        None
    }

    /// Brings its load at one instant into a sum.
    fn load(&self, _p: &[f64], _state: &mut [f64], _motion: &Motion<f64>, _sum: &mut Load<f64>) {}

    /// How it joins shaft and knob, if it does.
    fn joint(&self, _p: &[f64]) -> Option<Joint<f64>> {
        None
    }
}

/// Nobody measures where there is no operating system.
#[cfg(not(feature = "std"))]
pub trait Along {}
#[cfg(not(feature = "std"))]
impl<L> Along for L {}

impl core::fmt::Debug for dyn Law {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.info().id)
    }
}

/// Derivatives that are carried along a simulated motion at a time: those of the base model and a joint, in three
/// vectors of four.
pub const CARRIED: usize = 12;
/// A number with the derivatives that are carried along.
pub type D = Dual<f64, CARRIED>;

/// A number that a motion can be simulated with, step by step: alone, with derivatives, or several side by side.
pub trait Carried: Branches {
    /// [`Law::load`] for this number.
    fn load(law: &dyn Law, p: &[Self], state: &mut [Self], motion: &Motion<Self>, sum: &mut Load<Self>);
    /// [`Law::joint`] for this number.
    fn joint(law: &dyn Law, p: &[Self]) -> Option<Joint<Self>>;
}

macro_rules! carried {
    ($number:ty, $load:ident, $joint:ident) => {
        impl Carried for $number {
            #[inline(always)]
            fn load(
                law: &dyn Law,
                p: &[Self],
                state: &mut [Self],
                motion: &Motion<Self>,
                sum: &mut Load<Self>,
            ) {
                law.$load(p, state, motion, sum);
            }

            fn joint(law: &dyn Law, p: &[Self]) -> Option<Joint<Self>> {
                law.$joint(p)
            }
        }
    };
}

carried!(f64, load, joint);
#[cfg(feature = "std")]
carried!(D, load_carried, joint_carried);
#[cfg(feature = "std")]
carried!(Wide, load_wide, joint_wide);

/// The first `N` of a slice, as an array; a model always hands over as many as the effect has.
#[inline(always)]
pub(crate) fn take<T: Scalar, const N: usize>(p: &[T]) -> [T; N] {
    each(T::ZERO, |i| p.get(i).copied().unwrap_or(T::ZERO))
}

/// Parameters of which those from `first` on are differentiated by, one lane each.
#[inline(always)]
fn seeded<V: Scalar, const N: usize, const L: usize>(p: &[f64], first: usize) -> [Dual<V, L>; N] {
    Dual::seeds(take::<f64, N>(p).map(V::of), first)
}
