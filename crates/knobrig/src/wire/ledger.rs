//! The books of a session: which samples of which run came, came twice, came late or never came.
use super::coverage::{Coverage, Offer};
use super::frame::{Frame, Header};
use super::message::Message;
use super::sample::Sample;
use std::ops::Range;

/// A device whose clock goes back by more than this was restarted; a frame is never that late. us.
const RESTART_US: u64 = 1_000_000;

/// New samples of one frame, to be written in their place.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Which of `Ledger::runs`.
    pub run: usize,
    /// Index of the first of these samples, counted on from the device's (which wraps after 2^32).
    pub index: i64,
    /// Device time of the frame's first sample, us.
    pub frame_time_us: u64,
    /// Index of the frame's first sample.
    pub frame_index: i64,
    /// The samples, consecutive.
    pub samples: &'a [Sample],
}

/// What the books say of a run; samples, unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Account {
    /// Received, each counted once.
    pub received: u64,
    /// Of these, received after a later one.
    pub late: u64,
    /// Received again and dropped.
    pub duplicate: u64,
    /// Received so late that nobody knows whether it was a duplicate, and dropped.
    pub stale: u64,
    /// Received but outside of what the device says that it produced, and dropped.
    pub stray: u64,
    /// Received again with another content; the first is kept. Known where a log is read as a whole.
    pub contradicted: u64,
    /// Not received, as far as the run's ends are known.
    pub missing: u64,
    /// How many gaps these form.
    pub gaps: u64,
    /// Of the missing, those before the first that was received.
    pub missing_head: u64,
    /// Of the missing, those after the last that was received.
    pub missing_tail: u64,
    /// Produced by the device; known once STOPPED has come.
    pub produced: Option<u64>,
    /// Of the missing, those that the device itself dropped.
    pub dropped_on_device: Option<u64>,
    /// Of the missing, those that were lost on the way.
    pub lost_on_the_way: Option<u64>,
}

/// A run between START and STOPPED.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its number.
    pub tag: u16,
    coverage: Coverage,
    offered: Offer,
    stray: u64,
    /// Whether STARTED or STOPPED has said where it begins.
    origin_known: bool,
    /// Produced and sent, as STOPPED says.
    stopped: Option<(u32, u32)>,
}

impl Run {
    fn new(tag: u16, start: i64, keep: usize) -> Self {
        let coverage = Coverage::new(start, keep);
        Self { tag, coverage, offered: Offer::default(), stray: 0, origin_known: false, stopped: None }
    }

    /// Index of its first sample and the index after its last, as far as is known.
    pub fn whole(&self) -> Range<i64> {
        self.coverage.whole()
    }

    /// Stretches that are missing, by index; in live use those that may still be filled.
    pub fn gaps(&self) -> impl Iterator<Item = Range<i64>> {
        self.coverage.open_gaps()
    }

    /// Whether STARTED or STOPPED has said where it begins.
    pub fn origin_known(&self) -> bool {
        self.origin_known
    }

    /// The books as they stand.
    pub fn account(&self) -> Account {
        let Offer { on_time, late, duplicate, stale } = self.offered;
        let missing = self.coverage.missing();
        let (missing_head, missing_tail) = self.coverage.missing_ends();
        let dropped = self.stopped.map(|(produced, sent)| u64::from(produced.saturating_sub(sent)));
        Account {
            received: on_time + late,
            late,
            duplicate,
            stale,
            stray: self.stray,
            contradicted: 0,
            missing,
            gaps: self.coverage.gap_count(),
            missing_head,
            missing_tail,
            produced: self.stopped.map(|(produced, _)| produced.into()),
            dropped_on_device: dropped,
            lost_on_the_way: dropped.map(|dropped| missing.saturating_sub(dropped)),
        }
    }

    /// The index next to where the run stands whose low 32 bits these are.
    fn unwrap(&self, index: u32) -> i64 {
        let near = self.coverage.whole().end;
        near + i64::from(index.wrapping_sub(near as u32) as i32)
    }

    fn start(&mut self, first: u32) -> bool {
        let (first, whole) = (self.unwrap(first), self.coverage.whole());
        let fits = if self.origin_known { first == whole.start } else { first <= whole.start };
        if fits {
            self.coverage.reach(first..whole.end);
            self.origin_known = true;
        }
        fits
    }

    fn stop(&mut self, next: u32, produced: u32, sent: u32) {
        let end = self.unwrap(next);
        self.coverage.reach(end - i64::from(produced)..end);
        self.origin_known = true;
        self.stopped = Some((produced, sent));
    }

