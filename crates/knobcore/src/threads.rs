//! Threads that share the work of a process: as many as it has processors, and no more where work has parts itself.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Threads that share some work: more than these gain nothing.
static MOST: AtomicUsize = AtomicUsize::new(8);
/// Threads at work.
static BUSY: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this thread is among those at work.
    static COUNTED: Cell<bool> = const { Cell::new(false) };
}

/// Lets work have at most so many threads from now on, in all of this process: where each process of several has a core.
pub fn at_most(threads: usize) {
    MOST.store(threads.max(1), Ordering::Relaxed);
}

/// A thread at work, until it is dropped; one whose work has parts counts once.
struct AtWork(bool);

impl AtWork {
    fn begin() -> Self {
        let first = !COUNTED.replace(true);
        BUSY.fetch_add(usize::from(first), Ordering::Relaxed);
        Self(first)
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        if self.0 {
            COUNTED.set(false);
            BUSY.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

/// Does the same with each of some things, beside one another where processors are free. The order in which they are done
/// is nobody's: what is made of them may not depend on it.
pub fn share<T: Send>(things: Vec<T>, work: impl Fn(T) + Sync) {
    let count = things.len();
    let things = Mutex::new(things.into_iter());
    let next = || things.lock().unwrap_or_else(PoisonError::into_inner).next();
    let worker = || {
        let _at_work = AtWork::begin();
        while let Some(thing) = next() {
            work(thing);
        }
    };
    let most = std::thread::available_parallelism().map_or(1, usize::from).min(MOST.load(Ordering::Relaxed));
    // This thread is at work itself.
    let own = usize::from(!COUNTED.get());
    let free = most.saturating_sub(BUSY.load(Ordering::Relaxed) + own);
    std::thread::scope(|scope| {
        for _ in 0..free.min(count.saturating_sub(1)) {
            scope.spawn(worker);
        }
        worker();
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_is_done_once_also_where_the_work_has_parts_itself() {
        let sum = AtomicUsize::new(0);
        share((0..10).collect(), |thing: usize| {
            share((0..5).collect(), |part: usize| {
                sum.fetch_add(100 * thing + part, Ordering::Relaxed);
            });
            assert!(COUNTED.get());
        });
        assert_eq!(sum.into_inner(), 5 * 100 * 45 + 10 * 10);
        assert!(!COUNTED.get());
        share(Vec::<usize>::new(), |_| unreachable!("there is nothing to do"));
    }

    #[test]
    fn a_thread_that_is_at_work_counts_once_and_no_longer_than_it_is() {
        let outer = AtWork::begin();
        assert!(outer.0 && !AtWork::begin().0 && COUNTED.get());
        drop(outer);
        assert!(!COUNTED.get());
    }
}
