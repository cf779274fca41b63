//! Every state of the rig that commands, silences and a pulled plug lead to, each held against the tables of the wire
//! protocol: they are written here once more, and share no code with the rig.

use knobcore::effects::Id;
use knobcore::model::Model as Knob;
use knobcore::model_file;
use knobcore::param::Axis;
use knobrig::emulate::{Fixture, Rig};
use knobrig::wire::{
    Decoder, Event, Header, Message, Mode, Point, State, encode, model_chunks, motion_chunks,
};
use stateright::{Checker, Model, Property};
use std::hash::{Hash, Hasher};

mod common;

/// Heartbeat timeout and the finest wait, ms.
const TIMEOUT: u32 = 100;
const SHORT_RUN: u32 = 300; // samples: 60 ms
const LIMIT: f32 = 0.05;
const MODES: [Mode; 4] = [Mode::Drive, Mode::Render, Mode::RenderDriven, Mode::Commanded];

/// What a host, a line and a hand at the plug can do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Action {
    Arm(usize),
    ArmTooStrong,
    Start(u32),
    Stop,
    Disarm,
    Clear,
    Describe,
    Heartbeat,
    Torque(f32),
    Damaged,
    MotionThatJumps,
    Unplug,
    Wait(u32),
}

const ACTIONS: [Action; 23] = [
    Action::Arm(0),
    Action::Arm(1),
    Action::Arm(2),
    Action::Arm(3),
    Action::ArmTooStrong,
    Action::Start(0),
    Action::Start(SHORT_RUN),
    Action::Stop,
    Action::Disarm,
    Action::Clear,
    Action::Describe,
    Action::Heartbeat,
    Action::Torque(0.02),
    Action::Torque(9.0),
    Action::Torque(f32::NAN),
    Action::Torque(f32::INFINITY),
    Action::Damaged,
    Action::MotionThatJumps,
    Action::Unplug,
    Action::Wait(5),
    Action::Wait(60),
    Action::Wait(100),
    Action::Wait(120),
];

/// What the protocol says that a device is in, after what was done to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Spec {
    state: u8,
    mode: Option<usize>,
    /// Since the last valid word of the host, ms.
    silent: u32,
    /// Of the run, ms; none for one without an end.
    left: Option<u32>,
    /// Whether the last command was obeyed as the table says, and no limit was exceeded meanwhile.
    kept: bool,
}

/// A rig, and what the protocol says of it. Two of them are the same where the protocol says the same.
#[derive(Clone)]
struct Both {
    rig: Rig,
    spec: Spec,
    commands: u32,
}

impl std::fmt::Debug for Both {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}, the rig is {:?}", self.spec, self.rig.state())
    }
}
impl PartialEq for Both {
    fn eq(&self, other: &Self) -> bool {
        self.spec == other.spec
    }
}
impl Eq for Both {}
impl Hash for Both {
    fn hash<H: Hasher>(&self, to: &mut H) {
        self.spec.hash(to);
    }
}

impl Both {
    fn new() -> Self {
        let mut knob = Knob::new(&[Id::Inertia, Id::Coulomb], Axis::Rotary);
        for (name, value) in [("inertia.M", 5e-5), ("coulomb.neg", 0.01), ("coulomb.pos", 0.01)] {
            knob.set(name, value).unwrap();
        }
        let mut setup = common::setup(500);
        setup.fixture = Fixture::Knob(Box::new(knob.clone()));
        let mut both = Self {
            rig: Rig::new(setup),
            spec: Spec { state: 0, mode: None, silent: 0, left: None, kept: true },
            commands: 0,
        };
        let w = 10.0 / common::RATE;
        let at = |i: usize| 0.05 * (1.0 - (w * i as f64).cos());
        // Longer than any path that ends in it is long.
        let points: Vec<Point> = (0..10_000)
            .map(|i| Point { theta: at(i), omega: (0.5 * (w * i as f64).sin()) as f32, alpha: 0.0 })
            .collect();
        motion_chunks(&points).chain(model_chunks(model_file::write(&knob).as_bytes())).for_each(|chunk| {
            assert!(both.tell(&chunk));
        });
        both
    }

    /// Whether a command is acknowledged.
    fn tell(&mut self, message: &Message) -> bool {
        self.commands += 1;
        self.rig.hear(&encode(Header { sequence: self.commands, time_us: 0 }, message));
        let (mut decoder, mut good) = (Decoder::new(), false);
        decoder.push(&self.rig.speak(usize::MAX), |event| {
            if let Event::Frame(frame) = event {
                good |= matches!(frame.message, Message::Ack { .. } | Message::Descriptor { .. });
            }
        });
        good
    }

