//! What the rig does when it is told something.

use super::rig::Rig;
use crate::wire::{Frame, Message, Mode, Point, State, capability, refusal};
use knobcore::model_file;
use knobrender::{Limits, check_passive};

/// Speed beyond which the rig lets go, rad/s: nobody turns a knob by 16 turns in a second.
pub(super) const FASTEST: f64 = 100.0;

impl Rig {
    /// Carries out a command, and answers it where it is one that is answered.
    pub(super) fn obey(&mut self, frame: Frame) {
        let (message, command) = (&frame.message, frame.header.sequence);
        if let Message::Heartbeat | Message::Torque { .. } = message {
            return self.feed(message);
        }
        if let Some((last, answer)) = &self.answered
            && *last == frame
        {
            return self.out.extend_from_slice(&answer.clone());
        }
        let (start, state) = (self.out.len(), self.state);
        match state.after(message).and_then(|next| self.done(message, next)) {
            Ok(()) => match message {
                Message::Ping => self.say(&Message::Pong { command }),
                Message::Describe => self.describe(),
                _ => self.say(&Message::Ack { command }),
            },
            Err(code) => {
                let why = self.why(code);
                self.refuse(command, code, &why);
                self.answered = Some((frame, self.out[start..].to_vec()));
                return;
            }
        }
        let answer = self.out[start..].to_vec();
        match message {
            Message::Start { .. } => self.tell_started(),
            Message::Stop => self.end_run(),
            Message::Disarm if state.watched() => {
                self.end_run();
                self.armed = None;
                if self.state == State::Armed {
                    self.state = State::Idle;
                }
            }
            _ => {}
        }
        if self.state != state {
            self.tell_status();
        }
        self.answered = Some((frame, answer));
    }

    /// The host is alive, and may have said which torque it wants. What is not valid feeds nothing.
    fn feed(&mut self, message: &Message) {
        let commanded = matches!(self.armed, Some((Mode::Commanded, _))) && self.state == State::Rendering;
        match message {
            Message::Torque { torque } if commanded && torque.is_finite() => {
                self.fed_us = self.now_us;
                let limit = self.armed.map_or(0.0, |(_, limits)| limits.torque);
                if let Some(run) = &mut self.run {
                    run.scene.command(f64::from(*torque).clamp(-limit, limit));
                }
            }
            Message::Heartbeat if !commanded => self.fed_us = self.now_us,
            _ => {}
        }
    }

    fn describe(&mut self) {
        let device = self.setup.descriptor;
        self.say(&Message::Descriptor { device });
        self.tell_status();
        self.tell_fault();
    }

    fn done(&mut self, message: &Message, next: State) -> Result<(), u16> {
        match message {
            Message::Start { samples } => {
                let mode = self.armed.filter(|_| next == State::Rendering);
                self.begin(*samples, mode)?;
                self.state = next;
            }
            Message::Clear => (self.state, self.latched) = (next, None),
            Message::Arm { mode, torque_limit, torque_rate_limit } => {
                let d = &self.setup.descriptor;
                let able =
                    [capability::DRIVE, capability::RENDER, capability::RENDER_DRIVEN, capability::COMMANDED];
                if d.capabilities & able[*mode as usize] == 0 {
                    return Err(refusal::UNABLE);
                }
                let fits = |x: f32, most: f32| x > 0.0 && x <= most;
                if !fits(*torque_limit, d.torque_limit) || !fits(*torque_rate_limit, d.torque_rate_limit) {
                    return Err(refusal::VALUE);
                }
                if *mode == Mode::Render && !self.forced {
                    self.check_model(true)?;
                }
                let [torque, torque_rate] = [*torque_limit, *torque_rate_limit].map(f64::from);
                self.armed = Some((*mode, Limits { torque, torque_rate, speed: FASTEST }));
                (self.state, self.fed_us) = (next, self.now_us);
            }
            Message::Excite { total, first, check, points } => {
                if !self.can_follow(*first as usize, points) {
                    return Err(refusal::VALUE);
                }
                self.motion.take(*total, *first, *check, points)?;
            }
            Message::Model { total, first, check, bytes } => {
                if *first == 0 {
                    self.model = None;
                }
                self.file.take(*total, *first, *check, bytes)?;
                if self.file.whole().is_some() {
                    self.read_model()?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn read_model(&mut self) -> Result<(), u16> {
        let bytes = self.file.whole().unwrap_or_default();
        let text = std::str::from_utf8(bytes).map_err(|_| refusal::MODEL)?;
        let model = model_file::parse(text).map_err(|error| {
            self.complaint = error.to_string();
            refusal::MODEL
        })?;
        if let Some(own) = model.effects().find(|id| id.calls_out()) {
            self.complaint = format!("effect '{}' is not in the firmware", own.info().id);
            return Err(refusal::MODEL);
        }
        self.forced = model_file::is_forced(text);
        self.model = Some(model);
        if self.forced {
            return Ok(());
        }
        self.check_model(false).inspect_err(|_| self.model = None)
    }

    /// Refuses a model that would feed a hand or, in a hand, ring on this device.
    fn check_model(&mut self, in_a_hand: bool) -> Result<(), u16> {
        let device = in_a_hand.then(|| self.device(None));
        let Some(model) = &self.model else { return Ok(()) };
        check_passive(model, device, self.setup.descriptor.rate_hz).map_err(|error| {
            self.complaint = error.to_string();
            refusal::MODEL
        })
    }

    /// Whether a motion may go on by these points: from rest where the knob stands, without a jump.
    fn can_follow(&self, first: usize, points: &[Point]) -> bool {
        let most = FASTEST / self.setup.descriptor.rate_hz;
        let there = self.motion.so_far();
        // A chunk that does not follow on what is there is refused or repeated, whatever is in it.
        let before = if first == there.len() { there.last() } else { None };
        let sane =
            |p: &Point| p.theta.is_finite() && p.alpha.is_finite() && f64::from(p.omega).abs() <= FASTEST;
        let rests = |p: &Point| first > 0 || (p.theta == 0.0 && p.omega == 0.0);
        let near = |pair: [&Point; 2]| (pair[1].theta - pair[0].theta).abs() <= most;
        let pairs = before.into_iter().chain(points).zip(points.iter().skip(usize::from(before.is_none())));
        points.iter().all(sane)
            && points.first().is_none_or(rests)
            && pairs.into_iter().all(|(a, b)| near([a, b]))
    }

    fn why(&mut self, code: u16) -> String {
        match code {
            refusal::UNKNOWN => "unknown command".to_owned(),
            refusal::STATE => format!("not allowed while {:?}", self.state),
            refusal::VALUE => {
                "a value is not finite, not positive or above a limit, or a motion jumps or starts off rest"
                    .to_owned()
            }
            refusal::UNABLE => "this device cannot do that".to_owned(),
            refusal::MISSING => "no whole motion or model is there; upload it first".to_owned(),
            refusal::ORDER => "the chunk does not follow on those before it".to_owned(),
            refusal::LARGE => "larger than this device can keep".to_owned(),
            refusal::CHECK => "the check sum of the whole is another".to_owned(),
            _ => std::mem::take(&mut self.complaint),
        }
    }
}
