//! However a loop ends, the device had zero torque last.
use super::*;
use knobcore::effects::Id;
use knobcore::model::Model;
use knobcore::param::Axis;
use knobrender::{Limits, Renderer};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Runs, and returns the report and all torques that were written.
fn written(
    plan: Plan,
    controller: impl Controller,
    bench: Bench,
    ticks: &Ticks,
    latency: impl FnMut() -> u64,
) -> (Report, Vec<f64>) {
    let torques = Arc::clone(&bench.written);
    let report = run(plan, controller, bench, ticks, latency);
    let torques = torques.lock().unwrap().clone();
    assert_eq!(torques.last(), Some(&0.0), "{:?}", report.ending);
    (report, torques)
}

fn watched() -> Plan {
    Plan { watchdog_s: 0.02, ..plan() }
}

#[test]
fn a_device_that_fails_ends_with_zero_torque() {
    let bench = Bench { fails_at: Some(30), ..Bench::default() };
    let (report, torques) = written(plan(), pushing(), bench, &Ticks::default(), punctual);
    assert_eq!(report.ending, Ending::Device(Error::invalid("device", "unplugged")));
    assert_eq!((report.tally.steps, torques.len()), (30, 31));
    assert_eq!(report.last.len(), 30);
    assert_eq!(report.relieved, Ok(()));
}

#[test]
fn a_controller_with_a_fault_is_not_heard() {
    let faulty = Law(|_| 5.0, Some(30.0));
    let (report, torques) = written(plan(), faulty, Bench::default(), &Ticks::default(), punctual);
    assert_eq!(report.ending, Ending::Fault(Error::invalid("theta", "jumped")));
    assert_eq!(torques.iter().filter(|tau| **tau == 5.0).count(), 30);
    let row = report.last[30];
    assert_eq!((row.sensed.theta, row.tau), (30.0, 0.0));
}

#[test]
fn what_is_no_number_is_never_written() {
    for wrong in [f64::NAN, f64::INFINITY] {
        let law = Law(move |theta| if theta == 3.0 { wrong } else { 1.0 }, None);
        let (report, torques) = written(plan(), law, Bench::default(), &Ticks::default(), punctual);
        assert!(matches!(report.ending, Ending::NotFinite(_)));
        assert_eq!(torques, [1.0, 1.0, 1.0, 0.0]);
    }
}

#[test]
fn a_panic_takes_the_torque_off() {
    let wrong = Bench { on_read: Some(Box::new(|n| assert!(n != 5, "a broken device"))), ..Bench::default() };
    let (report, torques) = written(plan(), pushing(), wrong, &Ticks::default(), punctual);
    assert_eq!(report.ending, Ending::Panicked("a broken device".into()));
    assert_eq!(torques.len(), 6);
    let wrong = Law(|theta| if theta == 5.0 { panic!("at {theta}") } else { 1.0 }, None);
    let (report, _) = written(plan(), wrong, Bench::default(), &Ticks::default(), punctual);
    assert_eq!(report.ending, Ending::Panicked("at 5".into()));
}

/// Counts writes, and refuses so many of them; the first panics.
struct Stubborn(Arc<AtomicUsize>, usize);

impl Plant for Stubborn {
    fn read(&mut self) -> Result<Sensed> {
        Err(Error::invalid("device", "unplugged"))
    }

    fn write(&mut self, _: f64) -> Result<()> {
        let refused = self.0.fetch_add(1, Ordering::Relaxed);
        assert!(refused > 0, "the first write panics");
        if refused >= self.1 { Ok(()) } else { Err(Error::invalid("device", "busy")) }
    }
}

#[test]
fn zero_torque_is_written_again_to_a_device_that_does_not_take_it_and_the_report_says_so() {
    for (refusals, relieved) in [(2, Ok(())), (9, Err(Error::invalid("device", "busy")))] {
        let writes = Arc::new(AtomicUsize::new(0));
        let device = Stubborn(Arc::clone(&writes), refusals);
        let ready = Loop::new(plan(), Arc::default()).unwrap();
        let report = ready.run(pushing(), device, VirtualClock::new(Ticks::default()));
        assert_eq!(report.relieved, relieved);
        assert_eq!(writes.load(Ordering::Relaxed), 3);
    }
}

struct Released(Arc<AtomicBool>);

impl Drop for Released {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        assert!(std::thread::panicking(), "a device that panics when it is let go");
    }
}

#[test]
fn the_device_is_released_before_the_report_is_made() {
    let gone = Arc::new(AtomicBool::new(false));
    let held = Released(Arc::clone(&gone));
    let act = move |_| {
        let _ = &held;
    };
    let bench = Bench { on_read: Some(Box::new(act)), ..Bench::default() };
    let (report, _) = written(plan(), pushing(), bench, &Ticks::default(), punctual);
    assert!(gone.load(Ordering::Relaxed));
    assert_eq!(report.ending, Ending::Over);
}