    /// Carries out an action on the rig and, by the tables, on what the protocol says.
    fn act(&mut self, action: Action) {
        let spec = &mut self.spec;
        let (idle, recording, armed, rendering, fault) = (0, 1, 2, 3, 4);
        let command = match action {
            Action::Arm(mode) => {
                Message::Arm { mode: MODES[mode], torque_limit: LIMIT, torque_rate_limit: 100.0 }
            }
            Action::ArmTooStrong => {
                Message::Arm { mode: Mode::Render, torque_limit: 1e3, torque_rate_limit: 100.0 }
            }
            Action::Start(samples) => Message::Start { samples },
            Action::Stop => Message::Stop,
            Action::Disarm => Message::Disarm,
            Action::Clear => Message::Clear,
            Action::Describe => Message::Describe,
            Action::Heartbeat => Message::Heartbeat,
            Action::Torque(torque) => Message::Torque { torque },
            Action::MotionThatJumps => {
                let points = [Point { theta: 100.0, omega: 0.0, alpha: 0.0 }];
                let Some(chunk) = motion_chunks(&points).next() else { return };
                chunk
            }
            Action::Damaged => {
                let mut frame = encode(Header::default(), &Message::Heartbeat);
                frame[5] ^= 0x40;
                return self.rig.hear(&frame);
            }
            Action::Unplug => {
                spec.state = match spec.state {
                    2 | 3 => fault,
                    1 => idle,
                    other => other,
                };
                spec.left = None;
                return self.rig.unplugged();
            }
            Action::Wait(ms) => return self.wait(ms),
        };
        let commanded = spec.mode == Some(3) && spec.state == rendering;
        let (next, good) = match (action, spec.state) {
            (Action::Arm(_), 0) => (armed, true),
            (Action::Start(_), 0) => (recording, true),
            (Action::Start(_), 2) => (rendering, true),
            (Action::Arm(_) | Action::ArmTooStrong | Action::Start(_) | Action::MotionThatJumps, state) => {
                (state, false)
            }
            (Action::Stop, 1) => (idle, true),
            (Action::Stop, 3) => (armed, true),
            (Action::Disarm, 2 | 3) => (idle, true),
            (Action::Clear, 4) => (idle, true),
            (Action::Heartbeat | Action::Torque(_), state) => (state, false),
            (_, state) => (state, true),
        };
        match action {
            Action::Arm(mode) if good => (spec.mode, spec.silent) = (Some(mode), 0),
            Action::Start(samples) if good => spec.left = (samples > 0).then_some(samples / 5),
            Action::Heartbeat if !commanded => spec.silent = 0,
            Action::Torque(torque) if commanded && torque.is_finite() => spec.silent = 0,
            _ => {}
        }
        if next != spec.state && (next == idle || next == armed) && !matches!(action, Action::Arm(_)) {
            spec.left = None;
        }
        spec.state = next;
        if next != armed && next != rendering {
            (spec.mode, spec.silent) = (None, 0);
        }
        let told = self.tell(&command);
        self.spec.kept &= told == good && self.agrees();
    }

    /// Time goes by, sample by sample.
    fn wait(&mut self, ms: u32) {
        for _ in 0..ms {
            for _ in 0..5 {
                let last = self.rig.motor_torque();
                self.rig.advance(self.rig.now_us() + 200);
                let now = self.rig.motor_torque();
                let slewed = (now - last).abs() <= 100.0 / common::RATE * (1.0 + 1e-9) || now == 0.0;
                self.spec.kept &= now.abs() <= f64::from(LIMIT) && slewed;
            }
            let spec = &mut self.spec;
            if spec.state == 2 || spec.state == 3 {
                spec.silent += 1;
            }
            // A run may end in the very sample in which the watchdog would have ended it.
            if let Some(left) = &mut spec.left {
                *left -= 1;
                if *left == 0 {
                    spec.left = None;
                    spec.state = if spec.state == 3 { 2 } else { 0 };
                }
            }
            if (spec.state == 2 || spec.state == 3) && spec.silent > TIMEOUT {
                (spec.state, spec.mode, spec.left, spec.silent) = (4, None, None, 0);
            }
        }
        self.rig.speak(usize::MAX);
        // What was done long ago makes no difference any more.
        self.spec.silent = self.spec.silent.min(TIMEOUT + 1);
        self.spec.kept &= self.agrees();
    }

    fn agrees(&self) -> bool {
        let state = match self.rig.state() {
            State::Idle => 0,
            State::Recording => 1,
            State::Armed => 2,
            State::Rendering => 3,
            State::Fault => 4,
        };
        state == self.spec.state && (self.rig.motor_torque() == 0.0 || state == 3) && self.is_watched()
    }

    /// Whether silence from here on ends in the fault, and exactly when: what the rig remembers of the host's last
    /// word is seen from outside in no other way, and paths that the protocol takes for one are followed once.
    fn is_watched(&self) -> bool {
        let left = TIMEOUT - self.spec.silent.min(TIMEOUT);
        if self.spec.state != 2 && self.spec.state != 3 {
            return true;
        }
        let mut silent = self.rig.clone();
        silent.advance(silent.now_us() + 1000 * u64::from(left));
        let still = silent.state().watched();
        silent.advance(silent.now_us() + 1000);
        still && silent.state() == State::Fault
    }
}

struct Everything;

impl Model for Everything {
    type State = Both;
    type Action = Action;

    fn init_states(&self) -> Vec<Both> {
        vec![Both::new()]
    }

    fn actions(&self, _: &Both, actions: &mut Vec<Action>) {
        actions.extend(ACTIONS);
    }

    fn next_state(&self, last: &Both, action: Action) -> Option<Both> {
        let mut next = last.clone();
        next.act(action);
        Some(next)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("the rig does what the tables say, within its limits", |_, both: &Both| {
                both.spec.kept
            }),
            Property::sometimes("it renders", |_, both: &Both| both.spec.state == 3),
            Property::sometimes("a fault is latched", |_, both: &Both| both.spec.state == 4),
        ]
    }
}

#[test]
fn every_state_that_can_be_reached_is_one_of_the_protocol() {
    let checked = Everything.checker().spawn_bfs().join();
    println!("{} states, {} ways into them", checked.unique_state_count(), checked.state_count());
    checked.assert_properties();
    assert!(checked.unique_state_count() > 500, "{}", checked.unique_state_count());
}
