//! A million DATA frames over a bad line. The injector keeps books of its own, from what it wrote alone;
//! decoder and ledger have to come to the same.

use knobcore::random::Noise;
use knobrig::wire::{Account, Decoder, Event, Header, Ledger, Message, Sample, Samples, encode};

const FRAMES: u32 = 1_000_000;
const RUNS: u32 = 20;
const BATCH: u32 = 25;
const PERIOD_US: u64 = 200;

/// What the device measured: different for every run and index.
fn sample(run: u16, index: u32) -> Sample {
    let bits = Noise::new(u64::from(run) << 32 | u64::from(index)).bits();
    Sample {
        count: bits as i32,
        omega: (bits >> 32) as i16,
        alpha: (bits >> 40) as i16,
        tau: (bits >> 48) as i16,
    }
}

fn wire(index: u32, message: &Message) -> Vec<u8> {
    encode(Header { sequence: index, time_us: u64::from(index) * PERIOD_US }, message).to_vec()
}

/// What the injector knows about a run.
struct Books {
    run: u16,
    first: u32,
    produced: u32,
    sent: u32,
    /// Whether each sample came.
    came: Vec<bool>,
    /// Place after the last sample that came so far.
    reached: usize,
    late: u64,
    duplicate: u64,
}

impl Books {
    fn arrived(&mut self, index: u32) {
        let place = (index - self.first) as usize;
        for place in place..place + BATCH as usize {
            if self.came[place] {
                self.duplicate += 1;
            } else {
                self.came[place] = true;
                self.late += u64::from(place < self.reached);
            }
        }
        self.reached = self.reached.max(place + BATCH as usize);
    }

    fn account(&self) -> Account {
        let missing = self.came.iter().filter(|&&came| !came).count() as u64;
        let gaps =
            (0..self.came.len()).filter(|&at| !self.came[at] && (at == 0 || self.came[at - 1])).count();
        let run_of_missing = |mut places: Box<dyn Iterator<Item = &bool>>| {
            places.position(|&came| came).unwrap_or(self.came.len()) as u64
        };
        let dropped = u64::from(self.produced - self.sent);
        Account {
            received: u64::from(self.produced) - missing,
            late: self.late,
            duplicate: self.duplicate,
            stale: 0,
            stray: 0,
            contradicted: 0,
            missing,
            gaps: gaps as u64,
            missing_head: run_of_missing(Box::new(self.came.iter())),
            missing_tail: run_of_missing(Box::new(self.came.iter().rev())),
            produced: Some(self.produced.into()),
            dropped_on_device: Some(dropped),
            lost_on_the_way: Some(missing - dropped),
        }
    }
}

/// A line that damages what is written to it and remembers what stands on it unharmed.
struct Line {
    noise: Noise,
    bytes: Vec<u8>,
    /// Begin and index of every frame that was written whole.
    unharmed: Vec<(usize, u32)>,
    /// Frames that wait for later ones to pass, and how many.
    held: Vec<(u64, u32, Vec<u8>)>,
    /// How often each of the kinds of damage was done.
    done: [u32; 8],
}

impl Line {
    fn below(&mut self, end: usize) -> usize {
        (self.noise.bits() % end as u64) as usize
    }

    fn whole(&mut self, index: u32, wire: &[u8]) {
        self.unharmed.push((self.bytes.len(), index));
        self.bytes.extend(wire);
    }

    fn garbage(&mut self) {
        for _ in 0..1 + self.below(40) {
            let byte = self.noise.bits() as u8;
            self.bytes.push(byte);
        }
    }

    fn write(&mut self, index: u32, mut wire: Vec<u8>) {
        let kind = if self.noise.uniform() < 0.7 { 0 } else { 1 + self.below(7) };
        self.done[kind] += 1;
        match kind {
            0 => self.whole(index, &wire),
            1 => {
                let flips = 1 + self.below(8);
                let bits: std::collections::BTreeSet<_> =
                    (0..flips).map(|_| self.below(8 * wire.len())).collect();
                bits.into_iter().for_each(|bit| wire[bit / 8] ^= 1 << (bit % 8));
                self.bytes.extend(wire);
            }
            2 => {}
            3 => {
                self.whole(index, &wire);
                self.whole(index, &wire);
            }
            4 => {
                let passed_by = 1 + self.noise.bits() % 6;
                self.held.push((passed_by, index, wire));
                return;
            }
            5 => {
                let cut = 1 + self.below(wire.len() - 1);
                if self.noise.uniform() < 0.5 {
                    wire.truncate(cut);
                } else {
                    wire.drain(..cut);
                }
                self.bytes.extend(wire);
            }
            6 => {
                self.garbage();
                self.whole(index, &wire);
            }
            _ => {
                let (head, tail) = wire.split_at(1 + self.below(wire.len() - 1));
                self.bytes.extend(head);
                self.garbage();
                self.bytes.extend(tail);
            }
        }
        self.release(1);
    }

    /// Lets so many frames pass those that are held, and writes those that have waited for enough.
    fn release(&mut self, passed: u64) {
        for (left, index, wire) in std::mem::take(&mut self.held) {
            if left <= passed {
                self.whole(index, &wire);
            } else {
                self.held.push((left - passed, index, wire));
            }
        }
    }

