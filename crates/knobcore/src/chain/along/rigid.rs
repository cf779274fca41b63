//! The chain on a motion that is prescribed and a shaft that is rigid: inverse dynamics over whole columns.
//!
//! Block by block: first all loads come together, then the friction budget is spent once, with its gradient to
//! every channel of the load; by the chain rule each effect then needs derivatives to its own parameters only,
//! however the loads act on each other.

use crate::effects::law::{BLOCK, Response, Scratch, Totals};
use crate::model::Part;
use core::cell::Cell;

thread_local! {
    /// Kept from call to call where no effect shapes the friction: it is larger than what most of them compute, and those
    /// leave what they do not use at zero. A user's effect may end up here again.
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

/// Torque and derivatives of loads on the moving knob, whose friction that builds up begins `bent` so far; what the columns
/// held is replaced.
pub(super) fn loads(parts: &[Part<'_>], bent: f64, over: &mut Response<'_>) {
    let plain = !parts.iter().any(|(id, ..)| id.info().shapes_friction);
    let samples = over.torque.len();
    let kept = |(id, p, columns): &Part<'_>| {
        let mut kept = id.law().kept(p, columns, over.motion);
        id.law().bend(&mut kept, bent);
        kept
    };
    let mut kept: Vec<Vec<f64>> = parts.iter().map(kept).collect();
    let mut scratch = SCRATCH.take().filter(|_| plain).unwrap_or_default();
    let Scratch { channels, spent, end } = &mut *scratch;
    for start in (0..samples).step_by(BLOCK) {
        let block = start..(start + BLOCK).min(samples);
        let mut totals = Totals::new(over.motion, block, plain, channels, end);
        for ((id, p, _), kept) in parts.iter().zip(&mut kept) {
            id.law().total(p, kept, &mut totals);
        }
        let mut gradient = totals.spend(over.torque, over.slopes, spent);
        for ((id, p, columns), kept) in parts.iter().zip(&mut kept) {
            id.law().slopes(p, columns, kept, &mut gradient);
        }
    }
    if plain {
        SCRATCH.set(Some(scratch));
    }
}