fn stalled(report: &Report) -> (&'static str, f64) {
    match report.ending {
        Ending::Stalled { during, late_s, .. } => (during, late_s),
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_loop_that_wakes_up_later_than_the_watchdog_allows_does_not_step() {
    let mut wakes = 0;
    let late = || {
        wakes += 1;
        if wakes == 6 { 20 * MS + 1 } else { 20 * MS }
    };
    let long = Plan { seconds: Some(1.0), ..watched() };
    let (report, torques) = written(long, pushing(), Bench::default(), &Ticks::default(), late);
    assert_eq!(stalled(&report), ("awake", 0.020_000_001));
    assert_eq!(torques.len(), 6);
}

#[test]
fn a_torque_that_took_longer_than_the_watchdog_allows_is_not_written() {
    let ticks = Ticks::default();
    let (report, torques) = written(watched(), pushing(), slow_at(&ticks, 5, 21 * MS), &ticks, punctual);
    assert_eq!(stalled(&report), ("ready to write", 0.021));
    assert_eq!(torques, [1.0, 2.0, 3.0, 4.0, 5.0, 0.0]);
    assert_eq!(report.last[5].tau, 0.0);
}

#[test]
fn a_write_that_hung_ends_the_loop_when_it_comes_back() {
    let ticks = Ticks::default();
    let pass = ticks.clone();
    let act = move |n| {
        if n == 5 {
            pass.pass(300 * MS)
        }
    };
    let bench = Bench { on_write: Some(Box::new(act)), ..Bench::default() };
    let (report, torques) = written(watched(), pushing(), bench, &ticks, punctual);
    assert_eq!(stalled(&report), ("back from a write", 0.3));
    assert_eq!(torques.len(), 7);
}

#[test]
fn too_large_a_share_of_misses_in_a_second_ends_the_loop() {
    let ticks = Ticks::default();
    let pass = ticks.clone();
    // Two of three periods are missed, from the 1000th step on.
    let act = move |n| {
        if n >= 1000 {
            pass.pass(2 * MS + MS / 2)
        }
    };
    let bench = Bench { on_read: Some(Box::new(act)), ..Bench::default() };
    let strict = Plan { seconds: Some(10.0), missed_share: 0.1, ..plan() };
    let (report, _) = written(strict, pushing(), bench, &ticks, punctual);
    assert_eq!(report.ending, Ending::Misses { share: 0.102, limit: 0.1 });
    assert_eq!((report.tally.steps, report.tally.missed), (1051, 102));
}

#[test]
fn the_same_misses_spread_over_more_than_a_second_do_not() {
    let ticks = Ticks::default();
    let pass = ticks.clone();
    let act = move |n| {
        if n % 50 == 0 {
            pass.pass(2 * MS + MS / 2)
        }
    };
    let bench = Bench { on_read: Some(Box::new(act)), ..Bench::default() };
    let strict = Plan { seconds: Some(10.0), missed_share: 0.1, ..plan() };
    let (report, _) = written(strict, pushing(), bench, &ticks, punctual);
    assert_eq!(report.ending, Ending::Over);
    assert!(report.tally.missed > 300);
}

#[test]
fn too_long_a_run_of_misses_ends_the_loop() {
    let ticks = Ticks::default();
    for (run, ending) in [(5, Ending::Over), (6, Ending::Run { run: 6, limit: 5 })] {
        let strict = Plan { missed_run: Some(5), ..plan() };
        let bench = slow_at(&ticks, 50, run * MS + MS / 2);
        let (report, _) = written(strict, pushing(), bench, &ticks, punctual);
        assert_eq!(report.ending, ending);
        assert_eq!(report.tally.longest_run, run);
    }
}

#[test]
fn every_ending_says_what_to_make_of_it() {
    let (late_s, watchdog_s) = (0.5, 0.02);
    for (ending, word, part) in [
        (Ending::Over, "time", "time was over"),
        (Ending::Asked, "asked", "asked to stop"),
        (Ending::Fault(Error::invalid("theta", "jumped")), "fault", "theta: jumped"),
        (Ending::NotFinite(f64::NAN), "fault", "NaN, which is no torque"),
        (Ending::Device(Error::invalid("device", "unplugged")), "device", "unplugged"),
        (Ending::Stalled { during: "awake", late_s, watchdog_s }, "stalled", "500.0 ms after its deadline"),
        (Ending::Misses { share: 0.25, limit: 0.2 }, "misses", "25.0 % of the periods"),
        (Ending::Run { run: 60, limit: 50 }, "misses", "60 periods in a row"),
        (Ending::Panicked("oh".into()), "panic", "panicked: oh"),
    ] {
        assert_eq!(ending.word(), word);
        assert!(ending.to_string().contains(part), "{ending}");
    }
}

#[test]
fn a_renderer_that_senses_an_impossible_jump_ends_the_loop() {
    let model = Model::new(&[Id::parse("viscous").unwrap()], Axis::Rotary);
    let limits = Limits { torque: 1.0, torque_rate: 1e4, speed: 100.0 };
    let renderer = Renderer::new(&model, 1000.0, None, limits).unwrap();
    // The bench turns by a radian in every read.
    let (report, torques) = written(plan(), renderer, Bench::default(), &Ticks::default(), punctual);
    let Ending::Fault(fault) = &report.ending else { panic!("{:?}", report.ending) };
    assert!(fault.to_string().starts_with("jump: "), "{fault}");
    assert!(torques.iter().all(|tau| *tau == 0.0));
}
