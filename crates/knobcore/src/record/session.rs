//! A conversation with a rig that is recorded.
use super::desk::{Desk, LogFile};
use super::figures::Meter;
use crate::wire::{Decoder, Event, Header, Ledger, Message, encode};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// From one HEARTBEAT to the next.
const BEAT: Duration = Duration::from_millis(25);
/// Gaps that may still be filled by frames that come late; a serial line does not reorder.
const OPEN_GAPS: usize = 64;

/// Logs, reads and counts what comes. Its memory is bounded, however long it goes on.
pub struct Session {
    desk: Arc<Desk>,
    start: Instant,
    decoder: Decoder,
    ledger: Ledger,
    meter: Meter,
    log: Option<LogFile>,
    beaten: Option<Instant>,
    beats: u32,
}

impl Session {
    /// A session that begins now.
    pub fn new(desk: Arc<Desk>, start: Instant) -> Self {
        Self {
            desk,
            start,
            decoder: Decoder::new(),
            ledger: Ledger::live(OPEN_GAPS),
            meter: Meter::default(),
            log: None,
            beaten: None,
            beats: 0,
        }
    }

    /// Where it meets its host.
    pub fn desk(&self) -> &Arc<Desk> {
        &self.desk
    }

    /// Takes bytes from the rig: first into the log, as they are, then to those who want to know.
    pub fn receive(&mut self, bytes: &[u8], now: Instant) {
        if let Some(log) = self.desk.write(|papers| papers.log.take()) {
            self.log = log;
        }
        // Each piece is written at once: what the system has taken survives the end of this process.
        let written = self.log.as_mut().map(|log| log.write_all(bytes));
        let Self { desk, decoder, ledger, meter, log, .. } = self;
        desk.write(|papers| {
            papers.figures.bytes += bytes.len() as u64;
            match written {
                Some(Ok(())) => papers.figures.logged += bytes.len() as u64,
                Some(Err(error)) => {
                    *log = None;
                    papers.figures.log_error = Some(error.to_string());
                }
                None => {}
            }
            decoder.push(bytes, |event| match event {
                Event::Frame(frame) => {
                    papers.figures.frames += 1;
                    let mut figures = std::mem::take(&mut papers.figures);
                    ledger.enter(&frame, |piece| meter.count(piece, now, &mut figures));
                    match &frame.message {
                        Message::Descriptor { device } => meter.describe(*device),
                        Message::Status { state, temperature, .. } => {
                            figures.state = Some(*state);
                            figures.temperature = Some(*temperature).filter(|t| t.is_finite());
                        }
                        _ => {}
                    }
                    papers.figures = figures;
                    if !matches!(frame.message, Message::Data { .. }) {
                        papers.tell(frame);
                    }
                }
                Event::Corrupt { .. } => papers.figures.corrupt += 1,
                Event::Foreign { version } => papers.figures.foreign_version = Some(version),
                Event::Unknown { .. } => {}
            });
            meter.settle(ledger.runs(), now, &mut papers.figures);
        });
    }

    /// What is to be sent now: the host's bytes, and a HEARTBEAT where one is due.
    pub fn outgoing(&mut self, now: Instant) -> Vec<u8> {
        let due = self.beaten.is_none_or(|beaten| now.saturating_duration_since(beaten) >= BEAT);
        let (mut bytes, beats) = self.desk.write(|papers| {
            let beats = papers.beats_until.is_some_and(|end| now < end);
            (std::mem::take(&mut papers.outgoing), beats)
        });
        if beats && due {
            self.beaten = Some(now);
            self.beats = self.beats.wrapping_add(1);
            let time_us = now.saturating_duration_since(self.start).as_micros() as u64;
            let header = Header { sequence: self.beats, time_us };
            bytes.extend_from_slice(&encode(header, &Message::Heartbeat));
        }
        bytes
    }

    /// How long nothing needs to be sent, unless the host wants to.
    pub fn rest(&self, now: Instant) -> Duration {
        self.beaten
            .map_or(BEAT, |beaten| BEAT.saturating_sub(now.saturating_duration_since(beaten)))
            .max(Duration::from_millis(1))
    }
}
