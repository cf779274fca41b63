//! Where the host and a session meet.
use super::figures::Figures;
use crate::wire::Frame;
use knobcore::error::{Error, Result};
#[cfg(feature = "orders")]
use loom::sync::{Condvar, Mutex, MutexGuard};
use std::collections::VecDeque;
use std::io::Write;
use std::sync::PoisonError;
#[cfg(not(feature = "orders"))]
use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// Messages that wait for the host; a rig says a few in a second. A ring of two is looked through in every order.
const MESSAGES: usize = if cfg!(feature = "orders") { 2 } else { 1024 };
/// Bytes that wait to be sent: more than any window of an upload.
const OUTGOING: usize = 1 << 20;

/// Where a log goes.
pub type LogFile = Box<dyn Write + Send>;

/// What is shared between a session and its host. Nobody keeps it locked while waiting for anything else.
#[derive(Default)]
pub struct Desk {
    papers: Mutex<Papers>,
    news: Condvar,
}

/// All that lies on the desk.
#[derive(Default)]
pub(super) struct Papers {
    pub figures: Figures,
    pub messages: VecDeque<Frame>,
    pub outgoing: Vec<u8>,
    /// A change of logs that the session has not seen yet.
    pub log: Option<Option<LogFile>>,
    /// Until when heartbeats are sent.
    pub beats_until: Option<Instant>,
    pub stop: bool,
}

impl Papers {
    /// Adds a message; the oldest one makes room.
    pub fn tell(&mut self, frame: Frame) {
        if self.messages.len() == MESSAGES {
            self.messages.pop_front();
            self.figures.forgotten += 1;
        }
        self.messages.push_back(frame);
    }
}

impl Desk {
    /// The figures as they stand.
    pub fn figures(&self) -> Figures {
        self.lock().figures.clone()
    }

    /// The next message other than DATA; none where no one comes within `patience` or can come any more.
    pub fn next_message(&self, patience: Duration) -> Option<Frame> {
        // A patience that no clock reaches is one without an end.
        let end = Instant::now().checked_add(patience);
        let mut papers = self.lock();
        while papers.messages.is_empty() && papers.figures.ended.is_none() {
            let left = end.map_or(patience, |end| end.saturating_duration_since(Instant::now()));
            if left.is_zero() {
                break;
            }
            papers = self.news.wait_timeout(papers, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        papers.messages.pop_front()
    }

    /// Lets the session send these bytes.
    ///
    /// # Errors
    /// Where so much waits already that nobody can be listening.
    pub fn send(&self, bytes: &[u8]) -> Result<()> {
        let mut papers = self.lock();
        if papers.outgoing.len() + bytes.len() > OUTGOING {
            return Err(Error::invalid("port", "takes no more bytes; check the cable and the rig"));
        }
        papers.outgoing.extend_from_slice(bytes);
        Ok(())
    }

    /// From now on everything that comes goes into this log, or into none.
    pub fn log_to(&self, log: Option<LogFile>) {
        let mut papers = self.lock();
        papers.figures.log_error = None;
        papers.figures.logged = 0;
        papers.log = Some(log);
    }

    /// Heartbeats are sent until then: a host that hangs does not hold a torque for longer.
    pub fn beat_until(&self, end: Option<Instant>) {
        let mut papers = self.lock();
        // Nobody beats for a session that is over, whoever was first.
        papers.beats_until = end.filter(|_| papers.figures.ended.is_none());
    }

    /// Asks whoever serves the session to stop.
    pub fn stop(&self) {
        self.lock().stop = true;
    }

    pub(super) fn stopping(&self) -> bool {
        self.lock().stop
    }

    /// Nothing comes any more, and why.
    pub fn end(&self, why: impl Into<String>) {
        let mut papers = self.lock();
        papers.beats_until = None;
        papers.figures.ended.get_or_insert(why.into());
        drop(papers);
        self.news.notify_all();
    }

    /// Changes what lies on the desk; whoever waits for a message is told of a new one.
    pub(super) fn write<R>(&self, change: impl FnOnce(&mut Papers) -> R) -> R {
        let mut papers = self.lock();
        let done = change(&mut papers);
        let news = !papers.messages.is_empty();
        drop(papers);
        if news {
            self.news.notify_all();
        }
        done
    }

    fn lock(&self) -> MutexGuard<'_, Papers> {
        self.papers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
