//! Frames out of a stream of bytes, whatever the stream has suffered.
use super::frame::{DELIMITER, Event, MAX_WIRE, open};

/// Cuts a stream at the delimiters and checks what stands between. Its memory is one frame.
#[derive(Debug, Clone)]
pub struct Decoder {
    /// Bytes since the last delimiter, as far as a frame may be long.
    buffer: [u8; MAX_WIRE],
    /// How many came since then; more than the buffer holds can be no frame.
    length: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { buffer: [0; MAX_WIRE], length: 0 }
    }
}

impl Decoder {
    /// A decoder at the beginning of a stream.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the next bytes of the stream, in pieces of any length, and tells what they complete.
    pub fn push(&mut self, bytes: &[u8], mut tell: impl FnMut(Event)) {
        let mut pieces = bytes.split(|&byte| byte == DELIMITER).peekable();
        while let Some(piece) = pieces.next() {
            self.keep(piece);
            if pieces.peek().is_some()
                && let Some(event) = self.close()
            {
                tell(event);
            }
        }
    }

    /// Bytes since the last delimiter: the beginning of a frame, or of garbage.
    pub fn pending(&self) -> usize {
        self.length
    }

    fn keep(&mut self, piece: &[u8]) {
        let start = self.length.min(MAX_WIRE);
        let kept = piece.len().min(MAX_WIRE - start);
        self.buffer[start..start + kept].copy_from_slice(&piece[..kept]);
        self.length = self.length.saturating_add(piece.len());
    }

    /// What stands before a delimiter; nothing stands between two of them.
    fn close(&mut self) -> Option<Event> {
        let length = std::mem::take(&mut self.length);
        if length == 0 {
            return None;
        }
        let corrupt = Event::Corrupt { bytes: length.saturating_add(1) };
        Some(self.buffer.get_mut(..length).and_then(open).unwrap_or(corrupt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::frame::{Header, encode};
    use crate::wire::message::Message;

    fn events(stream: &[u8]) -> Vec<Event> {
        let mut events = Vec::new();
        Decoder::new().push(stream, |event| events.push(event));
        events
    }

    fn ping() -> Vec<u8> {
        encode(Header::default(), &Message::Ping).to_vec()
    }

    #[test]
    fn nothing_stands_between_two_delimiters() {
        assert_eq!(events(&[0; 100]), []);
        assert_eq!(events(&[&[0, 0], &ping()[..], &[0]].concat()).len(), 1);
    }

    #[test]
    fn a_delimiter_saves_the_frame_behind_garbage() {
        let events = events(&[b"noise\0", &ping()[..]].concat());
        assert_eq!(events[0], Event::Corrupt { bytes: 6 });
        assert!(matches!(events[1], Event::Frame(_)));
    }

    #[test]
    fn the_longest_stretch_that_can_be_a_frame_is_looked_at_and_no_longer_one() {
        for length in [MAX_WIRE - 1, MAX_WIRE, MAX_WIRE + 1, 5 * MAX_WIRE] {
            let mut stream = vec![b'x'; length];
            stream.push(0);
            stream.extend(ping());
            let events = events(&stream);
            assert_eq!(events[0], Event::Corrupt { bytes: length + 1 });
            assert!(matches!(events[1], Event::Frame(_)));
        }
    }
}
