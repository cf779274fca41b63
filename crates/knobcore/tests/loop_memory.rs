//! A render loop allocates nothing between its first period and its end.
use knobcore::error::{Error, Result};
use knobcore::realtime::{Controller, Device, Loop, Plan, Ticks, VirtualClock};
use knobcore::render::Sensed;
use std::sync::Arc;

struct Still;

impl Device for Still {
    fn read(&mut self) -> Result<Sensed> {
        Ok(Sensed { theta: 0.1, omega: 0.0, alpha: 0.0, hand: Some(0.01) })
    }

    fn write(&mut self, _: f64) -> Result<()> {
        Ok(())
    }
}

struct Spring;

impl Controller for Spring {
    fn step(&mut self, sensed: Sensed) -> f64 {
        0.01 * sensed.theta
    }

    fn fault(&self) -> Option<Error> {
        None
    }
}

/// Allocations of a loop that is made, run and reported; its wake-ups are late, so that it misses periods too.
fn allocations(seconds: f64) -> (u64, u64) {
    let plan = Plan { seconds: Some(seconds), missed_share: 1.0, ..Plan::default() };
    let mut steps = 0;
    let counted = allocation_counter::measure(|| {
        let mut wakes = 0_u64;
        let late = || {
            wakes += 1;
            if wakes.is_multiple_of(100) { 300_000 } else { 5_000 }
        };
        let clock = VirtualClock::late(Ticks::default(), late);
        let report = Loop::new(plan, Arc::default()).map(|ready| ready.run(Spring, Still, clock));
        steps = report.map_or(0, |report| report.tally.steps);
    });
    (counted.count_total, steps)
}

#[test]
fn a_million_periods_allocate_no_more_than_one_second_of_them() {
    let (short, few) = allocations(2.0);
    let (long, many) = allocations(210.0);
    assert!(few > 9_000 && many > 1_000_000, "{few} and {many} steps");
    assert_eq!(long, short);
}
