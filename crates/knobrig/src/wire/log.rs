//! A wire log read as a whole: the samples of each run in order, and all else that was said.
use super::decoder::Decoder;
use super::frame::{Event, Frame};
use super::ledger::{Account, Ledger, Piece};
use super::message::Message;
use super::sample::Sample;
use std::ops::Range;

/// The samples of one run that came, by rising index. Those that did not come are absent, never filled.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Number of the run.
    pub tag: u16,
    /// The device's index of the run's first sample (its low 32 bits).
    pub first: u32,
    /// Samples from the start of the run to each sample.
    pub index: Vec<i64>,
    /// Raw samples.
    pub samples: Vec<Sample>,
    /// Missing stretches, in samples from the start of the run.
    pub gaps: Vec<Range<i64>>,
    /// Of each frame that brought something new: samples from the start of the run, device time in us.
    pub stamps: Vec<(i64, u64)>,
    /// Whether the start of the run is known; otherwise it is taken to be the first sample that came.
    pub start_known: bool,
    /// The books.
    pub account: Account,
}

/// Everything that a wire log holds.
#[derive(Debug, Default)]
pub struct Log {
    decoder: Decoder,
    ledger: Ledger,
    pieces: Vec<Vec<Kept>>,
    /// Frames of which some samples had come before: the run, the index of the first sample, all samples.
    again: Vec<(usize, i64, Vec<Sample>)>,
    /// Frames other than DATA, in the order in which they came.
    pub said: Vec<Frame>,
    /// Whole frames of this version, DATA included.
    pub frames: u64,
    /// Stretches between delimiters that were no frame.
    pub corrupt: u64,
    /// Their bytes.
    pub corrupt_bytes: u64,
    /// Whole frames of a type that is unknown.
    pub unknown: u64,
    /// Whole frames of another version: how many, and the last one's version.
    pub foreign: Option<(u64, u8)>,
}

#[derive(Debug)]
struct Kept {
    index: i64,
    stamp: (i64, u64),
    samples: Vec<Sample>,
}

impl Log {
    /// Takes the next bytes of the log, in pieces of any length.
    pub fn push(&mut self, bytes: &[u8]) {
        let Self { decoder, ledger, pieces, again, said, frames, corrupt, corrupt_bytes, unknown, foreign } =
            self;
        decoder.push(bytes, |event| match event {
            Event::Frame(frame) => {
                *frames += 1;
                let before = ledger.enter(&frame, |piece| keep(pieces, piece));
                match (&frame.message, before) {
                    (Message::Data { samples, .. }, Some((run, index))) => {
                        again.push((run, index, samples.to_vec()));
                    }
                    (Message::Data { .. }, None) => {}
                    _ => said.push(frame),
                }
            }
            Event::Corrupt { bytes } => {
                *corrupt += 1;
                *corrupt_bytes += bytes as u64;
            }
            Event::Foreign { version } => {
                *foreign = Some((foreign.map_or(1, |(count, _)| count + 1), version));
            }
            Event::Unknown { .. } => *unknown += 1,
        });
    }

    /// Bytes at the end that are not yet a frame.
    pub fn pending(&self) -> usize {
        self.decoder.pending()
    }

    /// The runs in the order in which they began.
    pub fn recordings(mut self) -> Vec<Recording> {
        self.pieces.resize_with(self.ledger.runs().len(), Vec::new);
        let runs = self.ledger.runs().iter().zip(self.pieces).enumerate();
        runs.map(|(number, (run, mut pieces))| {
            let start = run.whole().start;
            pieces.sort_by_key(|piece| piece.index);
            let mut stamps: Vec<_> =
                pieces.iter().map(|piece| (piece.stamp.0 - start, piece.stamp.1)).collect();
            stamps.dedup();
            let places = |piece: &Kept| piece.index - start..piece.index - start + piece.samples.len() as i64;
            let index: Vec<i64> = pieces.iter().flat_map(places).collect();
            let samples: Vec<Sample> = pieces.into_iter().flat_map(|piece| piece.samples).collect();
            let other = |at: i64, sample: &Sample| {
                index.binary_search(&at).is_ok_and(|place| samples[place] != *sample)
            };
            let again = self.again.iter().filter(|(run, ..)| *run == number);
            let differ = |(_, first, samples): &(usize, i64, Vec<Sample>)| {
                (first - start..).zip(samples).filter(|(at, sample)| other(*at, sample)).count() as u64
            };
            let contradicted = again.map(differ).sum();
            Recording {
                tag: run.tag,
                first: start as u32,
                gaps: run.gaps().map(|gap| gap.start - start..gap.end - start).collect(),
                stamps,
                start_known: run.origin_known(),
                account: Account { contradicted, ..run.account() },
                index,
                samples,
            }
        })
        .collect()
    }
}

