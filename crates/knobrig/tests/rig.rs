//! The emulated rig, over its bytes alone, in virtual time.

use knobcore::effects::Id;
use knobcore::model::Model;
use knobcore::model_file;
use knobcore::param::Axis;
use knobrig::emulate::{Fixture, Rig, Setup, Track};
use knobrig::wire::{
    Decoder, Event, Frame, Header, Message, Mode, Point, Sample, State, encode, fault, model_chunks,
    motion_chunks,
};

mod common;
use common::track;

fn knob() -> Model {
    let mut model = Model::new(&[Id::Inertia, Id::Coulomb, Id::Viscous, Id::Detent], Axis::Rotary);
    for (name, value) in [
        ("inertia.M", 5e-5),
        ("coulomb.neg", 0.01),
        ("coulomb.pos", 0.012),
        ("viscous.pos", 5e-4),
        ("viscous.neg", 5e-4),
        ("detent.A", 0.02),
        ("detent.P", 0.08),
    ] {
        model.set(name, value).unwrap();
    }
    model
}

fn setup() -> Setup {
    Setup { fixture: Fixture::Knob(Box::new(knob())), ..common::setup(5000) }
}

/// A host that hears all that the rig says.
struct Host {
    rig: Rig,
    decoder: Decoder,
    commands: u32,
    heard: Vec<Frame>,
    commands_torque: bool,
}

impl Host {
    fn new(setup: Setup) -> Self {
        Self {
            rig: Rig::new(setup),
            decoder: Decoder::new(),
            commands: 0,
            heard: Vec::new(),
            commands_torque: false,
        }
    }

    fn tell(&mut self, message: &Message) {
        self.commands += 1;
        self.rig.hear(&encode(Header { sequence: self.commands, time_us: 0 }, message));
    }

    fn wait(&mut self, seconds: f64) {
        self.rig.advance(self.rig.now_us() + (1e6 * seconds) as u64);
        let heard = &mut self.heard;
        self.decoder.push(&self.rig.speak(usize::MAX), |event| match event {
            Event::Frame(frame) => heard.push(frame),
            other => panic!("{other:?}"),
        });
    }

    fn wait_alive(&mut self, seconds: f64) {
        for _ in 0..(seconds / 0.05).round() as usize {
            self.tell(&Message::Heartbeat);
            if self.commands_torque {
                self.tell(&Message::Torque { torque: 0.01 });
            }
            self.wait(0.05);
        }
    }

    fn samples(&self) -> Vec<Sample> {
        let data = self.heard.iter().filter_map(|frame| match &frame.message {
            Message::Data { samples, .. } => Some(samples.to_vec()),
            _ => None,
        });
        data.flatten().collect()
    }

    fn upload_motion(&mut self, track: &Track) {
        let point = |i: usize| Point {
            theta: track.theta[i],
            omega: track.omega[i] as f32,
            alpha: track.alpha[i] as f32,
        };
        let points: Vec<Point> = (0..track.len()).map(point).collect();
        motion_chunks(&points).for_each(|chunk| self.tell(&chunk));
    }

    fn upload_model(&mut self, text: &str) {
        model_chunks(text.as_bytes()).for_each(|chunk| self.tell(&chunk));
    }

    fn arm(&mut self, mode: Mode) {
        self.tell(&Message::Arm { mode, torque_limit: 0.5, torque_rate_limit: 1e6 });
    }

    fn refusals(&self) -> Vec<&Message> {
        self.heard.iter().map(|f| &f.message).filter(|m| matches!(m, Message::Nak { .. })).collect()
    }
}

/// Torque of the knob along the motion, N m.
fn expected(track: &Track) -> Vec<f64> {
    let (knob, p) = (knob(), knob().values());
    (0..track.len())
        .map(|i| {
            let motion = knobcore::motion::Motion::exact(0.0, track.theta[i], track.omega[i], track.alpha[i]);
            knob.load(&p, &mut [], &motion).sliding(&motion)
        })
        .collect()
}

fn worst(samples: &[Sample], expected: &[f64], steady: impl Fn(usize) -> bool) -> f64 {
    let apart = |i: usize| (f64::from(samples[i].tau) * 1e-5 - expected[i]).abs();
    (0..expected.len()).filter(|i| steady(*i)).map(apart).fold(0.0, f64::max)
}

#[test]
fn a_driven_motion_comes_back_with_the_torque_of_the_knob_and_the_exact_count() {
    let mut host = Host::new(setup());
    let motion = track(5013);
    host.upload_motion(&motion);
    host.arm(Mode::Drive);
    host.tell(&Message::Start { samples: 0 });
    host.wait_alive(1.5);
    assert_eq!(host.refusals(), [] as [&Message; 0]);
    let samples = host.samples();
    assert_eq!(samples.len(), 5013);
    assert!(worst(&samples, &expected(&motion), |_| true) < 1e-5);
    let stopped = host.heard.iter().find_map(|f| match f.message {
        Message::Stopped { produced, sent, .. } => Some((f.header.sequence, produced, sent)),
        _ => None,
    });
    assert_eq!(stopped, Some((5013, 5013, 5013)));
    assert_eq!(host.rig.state(), State::Armed);
}

