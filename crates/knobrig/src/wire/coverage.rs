//! Which places of a run have been filled: one stretch with gaps in it.
use std::collections::VecDeque;
use std::ops::Range;

/// A stretch of places, of which some are still missing.
#[derive(Debug, Clone)]
pub(super) struct Coverage {
    whole: Range<i64>,
    gaps: VecDeque<Range<i64>>,
    /// Most gaps that are kept open.
    keep: usize,
    /// Nothing before this place is taken any more.
    horizon: i64,
    /// Places missing before the horizon, and the gaps that they form.
    given_up: u64,
    given_up_gaps: u64,
}

/// What became of stretches that were offered; places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Offer {
    /// Filled now, behind all that came before.
    pub on_time: u64,
    /// Filled now, before something that came earlier.
    pub late: u64,
    /// Filled before.
    pub duplicate: u64,
    /// Too old: whether they were filled before is forgotten.
    pub stale: u64,
}

impl std::ops::AddAssign for Offer {
    fn add_assign(&mut self, other: Self) {
        self.on_time += other.on_time;
        self.late += other.late;
        self.duplicate += other.duplicate;
        self.stale += other.stale;
    }
}

impl Coverage {
    /// An empty stretch at `start` that keeps so many gaps open.
    pub fn new(start: i64, keep: usize) -> Self {
        let gaps = VecDeque::new();
        Self { whole: start..start, gaps, keep, horizon: i64::MIN, given_up: 0, given_up_gaps: 0 }
    }

    pub fn whole(&self) -> Range<i64> {
        self.whole.clone()
    }

    /// The gaps that may still be filled, in order.
    pub fn open_gaps(&self) -> impl Iterator<Item = Range<i64>> {
        self.gaps.iter().cloned()
    }

    pub fn gap_count(&self) -> u64 {
        self.given_up_gaps + self.gaps.len() as u64
    }

    /// Places of the stretch that are not filled.
    pub fn missing(&self) -> u64 {
        self.given_up + self.gaps.iter().map(length).sum::<u64>()
    }

    /// Places missing at the very beginning and at the very end.
    pub fn missing_ends(&self) -> (u64, u64) {
        let head = self.gaps.front().filter(|gap| gap.start == self.whole.start);
        let tail = self.gaps.back().filter(|gap| gap.end == self.whole.end);
        (head.map_or(0, length), tail.map_or(0, length))
    }

    /// The stretch is known to reach from and to here; what it gains is missing.
    pub fn reach(&mut self, whole: Range<i64>) {
        if whole.start < self.whole.start {
            self.lack(whole.start..self.whole.start);
            self.whole.start = whole.start;
        }
        if whole.end > self.whole.end {
            self.lack(self.whole.end..whole.end);
            self.whole.end = whole.end;
        }
    }

    /// Fills what is still missing of `offered` and tells each part of it, in order.
    pub fn fill(&mut self, offered: Range<i64>, mut tell: impl FnMut(Range<i64>)) -> Offer {
        let old = offered.start.max(self.horizon).min(offered.end);
        let mut offer = Offer { stale: (old - offered.start) as u64, ..Offer::default() };
        let offered = old..offered.end;
        if offered.is_empty() {
            return offer;
        }
        let behind = self.whole.end;
        self.reach(offered.clone());
        let mut at = self.gaps.partition_point(|gap| gap.end <= offered.start);
        while let Some(gap) = self.gaps.get(at).filter(|gap| gap.start < offered.end).cloned() {
            let part = gap.start.max(offered.start)..gap.end.min(offered.end);
            let late = (part.start.max(behind).min(part.end) - part.start) as u64;
            offer.late += late;
            offer.on_time += length(&part) - late;
            self.gaps.remove(at);
            for rest in [gap.start..part.start, part.end..gap.end] {
                if !rest.is_empty() {
                    self.gaps.insert(at, rest);
                    at += 1;
                }
            }
            tell(part);
        }
        self.give_up();
        offer.duplicate = length(&offered) - offer.on_time - offer.late;
        offer
    }

    /// Adds a gap at either end, joined with one that it touches.
    fn lack(&mut self, mut gap: Range<i64>) {
        if gap.end <= self.whole.start {
            if self.gaps.front().is_some_and(|first| first.start == gap.end) {
                gap.end = self.gaps.pop_front().map_or(gap.end, |first| first.end);
            }
            self.gaps.push_front(gap);
        } else {
            if self.gaps.back().is_some_and(|last| last.end == gap.start) {
                gap.start = self.gaps.pop_back().map_or(gap.start, |last| last.start);
            }
            self.gaps.push_back(gap);
        }
    }

