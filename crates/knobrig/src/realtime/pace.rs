//! The beat: absolute deadlines, and the share of them that were missed lately.

/// Deadlines at start + n period; times in ns.
pub struct Pace {
    start: u64,
    period: u64,
    n: u64,
}

impl Pace {
    /// The first deadline is `start`.
    pub fn new(start: u64, period: u64) -> Self {
        Self { start, period: period.max(1), n: 0 }
    }

    /// The number of the period that is next.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// Its deadline.
    pub fn deadline(&self) -> u64 {
        self.start + self.n * self.period
    }

    /// Goes on to the first deadline that is not past at `now`; returns how many were skipped for that.
    pub fn advance(&mut self, now: u64) -> u64 {
        let ahead = now.saturating_sub(self.start).div_ceil(self.period);
        let next = ahead.max(self.n + 1);
        let skipped = next - self.n - 1;
        self.n = next;
        skipped
    }
}

/// Which of the last periods were missed.
pub struct Window {
    missed: Box<[bool]>,
    at: usize,
    count: usize,
}

impl Window {
    /// A window of so many periods.
    pub fn new(periods: usize) -> Self {
        Self { missed: vec![false; periods.max(1)].into_boxed_slice(), at: 0, count: 0 }
    }

    /// One period was kept, then `skipped` were missed.
    pub fn note(&mut self, skipped: u64) {
        self.push(false);
        for _ in 0..skipped.min(self.missed.len() as u64) {
            self.push(true);
        }
    }

    fn push(&mut self, missed: bool) {
        if let Some(slot) = self.missed.get_mut(self.at) {
            self.count = self.count + usize::from(missed) - usize::from(*slot);
            *slot = missed;
        }
        self.at = (self.at + 1) % self.missed.len();
    }

    /// The share of the window that was missed; periods before the first count as kept.
    pub fn share(&self) -> f64 {
        self.count as f64 / self.missed.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deadline_is_a_multiple_of_the_period_however_late_the_step_before_was() {
        let mut pace = Pace::new(1000, 200);
        for (now, skipped, deadline) in
            [(1000, 0, 1200), (1399, 0, 1400), (1400, 0, 1600), (1801, 1, 2000), (3000, 4, 3000)]
        {
            assert_eq!((pace.advance(now), pace.deadline()), (skipped, deadline), "at {now}");
        }
    }

    #[test]
    fn a_step_that_ends_exactly_at_a_deadline_does_not_miss_it() {
        let mut pace = Pace::new(0, 200);
        assert_eq!(pace.advance(200), 0);
        assert_eq!(pace.n(), 1);
    }

    #[test]
    fn the_share_is_of_the_last_periods_alone() {
        let mut window = Window::new(10);
        window.note(4);
        assert_eq!(window.share(), 0.4);
        for _ in 0..5 {
            window.note(0);
        }
        assert_eq!(window.share(), 0.4);
        for kept in 1..=4 {
            window.note(0);
            assert_eq!(window.share(), f64::from(5 - kept) / 10.0);
        }
        window.note(1_000_000);
        assert_eq!(window.share(), 1.0);
    }
}
