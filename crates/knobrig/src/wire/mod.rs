//! The language between host and rig: what a device sends, what it is told, and how losses are counted.
//!
//! `docs/wire-protocol.md` says the same for those who write firmware. Nothing here does input or output,
//! and nothing but `ledger`, `log` and `upload` uses the heap.
mod command;
mod coverage;
mod decoder;
mod descriptor;
mod field;
mod frame;
mod ledger;
mod log;
mod message;
mod sample;
mod state;
mod upload;

pub use decoder::Decoder;
pub use descriptor::{Channel, Descriptor, Unit, capability};
pub use field::{MAX_BODY, MAX_PLAIN, Serial, Text};
pub use frame::{DELIMITER, Event, Frame, Header, MAX_WIRE, VERSION, WireBytes, encode};
pub use ledger::{Account, Ledger, Piece, Run};
pub use log::{Log, Recording};
pub use message::{Bytes, Message, Mode, Points, Samples, flag};
pub use sample::{Point, Sample};
pub use state::{State, fault, refusal};
pub use upload::{Upload, model_chunks, motion_chunks};
