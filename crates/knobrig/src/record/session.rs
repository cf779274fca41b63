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
                // Another log was asked for meanwhile, and these bytes are not in that one.
                _ if papers.log.is_some() => {}
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
            meter.enter(ledger.runs(), now, &mut papers.figures);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{Sample, Samples, State};
    use std::io::{Error, Result, Write};
    use std::sync::Mutex;

    /// A file that others look into; it takes so many bytes.
    #[derive(Clone)]
    struct Shared(Arc<Mutex<Vec<u8>>>, usize);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> Result<usize> {
            let mut file = self.0.lock().unwrap();
            if file.len() == self.1 {
                return Err(Error::other("no space left"));
            }
            let taken = bytes.len().min(self.1 - file.len());
            file.extend_from_slice(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> Result<()> {
            Ok(())
        }
    }

    fn logged(room: usize) -> (Session, Shared) {
        let desk = Arc::new(Desk::default());
        let file = Shared(Arc::default(), room);
        desk.log_to(Some(Box::new(file.clone())));
        (Session::new(desk, Instant::now()), file)
    }

    fn data(first: u32) -> Vec<u8> {
        let sample = Sample { count: 0, omega: 1, alpha: 2, tau: 3 };
        let header = Header { sequence: first, time_us: u64::from(first) * 200 };
        let samples: Samples = std::iter::repeat_n(sample, 25).collect();
        encode(header, &Message::Data { run: 7, samples }).to_vec()
    }

    fn status() -> Vec<u8> {
        let status = Message::Status { state: State::Recording, temperature: 31.5, flags: 0 };
        encode(Header::default(), &status).to_vec()
    }

    #[test]
    fn what_came_is_in_the_log_as_it_came_whole_or_not() {
        let (mut session, file) = logged(usize::MAX);
        let stream = [b"noise\0".to_vec(), data(0), data(25)[..50].to_vec()].concat();
        for piece in stream.chunks(7) {
            session.receive(piece, Instant::now());
        }
        assert_eq!(*file.0.lock().unwrap(), stream);
        let figures = session.desk().figures();
        assert_eq!((figures.bytes, figures.logged), (stream.len() as u64, stream.len() as u64));
        assert_eq!((figures.frames, figures.corrupt, figures.received), (1, 1, 25));
    }

    #[test]
    fn a_full_disk_is_told_and_the_conversation_goes_on() {
        let (mut session, file) = logged(100);
        for first in [0, 25] {
            session.receive(&data(first), Instant::now());
        }
        let figures = session.desk().figures();
        assert_eq!(file.0.lock().unwrap().len(), 100);
        assert!(figures.log_error.is_some_and(|why| why.contains("no space left")));
        assert_eq!(figures.received, 50);
    }

    #[test]
    fn heartbeats_come_every_25_ms_as_long_as_they_were_asked_for_and_no_longer() {
        let (mut session, _) = logged(0);
        let start = Instant::now();
        assert!(session.outgoing(start).is_empty());
        session.desk().beat_until(Some(start + Duration::from_millis(200)));
        let spoken = (100..300).map(|ms| session.outgoing(start + Duration::from_millis(ms)));
        assert_eq!(spoken.filter(|bytes| !bytes.is_empty()).count(), 4);
    }

    #[test]
    fn what_nobody_fetches_takes_no_more_memory() {
        let (mut session, _) = logged(usize::MAX);
        for _ in 0..3000 {
            session.receive(&status(), Instant::now());
        }
        let figures = session.desk().figures();
        let fetched = std::iter::from_fn(|| session.desk().next_message(Duration::ZERO)).count() as u64;
        assert_eq!(fetched + figures.forgotten, 3000);
        assert!(fetched <= 1024);
        assert_eq!((figures.state, figures.temperature), (Some(State::Recording), Some(31.5)));
        let flood = vec![0; 1 << 20];
        assert!(session.desk().send(&flood).is_ok() && session.desk().send(b"more").is_err());
    }

    #[test]
    fn figures_tell_the_rate_of_the_last_second_and_that_of_the_devices_clock() {
        let (mut session, _) = logged(usize::MAX);
        let start = Instant::now();
        for frame in 0..400_u32 {
            session.receive(&data(25 * frame), start + Duration::from_millis(u64::from(frame) * 5));
        }
        let figures = session.desk().figures();
        assert!((figures.rate_hz / 5000.0 - 1.0).abs() < 0.06, "{}", figures.rate_hz);
        assert!(figures.device_rate_hz.is_some_and(|rate| (rate - 5000.0).abs() < 1e-6));
        assert_eq!((figures.run, figures.received, figures.missing), (Some(7), 10_000, 0));
    }
}