    /// The whole frames, and whether a reader has to find them: a frame directly behind damage that has no
    /// delimiter of its own is lost with it, the next one never is.
    fn readable(&self) -> Vec<(u32, bool)> {
        let ended = |at: usize| at == 0 || self.bytes[at - 1] == 0;
        self.unharmed.iter().map(|&(at, index)| (index, ended(at))).collect()
    }
}

/// Feeds a stretch of the line to the decoder in pieces and the ledger with what it finds; gives the indices
/// of the DATA frames that were found, after a look at every sample that was accepted.
fn read(noise: &mut Noise, bytes: &[u8], decoder: &mut Decoder, ledger: &mut Ledger) -> Vec<u32> {
    let (mut found, mut rest) = (Vec::new(), bytes);
    while !rest.is_empty() {
        let (piece, after) = rest.split_at((1 + noise.bits() as usize % 4096).min(rest.len()));
        rest = after;
        decoder.push(piece, |event| {
            let Event::Frame(frame) = event else { return };
            let Message::Data { run, .. } = frame.message else {
                ledger.enter(&frame, |_| {});
                return;
            };
            found.push(frame.header.sequence);
            ledger.enter(&frame, |piece| {
                for (index, accepted) in (piece.index as u32..).zip(piece.samples) {
                    assert_eq!(*accepted, sample(run, index), "a corrupt sample was accepted");
                }
            });
        });
    }
    found
}

#[test]
fn a_million_frames_over_a_bad_line_are_accounted_for_exactly() {
    let (mut noise, mut decoder, mut ledger) = (Noise::new(1), Decoder::new(), Ledger::exact());
    let mut line = Line { noise: Noise::new(2), bytes: vec![], unharmed: vec![], held: vec![], done: [0; 8] };
    let (mut all, mut index, mut lost_behind_damage) = (Vec::new(), 0, 0);
    for run in 0..RUNS as u16 {
        // In the middle of the session the device loses its power: index and time begin anew.
        index = if run == RUNS as u16 / 2 { 3 } else { index + 1000 };
        let produced = FRAMES / RUNS * BATCH;
        let came = vec![false; produced as usize];
        let mut books =
            Books { run, first: index, produced, sent: produced, came, reached: 0, late: 0, duplicate: 0 };
        line.bytes.extend(wire(index, &Message::Started { run, first: index }));
        for frame in 0..FRAMES / RUNS {
            if noise.uniform() < 0.01 {
                books.sent -= BATCH; // its queue was full
            } else {
                let samples: Samples = (index..index + BATCH).map(|index| sample(run, index)).collect();
                let wire = wire(index, &Message::Data { run, samples });
                line.write(index, wire);
            }
            index += BATCH;
            if frame + 1 == FRAMES / RUNS {
                line.release(u64::MAX);
                line.bytes.push(0);
                line.bytes.extend(wire(index, &Message::Stopped { run, produced, sent: books.sent }));
            }
            if line.bytes.ends_with(&[0]) && (line.bytes.len() > 500_000 || frame + 1 == FRAMES / RUNS) {
                let written = line.readable();
                let expected: Vec<u32> =
                    written.iter().filter(|(_, readable)| *readable).map(|(index, _)| *index).collect();
                assert_eq!(read(&mut noise, &line.bytes, &mut decoder, &mut ledger), expected);
                expected.iter().for_each(|&index| books.arrived(index));
                lost_behind_damage += written.len() - expected.len();
                line.bytes.clear();
                line.unharmed.clear();
            }
        }
        all.push(books);
    }
    assert_eq!(ledger.runs().len(), all.len());
    for (run, books) in ledger.runs().iter().zip(&all) {
        assert_eq!((run.tag, run.account()), (books.run, books.account()));
        let first = run.whole().start;
        assert!(run.gaps().flatten().all(|index| !books.came[(index - first) as usize]));
    }
    assert!(line.done.iter().all(|&count| count > 30_000), "too little damage: {:?}", line.done);
    let damages: u32 = [1, 5, 6, 7].iter().map(|&kind| line.done[kind]).sum();
    assert!(lost_behind_damage > 1000 && lost_behind_damage < damages as usize);
}

#[test]
fn endless_garbage_is_no_frame_and_takes_no_memory() {
    let (mut noise, mut decoder, mut bytes) = (Noise::new(4), Decoder::new(), 0);
    assert!(size_of::<Decoder>() < 1100);
    for _ in 0..2000 {
        let garbage: Vec<u8> = (0..4096).map(|_| noise.bits() as u8).collect();
        decoder.push(&garbage, |event| match event {
            Event::Corrupt { bytes: more } => bytes += more,
            other => panic!("{other:?} out of garbage"),
        });
    }
    decoder.push(&vec![0xFF; 10_000_000], |event| panic!("{event:?} before any delimiter"));
    assert!(bytes > 8_000_000 && decoder.pending() >= 10_000_000);
    let ping = wire(1, &Message::Ping);
    let mut frames = 0;
    for _ in 0..2 {
        decoder.push(&ping, |event| frames += usize::from(matches!(event, Event::Frame(_))));
    }
    assert_eq!(frames, 1, "resynchronised after one frame");
}
