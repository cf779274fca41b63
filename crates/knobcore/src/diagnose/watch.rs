//! Long work as the one who waits for it sees it: how far it is, and an end to it when it is no longer wanted.

use crate::threads::share;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Who waits is not asked more often than this: an answer may take a lock that others need.
const APART: Duration = Duration::from_millis(20);

/// Told the share that is done, 0 to 1, from any thread; answers whether the rest is still wanted.
pub type Tell<'a> = dyn Fn(f64) -> bool + Sync + 'a;

/// Work of so many steps, done by several threads.
pub struct Watch<'a> {
    tell: &'a Tell<'a>,
    steps: usize,
    done: AtomicUsize,
    unwanted: AtomicBool,
    asked: Mutex<Option<Instant>>,
}

impl<'a> Watch<'a> {
    /// Of `steps` steps, none of them done.
    pub fn new(tell: &'a Tell<'a>, steps: usize) -> Self {
        let (done, unwanted) = (AtomicUsize::new(0), AtomicBool::new(false));
        Self { tell, steps, done, unwanted, asked: Mutex::new(None) }
    }

    /// One more step is done.
    pub fn step(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether to go on; once it is false it stays so. To be asked often: nothing else ends the work.
    pub fn wanted(&self) -> bool {
        // An answer that is long in coming holds up all threads: so the work is made to pause.
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let known = !self.unwanted.load(Ordering::Relaxed);
        if !known || asked.is_some_and(|last| last.elapsed() < APART) {
            return known;
        }
        let share = self.done.load(Ordering::Relaxed) as f64 / self.steps.max(1) as f64;
        let wanted = (self.tell)(share);
        self.unwanted.store(!wanted, Ordering::Relaxed);
        *asked = Some(Instant::now());
        wanted
    }

    /// Does the same with each of some things, as many at a time as there are processors, as long as it is wanted. The
    /// results are in the order of the things, whichever was done first: sums of them round alike each time.
    pub fn each<T: Sync, R: Send>(&self, things: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
        let done = Mutex::new(Vec::new());
        share(things.iter().enumerate().collect(), |(at, thing)| {
            if self.wanted() {
                let result = work(thing);
                done.lock().unwrap_or_else(PoisonError::into_inner).push((at, result));
            }
        });
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_by_key(|(at, _)| *at);
        done.into_iter().map(|(_, result)| result).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_longer_wanted_stays_so_and_nobody_is_asked_again() {
        let asked = AtomicUsize::new(0);
        let tell = |_: f64| asked.fetch_add(1, Ordering::Relaxed) > 0;
        let watch = Watch::new(&tell, 4);
        assert!(!watch.wanted());
        std::thread::sleep(APART);
        assert!(!watch.wanted());
        assert_eq!(asked.into_inner(), 1);
    }

    #[test]
    fn results_are_in_the_order_of_the_things_whichever_was_done_first() {
        let watch = Watch::new(&|_| true, 1);
        let waits: Vec<u64> = (0..12).map(|at| if at % 2 == 0 { 5 } else { 0 }).collect();
        let things: Vec<(usize, u64)> = waits.into_iter().enumerate().collect();
        let done = watch.each(&things, |(at, wait)| {
            std::thread::sleep(Duration::from_millis(*wait));
            *at
        });
        assert!(done.iter().copied().eq(0..12));
    }

    #[test]
    fn the_share_that_is_done_is_told_now_and_then() {
        let told = Mutex::new(Vec::new());
        let tell = |share: f64| {
            told.lock().unwrap().push(share);
            true
        };
        let watch = Watch::new(&tell, 2);
        assert!(watch.wanted() && watch.wanted());
        watch.step();
        std::thread::sleep(APART);
        assert!(watch.wanted());
        assert_eq!(told.into_inner().unwrap(), [0.0, 0.5]);
    }
}
