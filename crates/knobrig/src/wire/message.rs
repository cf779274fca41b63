//! Every message of the protocol: its number, its fields, in the order in which they stand in the body.
use super::descriptor::Descriptor;
use super::field::{Field, MAX_BODY, Reader, Text, Writer, choice};
use super::sample::{Point, Sample};
use super::state::State;
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

/// Samples of a DATA frame. Devices send 25 at 5 kHz: 273 bytes on the wire, 55 kB/s.
pub type Samples = ArrayVec<Sample, { (MAX_BODY - 2) / Sample::BYTES }>;
/// Points of one chunk of a motion.
pub type Points = ArrayVec<Point, { (MAX_BODY - 12) / Point::BYTES }>;
/// Bytes of one chunk of a model file.
pub type Bytes = ArrayVec<u8, { MAX_BODY - 12 }>;

choice! {
    /// Where the torque comes from.
    pub enum Mode {
        /// The uploaded motion drives the knob.
        Drive = 0,
        /// The uploaded model is rendered to the hand.
        Render = 1,
        /// The uploaded model is rendered while the uploaded motion moves the knob.
        RenderDriven = 2,
        /// The host commands the torque.
        Commanded = 3,
    }
}

macro_rules! messages {
    ($($(#[$about:meta])* $kind:literal $name:ident $({ $($(#[$what:meta])* $field:ident: $type:ty,)* })?)*) => {
        /// A message without its frame. Whatever can be built fits a frame.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "type", rename_all = "SCREAMING_SNAKE_CASE", deny_unknown_fields)]
        // In place on purpose: a device has no heap, and a host makes a few hundred in a second.
        #[allow(clippy::large_enum_variant)]
        pub enum Message {
            $($(#[$about])* $name $({ $($(#[$what])* $field: $type,)* })?,)*
        }

        impl Message {
            /// The number of the message's type.
            pub fn kind(&self) -> u8 {
                match self {
                    $(Self::$name { .. } => $kind,)*
                }
            }

            pub(super) fn write(&self, out: &mut Writer) {
                match self {
                    $(Self::$name $({ $($field,)* })? => { $($($field.write(out);)*)? })*
                }
            }

            /// Reads a whole body; none where the number is no type or the body is not one of it.
            pub(super) fn read(kind: u8, body: &[u8]) -> Option<Self> {
                let mut from = Reader(body);
                let message = match kind {
                    $($kind => Self::$name $({ $($field: <$type>::read(&mut from)?,)* })?,)*
                    _ => return None,
                };
                from.is_empty().then_some(message)
            }
        }
    };
}

messages! {
    /// Are you there? Answered by PONG.
    0x01 Ping
    /// What are you? Answered by DESCRIPTOR and STATUS, and by FAULT where one is latched.
    0x02 Describe
    /// Starts a run: recording and, where armed, torque.
    0x03 Start {
        /// Samples of the run; 0: until STOP.
        samples: u32,
    }
    /// Ends the run.
    0x04 Stop
    /// A part of a motion that is uploaded ahead, one point per sample.
    0x05 Excite {
        /// Points of the whole motion.
        total: u32,
        /// Place of the first point of this chunk.
        first: u32,
        /// CRC-32 of all points of the motion, as they stand in the chunks.
        check: u32,
        /// The points of this chunk.
        points: Points,
    }
    /// A part of a model file that is uploaded ahead.
    0x06 Model {
        /// Bytes of the whole file.
        total: u32,
        /// Place of the first byte of this chunk.
        first: u32,
        /// CRC-32 of the whole file.
        check: u32,
        /// The bytes of this chunk.
        bytes: Bytes,
    }
    /// Allows torque from the next START on.
    0x07 Arm {
        /// Where the torque comes from.
        mode: Mode,
        /// Greatest torque, N m; not above the descriptor's.
        torque_limit: f32,
        /// Greatest change of torque, N m/s; not above the descriptor's.
        torque_rate_limit: f32,
    }
    /// Torque to zero at once; ends an armed run.
    0x08 Disarm
    /// The host is alive. Never answered.
    0x09 Heartbeat
    /// Torque until the next one, in mode `Commanded`. Never answered.
    0x0A Torque {
        /// Torque, N m.
        torque: f32,
    }
    /// Forgets a latched fault. Never arms.
    0x0B Clear
    /// What the device is.
    0x81 Descriptor {
        /// All of it.
        device: Descriptor,
    }
    /// Samples; the sequence of the frame is the index of the first, its time is that sample's.
    0x82 Data {
        /// Number of the run.
        run: u16,
        /// Consecutive samples.
        samples: Samples,
    }
    /// A run has started.
    0x83 Started {
        /// Number of the run: different from those before it, also over a power-up.
        run: u16,
        /// Index of its first sample.
        first: u32,
    }
    /// A run has ended; the sequence of the frame is the index after its last sample.
    0x84 Stopped {
        /// Number of the run.
        run: u16,
        /// Samples that the run has.
        produced: u32,
        /// Samples of these that went into DATA frames; the others were dropped on the device.
        sent: u32,
    }
    /// How the device is.
    0x85 Status {
        /// Its state.
        state: State,
        /// Temperature, degrees Celsius; NaN where it is not measured.
        temperature: f32,
        /// Sum of `flag` bits.
        flags: u16,
    }
    /// A command was carried out.
    0x86 Ack {
        /// Its number.
        command: u32,
    }
    /// A command was refused and changed nothing.
    0x87 Nak {
        /// Its number.
        command: u32,
        /// Why, one of `refusal`.
        code: u16,
        /// Why, for a person.
        text: Text,
    }
    /// The device has set its torque to zero and keeps it there until CLEAR.
    0x88 Fault {
        /// Why, one of `fault`.
        code: u16,
        /// Why, for a person.
        text: Text,
    }
    /// I am here.
    0x89 Pong {
        /// Number of the PING.
        command: u32,
    }
}

impl Message {
    /// Whether it goes from the host to the device.
    pub fn is_command(&self) -> bool {
        self.kind() & 0x80 == 0
    }
}

/// Bits of `Message::Status`.
pub mod flag {
    /// A whole motion is there.
    pub const MOTION: u16 = 1;
    /// A whole model is there.
    pub const MODEL: u16 = 2;
    /// Torque was at a limit since the last STATUS.
    pub const LIMITED: u16 = 4;
    /// Samples were dropped on the device since the last STATUS.
    pub const DROPPED: u16 = 8;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_type_is_unreadable() {
        assert_eq!(Message::read(0x00, &[]), None);
        assert_eq!(Message::read(0x7F, &[]), None);
    }

    #[test]
    fn a_body_of_another_length_is_unreadable() {
        assert_eq!(Message::read(0x03, &[1, 0, 0, 0]), Some(Message::Start { samples: 1 }));
        assert_eq!(Message::read(0x03, &[1, 0, 0]), None);
        assert_eq!(Message::read(0x03, &[1, 0, 0, 0, 0]), None);
        assert_eq!(Message::read(0x01, &[0]), None);
        assert_eq!(Message::read(0x82, &[0; 2 + 15]), None);
    }

    #[test]
    fn an_unknown_mode_is_unreadable() {
        assert!(Message::read(0x07, &[3, 0, 0, 0, 0, 0, 0, 0, 0]).is_some());
        assert!(Message::read(0x07, &[4, 0, 0, 0, 0, 0, 0, 0, 0]).is_none());
    }

    #[test]
    fn the_high_bit_of_a_type_says_who_speaks() {
        assert!(Message::Clear.is_command());
        assert!(!Message::Pong { command: 0 }.is_command());
    }
}