    /// The part of a frame's samples that can belong to the run.
    fn possible(&self, offered: &Range<i64>) -> Range<i64> {
        let whole = self.coverage.whole();
        let from = if self.origin_known { whole.start } else { i64::MIN };
        let to = if self.stopped.is_some() { whole.end } else { i64::MAX };
        let start = offered.start.clamp(from, to);
        start..offered.end.clamp(start, to)
    }
}

/// Takes the frames of a device in the order in which they come and keeps the books of its runs.
#[derive(Debug, Clone)]
pub struct Ledger {
    runs: Vec<Run>,
    /// Where the runs since the device's last power-up begin in `runs`.
    powered: usize,
    keep: usize,
    latest_us: u64,
}

impl Default for Ledger {
    /// Exact books.
    fn default() -> Self {
        Self::exact()
    }
}

impl Ledger {
    /// Exact books, for a log that is read as a whole.
    pub fn exact() -> Self {
        Self { runs: Vec::new(), powered: 0, keep: usize::MAX, latest_us: 0 }
    }

    /// Books in bounded memory, for a capture that is going on: a gap counts as lost for good when
    /// `open_gaps` later ones are open.
    pub fn live(open_gaps: usize) -> Self {
        Self { keep: open_gaps, ..Self::exact() }
    }

    /// All runs in the order in which they began.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Enters a frame; tells the samples that are new, in pieces of consecutive ones. Where some of them came before:
    /// which of `Ledger::runs` that is, and the index of the frame's first sample.
    pub fn enter(&mut self, frame: &Frame, mut tell: impl FnMut(Piece<'_>)) -> Option<(usize, i64)> {
        if frame.message.is_command() {
            return None;
        }
        let Header { sequence, time_us } = frame.header;
        if time_us.saturating_add(RESTART_US) < self.latest_us {
            self.powered = self.runs.len();
            self.latest_us = time_us;
        }
        self.latest_us = self.latest_us.max(time_us);
        match frame.message {
            Message::Started { run, first } => {
                let known = self.find(run);
                if known.is_none_or(|at| !self.runs[at].start(first)) {
                    let at = self.open(run, first);
                    self.runs[at].origin_known = true;
                }
            }
            Message::Stopped { run, produced, sent } => {
                let at = self.find(run).unwrap_or_else(|| self.open(run, sequence.wrapping_sub(produced)));
                self.runs[at].stop(sequence, produced, sent);
            }
            Message::Data { run, ref samples } => {
                let at = self.find(run).unwrap_or_else(|| self.open(run, sequence));
                let run = &mut self.runs[at];
                let frame_index = run.unwrap(sequence);
                let offered = frame_index..frame_index + samples.len() as i64;
                let possible = run.possible(&offered);
                run.stray += (offered.end - offered.start - (possible.end - possible.start)) as u64;
                let offer = run.coverage.fill(possible, |part| {
                    let place = (part.start - frame_index) as usize..(part.end - frame_index) as usize;
                    let samples = &samples[place];
                    let index = part.start;
                    tell(Piece { run: at, index, frame_time_us: time_us, frame_index, samples });
                });
                run.offered += offer;
                return (offer.duplicate > 0).then_some((at, frame_index));
            }
            _ => {}
        }
        None
    }

    /// The latest run of this number since the last power-up.
    fn find(&self, tag: u16) -> Option<usize> {
        let place = self.runs[self.powered..].iter().rposition(|run| run.tag == tag)?;
        Some(self.powered + place)
    }

    fn open(&mut self, tag: u16, start: u32) -> usize {
        self.runs.push(Run::new(tag, start.into(), self.keep));
        self.runs.len() - 1
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::single_range_in_vec_init)] // a list of one gap is meant
    use super::*;
    use crate::wire::message::Samples;

    fn frame(sequence: u32, message: Message) -> Frame {
        Frame { header: Header { sequence, time_us: u64::from(sequence) * 200 }, message }
    }

    fn data(run: u16, first: u32, count: usize) -> Frame {
        let samples: Samples = (0..count)
            .map(|i| Sample { count: first.wrapping_add(i as u32) as i32, omega: 0, alpha: 0, tau: 0 })
            .collect();
        frame(first, Message::Data { run, samples })
    }

    fn started(run: u16, first: u32) -> Frame {
        frame(first, Message::Started { run, first })
    }

    fn stopped(run: u16, next: u32, produced: u32, sent: u32) -> Frame {
        frame(next, Message::Stopped { run, produced, sent })
    }

