//! The last second of a loop, in memory that is laid out before it starts.
use knobrender::Sensed;

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// When it woke up, s since the first deadline.
    pub t: f64,
    /// What the device sensed.
    pub sensed: Sensed,
    /// The torque that was written, N m.
    pub tau: f64,
    /// How late it woke up, s.
    pub late: f64,
}

const EMPTY: Row =
    Row { t: 0.0, sensed: Sensed { theta: 0.0, omega: 0.0, alpha: 0.0, hand: None }, tau: 0.0, late: 0.0 };

/// A ring that forgets the oldest row for the newest.
pub struct Last {
    rows: Box<[Row]>,
    /// Rows ever pushed.
    pushed: usize,
}

impl Last {
    /// A ring of this many rows.
    pub fn new(rows: usize) -> Self {
        Self { rows: vec![EMPTY; rows].into_boxed_slice(), pushed: 0 }
    }

    /// Keeps a row.
    pub fn push(&mut self, row: Row) {
        let at = self.pushed % self.rows.len().max(1);
        if let Some(slot) = self.rows.get_mut(at) {
            *slot = row;
        }
        self.pushed += 1;
    }

    /// The newest row.
    pub fn newest(&self) -> Option<Row> {
        let at = self.pushed.checked_sub(1)? % self.rows.len().max(1);
        self.rows.get(at).copied()
    }

    /// The rows of the last `seconds`, oldest first.
    pub fn of(mut self, seconds: f64) -> Vec<Row> {
        let Some(newest) = self.newest() else { return Vec::new() };
        let kept = self.pushed.min(self.rows.len());
        let oldest = self.pushed - kept;
        self.rows.rotate_left(oldest % self.rows.len().max(1));
        let rows = self.rows.iter().take(kept);
        rows.filter(|row| newest.t - row.t < seconds).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(rows: usize) -> Vec<f64> {
        let mut last = Last::new(10);
        (0..rows).for_each(|i| last.push(Row { t: i as f64, ..EMPTY }));
        assert_eq!(last.newest().map(|row| row.t), (rows > 0).then_some(rows as f64 - 1.0));
        last.of(8.0).iter().map(|row| row.t).collect()
    }

    #[test]
    fn rows_come_out_in_order_however_often_the_ring_wrapped() {
        for rows in [0, 3, 8, 10, 11, 20, 27] {
            let expected: Vec<f64> = (rows.max(8) - 8..rows).map(|i| i as f64).collect();
            assert_eq!(after(rows), expected, "{rows} rows");
        }
    }
}
