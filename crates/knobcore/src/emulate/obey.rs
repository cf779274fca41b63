//! What the rig does when it is told something.

use super::rig::Rig;
use super::upload::Chunk;
use crate::effects::Id;
use crate::model_file;
use crate::render::Limits;
use crate::wire::{Message, Point, State, capability, refusal};

/// Speed that the handle never reaches, rad/s.
const FASTEST: f64 = 1000.0;

impl Rig {
    /// Carries out a command, and answers it where it is one that is answered.
    pub(super) fn obey(&mut self, command: u32, message: &Message) {
        match self.state.after(message).and_then(|next| self.done(message, next)) {
            Ok(()) => match message {
                Message::Ping => self.say(&Message::Pong { command }),
                Message::Heartbeat | Message::Torque { .. } | Message::Describe => {}
                _ => self.say(&Message::Ack { command }),
            },
            Err(code) => {
                let why = self.why(code);
                self.refuse(command, code, &why);
            }
        }
    }

    fn done(&mut self, message: &Message, next: State) -> Result<(), u16> {
        match message {
            Message::Describe => {
                let device = self.setup.descriptor.clone();
                self.say(&Message::Descriptor { device });
                self.tell_status();
                self.tell_fault();
            }
            Message::Start { samples } => {
                let mode = self.armed.filter(|_| next == State::Rendering);
                self.begin(*samples, mode)?;
                self.state = next;
            }
            Message::Stop => self.end_run(),
            Message::Disarm => {
                self.end_run();
                (self.state, self.armed) = (next, None);
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
                self.state = next;
            }
            Message::Excite { total, first, check, points } => {
                let finite = |p: &Point| p.theta.is_finite() && p.omega.is_finite() && p.alpha.is_finite();
                if !points.iter().all(finite) {
                    return Err(refusal::VALUE);
                }
                let bytes: Vec<u8> = points.iter().flat_map(point_bytes).collect();
                let chunk = Chunk { total: *total, first: *first, check: *check };
                let most = self.setup.descriptor.motion_capacity as usize;
                self.motion.take(chunk, points, &bytes, most)?;
            }
            Message::Model { total, first, check, bytes } => {
                let chunk = Chunk { total: *total, first: *first, check: *check };
                let most = self.setup.descriptor.model_capacity as usize;
                if self.file.take(chunk, bytes, bytes, most)? {
                    self.read_model()?;
                }
            }
            Message::Torque { torque } => {
                let limit = self.armed.map_or(0.0, |(_, limits)| limits.torque);
                if let (Some(run), true) = (&mut self.run, torque.is_finite()) {
                    run.scene.command(f64::from(*torque).clamp(-limit, limit));
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

/// A point as it stands in a frame.
fn point_bytes(point: &Point) -> [u8; Point::BYTES] {
    let mut bytes = [0; Point::BYTES];
    bytes[..8].copy_from_slice(&point.theta.to_le_bytes());
    bytes[8..12].copy_from_slice(&point.omega.to_le_bytes());
    bytes[12..].copy_from_slice(&point.alpha.to_le_bytes());
    bytes
}
