//! What the rig does when it is told something.

use super::rig::Rig;
use crate::wire::{Frame, Message, Mode, Point, State, capability, refusal};
use knobcore::effects::Id;
use knobcore::model_file;
use knobrender::Limits;

/// Speed that the handle never reaches, rad/s.
const FASTEST: f64 = 1000.0;

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

    /// The host is alive, and may have said which torque it wants.
    fn feed(&mut self, message: &Message) {
        let commanded = matches!(self.armed, Some((Mode::Commanded, _))) && self.state == State::Rendering;
        if commanded == matches!(message, Message::Torque { .. }) {
            self.fed_us = self.now_us;
        }
        let limit = self.armed.map_or(0.0, |(_, limits)| limits.torque);
        if let (Message::Torque { torque }, Some(run)) = (message, &mut self.run)
            && torque.is_finite()
        {
            run.scene.command(f64::from(*torque).clamp(-limit, limit));
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
            Message::Clear => (self.state, self.fault) = (next, None),
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
                let [torque, torque_rate] = [*torque_limit, *torque_rate_limit].map(f64::from);
                self.armed = Some((*mode, Limits { torque, torque_rate, speed: FASTEST }));
                (self.state, self.fed_us) = (next, self.now_us);
            }
            Message::Excite { total, first, check, points } => {
                let finite = |p: &Point| p.theta.is_finite() && p.omega.is_finite() && p.alpha.is_finite();
                if !points.iter().all(finite) {
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
        if let Some(own) = model.effects().find(|id| matches!(id, Id::User(_))) {
            self.complaint = format!("effect '{}' is not in the firmware", own.info().id);
            return Err(refusal::MODEL);
        }
        self.model = Some(model);
        Ok(())
    }

    fn why(&mut self, code: u16) -> String {
        match code {
            refusal::UNKNOWN => "unknown command".to_owned(),
            refusal::STATE => format!("not allowed while {:?}", self.state),
            refusal::VALUE => "a value is not finite, not positive or above a limit".to_owned(),
            refusal::UNABLE => "this device cannot do that".to_owned(),
            refusal::MISSING => "no whole motion or model is there; upload it first".to_owned(),
            refusal::ORDER => "the chunk does not follow on those before it".to_owned(),
            refusal::LARGE => "larger than this device can keep".to_owned(),
            refusal::CHECK => "the check sum of the whole is another".to_owned(),
            _ => std::mem::take(&mut self.complaint),
        }
    }
}
