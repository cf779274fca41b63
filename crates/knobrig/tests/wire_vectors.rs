//! Every message stands on the wire byte for byte as `tests/wire/vectors.toml` says, which a second
//! implementation of docs/wire-protocol.md made (`tests/wire/make_vectors.py`).

use knobcore::random::Noise;
use knobrig::wire::{Decoder, Event, Frame, Header, MAX_WIRE, Message, encode};
use serde::Deserialize;
use std::collections::BTreeSet;

#[derive(Deserialize)]
struct Vectors {
    frame: Vec<Vector>,
}

#[derive(Deserialize)]
struct Vector {
    name: String,
    sequence: u32,
    time_us: u64,
    message: Message,
    hex: String,
}

impl Vector {
    fn header(&self) -> Header {
        Header { sequence: self.sequence, time_us: self.time_us }
    }

    fn wire(&self) -> Vec<u8> {
        let digits = self.hex.as_bytes().chunks(2);
        digits.map(|two| u8::from_str_radix(std::str::from_utf8(two).unwrap(), 16).unwrap()).collect()
    }
}

fn vectors() -> Vec<Vector> {
    toml::from_str::<Vectors>(include_str!("../../../tests/wire/vectors.toml")).unwrap().frame
}

fn events(bytes: &[u8]) -> Vec<Event> {
    let mut events = Vec::new();
    Decoder::new().push(bytes, |event| events.push(event));
    events
}

fn whole(plain: &[u8]) -> Vec<u8> {
    let mut wire = cobs::encode_vec(&[plain, &crc32fast::hash(plain).to_le_bytes()].concat());
    wire.push(0);
    wire
}

/// The frame without its stuffing and check sum.
fn plain(wire: &[u8]) -> Vec<u8> {
    let mut plain = cobs::decode_vec(&wire[..wire.len() - 1]).unwrap();
    plain.truncate(plain.len() - 4);
    plain
}

#[test]
fn every_message_is_written_as_the_vectors_say() {
    for vector in vectors() {
        let wire = encode(vector.header(), &vector.message);
        assert_eq!(wire[..], vector.wire(), "{}", vector.name);
    }
}

#[test]
fn every_message_is_read_as_the_vectors_say() {
    for vector in vectors() {
        let expected = Event::Frame(Frame { header: vector.header(), message: vector.message.clone() });
        // Not ==: a temperature that is not measured is NaN.
        assert_eq!(format!("{:?}", events(&vector.wire())), format!("{:?}", [expected]), "{}", vector.name);
    }
}

#[test]
fn the_vectors_show_every_type_of_message() {
    let shown: BTreeSet<u8> = vectors().iter().map(|vector| vector.message.kind()).collect();
    let types: BTreeSet<u8> = (0x01..=0x0B).chain(0x81..=0x89).collect();
    assert_eq!(shown, types);
}

#[test]
fn a_batch_of_25_samples_takes_at_most_273_bytes_and_the_longest_frame_fits() {
    let length = |name: &str| vectors().iter().find(|vector| vector.name == name).unwrap().wire().len();
    assert!((272..=273).contains(&length("data, 25 samples")));
    assert!((1020..=MAX_WIRE).contains(&length("model, the longest chunk")));
}

#[test]
fn no_beginning_of_a_frame_is_a_frame() {
    for vector in vectors() {
        let wire = vector.wire();
        for length in 1..wire.len() - 1 {
            let cut = [&wire[..length], &[0]].concat();
            assert_eq!(events(&cut), [Event::Corrupt { bytes: length + 1 }], "{}", vector.name);
        }
    }
}

#[test]
fn no_frame_with_a_flipped_bit_is_a_frame() {
    for vector in vectors() {
        let wire = vector.wire();
        for bit in 0..8 * wire.len() {
            let mut flipped = wire.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let events = events(&flipped);
            assert!(events.iter().all(|event| matches!(event, Event::Corrupt { .. })), "{}", vector.name);
        }
    }
}

#[test]
fn another_version_is_recognised_as_such() {
    for vector in vectors() {
        for version in [0, 2, 255] {
            let mut other = plain(&vector.wire());
            other[0] = version;
            assert_eq!(events(&whole(&other)), [Event::Foreign { version }]);
        }
    }
}

#[test]
fn an_unknown_type_and_a_body_of_another_length_are_told_apart_from_damage() {
    for vector in vectors() {
        let (header, mut other) = (vector.header(), plain(&vector.wire()));
        other[1] = 0x7E;
        assert_eq!(events(&whole(&other)), [Event::Unknown { header, kind: 0x7E }]);
        let kind = vector.message.kind();
        let longer = [plain(&vector.wire()), vec![0]].concat();
        let lists = matches!(vector.message, Message::Model { .. });
        assert!(lists || events(&whole(&longer)) == [Event::Unknown { header, kind }], "{}", vector.name);
    }
}

#[test]
fn whatever_can_be_read_is_written_back_byte_for_byte() {
    let (mut noise, mut read) = (Noise::new(11), 0);
    for vector in vectors() {
        for _ in 0..300 {
            let mut changed = plain(&vector.wire());
            for _ in 0..1 + noise.bits() % 6 {
                let at = 2 + noise.bits() as usize % (changed.len() - 2);
                changed[at] = noise.bits() as u8;
            }
            let wire = whole(&changed);
            match &events(&wire)[..] {
                [Event::Frame(frame)] => {
                    assert_eq!(encode(frame.header, &frame.message)[..], wire);
                    read += 1;
                }
                [Event::Unknown { .. }] => {}
                other => panic!("{}: {other:?}", vector.name),
            }
        }
    }
    assert!(read > 3000, "only {read} of the changed frames could be read");
}

#[test]
fn a_stream_may_be_cut_anywhere() {
    let stream: Vec<u8> = vectors().iter().flat_map(Vector::wire).collect();
    let mut noise = Noise::new(12);
    for _ in 0..50 {
        let (mut decoder, mut frames, mut rest) = (Decoder::new(), 0, &stream[..]);
        while !rest.is_empty() {
            let (piece, after) = rest.split_at((noise.bits() as usize % 40).min(rest.len()));
            decoder.push(piece, |event| frames += usize::from(matches!(event, Event::Frame(_))));
            rest = after;
        }
        assert_eq!((frames, decoder.pending()), (vectors().len(), 0));
    }
}
