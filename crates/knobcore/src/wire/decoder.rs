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
