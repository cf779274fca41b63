//! What the render loop costs and how punctual it is on this machine, with a device that does nothing.
//!
//! `cargo run --release --example loop_timing [SECONDS] [RATE_HZ]`
use knobcore::error::{Error, Result};
use knobrender::Sensed;
use knobrig::realtime::{
    Clock, Controller, Histogram, Loop, Plan, Plant, Realtime, Report, SystemClock, Ticks, VirtualClock,
    real_time_priority, start,
};
use std::sync::Arc;
use std::time::Duration;

struct Still;

impl Plant for Still {
    fn read(&mut self) -> Result<Sensed> {
        Ok(Sensed { theta: 0.1, omega: 0.0, alpha: 0.0, hand: None })
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

/// Nanoseconds of a period in which nothing is waited for.
fn cost(plan: Plan) -> Result<f64> {
    const PERIODS: f64 = 2e6;
    let clock = SystemClock::default();
    let long = Plan { seconds: Some(PERIODS / plan.rate_hz), ..plan };
    let start = clock.now();
    let report = Loop::new(long, Arc::default())?.run(Spring, Still, VirtualClock::new(Ticks::default()));
    Ok((clock.now() - start) as f64 / report.tally.steps as f64)
}

fn show(name: &str, report: &Report) {
    let tally = &report.tally;
    println!("{name}: {} steps, {} missed, {} in a row", tally.steps, tally.missed, tally.longest_run);
    println!("  ended because {}", report.ending);
    for (what, histogram) in [("late", &tally.late), ("busy", &tally.busy)] {
        println!("  {what}, us: {}", quantiles(histogram));
    }
}

fn quantiles(histogram: &Histogram) -> String {
    let us = |ns: u64| ns as f64 / 1e3;
    let [median, p99, p999] = [0.5, 0.99, 0.999].map(|share| us(histogram.quantile(share)));
    let (min, max) = (us(histogram.min()), us(histogram.max()));
    format!("min {min:.2}, median {median:.2}, 99 % {p99:.1}, 99.9 % {p999:.1}, max {max:.1}")
}

fn main() -> Result<()> {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse().ok());
    let seconds = numbers.next().unwrap_or(10.0);
    let rate_hz = numbers.next().unwrap_or(5000.0);
    let plan = Plan { rate_hz, seconds: Some(seconds), ..Plan::default() };
    println!("virtual time: {:.0} ns a period", cost(plan)?);
    for rt in [Realtime::Off, Realtime::Warn] {
        let running = start(plan, rt, real_time_priority, Spring, Still, SystemClock::default())?;
        let name = format!("{:?}", running.standing());
        if let Some(report) = running.wait(Duration::from_secs_f64(seconds + 10.0)) {
            show(&name, &report);
        }
    }
    Ok(())
}