#[test]
fn a_rendered_model_that_a_motion_turns_feels_like_the_knob() {
    let mut host = Host::new(setup());
    let motion = track(10_000);
    host.upload_motion(&motion);
    host.upload_model(&model_file::write(&knob()));
    host.arm(Mode::RenderDriven);
    host.tell(&Message::Start { samples: 0 });
    host.wait_alive(2.5);
    assert_eq!(host.refusals(), [] as [&Message; 0]);
    let samples = host.samples();
    assert_eq!(samples.len(), 10_000);
    let steady = |i: usize| i > 100 && motion.omega[i].abs() > 0.2;
    let apart = worst(&samples, &expected(&motion), steady);
    assert!(apart < 1e-4, "{apart} N m");
}

#[test]
fn a_model_that_cannot_be_rendered_is_refused_in_words() {
    let mut host = Host::new(setup());
    host.upload_model("schema = \"knobcam.model/1\"\n[effects.magic]\nx = 1.0\n");
    host.wait(0.01);
    let Some(Message::Nak { text, .. }) = host.refusals().first() else { panic!("no refusal") };
    assert!(text.contains("magic"), "{text}");
}

#[test]
fn a_silent_host_loses_the_torque_within_the_heartbeat_for_good() {
    for mode in [Mode::Render, Mode::Drive, Mode::RenderDriven, Mode::Commanded] {
        let mut host = Host::new(setup());
        host.upload_motion(&track(50_000));
        host.upload_model(&model_file::write(&knob()));
        host.arm(mode);
        host.tell(&Message::Start { samples: 0 });
        host.commands_torque = mode == Mode::Commanded;
        host.wait_alive(0.3);
        let refusals = host.refusals();
        assert!(
            host.rig.motor_torque() != 0.0,
            "{mode:?} {refusals:?} {:?} {:?}",
            host.rig.state(),
            host.samples().len()
        );
        host.wait(0.12);
        assert_eq!(host.rig.motor_torque(), 0.0, "{mode:?}");
        assert_eq!(host.rig.state(), State::Fault);
        // Neither speaking again nor starting again brings torque back.
        for message in [
            Message::Heartbeat,
            Message::Start { samples: 0 },
            Message::Describe,
            Message::Disarm,
            Message::Stop,
        ] {
            host.tell(&message);
            host.wait(0.01);
            assert_eq!((host.rig.motor_torque(), host.rig.state()), (0.0, State::Fault));
        }
        host.tell(&Message::Clear);
        host.tell(&Message::Start { samples: 10 });
        host.wait(0.01);
        assert_eq!(host.rig.state(), State::Idle, "a cleared device records, and is not armed");
        let told =
            host.heard.iter().any(|f| matches!(f.message, Message::Fault { code: fault::WATCHDOG, .. }));
        assert!(told, "{mode:?}");
    }
}

#[test]
fn a_port_that_closes_takes_the_torque_at_once() {
    let mut host = Host::new(setup());
    host.upload_model(&model_file::write(&knob()));
    host.arm(Mode::Render);
    host.tell(&Message::Start { samples: 0 });
    host.wait_alive(0.2);
    host.rig.unplugged();
    assert_eq!((host.rig.motor_torque(), host.rig.state()), (0.0, State::Fault));
}

#[test]
fn samples_that_nobody_reads_are_dropped_and_counted() {
    let mut host = Host::new(setup());
    host.tell(&Message::Start { samples: 0 });
    host.rig.advance(10_000_000);
    host.tell(&Message::Stop);
    host.wait(0.01);
    let kept = host.samples().len() as u32;
    let last = host.heard.iter().find_map(|f| match f.message {
        Message::Stopped { produced, sent, .. } => Some((produced, sent)),
        _ => None,
    });
    let (produced, sent) = last.unwrap();
    assert!(sent == kept && sent < produced && produced >= 49_999, "{sent} of {produced}");
}

#[test]
fn a_hand_turns_the_knob_until_it_is_told_to_stop() {
    let mut host = Host::new(setup());
    host.tell(&Message::Start { samples: 12_345 });
    (0..60).for_each(|_| host.wait(0.05));
    assert_eq!(host.samples().len(), 12_345);
    assert_eq!(host.rig.state(), State::Idle);
}

#[test]
fn a_heartbeat_alone_does_not_keep_a_torque_that_the_host_commands() {
    let mut host = Host::new(setup());
    host.arm(Mode::Commanded);
    host.tell(&Message::Start { samples: 0 });
    host.tell(&Message::Torque { torque: 0.01 });
    host.wait_alive(0.2);
    assert_eq!((host.rig.motor_torque(), host.rig.state()), (0.0, State::Fault));
}

#[test]
fn a_command_that_comes_twice_is_answered_twice_and_carried_out_once() {
    let mut host = Host::new(setup());
    let start = encode(Header { sequence: 7, time_us: 3 }, &Message::Start { samples: 100 });
    host.rig.hear(&start);
    host.rig.hear(&start);
    (0..4).for_each(|_| host.wait(0.05));
    let count = |of: fn(&Message) -> bool| host.heard.iter().filter(|f| of(&f.message)).count();
    assert_eq!(count(|m| matches!(m, Message::Ack { command: 7 })), 2);
    assert_eq!(count(|m| matches!(m, Message::Started { .. })), 1);
    assert_eq!(host.samples().len(), 100);
}
