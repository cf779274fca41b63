//! The loop itself.
use super::clock::{Clock, SECOND};
use super::end::Ending;
use super::last::{Last, Row};
use super::live::Live;
use super::pace::{Pace, Window};
use super::plan::Plan;
use super::tally::Tally;
use super::{Controller, Plant};
use knobcore::error::{Error, Result};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// How often a second what the loop reached is published.
const PUBLISHED_HZ: usize = 100;
/// How often zero torque is written to a device that does not take it: a full buffer may be empty the next time.
const ATTEMPTS: usize = 3;

/// What became of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// How it was to run.
    pub plan: Plan,
    /// Counts and durations.
    pub tally: Tally,
    /// Why it ended.
    pub ending: Ending,
    /// Whether the device took the zero torque at the end.
    pub relieved: Result<()>,
    /// The last second, oldest step first.
    pub last: Vec<Row>,
}

/// A loop that has all the memory it will need.
pub struct Loop {
    plan: Plan,
    live: Arc<Live>,
    tally: Tally,
    window: Window,
    last: Last,
}

impl Loop {
    /// Makes a loop ready.
    pub fn new(plan: Plan, live: Arc<Live>) -> Result<Self> {
        let plan = plan.checked()?;
        let second = plan.periods_in_a_second();
        let (window, last) = (Window::new(second), Last::new(second));
        Ok(Self { plan, live, tally: Tally::default(), window, last })
    }

    /// Runs on the calling thread until the end. The device is released before the report is made.
    pub fn run<C: Controller, D: Plant, K: Clock>(
        mut self,
        mut controller: C,
        mut device: D,
        mut clock: K,
    ) -> Report {
        let turning = AssertUnwindSafe(|| self.turn(&mut controller, &mut device, &mut clock));
        let ending = catch_unwind(turning).unwrap_or_else(|panic| Ending::Panicked(words(&*panic)));
        let relieved = relieve(&mut device);
        // A device that panics when it is let go has had its zero torque.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(device)));
        self.live.publish(&self.tally, self.last.newest());
        Report { plan: self.plan, tally: self.tally, ending, relieved, last: self.last.of(1.0) }
    }

    fn turn(
        &mut self,
        controller: &mut impl Controller,
        device: &mut impl Plant,
        clock: &mut impl Clock,
    ) -> Ending {
        let (period, periods) = (self.plan.period(), self.plan.periods());
        let every = (self.plan.periods_in_a_second() / PUBLISHED_HZ).max(1) as u64;
        let start = clock.now() + period;
        let mut pace = Pace::new(start, period);
        while pace.n() < periods {
            let deadline = pace.deadline();
            let woke = clock.sleep_until(deadline);
            if self.live.stopping() {
                return Ending::Asked;
            }
            if let Err(ending) = self.step(controller, device, clock, [start, deadline, woke]) {
                return ending;
            }
            let done = clock.now();
            let left = periods - pace.n() - 1;
            let skipped = pace.advance(done).min(left);
            self.tally.note(done.saturating_sub(woke), skipped);
            controller.missed(skipped);
            if let Err(ending) = self.in_time("back from a write", deadline, done) {
                return ending;
            }
            if let Some(ending) = self.missed_too_many(skipped) {
                return ending;
            }
            if self.tally.steps.is_multiple_of(every) {
                self.live.publish(&self.tally, self.last.newest());
            }
        }
        Ending::Over
    }

    /// One period: what is written is finite, in time, and from a controller without a fault.
    fn step(
        &mut self,
        controller: &mut impl Controller,
        device: &mut impl Plant,
        clock: &impl Clock,
        [start, deadline, woke]: [u64; 3],
    ) -> std::result::Result<(), Ending> {
        self.tally.late.add(woke.saturating_sub(deadline));
        self.in_time("awake", deadline, woke)?;
        let sensed = device.read().map_err(Ending::Device)?;
        let answer = controller.step(sensed);
        let checked = match controller.fault() {
            Some(fault) => Err(Ending::Fault(fault)),
            None if !answer.is_finite() => Err(Ending::NotFinite(answer)),
            None => self.in_time("ready to write", deadline, clock.now()),
        };
        let tau = if checked.is_ok() { answer } else { 0.0 };
        self.last.push(Row { t: seconds(woke - start), sensed, tau, late: seconds(woke - deadline) });
        checked?;
        device.write(tau).map_err(Ending::Device)
    }

    fn in_time(&self, during: &'static str, deadline: u64, now: u64) -> std::result::Result<(), Ending> {
        let late = now.saturating_sub(deadline);
        if late <= self.plan.watchdog() {
            return Ok(());
        }
        Err(Ending::Stalled { during, late_s: seconds(late), watchdog_s: self.plan.watchdog_s })
    }

    fn missed_too_many(&mut self, skipped: u64) -> Option<Ending> {
        self.window.note(skipped);
        if let Some(limit) = self.plan.missed_run
            && skipped > limit
        {
            return Some(Ending::Run { run: skipped, limit });
        }
        let (share, limit) = (self.window.share(), self.plan.missed_share);
        (share > limit).then_some(Ending::Misses { share, limit })
    }
}

/// Takes the torque off the device, whatever state it is in.
fn relieve(device: &mut impl Plant) -> Result<()> {
    let mut write = || {
        let zero = AssertUnwindSafe(|| device.write(0.0));
        catch_unwind(zero).unwrap_or_else(|panic| Err(Error::invalid("device", words(&*panic))))
    };
    let mut taken = write();
    for _ in 1..ATTEMPTS {
        if taken.is_ok() {
            break;
        }
        taken = write();
    }
    taken
}

/// What a panic said.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "it did not say why".into())
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / SECOND as f64
}
