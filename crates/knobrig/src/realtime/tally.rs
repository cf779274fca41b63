//! What became of the beat, in numbers.
use super::histogram::Histogram;

/// Counts and durations of a loop so far.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Periods in which a torque was written.
    pub steps: u64,
    /// Periods that were skipped because a step before them ended too late.
    pub missed: u64,
    /// The most periods that were skipped in a row.
    pub longest_run: u64,
    /// How long after its deadline each step woke up.
    pub late: Histogram,
    /// How long each step took: read, step and write.
    pub busy: Histogram,
}

impl Tally {
    /// Periods that passed.
    pub fn periods(&self) -> u64 {
        self.steps + self.missed
    }

    /// A step was done, and then `skipped` periods were missed.
    pub(super) fn note(&mut self, busy_ns: u64, skipped: u64) {
        self.steps += 1;
        self.busy.add(busy_ns);
        self.missed += skipped;
        self.longest_run = self.longest_run.max(skipped);
    }
}
