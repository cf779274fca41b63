//! The rig: a state machine that hears bytes, lets time go by and speaks bytes.

use super::scene::{Scene, Track};
use super::sensors::Sensors;
use crate::wire::{
    Decoder, Descriptor, Event, Frame, Header, Message, Mode, Point, Samples, State, Text, Upload, encode,
    fault, flag, refusal,
};
use knobcore::model::Model;
use knobcore::random::Noise;
use knobrender::Limits;

/// What is in the rig's gripper while it measures.
#[derive(Debug, Clone)]
pub enum Fixture {
    /// A knob with whatever effects it has, named or not.
    Knob(Box<Model>),
    /// Nothing: the motor turns freely.
    Free,
    /// An anchor that prevents any movement: the torque is that of the position control, N m/rad.
    Anchor(f64),
}

/// What a rig is made of.
#[derive(Debug, Clone)]
pub struct Setup {
    /// What it says about itself.
    pub descriptor: Descriptor,
    /// What is in its gripper.
    pub fixture: Fixture,
    /// What its sensors add.
    pub sensors: Sensors,
    /// The motion of a hand that turns the knob, or holds the handle; it is repeated.
    pub hand: Track,
    /// Seed of the noise.
    pub seed: u64,
}

/// Samples of a DATA frame.
const BATCH: usize = 25;
/// Bytes that wait to be read before samples are dropped.
const ROOM: usize = 1 << 18;
/// From one STATUS to the next, microseconds.
const STATUS_US: u64 = 1_000_000;
/// Temperature of a rig that does not get warm, degrees Celsius.
const TEMPERATURE: f32 = 25.0;

/// A run that goes on.
#[derive(Clone)]
pub(super) struct Run {
    pub scene: Scene,
    pub left: Option<u32>,
    produced: u32,
    sent: u32,
    batch: Samples,
    batch_us: u64,
}

/// A fault: its code, why, and since when, us.
#[derive(Debug, Clone, Copy)]
pub(super) struct Latched {
    code: u16,
    why: &'static str,
    since_us: u64,
}

/// An emulated rig.
#[derive(Clone)]
pub struct Rig {
    pub(super) setup: Setup,
    pub(super) state: State,
    pub(super) motion: Upload<Point>,
    pub(super) file: Upload<u8>,
    pub(super) model: Option<Model>,
    /// Whether it is to be rendered though it may feed a hand.
    pub(super) forced: bool,
    pub(super) armed: Option<(Mode, Limits)>,
    pub(super) latched: Option<Latched>,
    /// What is wrong with the last model, in words.
    pub(super) complaint: String,
    pub(super) run: Option<Run>,
    pub(super) runs: u16,
    pub(super) place: f64,
    decoder: Decoder,
    noise: Noise,
    pub(super) now_us: u64,
    next_us: f64,
    status_us: u64,
    pub(super) fed_us: u64,
    sequence: u32,
    motor: f64,
    dropped: bool,
    pub(super) out: Vec<u8>,
    /// The last command that was answered, and the answer.
    pub(super) answered: Option<(Frame, Vec<u8>)>,
}

impl Rig {
    /// A rig that has just been switched on.
    pub fn new(setup: Setup) -> Self {
        Self {
            noise: Noise::new(setup.seed),
            // Runs are told apart over power-ups, too.
            runs: (setup.seed as u16).wrapping_mul(257),
            state: State::Idle,
            motion: Upload::new(setup.descriptor.motion_capacity as usize),
            file: Upload::new(setup.descriptor.model_capacity as usize),
            model: None,
            forced: false,
            armed: None,
            latched: None,
            complaint: String::new(),
            run: None,
            place: 0.0,
            decoder: Decoder::new(),
            now_us: 0,
            next_us: 0.0,
            status_us: 0,
            fed_us: 0,
            sequence: 0,
            motor: 0.0,
            dropped: false,
            out: Vec::new(),
            answered: None,
            setup,
        }
    }

    /// Its state.
    pub fn state(&self) -> State {
        self.state
    }

    /// Torque of its motor at this instant, N m.
    pub fn motor_torque(&self) -> f64 {
        self.motor
    }

    /// Angle of what its motor or a hand turns at this instant, rad.
    pub fn place(&self) -> f64 {
        self.run.as_ref().map_or(self.place, |run| run.scene.place())
    }

    /// Microseconds since it was switched on.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Bytes from the host.
    pub fn hear(&mut self, bytes: &[u8]) {
        let mut frames = Vec::new();
        self.decoder.push(bytes, |event| frames.push(event));
        for event in frames {
            match event {
                Event::Frame(frame) => self.obey(frame),
                Event::Unknown { header, .. } => {
                    self.refuse(header.sequence, refusal::UNKNOWN, "unknown command");
                }
                Event::Foreign { .. } | Event::Corrupt { .. } => {}
            }
        }
    }

    /// Time goes by until `until_us`: samples are taken, and the host's silence is noticed.
    pub fn advance(&mut self, until_us: u64) {
        let period = 1e6 / self.setup.descriptor.rate_hz;
        while self.now_us < until_us {
            let tick =
                if self.run.is_some() { (self.next_us.ceil() as u64).max(self.now_us) } else { until_us };
            let deadline = self.fed_us + 1000 * u64::from(self.setup.descriptor.heartbeat_ms);
            let next = tick.min(until_us);
            if self.state.watched() && deadline < next {
                self.now_us = deadline.max(self.now_us);
                self.break_off(fault::WATCHDOG, "the host was silent for longer than the heartbeat");
                continue;
            }
            self.now_us = next;
            if self.run.is_some() && tick <= until_us {
                self.sample();
                self.next_us += period;
                self.now_us = self.now_us.max(tick);
                if tick == until_us {
                    break;
                }
            }
            if self.now_us >= self.status_us && self.run.is_some() {
                self.status_us = self.now_us + STATUS_US;
                self.tell_status();
            }
        }
    }

