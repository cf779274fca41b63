//! Time as the loop sees it, and a time that only passes when it is told to.
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Nanoseconds in a second.
pub const SECOND: u64 = 1_000_000_000;

/// A clock that never goes back.
pub trait Clock {
    /// Time since a fixed instant, ns.
    fn now(&self) -> u64;

    /// Waits until `deadline`, ns, and returns the time then: the deadline or later.
    fn sleep_until(&mut self, deadline: u64) -> u64;
}

/// The time of a virtual clock, for everyone who takes part in it: an emulated device, a test.
#[derive(Debug, Clone, Default)]
pub struct Ticks(Arc<AtomicU64>);

impl Ticks {
    /// Time since the start, ns.
    pub fn now(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    /// Lets time pass, ns.
    pub fn pass(&self, by: u64) {
        self.0.fetch_add(by, Ordering::Relaxed);
    }
}

/// A clock without waiting: time goes straight to the deadline, and past it by the latency of that wake-up.
pub struct VirtualClock<L = fn() -> u64> {
    ticks: Ticks,
    latency: L,
}

impl VirtualClock {
    /// A clock that is always punctual.
    pub fn new(ticks: Ticks) -> Self {
        Self { ticks, latency: || 0 }
    }
}

impl<L: FnMut() -> u64> VirtualClock<L> {
    /// A clock whose wake-ups are late by what `latency` returns, ns.
    pub fn late(ticks: Ticks, latency: L) -> Self {
        Self { ticks, latency }
    }
}

impl<L: FnMut() -> u64> Clock for VirtualClock<L> {
    fn now(&self) -> u64 {
        self.ticks.now()
    }

    fn sleep_until(&mut self, deadline: u64) -> u64 {
        let ahead = deadline.saturating_sub(self.ticks.now());
        self.ticks.pass(ahead + (self.latency)());
        self.ticks.now()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sleeper_wakes_at_its_deadline_plus_the_latency() {
        let mut clock = VirtualClock::late(Ticks::default(), || 30);
        assert_eq!(clock.sleep_until(100), 130);
        assert_eq!(clock.now(), 130);
    }

    #[test]
    fn a_deadline_that_has_passed_is_not_waited_for() {
        let ticks = Ticks::default();
        ticks.pass(500);
        assert_eq!(VirtualClock::new(ticks).sleep_until(100), 500);
    }
}
