//! Random models, commands and stops: whatever comes, torque, speed and energy stay within their limits.
//!
//! A short part runs in the tests, each time from another seed, which is printed; `benches/study_safety.py` runs the
//! whole. KNOBCAM_SEED and KNOBCAM_SEQUENCES choose what is run.

use knobcore::model::Model;
use knobcore::model_file;
use knobcore::random::Noise;
use knobrender::TANK_J;
use knobrig::emulate::{Fixture, Rig};
use knobrig::wire::{
    DELIMITER, Decoder, Event, Header, Message, Mode, Point, State, encode, fault, model_chunks,
    motion_chunks,
};

use std::f64::consts::TAU;

mod common;
use common::RATE;
use common::models::{random_model, stored};
use common::seen::Seen;

/// Speed beyond which the rig lets go, rad/s, and what a sample adds before it can.
const FASTEST: f64 = 100.0;
/// One sample, us; heartbeat timeout, us.
const TICK: u64 = 200;
const TIMEOUT: u64 = 100_000;
const MODES: [Mode; 4] = [Mode::Drive, Mode::Render, Mode::RenderDriven, Mode::Commanded];

/// The rig, and beside it what whoever watches it from outside knows.
struct Watched {
    rig: Rig,
    noise: Noise,
    decoder: Decoder,
    commands: u32,
    /// Of the last ARM that was acknowledged: mode, torque limit, torque rate limit.
    armed: Option<(usize, [f64; 2])>,
    /// The device's own limits.
    most: [f64; 2],
    fed_us: u64,
    model: Option<(Model, bool)>,
    /// Energy that the motor gave out in this run, J.
    given: f64,
    last: Option<f64>,
    seen: Seen,
}

impl Watched {
    fn new(seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let mut setup = common::setup(1000 + (noise.bits() % 4000) as usize);
        setup.seed = seed;
        setup.descriptor.torque_limit = (0.05 + noise.uniform()) as f32;
        setup.descriptor.torque_rate_limit = 10_f64.powf(2.0 + 2.0 * noise.uniform()) as f32;
        setup.descriptor.delay_samples = (noise.bits() % 3) as u16;
        setup.fixture = Fixture::Knob(Box::new(random_model(&mut noise, 0.0)));
        let most = [setup.descriptor.torque_limit, setup.descriptor.torque_rate_limit].map(f64::from);
        Self {
            rig: Rig::new(setup),
            most,
            noise,
            decoder: Decoder::new(),
            commands: 0,
            armed: None,
            fed_us: 0,
            model: None,
            given: 0.0,
            last: None,
            seen: Seen::default(),
        }
    }

    fn chance(&mut self, share: f64) -> bool {
        self.noise.uniform() < share
    }

    fn below(&mut self, n: u64) -> u64 {
        self.noise.bits() % n
    }

    /// A command; whether it is acknowledged.
    fn tell(&mut self, message: &Message) -> bool {
        self.commands += 1;
        self.rig.hear(&encode(Header { sequence: self.commands, time_us: self.rig.now_us() }, message));
        self.listen()
    }

    /// Hears what the rig says; whether that acknowledges something.
    fn listen(&mut self) -> bool {
        let (mut good, mut faults) = (false, Vec::new());
        let mut angles = Vec::new();
        let counts = self.rig.speak(usize::MAX);
        self.decoder.push(&counts, |event| {
            let Event::Frame(frame) = event else { return };
            match frame.message {
                Message::Ack { .. } => good = true,
                Message::Fault { code, .. } => faults.push(code),
                Message::Data { samples, .. } => angles.extend(samples.iter().map(|sample| sample.count)),
                _ => {}
            }
        });
        for code in faults {
            match code {
                fault::WATCHDOG => self.seen.watchdog += 1,
                fault::ENERGY => self.seen.emptied += 1,
                _ => self.seen.faults += 1,
            }
        }
        good
    }

    fn arm(&mut self) {
        let mode = [0, 1, 1, 1, 2, 3][self.below(6) as usize];
        let mut limits = self.most.map(|most| 0.999 * most * 10_f64.powf(-1.5 * self.noise.uniform()));
        if self.chance(0.05) {
            limits[0] = [f64::NAN, -1.0, 0.0, 2.0 * self.most[0]][self.below(4) as usize];
        }
        let [torque_limit, torque_rate_limit] = limits.map(|x| x as f32);
        if self.tell(&Message::Arm { mode: MODES[mode], torque_limit, torque_rate_limit }) {
            self.armed = Some((mode, [torque_limit, torque_rate_limit].map(f64::from)));
            self.fed_us = self.rig.now_us();
        }
    }