    /// Gives up the oldest gaps when there are too many.
    fn give_up(&mut self) {
        while self.gaps.len() > self.keep
            && let Some(gap) = self.gaps.pop_front()
        {
            self.given_up += length(&gap);
            self.given_up_gaps += 1;
            self.horizon = self.horizon.max(gap.end);
        }
    }
}

fn length(places: &Range<i64>) -> u64 {
    places.end.saturating_sub(places.start).max(0) as u64
}

#[cfg(test)]
mod tests {
    #![allow(clippy::single_range_in_vec_init)] // a list of one gap is meant
    use super::*;
    use knobcore::random::Noise;

    fn filled(coverage: &mut Coverage, offered: Range<i64>) -> (Vec<Range<i64>>, Offer) {
        let mut parts = Vec::new();
        let offer = coverage.fill(offered, |part| parts.push(part));
        (parts, offer)
    }

    #[test]
    fn what_follows_on_leaves_no_gap() {
        let mut coverage = Coverage::new(0, 9);
        assert_eq!(filled(&mut coverage, 0..25).1, Offer { on_time: 25, ..Offer::default() });
        assert_eq!(filled(&mut coverage, 25..50).0, [25..50]);
        assert_eq!((coverage.missing(), coverage.whole()), (0, 0..50));
    }

    #[test]
    fn a_gap_is_filled_by_what_comes_late() {
        let mut coverage = Coverage::new(0, 9);
        filled(&mut coverage, 0..25);
        filled(&mut coverage, 50..75);
        assert_eq!(coverage.open_gaps().collect::<Vec<_>>(), [25..50]);
        assert_eq!(filled(&mut coverage, 25..50).1, Offer { late: 25, ..Offer::default() });
        assert_eq!(filled(&mut coverage, 25..50).1, Offer { duplicate: 25, ..Offer::default() });
        assert_eq!(coverage.missing(), 0);
    }

    #[test]
    fn a_stretch_over_several_gaps_fills_each() {
        let mut coverage = Coverage::new(0, 9);
        filled(&mut coverage, 10..20);
        filled(&mut coverage, 30..40);
        let (parts, offer) = filled(&mut coverage, 5..45);
        assert_eq!(parts, [5..10, 20..30, 40..45]);
        assert_eq!(offer, Offer { on_time: 5, late: 15, duplicate: 20, stale: 0 });
        assert_eq!(coverage.open_gaps().collect::<Vec<_>>(), [0..5]);
    }

    #[test]
    fn a_known_end_shows_the_lost_tail() {
        let mut coverage = Coverage::new(0, 9);
        filled(&mut coverage, 5..10);
        coverage.reach(0..30);
        coverage.reach(0..40);
        assert_eq!(coverage.missing_ends(), (5, 30));
        assert_eq!(coverage.gap_count(), 2);
    }

    #[test]
    fn gaps_beyond_those_kept_are_given_up_and_still_counted() {
        let mut coverage = Coverage::new(0, 2);
        for at in 0..10 {
            filled(&mut coverage, 10 * at + 5..10 * at + 10);
        }
        assert_eq!(coverage.open_gaps().count(), 2);
        assert_eq!((coverage.missing(), coverage.gap_count()), (50, 10));
        assert_eq!(filled(&mut coverage, 0..5).1, Offer { stale: 5, ..Offer::default() });
        assert_eq!(coverage.missing(), 50);
    }

    #[test]
    fn it_agrees_with_a_plain_set_of_places_whatever_comes() {
        let mut noise = Noise::new(3);
        for _ in 0..200 {
            let mut coverage = Coverage::new(0, usize::MAX);
            let mut set = vec![false; 400];
            for _ in 0..60 {
                let start = (noise.bits() % 300) as usize;
                let end = start + 1 + (noise.bits() % 40) as usize;
                let new = set[start..end].iter().filter(|&&there| !there).count() as u64;
                let (parts, offer) = filled(&mut coverage, start as i64..end as i64);
                assert_eq!(offer.on_time + offer.late, new);
                assert_eq!(offer.duplicate, (end - start) as u64 - new);
                for part in parts {
                    set[part.start as usize..part.end as usize].fill(true);
                }
                assert!(set[start..end].iter().all(|&there| there));
                let end = coverage.whole().end as usize;
                assert_eq!(coverage.missing(), set[..end].iter().filter(|&&there| !there).count() as u64);
                assert!(!set[end..].contains(&true));
            }
        }
    }
}
