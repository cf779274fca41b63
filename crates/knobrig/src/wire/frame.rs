//! A frame: header, body and check sum, stuffed (Cheshire & Baker 1999, COBS) so that a zero byte ends it
//! and stands nowhere else in it.
use super::field::{CHECK, Field, MAX_PLAIN, Reader, Writer};
use super::message::Message;
use arrayvec::ArrayVec;

/// The version that this code speaks.
pub const VERSION: u8 = 1;
/// The byte that ends a frame.
pub const DELIMITER: u8 = 0;
/// Longest frame with its delimiter, bytes on the wire.
pub const MAX_WIRE: usize = cobs::max_encoding_length(MAX_PLAIN) + 1;

/// A frame as it goes over the wire, with its delimiter.
pub type WireBytes = ArrayVec<u8, MAX_WIRE>;

/// What every frame says before its message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Header {
    /// From a device: the index of the first sample of DATA, of the next sample otherwise, counted since
    /// power-up. From a host: the number of the command.
    pub sequence: u32,
    /// The sender's clock, microseconds since its start. Of DATA: the instant of the first sample.
    pub time_us: u64,
}

/// A message with its header.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Place and time.
    pub header: Header,
    /// Content.
    pub message: Message,
}

/// The bytes of a frame, with the delimiter that ends it.
pub fn encode(header: Header, message: &Message) -> WireBytes {
    let mut plain = Writer::new();
    plain.put(&[VERSION, message.kind()]);
    header.sequence.write(&mut plain);
    header.time_us.write(&mut plain);
    message.write(&mut plain);
    let check = crc32fast::hash(plain.written());
    check.write(&mut plain);

    let mut wire = WireBytes::from([DELIMITER; MAX_WIRE]);
    let stuffed = cobs::encode(plain.written(), &mut wire);
    // The encoder leaves a byte there when the last block is full.
    wire[stuffed] = DELIMITER;
    wire.truncate(stuffed + 1);
    wire
}

/// What a decoder finds in a stream.
#[derive(Debug, Clone, PartialEq)]
// A frame is handed over in place and at once; nobody keeps a list of events.
#[allow(clippy::large_enum_variant)]
pub enum Event {
    /// A whole frame.
    Frame(Frame),
    /// These bytes, the delimiter included, are no frame.
    Corrupt {
        /// How many.
        bytes: usize,
    },
    /// A whole frame of a sender that speaks another version.
    Foreign {
        /// Which.
        version: u8,
    },
    /// A whole frame of a type that is unknown, or with a body that is not one of its type.
    Unknown {
        /// Its place and time.
        header: Header,
        /// Number of its type.
        kind: u8,
    },
}

/// Opens what stood between two delimiters, overwriting it; none if that is no frame.
pub(super) fn open(stuffed: &mut [u8]) -> Option<Event> {
    let length = cobs::decode_in_place(stuffed).ok()?;
    let (covered, check) = stuffed.get(..length)?.split_last_chunk::<CHECK>()?;
    if crc32fast::hash(covered) != u32::from_le_bytes(*check) {
        return None;
    }
    let (&version, rest) = covered.split_first()?;
    if version != VERSION {
        return Some(Event::Foreign { version });
    }
    let mut from = Reader(rest);
    let kind = u8::read(&mut from)?;
    let header = Header { sequence: u32::read(&mut from)?, time_us: u64::read(&mut from)? };
    Some(match Message::read(kind, from.0) {
        Some(message) => Event::Frame(Frame { header, message }),
        None => Event::Unknown { header, kind },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::field::HEADER;
    use crate::wire::message::Bytes;

    fn chunk(bytes: usize) -> Message {
        Message::Model {
            total: 0x0101_0101,
            first: 0x0101_0101,
            check: 1,
            bytes: vec![7; bytes][..].try_into().unwrap(),
        }
    }

    #[test]
    fn a_frame_of_any_length_ends_with_its_only_zero() {
        let header = Header { sequence: 0x0101_0101, time_us: 0x0101_0101_0101_0101 };
        for bytes in 0..=Bytes::new().capacity() {
            let wire = encode(header, &chunk(bytes));
            let (last, before) = wire.split_last().unwrap();
            assert!(*last == DELIMITER && !before.contains(&DELIMITER), "{bytes} bytes");
            let frame = Frame { header, message: chunk(bytes) };
            assert_eq!(open(&mut before.to_vec()), Some(Event::Frame(frame)));
        }
    }

    #[test]
    fn a_frame_needs_a_whole_header_and_check_sum() {
        for length in 0..HEADER {
            let plain = &[VERSION; HEADER][..length];
            let check = crc32fast::hash(plain).to_le_bytes();
            let event = open(&mut cobs::encode_vec(&[plain, &check].concat()));
            assert_eq!(event, None, "{length} bytes");
        }
    }
}