    fn entered(frames: &[Frame]) -> Ledger {
        let mut ledger = Ledger::exact();
        for frame in frames {
            ledger.enter(frame, |piece| {
                assert_eq!(piece.samples[0].count, piece.index as u32 as i32);
            });
        }
        ledger
    }

    #[test]
    fn a_run_without_loss_misses_nothing() {
        let ledger = entered(&[started(7, 100), data(7, 100, 25), data(7, 125, 25), stopped(7, 150, 50, 50)]);
        let account = ledger.runs()[0].account();
        assert_eq!((account.received, account.missing, account.gaps), (50, 0, 0));
        assert_eq!(account.lost_on_the_way, Some(0));
    }

    #[test]
    fn what_the_device_dropped_is_told_from_what_the_way_lost() {
        let ledger = entered(&[
            started(7, 0),
            data(7, 0, 25),
            // 25..50 never sent; 50..75 lost; 75..100 lost, the tail.
            stopped(7, 100, 100, 75),
        ]);
        let account = ledger.runs()[0].account();
        assert_eq!((account.missing, account.missing_tail), (75, 75));
        assert_eq!((account.dropped_on_device, account.lost_on_the_way), (Some(25), Some(50)));
    }

    #[test]
    fn late_and_repeated_frames_are_taken_once() {
        let ledger = entered(&[
            started(7, 0),
            data(7, 25, 25),
            data(7, 0, 25),
            data(7, 0, 25),
            stopped(7, 75, 75, 75),
            data(7, 50, 25),
        ]);
        let account = ledger.runs()[0].account();
        assert_eq!((account.received, account.late, account.duplicate), (75, 50, 25));
        assert_eq!(account.missing, 0);
    }

    #[test]
    fn stopped_alone_tells_where_a_run_began() {
        let ledger = entered(&[data(7, 50, 25), stopped(7, 100, 100, 100)]);
        let account = ledger.runs()[0].account();
        assert_eq!((account.missing_head, account.missing_tail), (50, 25));
        let nothing_came = entered(&[stopped(7, 100, 100, 100)]);
        assert_eq!(nothing_came.runs()[0].account().missing, 100);
    }

    #[test]
    fn samples_outside_of_a_run_are_not_taken() {
        let ledger = entered(&[started(7, 50), data(7, 40, 25), stopped(7, 100, 50, 50), data(7, 90, 25)]);
        let account = ledger.runs()[0].account();
        assert_eq!((account.received, account.stray), (25, 25));
    }

    #[test]
    fn runs_are_told_apart_by_their_number_even_when_frames_cross() {
        let ledger = entered(&[started(7, 0), data(8, 50, 25), data(7, 0, 25), started(8, 50)]);
        assert_eq!(ledger.runs().iter().map(|run| run.tag).collect::<Vec<_>>(), [7, 8]);
        assert!(ledger.runs().iter().all(|run| run.account().received == 25 && run.origin_known()));
    }

    #[test]
    fn a_restarted_device_begins_a_new_run_even_under_an_old_number() {
        let ledger = entered(&[started(1, 20_000), data(1, 20_000, 25), data(1, 0, 25)]);
        assert_eq!(ledger.runs().iter().map(Run::whole).collect::<Vec<_>>(), [20_000..20_025, 0..25]);
        let ledger = entered(&[started(1, 100), data(1, 100, 25), started(1, 0), data(1, 0, 25)]);
        assert_eq!(ledger.runs().len(), 2);
    }

    #[test]
    fn the_index_may_wrap_in_the_middle_of_a_run() {
        let first = u32::MAX - 24;
        let mut ledger = Ledger::exact();
        for mut frame in [started(7, first), data(7, first, 25), data(7, 25, 25), stopped(7, 50, 75, 75)] {
            frame.header.time_us = 0;
            ledger.enter(&frame, |_| {});
        }
        let account = ledger.runs()[0].account();
        assert_eq!((account.received, account.missing), (50, 25));
        assert_eq!(ledger.runs()[0].gaps().collect::<Vec<_>>(), [1 << 32..(1 << 32) + 25]);
    }

    #[test]
    fn live_books_stay_small_and_right() {
        let mut ledger = Ledger::live(8);
        for at in 0..1000 {
            ledger.enter(&data(7, 50 * at, 25), |_| {});
        }
        let run = &ledger.runs()[0];
        assert_eq!((run.gaps().count(), run.account().missing), (8, 999 * 25));
    }

    #[test]
    fn commands_are_none_of_the_books_business() {
        let ledger = entered(&[frame(0, Message::Start { samples: 5 })]);
        assert!(ledger.runs().is_empty());
    }
}
