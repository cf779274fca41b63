//! The emulated handle as a device of the render loop: time goes by on it as on the loop's clock.

use super::handle::Handle;
use super::scene::{Track, grip};
use crate::realtime::{Clock, Plant};
use knobcore::error::Result;
use knobrender::{Device, Sensed};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Nanoseconds to seconds.
const NS: f64 = 1e-9;

/// A hand that follows a motion, again and again, and holds the handle through a spring and a damper.
#[derive(Debug, Clone)]
pub struct Hand {
    /// The motion, from where the handle stands at first.
    pub track: Arc<Track>,
    /// Its samples per second, Hz.
    pub rate_hz: f64,
    /// Whether the device measures the torque of the hand.
    pub measured: bool,
}

impl Hand {
    /// Torque at `t` seconds on a handle that is at an angle (from the start) and a speed, N m.
    fn torque(&self, t: f64, handle: [f64; 2]) -> f64 {
        let n = self.track.len().max(1);
        let place = t * self.rate_hz;
        let (at, share) = (place as usize, place.fract());
        let [from, to] = [self.track.at(at % n), self.track.at((at + 1) % n)];
        grip([0, 1].map(|i| from[i] + share * (to[i] - from[i])), handle)
    }
}

/// Torque of a hand, if there is one, that took hold of the handle at `origin`, N m.
fn pull(hand: Option<&Hand>, origin: f64, t: f64, [theta, omega]: [f64; 2]) -> f64 {
    hand.map_or(0.0, |hand| hand.torque(t, [theta - origin, omega]))
}

/// What a handle shows to those who watch it, while it is turned and afterwards.
#[derive(Debug, Default)]
pub struct Shown([AtomicU64; 3]);

impl Shown {
    /// A handle that stands at an angle, rad.
    pub fn at(theta: f64) -> Self {
        let shown = Self::default();
        shown.put([theta, 0.0, 0.0]);
        shown
    }

    /// Angle, rad, speed, rad/s, and the work that hands have done so far, J.
    pub fn get(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| f64::from_bits(self.0[i].load(Ordering::Relaxed)))
    }

    fn put(&self, values: [f64; 3]) {
        for (slot, value) in self.0.iter().zip(values) {
            slot.store(value.to_bits(), Ordering::Relaxed);
        }
    }
}

/// A handle in a hand, or in none, that moves as time goes by on a clock. A loop that is late finds it where it
/// went meanwhile, under the last torque that was written.
pub struct Held<K> {
    handle: Handle,
    device: Device,
    hand: Option<Hand>,
    clock: K,
    /// From a measurement to the torque that answers it, ns.
    delay: u64,
    start: u64,
    /// The handle is integrated until then, ns.
    now: u64,
    read: u64,
    origin: f64,
    /// Speed when it was last read, rad/s.
    before: f64,
    motor: f64,
    /// Torques that were written and do not act yet, with the time from which on they do.
    waiting: VecDeque<(u64, f64)>,
    work: f64,
    shown: Arc<Shown>,
}

impl<K: Clock> Held<K> {
    /// A handle that stands where it is shown, on a device whose samples are `period` ns long.
    pub fn new(device: Device, period: u64, hand: Option<Hand>, shown: Arc<Shown>, clock: K) -> Self {
        let [theta, omega, work] = shown.get();
        let mut handle = Handle::new(device, period as f64 * NS, theta);
        handle.kick(omega);
        let start = clock.now();
        Self {
            handle,
            device,
            hand,
            clock,
            delay: device.delay as u64 * period,
            start,
            now: start,
            read: start,
            origin: theta,
            before: omega,
            motor: 0.0,
            waiting: VecDeque::with_capacity(device.delay + 2),
            work,
            shown,
        }
    }

    /// Lets the handle move until `until`, ns, under the torques that act by then.
    fn follow(&mut self, until: u64) {
        while self.now < until {
            while let Some((_, tau)) = self.waiting.front().copied().filter(|(from, _)| *from <= self.now) {
                self.motor = tau;
                self.waiting.pop_front();
            }
            let next = self.waiting.front().map_or(until, |(from, _)| until.min(*from));
            let (t, seconds) = ((self.now - self.start) as f64 * NS, (next - self.now) as f64 * NS);
            let (hand, origin) = (self.hand.as_ref(), self.origin);
            let pull = |share: f64, at| pull(hand, origin, t + share * seconds, at);
            self.work += self.handle.turn(seconds, self.motor, pull);
            self.now = next;
        }
    }
}