    fn start(&mut self) {
        let samples = if self.chance(0.5) { 0 } else { self.below(2000) as u32 };
        if self.tell(&Message::Start { samples }) && self.rig.state() == State::Rendering {
            self.seen.renderings += 1;
            (self.given, self.last) = (0.0, None);
        }
    }

    fn upload_model(&mut self) {
        let bad = if self.chance(0.5) { 0.4 } else { 0.0 };
        let model = random_model(&mut self.noise, bad);
        let forced = self.chance(if bad > 0.0 { 0.6 } else { 0.1 });
        let mut text = model_file::write(&model);
        if forced {
            text = text.replacen('\n', "\nforced = true\n", 1);
        }
        let was_idle = self.rig.state() == State::Idle;
        let chunks: Vec<Message> = model_chunks(text.as_bytes()).collect();
        let taken = chunks.iter().all(|chunk| self.tell(chunk));
        if was_idle {
            self.seen.forced += u64::from(taken && forced);
            self.seen.refused_models += u64::from(!taken);
            self.model = taken.then_some((model, forced));
        }
    }

    fn upload_motion(&mut self) {
        let [size, w] = [0.5 * self.noise.uniform(), 2.0 + 20.0 * self.noise.uniform()];
        let mut points: Vec<Point> = (0..1500)
            .map(|i| {
                let (sin, cos) = (w * f64::from(i) / RATE).sin_cos();
                let omega = (size * w * sin) as f32;
                Point { theta: size * (1.0 - cos), omega, alpha: (size * w * w * cos) as f32 }
            })
            .collect();
        if self.chance(0.2) {
            let at = self.below(1500) as usize;
            let wrong = [f64::NAN, 100.0, -1e9][self.below(3) as usize];
            points[at].theta = wrong;
        }
        motion_chunks(&points).for_each(|chunk| {
            self.tell(&chunk);
        });
    }

    fn torque(&mut self) {
        let any = (self.noise.normal() * 0.3) as f32;
        let torque = [any, any, any, f32::NAN, f32::INFINITY, 1e30][self.below(6) as usize];
        let commanded = self.rig.state() == State::Rendering && self.armed.is_some_and(|(mode, _)| mode == 3);
        self.tell(&Message::Torque { torque });
        if commanded && torque.is_finite() {
            self.fed_us = self.rig.now_us();
        }
    }

    fn beat(&mut self) {
        let commanded = self.rig.state() == State::Rendering && self.armed.is_some_and(|(mode, _)| mode == 3);
        self.tell(&Message::Heartbeat);
        if !commanded {
            self.fed_us = self.rig.now_us();
        }
    }

    fn noise_on_the_line(&mut self) {
        let mut frame = encode(Header::default(), &Message::Heartbeat).to_vec();
        let at = self.below(frame.len() as u64) as usize;
        frame[at] ^= 1 << self.below(8);
        frame.push(DELIMITER);
        // What the damage made of it must be no frame at all.
        let mut whole = false;
        Decoder::new().push(&frame, |event| whole |= matches!(event, Event::Frame(_)));
        assert!(!whole);
        self.rig.hear(&frame);
        self.listen();
    }

    /// Something that may happen at any time.
    fn something(&mut self) {
        match self.below(20) {
            0 => self.arm(),
            1 => self.start(),
            2 => _ = self.tell(&Message::Stop),
            3 => _ = self.tell(&Message::Disarm),
            4 => _ = self.tell(&Message::Clear),
            5 => _ = self.tell(&Message::Describe),
            6 => self.upload_model(),
            7 => self.upload_motion(),
            8 => self.noise_on_the_line(),
            9 => self.rig.unplugged(),
            10..=13 => self.torque(),
            14..=17 => self.beat(),
            _ => {}
        }
        let wait = [0, 1, 5, 20, 60, 120][self.below(6) as usize];
        self.wait(wait);
    }

    /// What a host does that means well, with a stop at the end that nobody planned.
    fn session(&mut self) {
        self.tell(&Message::Disarm);
        self.tell(&Message::Clear);
        self.upload_model();
        if self.chance(0.7) {
            self.upload_motion();
        }
        self.arm();
        self.start();
        for _ in 0..self.below(12) {
            self.beat();
            self.torque();
            let wait = self.below(30);
            self.wait(wait);
        }
        match self.below(6) {
            0 => _ = self.tell(&Message::Stop),
            1 => _ = self.tell(&Message::Disarm),
            2 => self.rig.unplugged(),
            3 => self.wait(130),
            4 => _ = self.tell(&Message::Clear),
            _ => {}
        }
        self.wait(3);
    }