    /// The host has closed the port.
    pub fn unplugged(&mut self) {
        if self.state.watched() {
            self.break_off(fault::PORT, "the port was closed while torque was possible");
        } else if self.state == State::Recording {
            self.end_run();
        }
        self.out.clear();
    }

    /// What it has to say, at most `most` bytes of it.
    pub fn speak(&mut self, most: usize) -> Vec<u8> {
        let rest = self.out.split_off(most.min(self.out.len()));
        std::mem::replace(&mut self.out, rest)
    }

    /// Begins a run; the reason where there is nothing to run with.
    pub(super) fn begin(&mut self, samples: u32, mode: Option<(Mode, Limits)>) -> Result<(), u16> {
        let scene = self.scene(mode)?;
        self.runs = self.runs.wrapping_add(1);
        self.run = Some(Run {
            scene,
            left: (samples > 0).then_some(samples),
            produced: 0,
            sent: 0,
            batch: Samples::new(),
            batch_us: 0,
        });
        self.next_us = self.now_us as f64 + 1e6 / self.setup.descriptor.rate_hz;
        self.status_us = self.now_us + STATUS_US;
        Ok(())
    }

    /// Says that a run has begun.
    pub(super) fn tell_started(&mut self) {
        self.say(&Message::Started { run: self.runs, first: self.sequence });
    }

    fn sample(&mut self) {
        let Some(run) = &mut self.run else { return };
        if run.left == Some(0) {
            return self.end_run();
        }
        let Some(instant) = run.scene.next() else { return self.end_run() };
        let sample = self.setup.sensors.sample(&self.setup.descriptor, &mut self.noise, instant.sensed);
        if run.batch.is_empty() {
            run.batch_us = self.now_us;
        }
        run.batch.push(sample);
        run.produced += 1;
        run.left = run.left.map(|left| left - 1);
        let (full, over) = (run.batch.len() == BATCH, run.left == Some(0));
        let broken = run.scene.fault();
        self.sequence = self.sequence.wrapping_add(1);
        self.motor = if self.state == State::Rendering { instant.motor } else { 0.0 };
        if full {
            self.send_batch();
        }
        if let Some((code, why)) = broken {
            self.break_off(code, why);
        } else if over {
            self.end_run();
        }
    }

    /// Sends what has come together, or drops it where nobody reads.
    fn send_batch(&mut self) {
        let Some(run) = &mut self.run else { return };
        if run.batch.is_empty() {
            return;
        }
        let samples = std::mem::take(&mut run.batch);
        let count = samples.len() as u32;
        if self.out.len() > ROOM {
            self.dropped = true;
            return;
        }
        run.sent += count;
        let header = Header { sequence: self.sequence.wrapping_sub(count), time_us: run.batch_us };
        self.out.extend_from_slice(&encode(header, &Message::Data { run: self.runs, samples }));
    }

    /// Ends the run, with torque at zero.
    pub(super) fn end_run(&mut self) {
        self.send_batch();
        self.motor = 0.0;
        if let Some(run) = self.run.take() {
            self.place = run.scene.place();
            self.state = self.state.ended();
            let (produced, sent) = (run.produced, run.sent);
            self.say(&Message::Stopped { run: self.runs, produced, sent });
            self.tell_status();
        }
    }

    /// Torque to zero at once, latched.
    fn break_off(&mut self, code: u16, why: &'static str) {
        self.end_run();
        self.state = State::Fault;
        self.armed = None;
        self.latched = Some(Latched { code, why, since_us: self.now_us });
        self.tell_fault();
        self.tell_status();
    }

    /// Says what is latched, and how long ago it was: the cause alone says little of what there is to look at.
    pub(super) fn tell_fault(&mut self) {
        if let Some(Latched { code, why, since_us }) = self.latched {
            let ago = (self.now_us - since_us) as f64 * 1e-6;
            let since = if ago > 0.0 { format!("{ago:.1} s ago: ") } else { String::new() };
            self.say(&Message::Fault { code, text: text(&format!("{since}{why}")) });
        }
    }

    pub(super) fn tell_status(&mut self) {
        let mut flags = 0;
        for (bit, set) in [
            (flag::MOTION, self.motion.whole().is_some()),
            (flag::MODEL, self.model.is_some()),
            (flag::DROPPED, std::mem::take(&mut self.dropped)),
        ] {
            flags |= if set { bit } else { 0 };
        }
        self.say(&Message::Status { state: self.state, temperature: TEMPERATURE, flags });
    }

    pub(super) fn refuse(&mut self, command: u32, code: u16, why: &str) {
        self.say(&Message::Nak { command, code, text: text(why) });
    }

    /// Sends a message of the device now.
    pub(super) fn say(&mut self, message: &Message) {
        let header = Header { sequence: self.sequence, time_us: self.now_us };
        self.out.extend_from_slice(&encode(header, message));
    }
}

/// As much of a sentence as a frame takes.
fn text(why: &str) -> Text {
    let mut text = Text::new();
    for letter in why.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }) {
        if text.try_push(letter).is_err() {
            break;
        }
    }
    text
}
