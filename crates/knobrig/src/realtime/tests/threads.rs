//! A loop on its own thread, in real time and in virtual time.
use super::*;
use std::time::Duration;

const LONG: Duration = Duration::from_secs(20);

fn granted() -> Result<()> {
    Ok(())
}

fn refused() -> Result<()> {
    Err(Error::invalid("rt", "not permitted"))
}

fn endless() -> Plan {
    Plan { seconds: None, ..plan() }
}

#[test]
fn enforce_does_not_touch_the_device_without_priority() {
    let bench = Bench::default();
    let written = Arc::clone(&bench.written);
    let clock = VirtualClock::new(Ticks::default());
    let started = start(plan(), Realtime::Enforce, refused, pushing(), bench, clock);
    assert_eq!(started.err(), refused().err());
    assert!(written.lock().unwrap().is_empty());
}

#[test]
fn warn_runs_without_priority_and_the_result_says_why() {
    let clock = VirtualClock::new(Ticks::default());
    let running = start(plan(), Realtime::Warn, refused, pushing(), Bench::default(), clock).unwrap();
    assert_eq!(running.standing(), &Standing::Ordinary("rt: not permitted".into()));
    assert_eq!(running.wait(LONG).unwrap().ending, Ending::Over);
}

#[test]
fn a_loop_that_is_asked_to_stop_takes_the_torque_off() {
    let bench = Bench::default();
    let written = Arc::clone(&bench.written);
    let clock = SystemClock::default();
    let running = start(endless(), Realtime::Off, granted, pushing(), bench, clock).unwrap();
    assert_eq!(running.wait(Duration::from_millis(30)), None);
    running.stop();
    assert_eq!(running.wait(LONG).unwrap().ending, Ending::Asked);
    assert_eq!(written.lock().unwrap().last(), Some(&0.0));
}

#[test]
fn letting_go_of_a_loop_stops_it() {
    let bench = Bench::default();
    let written = Arc::downgrade(&bench.written);
    let clock = VirtualClock::new(Ticks::default());
    drop(start(endless(), Realtime::Off, granted, pushing(), bench, clock).unwrap());
    while written.strong_count() > 0 {
        std::thread::yield_now();
    }
}

#[test]
fn what_a_running_loop_reached_can_be_watched() {
    let clock = SystemClock::default();
    let running = start(endless(), Realtime::Off, granted, pushing(), Bench::default(), clock).unwrap();
    let mut seen = 0;
    while seen < 50 {
        let snapshot = running.snapshot();
        assert!(snapshot.tally.steps >= seen);
        seen = snapshot.tally.steps;
        assert_eq!(snapshot.newest.is_some(), seen > 0);
        std::thread::yield_now();
    }
    assert_eq!(running.wait(Duration::ZERO), None);
}

#[test]
fn in_real_time_every_period_is_either_a_step_or_a_miss() {
    let bench = Bench::default();
    let written = Arc::clone(&bench.written);
    let clock = SystemClock::default();
    let loaded = Plan { rate_hz: 5000.0, seconds: Some(0.2), ..plan() };
    let running = start(loaded, Realtime::Warn, real_time_priority, pushing(), bench, clock).unwrap();
    let report = running.wait(LONG).unwrap();
    assert_eq!(report.ending, Ending::Over);
    assert_eq!(report.tally.periods(), 1000);
    assert_eq!(report.tally.late.count(), report.tally.steps);
    let written = written.lock().unwrap();
    assert_eq!(written.len() as u64, report.tally.steps + 1);
    assert_eq!(written.last(), Some(&0.0));
}
