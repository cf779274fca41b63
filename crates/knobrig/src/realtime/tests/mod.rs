//! A loop on a small device, mostly in virtual time.
mod beat;
mod safety;
mod threads;

use super::*;
use std::sync::{Arc, Mutex};

/// Nanoseconds in a millisecond.
const MS: u64 = 1_000_000;

/// What a test does at the nth call.
type At = Box<dyn FnMut(usize) + Send>;

/// Senses how often it was read, and remembers every torque.
#[derive(Default)]
struct Bench {
    reads: usize,
    written: Arc<Mutex<Vec<f64>>>,
    on_read: Option<At>,
    on_write: Option<At>,
    fails_at: Option<usize>,
}

impl Plant for Bench {
    fn read(&mut self) -> Result<Sensed> {
        let n = self.reads;
        self.reads += 1;
        if let Some(act) = &mut self.on_read {
            act(n);
        }
        if self.fails_at == Some(n) {
            return Err(Error::invalid("device", "unplugged"));
        }
        Ok(Sensed { theta: n as f64, omega: 0.0, alpha: 0.0, hand: None })
    }

    fn write(&mut self, tau: f64) -> Result<()> {
        let mut written = self.written.lock().unwrap();
        written.push(tau);
        if let Some(act) = &mut self.on_write {
            act(written.len() - 1);
        }
        Ok(())
    }
}

/// Answers with a law of theta.
struct Law<F: FnMut(f64) -> f64>(F, Option<f64>);

impl<F: FnMut(f64) -> f64> Controller for Law<F> {
    fn step(&mut self, sensed: Sensed) -> f64 {
        if self.1 == Some(sensed.theta) {
            self.1 = Some(f64::NEG_INFINITY);
        }
        (self.0)(sensed.theta)
    }

    fn fault(&self) -> Option<Error> {
        (self.1 == Some(f64::NEG_INFINITY)).then(|| Error::invalid("theta", "jumped"))
    }
}

/// Pushes back with one more than theta, so that no answer is zero.
fn pushing() -> Law<impl FnMut(f64) -> f64> {
    Law(|theta| theta + 1.0, None)
}

/// A hundred periods of 1 ms, with limits that do not matter.
fn plan() -> Plan {
    Plan { rate_hz: 1000.0, seconds: Some(0.1), watchdog_s: 1.0, missed_share: 1.0, missed_run: None }
}

/// Runs in virtual time; every wake-up is late by `latency`, ns.
fn run(
    plan: Plan,
    controller: impl Controller,
    device: Bench,
    ticks: &Ticks,
    latency: impl FnMut() -> u64,
) -> Report {
    let clock = VirtualClock::late(ticks.clone(), latency);
    Loop::new(plan, Arc::default()).unwrap().run(controller, device, clock)
}

fn punctual() -> u64 {
    0
}

/// A device whose `n`th read takes `ns`.
fn slow_at(ticks: &Ticks, n: usize, ns: u64) -> Bench {
    let ticks = ticks.clone();
    let act = move |read| {
        if read == n {
            ticks.pass(ns)
        }
    };
    Bench { on_read: Some(Box::new(act)), ..Bench::default() }
}