fn keep(pieces: &mut Vec<Vec<Kept>>, piece: Piece<'_>) {
    if pieces.len() <= piece.run {
        pieces.resize_with(piece.run + 1, Vec::new);
    }
    pieces[piece.run].push(Kept {
        index: piece.index,
        stamp: (piece.frame_index, piece.frame_time_us),
        samples: piece.samples.to_vec(),
    });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::single_range_in_vec_init)] // a list of one gap is meant
    use super::*;
    use crate::wire::frame::{Header, encode};

    fn sample(index: u32) -> Sample {
        Sample { count: index as i32, omega: 1, alpha: 2, tau: 3 }
    }

    fn data(first: u32) -> Vec<u8> {
        let samples = (first..first + 25).map(sample).collect();
        let header = Header { sequence: first, time_us: u64::from(first) * 200 };
        encode(header, &Message::Data { run: 9, samples }).to_vec()
    }

    fn said(sequence: u32, message: Message) -> Vec<u8> {
        encode(Header { sequence, time_us: u64::from(sequence) * 200 }, &message).to_vec()
    }

    fn read(parts: &[Vec<u8>]) -> Log {
        let mut log = Log::default();
        parts.iter().for_each(|part| log.push(part));
        log
    }

    #[test]
    fn samples_stand_in_order_and_a_gap_stays_a_gap() {
        let stopped = Message::Stopped { run: 9, produced: 125, sent: 125 };
        let log = read(&[
            said(100, Message::Started { run: 9, first: 100 }),
            data(150),
            data(100),
            data(175),
            said(225, stopped),
        ]);
        let [run] = &log.recordings()[..] else { panic!("one run") };
        assert_eq!((run.first, run.start_known), (100, true));
        assert_eq!(run.gaps, [25..50, 100..125]);
        let expected: Vec<i64> = (0..25).chain(50..100).collect();
        assert_eq!(run.index, expected);
        assert!(run.samples.iter().zip(&run.index).all(|(have, at)| *have == sample(100 + *at as u32)));
        assert_eq!(run.stamps, [(0, 20_000), (50, 30_000), (75, 35_000)]);
    }

    #[test]
    fn all_that_a_log_holds_is_counted() {
        let log = read(&[data(0), b"noise\0".to_vec(), said(25, Message::Ack { command: 3 }), vec![1, 2, 3]]);
        assert_eq!((log.frames, log.corrupt, log.corrupt_bytes, log.pending()), (2, 1, 6, 3));
        assert_eq!(log.said.len(), 1);
        assert!(!log.recordings()[0].start_known);
    }

    #[test]
    fn two_frames_of_one_index_with_different_content_are_counted_and_the_first_is_kept() {
        let mut other = sample(110);
        other.tau = 7;
        let header = Header { sequence: 110, time_us: 22_000 };
        let changed = encode(header, &Message::Data { run: 9, samples: [other].into_iter().collect() });
        let log = read(&[data(100), data(100), changed.to_vec(), data(125)]);
        let [run] = &log.recordings()[..] else { panic!("one run") };
        assert_eq!((run.account.duplicate, run.account.contradicted), (26, 1));
        assert_eq!(run.samples[10], sample(110));
    }

    #[test]
    fn a_run_of_which_nothing_came_is_one_gap() {
        let log = read(&[said(125, Message::Stopped { run: 9, produced: 25, sent: 25 })]);
        let [run] = &log.recordings()[..] else { panic!("one run") };
        assert_eq!((run.gaps.clone(), run.samples.len()), (vec![0..25], 0));
    }
}