    /// Time goes by, and each sample is held against the limits.
    fn wait(&mut self, ms: u64) {
        for _ in 0..5 * ms {
            let before = self.rig.motor_torque();
            self.rig.advance(self.rig.now_us() + TICK);
            self.look(before);
        }
        self.listen();
    }

    fn look(&mut self, before: f64) {
        let (state, now) = (self.rig.state(), self.rig.motor_torque());
        self.seen.samples += 1;
        assert!(now.is_finite());
        assert!(now == 0.0 || state == State::Rendering, "{now} N m while {state:?}");
        if matches!(state, State::Armed | State::Rendering) {
            let silent = self.rig.now_us() - self.fed_us;
            assert!(silent <= TIMEOUT, "{silent} us without a valid word, and still {state:?}");
        }
        let Some((mode, [torque, rate])) = self.armed else { return assert_eq!(now, 0.0) };
        assert!(now.abs() <= torque, "{now} N m where ARM allows {torque}");
        let change = (now - before).abs();
        assert!(
            now == 0.0 || change <= rate / RATE * (1.0 + 1e-9),
            "{change} in a sample where {rate} N m/s"
        );
        self.seen.most_torque_share = self.seen.most_torque_share.max(now.abs() / torque);
        self.seen.with_torque += u64::from(now != 0.0);
        if state != State::Rendering {
            return self.last = None;
        }
        let theta = self.rig.place();
        if let Some(last) = self.last {
            let speed = (theta - last).abs() * RATE;
            let more = 2.0 * (torque + 1.0) / 5e-5 / RATE;
            assert!(speed <= FASTEST + more, "{speed} rad/s");
            self.seen.fastest = self.seen.fastest.max(speed);
            // A handle in a hand went under the torque of this very sample. Where the rig turns it, it is read first,
            // and the torque is what the model asks for, not what the motor gives.
            let gives = if mode == 2 { -before } else { now };
            self.given += gives * (theta - last);
        }
        self.last = Some(theta);
        if mode == 1 || mode == 2 {
            self.look_at_energy(torque);
        }
    }

    /// A rendered model gives out no more than its places hold, and 0.1 J; one that is forced no more than that.
    fn look_at_energy(&mut self, torque: f64) {
        // Looked at where it could be too much: the integral takes its time.
        let slack = 3.0 * torque * (FASTEST + torque / 5e-5 / RATE) / RATE;
        if self.given <= slack {
            return;
        }
        let Some((model, forced)) = &self.model else { panic!("rendered without a model") };
        let reach = model.reach.map_or(TAU, |[angle, _]| angle);
        let places = if *forced { 0.0 } else { stored(model, [-reach, reach]) };
        let allowed = places + TANK_J + slack;
        let told = || format!("forced: {forced}, {:?}\n{}", self.armed, model_file::write(model));
        assert!(self.given <= allowed, "{} J given out of {allowed}, {}", self.given, told());
        self.seen.most_energy_share = self.seen.most_energy_share.max(self.given / allowed);
        if !forced {
            self.seen.most_of_places = self.seen.most_of_places.max(self.given / (places + slack));
        }
    }
}

/// One sequence, whatever it asserts.
fn sequence(seed: u64) -> Seen {
    let mut watched = Watched::new(seed);
    if watched.chance(0.9) {
        watched.session();
    }
    for _ in 0..watched.below(8) {
        watched.something();
    }
    watched.seen
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

#[test]
fn torque_speed_and_energy_stay_within_their_limits_whatever_comes() {
    let clock = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
    let seed = number("KNOBCAM_SEED").unwrap_or(u64::from(clock.subsec_nanos()));
    let count = number("KNOBCAM_SEQUENCES").unwrap_or(200);
    println!("seed {seed}");
    let (mut all, mut exceeded) = (Seen::default(), Vec::new());
    for n in 0..count {
        match std::panic::catch_unwind(|| sequence(seed.wrapping_add(n.wrapping_mul(0x9E37_79B9)))) {
            Ok(seen) => all.add(&seen),
            Err(_) => {
                println!("sequence {n} of seed {seed}");
                exceeded.push(n);
            }
        }
    }
    println!("{}", all.document(seed, count, exceeded.len()));
    assert!(exceeded.is_empty(), "seed {seed}: limits exceeded in sequences {exceeded:?}");
    assert!(all.renderings > count / 10 && all.with_torque > 100 * count / 10);
}
