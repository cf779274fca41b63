//! The render loop: a device is sensed and driven on a fixed beat, and what became of that beat is told.
//!
//! ```text
//! sleep until start + n period -> read -> step -> write -> n = first deadline that lies ahead
//! ```
//! Deadlines are absolute, so lateness never adds up; after an overrun the periods that passed are skipped and
//! counted as missed, never made up for in a burst. However a loop ends, also by a panic of the device or the
//! controller, the last torque that it writes is zero, and the last second before that is kept.
//!
//! Nothing is allocated, and no lock is waited for, between the first period and the end.
//!
//! A loop cannot write while its own process is stopped or its device hangs in a call: it notices when it comes
//! back, and ends. So a device that holds its last torque needs a watchdog of its own.
mod clock;
mod end;
mod histogram;
mod last;
mod live;
mod monotonic;
mod pace;
mod plan;
mod priority;
mod run;
mod tally;
#[cfg(test)]
mod tests;
mod thread;

pub use clock::{Clock, Ticks, VirtualClock};
pub use end::Ending;
pub use histogram::Histogram;
pub use last::Row;
pub use live::{Live, Snapshot};
pub use monotonic::{SleepClock, SystemClock};
pub use plan::Plan;
pub use priority::{Realtime, Standing, real_time_priority};
pub use run::{Loop, Report};
pub use tally::Tally;
pub use thread::{Running, start};

use knobcore::error::{Error, Result};
use knobrender::{Renderer, Sensed};

/// A device as the loop sees it: anything that can be sensed and driven. Both calls return well within a period.
pub trait Plant {
    /// What it senses now.
    fn read(&mut self) -> Result<Sensed>;

    /// The torque by which the knob answers, N m: the device applies its negative to the hand.
    fn write(&mut self, tau: f64) -> Result<()>;
}

/// Anything that answers a sensed state with a torque.
pub trait Controller {
    /// The torque by which the knob answers, N m.
    fn step(&mut self, sensed: Sensed) -> f64;

    /// What the controller found wrong, if anything; it ends the loop.
    fn fault(&self) -> Option<Error>;

    /// Periods were skipped since the last step.
    fn missed(&mut self, _periods: u64) {}
}

impl<D: Plant + ?Sized> Plant for Box<D> {
    fn read(&mut self) -> Result<Sensed> {
        (**self).read()
    }

    fn write(&mut self, tau: f64) -> Result<()> {
        (**self).write(tau)
    }
}

impl<C: Controller + ?Sized> Controller for Box<C> {
    fn step(&mut self, sensed: Sensed) -> f64 {
        (**self).step(sensed)
    }

    fn fault(&self) -> Option<Error> {
        (**self).fault()
    }

    fn missed(&mut self, periods: u64) {
        (**self).missed(periods);
    }
}

impl Controller for Renderer {
    fn step(&mut self, sensed: Sensed) -> f64 {
        Self::step(self, sensed)
    }

    fn fault(&self) -> Option<Error> {
        Self::fault(self).map(|fault| Error::invalid(fault.name(), fault.text()))
    }

    fn missed(&mut self, periods: u64) {
        Self::missed(self, periods);
    }
}
