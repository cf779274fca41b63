//! Deadlines and what is counted.
use super::*;

fn times(report: &Report) -> Vec<u64> {
    report.last.iter().map(|row| (1e3 * row.t).round() as u64).collect()
}

#[test]
fn a_punctual_loop_takes_every_step_at_its_deadline() {
    let bench = Bench::default();
    let written = Arc::clone(&bench.written);
    let report = run(plan(), pushing(), bench, &Ticks::default(), punctual);
    assert_eq!(report.ending, Ending::Over);
    assert_eq!((report.tally.steps, report.tally.missed, report.tally.longest_run), (100, 0, 0));
    assert_eq!(times(&report), (0..100).collect::<Vec<_>>());
    let torques: Vec<f64> = (1..=100).map(f64::from).chain([0.0]).collect();
    assert_eq!(*written.lock().unwrap(), torques);
}

#[test]
fn an_overrun_skips_to_the_next_deadline_and_never_bursts() {
    let ticks = Ticks::default();
    let report = run(plan(), pushing(), slow_at(&ticks, 10, 7 * MS + MS / 2), &ticks, punctual);
    let expected: Vec<u64> = (0..=10).chain(18..100).collect();
    assert_eq!(times(&report), expected);
    assert_eq!((report.tally.steps, report.tally.missed, report.tally.longest_run), (93, 7, 7));
}

#[test]
fn the_count_of_misses_is_exact() {
    let ticks = Ticks::default();
    let pass = ticks.clone();
    // Every tenth step takes 2.5 periods and so misses two deadlines; the last does so beyond the end.
    let act = move |n| {
        if n % 10 == 9 {
            pass.pass(2 * MS + MS / 2)
        }
    };
    let bench = Bench { on_read: Some(Box::new(act)), ..Bench::default() };
    let long = Plan { seconds: Some(120.0), ..plan() };
    let report = run(long, pushing(), bench, &ticks, punctual);
    assert_eq!((report.tally.steps, report.tally.missed), (100_000, 20_000));
    assert_eq!(report.tally.longest_run, 2);
    assert_eq!(report.tally.busy.count(), 100_000);
    assert_eq!(report.tally.busy.max(), 2 * MS + MS / 2);
}

#[test]
fn misses_beyond_the_end_are_not_counted() {
    let ticks = Ticks::default();
    let report = run(plan(), pushing(), slow_at(&ticks, 97, 50 * MS), &ticks, punctual);
    assert_eq!((report.tally.steps, report.tally.missed), (98, 2));
}

#[test]
fn lateness_does_not_add_up() {
    let report = run(plan(), pushing(), Bench::default(), &Ticks::default(), || MS / 3);
    assert_eq!(report.tally.missed, 0);
    assert_eq!((report.tally.late.min(), report.tally.late.max()), (MS / 3, MS / 3));
}

#[test]
fn a_late_wake_up_still_takes_its_step_and_misses_those_that_passed() {
    let mut wakes = 0;
    let late = || {
        wakes += 1;
        if wakes == 21 { 3 * MS + 1 } else { 10 }
    };
    let report = run(plan(), pushing(), Bench::default(), &Ticks::default(), late);
    assert_eq!((report.tally.steps, report.tally.missed, report.tally.longest_run), (97, 3, 3));
    assert_eq!(report.tally.late.max(), 3 * MS + 1);
    let row = report.last[20];
    assert_eq!((row.t, row.late), (0.023_000_001, 0.003_000_001));
}

#[test]
fn the_last_second_is_kept_in_order_when_the_ring_wrapped() {
    let long = Plan { seconds: Some(3.5), ..plan() };
    let report = run(long, pushing(), Bench::default(), &Ticks::default(), punctual);
    assert_eq!(times(&report), (2500..3500).collect::<Vec<_>>());
    assert!(report.last.iter().all(|row| row.tau == row.sensed.theta + 1.0));
}

#[test]
fn the_last_second_is_a_second_also_when_periods_were_missed() {
    let ticks = Ticks::default();
    let long = Plan { seconds: Some(3.0), ..plan() };
    let report = run(long, pushing(), slow_at(&ticks, 2500, 200 * MS), &ticks, punctual);
    let times = times(&report);
    assert_eq!((times[0], times[times.len() - 1]), (2000, 2999));
    assert_eq!(times.len(), 801);
}
