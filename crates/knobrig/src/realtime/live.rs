//! What others see of a running loop, and how they ask it to stop.
use super::last::Row;
use super::tally::Tally;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, TryLockError};

/// A loop at one moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshot {
    /// Counts and durations so far.
    pub tally: Tally,
    /// The newest step.
    pub newest: Option<Row>,
}

/// Shared between a loop and those who watch it.
#[derive(Debug, Default)]
pub struct Live {
    stop: AtomicBool,
    snapshot: Mutex<Snapshot>,
}

impl Live {
    /// Asks the loop to stop; it does so in its next period.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The newest snapshot, at most some hundredths of a second old.
    pub fn snapshot(&self) -> Snapshot {
        self.snapshot.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Publishes a snapshot, unless somebody is just looking: the loop never waits.
    pub(super) fn publish(&self, tally: &Tally, newest: Option<Row>) {
        let mut snapshot = match self.snapshot.try_lock() {
            Ok(snapshot) => snapshot,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        snapshot.tally.clone_from(tally);
        snapshot.newest = newest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_does_not_wait_for_those_who_look() {
        let live = Live::default();
        let looking = live.snapshot.lock().unwrap();
        live.publish(&Tally { steps: 3, ..Tally::default() }, None);
        drop(looking);
        assert_eq!(live.snapshot().tally.steps, 0);
        live.publish(&Tally { steps: 4, ..Tally::default() }, None);
        assert_eq!(live.snapshot().tally.steps, 4);
    }
}
