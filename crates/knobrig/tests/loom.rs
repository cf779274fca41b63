//! Recorder and host meet at a desk: every order in which their threads can do so, by loom.
//!
//! `python3 dev.py orders` runs these.

use knobrig::record::{Desk, Session};
use knobrig::wire::{Header, Message, State, encode};
use loom::thread;
use std::io::{Result, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Loom's clock stands still: whoever waits for so long waits for ever, unless somebody wakes him.
const FOR_EVER: Duration = Duration::from_secs(1 << 20);

fn status(sequence: u32) -> Vec<u8> {
    let message = Message::Status { state: State::Idle, temperature: 25.0, flags: 0 };
    encode(Header { sequence, time_us: 0 }, &message).to_vec()
}

/// A file that others look into.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// What the recorder does on a thread of its own, beside what the host does.
fn beside(recorder: fn(&mut Session), host: fn(&Desk)) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(3);
    model.check(move || {
        let desk = Arc::new(Desk::default());
        let mut session = Session::new(desk.clone(), Instant::now());
        let thread = thread::spawn(move || recorder(&mut session));
        host(&desk);
        thread.join().unwrap();
    });
}

#[test]
fn whoever_waits_is_woken_by_what_comes_and_hears_it_once_and_in_order() {
    beside(
        |session| (1..3).for_each(|n| session.receive(&status(n), Instant::now())),
        |desk| {
            let heard = [1, 2].map(|_| desk.next_message(FOR_EVER).map(|frame| frame.header.sequence));
            assert_eq!(heard, [Some(1), Some(2)]);
            assert!(desk.next_message(Duration::ZERO).is_none());
        },
    );
}

#[test]
fn the_ring_forgets_the_oldest_and_counts_it_and_nothing_is_heard_twice() {
    beside(
        |session| {
            (1..5).for_each(|n| session.receive(&status(n), Instant::now()));
            session.desk().end("over");
        },
        |desk| {
            let heard: Vec<u32> = std::iter::from_fn(|| desk.next_message(FOR_EVER))
                .map(|frame| frame.header.sequence)
                .collect();
            assert!(heard.is_sorted_by(|a, b| a < b), "{heard:?}");
            assert_eq!(heard.last(), Some(&4));
            assert_eq!(heard.len() as u64 + desk.figures().forgotten, 4);
        },
    );
}

#[test]
fn whoever_waits_is_told_that_nothing_comes_any_more() {
    beside(
        |session| session.desk().end("unplugged"),
        |desk| {
            assert!(desk.next_message(FOR_EVER).is_none());
            assert_eq!(desk.figures().ended.as_deref(), Some("unplugged"));
        },
    );
}

#[test]
fn a_log_that_is_changed_while_bytes_come_counts_its_own_bytes_alone() {
    beside(
        |session| (1..4).for_each(|n| session.receive(&status(n), Instant::now())),
        |desk| {
            let [one, other] = [Shared::default(), Shared::default()];
            desk.log_to(Some(Box::new(one.clone())));
            desk.log_to(Some(Box::new(other.clone())));
            while desk.figures().frames < 3 {
                thread::yield_now();
            }
            let [one, other] = [one, other].map(|log| log.0.lock().unwrap().len());
            assert_eq!(desk.figures().logged, other as u64, "{one} bytes in the log before");
        },
    );
}

#[test]
fn what_the_host_sends_goes_out_once_and_in_order() {
    beside(
        |session| {
            let mut sent = Vec::new();
            while sent.len() < 4 {
                sent.append(&mut session.outgoing(Instant::now()));
                thread::yield_now();
            }
            assert_eq!(sent, b"abcd");
        },
        |desk| [b"ab", b"cd"].iter().for_each(|bytes| desk.send(*bytes).unwrap()),
    );
}

#[test]
fn heartbeats_end_with_the_session_also_where_they_are_asked_for_later() {
    beside(
        |session| {
            session.desk().end("unplugged");
            let mut sent = Vec::new();
            while sent.is_empty() {
                sent.append(&mut session.outgoing(Instant::now()));
                thread::yield_now();
            }
            assert_eq!(sent, b"x");
        },
        |desk| {
            desk.beat_until(Some(Instant::now() + FOR_EVER));
            desk.send(b"x").unwrap();
        },
    );
}
