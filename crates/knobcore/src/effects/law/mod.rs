//! One effect as the chain meets it: an object, behind which its function is compiled for numbers, for a pack
//! of samples and with derivatives.
//!
//! Each effect is compiled by itself, for each instruction set, and called once a block: nothing is inlined across
//! effects, so that a build grows with their number and not with its square.

pub(crate) mod block;
mod gradient;
mod memory;
mod own;
mod place;
mod response;
mod spent;
mod stated;

pub use block::Totals;
pub(crate) use block::{BLOCK, CHANNELS, Channels, Motions, PLAIN, SCALE, Scratch, load_of};
pub(crate) use gradient::Gradient;
pub(crate) use place::{Couples, Delays, Loads, Remembers, Senses};
pub use response::Response;
pub use stated::Stated;

use super::{Carrier, Context, Info, Joint, Survey};
use crate::motion::{Load, Motion};
use crate::scalar::{Branches, Dual, Scalar, Wide};

/// The least that a factor on the dry friction leaves of it: friction never pushes.
pub(super) const LEAST: f64 = 1e-3;
/// The way out where a law has no value.
pub(super) const NARROW: &str = "narrow the bounds of its parameters";

/// What every effect can do, wherever in the chain it acts. What it does not do does nothing.
pub trait Law: Sync {
    /// Its row of the catalogue.
    fn info(&self) -> &'static Info;

    /// Parameter values to start a search from.
    fn starts(&self, survey: &Survey) -> Vec<Vec<f64>>;

    /// Parameter values of an ordinary size on a knob.
    fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64>;

    /// What is implausible about such values in such a fit, a sentence each; effects that it names stand in braces.
    fn implausible(&self, _p: &[f64], _context: &Context) -> Vec<String> {
        Vec::new()
    }

    /// Over which distance its friction builds up after a reversal, rad or m.
    fn builds_up_over(&self, _p: &[f64]) -> Option<f64> {
        None
    }

    /// Numbers that it remembers from sample to sample.
    fn states(&self) -> usize {
        0
    }

    /// Whether what it does depends on more than the present sample.
    fn remembers(&self) -> bool {
        false
    }

    /// What is kept for it from block to block: its state, or what it worked out for the whole motion at once. `columns`
    /// says which parameters have a derivative column.
    fn kept(&self, _p: &[f64], _columns: &[Option<usize>], _motion: [&[f64]; 5]) -> Vec<f64> {
        Vec::new()
    }

    /// Brings its load at one instant into a sum.
    fn load(&self, _p: &[f64], _state: &mut [f64], _motion: &Motion<f64>, _sum: &mut Load<f64>) {}

    /// The same with derivatives.
    fn load_carried(&self, _p: &[D], _state: &mut [D], _motion: &Motion<D>, _sum: &mut Load<D>) {}

    /// The same for several knobs side by side, of other parameters each; of the catalogue alone.
    fn load_wide(&self, _p: &[Wide], _state: &mut [Wide], _motion: &Motion<Wide>, _sum: &mut Load<Wide>) {}

    /// How it joins shaft and knob, if it does.
    fn joint(&self, _p: &[f64]) -> Option<Joint<f64>> {
        None
    }

    /// The same with derivatives.
    fn joint_carried(&self, _p: &[D]) -> Option<Joint<D>> {
        None
    }

    /// The same for several side by side, of the catalogue alone.
    fn joint_wide(&self, _p: &[Wide]) -> Option<Joint<Wide>> {
        None
    }

    /// Adds what it asks over a block of samples to the totals; for what remembers, block after block.
    fn total(&self, _p: &[f64], _kept: &mut [f64], _totals: &mut Totals<'_>) {}

    /// Adds the derivatives of the torque by its own parameters over the block that came last.
    fn slopes(
        &self,
        _p: &[f64],
        _columns: &[Option<usize>],
        _kept: &mut [f64],
        _gradient: &mut Gradient<'_>,
    ) {
    }

    /// Passes torque and derivatives through it, if it is a sensor.
    fn pass(&self, _p: &[f64], _columns: &[Option<usize>], _over: &mut Response<'_>) {}
}

impl std::fmt::Debug for dyn Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
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
carried!(D, load_carried, joint_carried);
carried!(Wide, load_wide, joint_wide);

/// The first `N` of a slice, as an array; a model always hands over as many as the effect has.
#[inline(always)]
pub(crate) fn take<T: Scalar, const N: usize>(p: &[T]) -> [T; N] {
    std::array::from_fn(|i| p.get(i).copied().unwrap_or(T::of(0.0)))
}

/// Parameters of which those from `first` on are differentiated by, one lane each.
#[inline(always)]
fn seeded<V: Scalar, const N: usize, const L: usize>(p: &[f64], first: usize) -> [Dual<V, L>; N] {
    Dual::seeds(take::<f64, N>(p).map(V::of), first)
}