impl<K: Clock> Plant for Held<K> {
    fn read(&mut self) -> Result<Sensed> {
        let now = self.clock.now();
        self.follow(now);
        let [theta, omega, _] = self.handle.motion();
        let since = (now - self.read) as f64 * NS;
        let alpha = if since > 0.0 { (omega - self.before) / since } else { 0.0 };
        (self.read, self.before) = (now, omega);
        self.shown.put([theta, omega, self.work]);
        let t = (now - self.start) as f64 * NS;
        let measured = self.hand.as_ref().filter(|hand| hand.measured);
        let hand = measured.map(|hand| pull(Some(hand), self.origin, t, [theta, omega]));
        Ok(Sensed { alpha, ..self.handle.sensed(hand) })
    }

    fn write(&mut self, tau: f64) -> Result<()> {
        let now = self.clock.now();
        self.follow(now);
        let most = self.device.torque_limit;
        self.waiting.push_back((now.max(self.read + self.delay), (-tau).max(-most).min(most)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::realtime::{Ticks, VirtualClock};

    const PERIOD: u64 = 200_000;

    fn device(delay: usize) -> Device {
        Device {
            inertia: 5e-5,
            damping: 1e-3,
            delay,
            torque_limit: 0.02,
            torque_rate_limit: f64::INFINITY,
            encoder_step: 0.0,
            held: false,
        }
    }

    fn held(delay: usize, hand: Option<Hand>) -> (Ticks, Held<VirtualClock>) {
        let ticks = Ticks::default();
        let clock = VirtualClock::new(ticks.clone());
        (ticks, Held::new(device(delay), PERIOD, hand, Arc::new(Shown::at(0.3)), clock))
    }

    #[test]
    fn a_punctual_loop_finds_the_handle_that_is_pushed_sample_by_sample() {
        for delay in [0, 1, 4] {
            let mut pushed = Handle::new(device(delay), PERIOD as f64 * NS, 0.3);
            let (ticks, mut held) = held(delay, None);
            for i in 0..500 {
                let sensed = held.read().unwrap();
                let [theta, omega, alpha] = pushed.motion();
                for (a, b) in [(sensed.theta, theta), (sensed.omega, omega), (sensed.alpha, alpha)] {
                    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "delay {delay}, sample {i}: {a} {b}");
                }
                let tau = 0.03 * (0.1 * f64::from(i)).sin();
                held.write(tau).unwrap();
                pushed.push(-tau, [0.0; 2]);
                ticks.pass(PERIOD);
            }
        }
    }

    #[test]
    fn a_late_loop_finds_the_handle_where_the_last_torque_took_it() {
        let (ticks, mut held) = held(0, None);
        held.read().unwrap();
        held.write(-0.01).unwrap();
        ticks.pass(10 * PERIOD);
        let sensed = held.read().unwrap();
        let t = 10.0 * PERIOD as f64 * NS;
        assert!((sensed.omega / (0.01 / 5e-5 * t) - 1.0).abs() < 0.03, "{sensed:?}");
        assert!((sensed.alpha / (0.01 / 5e-5) - 1.0).abs() < 0.03, "{sensed:?}");
    }

    #[test]
    fn a_hand_takes_a_free_handle_along_and_its_work_is_what_the_handle_got() {
        let w = 3.0;
        let at = |f: fn(f64) -> f64| (0..5000).map(|i| f(w * f64::from(i) / 5000.0)).collect();
        let track = Track { theta: at(|x| x * x), omega: at(|x| 2.0 * 3.0 * x), alpha: vec![18.0; 5000] };
        let hand = Hand { track: Arc::new(track), rate_hz: 5000.0, measured: true };
        let (ticks, mut held) = held(0, Some(hand));
        let (mut lost, mut sensed) = (0.0, held.read().unwrap());
        for _ in 0..4500 {
            ticks.pass(PERIOD);
            sensed = held.read().unwrap();
            lost += 1e-3 * sensed.omega * sensed.omega * PERIOD as f64 * NS;
        }
        let t = 0.9;
        assert!((sensed.theta - 0.3 - 9.0 * t * t).abs() < 0.1, "{sensed:?}");
        let [_, omega, work] = held.shown.get();
        assert!((work / (0.5 * 5e-5 * omega * omega + lost) - 1.0).abs() < 1e-3, "{work}");
        assert!(sensed.hand.is_some_and(|tau| tau > 0.0));
    }
}
