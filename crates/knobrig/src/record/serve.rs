//! A thread that owns a port: it waits for bytes from either side and needs nobody else to go on.
use super::session::Session;
use knobcore::error::{Error, Result};
use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};
use rustix::io::{Errno, ioctl_fionbio, read, write};
use std::os::fd::{AsFd, OwnedFd};
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
use std::time::Instant;

/// Bytes that are read at once: a third of a second at 5 kHz.
const CHUNK: usize = 1 << 14;

/// Tells the thread that there is something to do.
#[derive(Clone)]
pub struct Waker(Arc<OwnedFd>);

impl Waker {
    /// Wakes the thread.
    pub fn wake(&self) {
        // A counter that is full wakes as well.
        let _ = write(&*self.0, &1_u64.to_ne_bytes());
    }
}

/// Serves a session on a port until the host stops it or the port is gone.
///
/// # Errors
/// Where the system has no thread or no descriptor to spare.
pub fn serve(session: Session, port: OwnedFd) -> Result<(Waker, JoinHandle<()>)> {
    let refused = |error: std::io::Error| Error::invalid("recorder", error.to_string());
    let bell = eventfd(0, EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC).map_err(|e| refused(e.into()))?;
    ioctl_fionbio(&port, true).map_err(|error| refused(error.into()))?;
    let waker = Waker(Arc::new(bell));
    let bell = waker.0.clone();
    let thread = Builder::new().name("knobcam-recorder".into()).spawn(move || {
        let desk = session.desk().clone();
        desk.end(attend(session, &port, &bell));
    });
    Ok((waker, thread.map_err(refused)?))
}

/// Goes on until there is a reason not to.
fn attend(mut session: Session, port: &OwnedFd, bell: &OwnedFd) -> String {
    let mut buffer = [0; CHUNK];
    let mut unsent = Vec::new();
    loop {
        let last = session.desk().stopping();
        unsent.append(&mut session.outgoing(Instant::now()));
        if !unsent.is_empty() {
            match write(port, &unsent) {
                Ok(sent) => drop(unsent.drain(..sent)),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return gone(error),
            }
        }
        if last {
            return "the recorder was stopped".into();
        }
        let events = if unsent.is_empty() { PollFlags::IN } else { PollFlags::IN | PollFlags::OUT };
        let mut waiting = [PollFd::new(port, events), PollFd::new(bell, PollFlags::IN)];
        let rest = Timespec::try_from(session.rest(Instant::now())).ok();
        match poll(&mut waiting, rest.as_ref()) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(error) => return gone(error),
        }
        let [port_events, bell_events] = waiting.map(|fd| fd.revents());
        if bell_events.contains(PollFlags::IN) {
            let _ = read(bell.as_fd(), &mut [0; 8]);
        }
        if port_events.intersects(PollFlags::IN | PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL) {
            match read(port, &mut buffer) {
                // A port that is ready and has nothing was closed at the other end.
                Ok(0) => return "the device is gone (end of file)".into(),
                Ok(count) => session.receive(&buffer[..count], Instant::now()),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return gone(error),
            }
        }
    }
}

fn gone(error: Errno) -> String {
    format!("the device is gone ({})", std::io::Error::from(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Desk;
    use crate::wire::{Header, Message, encode};
    use std::io::{Read, Write};
    use std::os::unix::net::UnixStream;
    use std::time::Duration;

    fn served() -> (UnixStream, Arc<Desk>, Waker, JoinHandle<()>) {
        let (rig, port) = UnixStream::pair().unwrap();
        let desk = Arc::new(Desk::default());
        let (waker, thread) = serve(Session::new(desk.clone(), Instant::now()), port.into()).unwrap();
        (rig, desk, waker, thread)
    }

    #[test]
    fn bytes_go_both_ways() {
        let (mut rig, desk, waker, thread) = served();
        desk.send(b"question").unwrap();
        waker.wake();
        let mut heard = [0; 8];
        rig.read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"question");
        rig.write_all(&encode(Header::default(), &Message::Pong { command: 5 })).unwrap();
        let frame = desk.next_message(Duration::from_secs(5)).unwrap();
        assert_eq!(frame.message, Message::Pong { command: 5 });
        desk.stop();
        waker.wake();
        thread.join().unwrap();
        assert!(desk.figures().ended.unwrap().contains("stopped"));
    }

    #[test]
    fn a_port_that_is_gone_ends_it_and_whoever_waits_is_told_at_once() {
        let (rig, desk, _waker, thread) = served();
        drop(rig);
        assert!(desk.next_message(Duration::from_secs(60)).is_none());
        thread.join().unwrap();
        assert!(desk.figures().ended.unwrap().contains("gone"));
    }
}
