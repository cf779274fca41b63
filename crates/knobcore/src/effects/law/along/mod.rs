//! What only those ask of an effect who measure: whole columns, derivatives, and what a search begins with.

pub(crate) mod block;
mod columns;
mod gradient;
mod memory;
mod own;
mod response;
mod spent;
mod stated;

pub use block::Totals;
use gradient::Gradient;
pub use response::Response;

use super::D;
use crate::effects::{Carrier, Context, Joint, Survey};
use crate::motion::{Load, Motion};
use crate::scalar::Wide;

/// What every effect can do along a motion that is prescribed. What it does not do does nothing.
pub trait Along {
    /// Parameter values to start a search from.
    fn starts(&self, survey: &Survey) -> Vec<Vec<f64>>;

    /// Parameter values of an ordinary size on a knob.
    fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64>;

    /// What is implausible about such values in such a fit, a sentence each; effects that it names stand in braces.
    fn implausible(&self, _p: &[f64], _context: &Context) -> Vec<String> {
        Vec::new()
    }

    /// What is kept for it from block to block: its state, or what it worked out for the whole motion at once. `columns`
    /// says which parameters have a derivative column.
    fn kept(&self, _p: &[f64], _columns: &[Option<usize>], _motion: [&[f64]; 5]) -> Vec<f64> {
        Vec::new()
    }

    /// The same with derivatives.
    fn load_carried(&self, _p: &[D], _state: &mut [D], _motion: &Motion<D>, _sum: &mut Load<D>) {}

    /// The same for several knobs side by side, of other parameters each; of the catalogue alone.
    fn load_wide(&self, _p: &[Wide], _state: &mut [Wide], _motion: &Motion<Wide>, _sum: &mut Load<Wide>) {}

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
