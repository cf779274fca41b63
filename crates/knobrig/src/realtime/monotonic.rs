//! Real time.
use super::clock::Clock;
use std::time::{Duration, Instant};

/// The clock that wakes up closest to its deadlines on this system.
#[cfg(target_os = "linux")]
pub type SystemClock = linux::NanosleepClock;
/// The clock that wakes up closest to its deadlines on this system.
#[cfg(not(target_os = "linux"))]
pub type SystemClock = SleepClock;

/// Real time by the standard library, on any system: sleeps short of the deadline, and spins for the rest.
pub struct SleepClock {
    start: Instant,
}

/// What an ordinary sleep may oversleep by; it is spun for instead.
const SPIN: Duration = Duration::from_micros(1500);

impl Default for SleepClock {
    fn default() -> Self {
        Self { start: Instant::now() }
    }
}

impl Clock for SleepClock {
    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    fn sleep_until(&mut self, deadline: u64) -> u64 {
        loop {
            let now = self.now();
            if now >= deadline {
                return now;
            }
            match Duration::from_nanos(deadline - now).checked_sub(SPIN) {
                Some(ahead) => std::thread::sleep(ahead),
                None => std::hint::spin_loop(),
            }
        }
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use super::Clock;
    use crate::realtime::clock::SECOND;
    use rustix::thread::clock_nanosleep_absolute;
    use rustix::time::{ClockId, Timespec, clock_gettime};

    /// Real time by `clock_nanosleep` until an absolute deadline.
    #[derive(Default)]
    pub struct NanosleepClock;

    impl Clock for NanosleepClock {
        fn now(&self) -> u64 {
            let now = clock_gettime(ClockId::Monotonic);
            now.tv_sec as u64 * SECOND + now.tv_nsec as u64
        }

        fn sleep_until(&mut self, deadline: u64) -> u64 {
            let request = Timespec { tv_sec: (deadline / SECOND) as _, tv_nsec: (deadline % SECOND) as _ };
            loop {
                let now = self.now();
                if now >= deadline {
                    return now;
                }
                // A signal may end the sleep early: what counts is the clock, and it is asked again.
                let _ = clock_nanosleep_absolute(ClockId::Monotonic, &request);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::realtime::clock::SECOND;

    fn never_wakes_early(mut clock: impl Clock) {
        for ahead in [0, 1_000, 300_000, 3_000_000] {
            let deadline = clock.now() + ahead;
            let woke = clock.sleep_until(deadline);
            assert!(woke >= deadline);
            assert!(clock.now() >= woke);
        }
    }

    #[test]
    fn no_clock_wakes_before_its_deadline() {
        never_wakes_early(SystemClock::default());
        never_wakes_early(SleepClock::default());
    }

    #[test]
    fn both_clocks_run_at_the_same_rate() {
        let (mut one, other) = (SystemClock::default(), SleepClock::default());
        let (a, b) = (one.now(), other.now());
        one.sleep_until(a + SECOND / 100);
        // The second is read within the time that the first is, so it cannot be behind by more than its start.
        assert!(other.now() - b >= SECOND / 100 - SECOND / 1000);
    }
}
