//! A torque that is read more slowly than the motion: each reading stands in the log until the next one.
//!
//! As a column of its own it is a staircase, late by half a stair on average, which no knob's torque is. What is known
//! are its readings: they are compared with the model where they were taken, and there the motion is what all of the
//! rows tell of it.

use super::Recording;
use super::motion::Moving;

/// Times the usual way between two readings, beyond which some are missing.
const MISSING: usize = 3;

/// The rows with a reading of the torque.
pub(super) struct Fresh {
    rows: Vec<usize>,
    t: Vec<f64>,
    theta: Vec<f64>,
    tau: Vec<f64>,
    after_gap: Vec<bool>,
    measured: Vec<bool>,
}

impl Fresh {
    /// None where every row has one.
    pub(super) fn of(recording: &Recording<'_>) -> Option<Self> {
        let rows: Vec<usize> = (0..recording.t.len()).filter(|&row| recording.tau[row].is_finite()).collect();
        if rows.len() == recording.t.len() || rows.is_empty() {
            return None;
        }
        let at = |column: &[f64]| rows.iter().map(|&row| column[row]).collect::<Vec<f64>>();
        let usual = recording.t.len() / rows.len() + 1;
        let before = std::iter::once(rows[0]).chain(rows.iter().copied());
        let gap = |(before, &row): (usize, &usize)| {
            row > before + MISSING * usual || recording.after_gap[before..=row].iter().skip(1).any(|gap| *gap)
        };
        Some(Self {
            t: at(recording.t),
            theta: at(recording.theta),
            tau: at(recording.tau),
            after_gap: before.zip(&rows).map(gap).collect(),
            measured: rows.iter().map(|&row| recording.measured[row]).collect(),
            rows,
        })
    }

    /// What is left of the recording; of its motion sensors, which have been read, the angle.
    pub(super) fn recording<'a>(&'a self, whole: &Recording<'a>) -> Recording<'a> {
        Recording {
            rate_hz: whole.rate_hz * self.rows.len() as f64 / whole.t.len() as f64,
            t: &self.t,
            theta: &self.theta,
            omega: None,
            alpha: None,
            tau: &self.tau,
            after_gap: &self.after_gap,
            measured: &self.measured,
            ..*whole
        }
    }

    /// The motion in these rows.
    pub(super) fn moving(&self, whole: &Moving) -> Moving {
        let at = |column: &[f64]| self.rows.iter().map(|&row| column[row]).collect::<Vec<f64>>();
        Moving {
            theta: at(&whole.theta),
            omega: at(&whole.omega),
            alpha: at(&whole.alpha),
            omega_sd: at(&whole.omega_sd),
            uncertainty: whole.uncertainty.as_ref().map(|[theta, alpha]| [at(theta), at(alpha)]),
            noise: whole.noise,
            strays: whole.strays.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Run;
    use crate::param::Axis;

    #[test]
    fn a_torque_read_every_fifth_row_is_a_recording_at_a_fifth_of_the_rate() {
        let t: Vec<f64> = (0..100).map(|row| f64::from(row) * 1e-3).collect();
        let mut tau = vec![f64::NAN; 100];
        (0..100).step_by(5).for_each(|row| tau[row] = row as f64);
        let mut after_gap = vec![false; 100];
        after_gap[42] = true;
        let whole = Recording {
            run: &Run::default(),
            axis: Axis::Rotary,
            rate_hz: 1000.0,
            t: &t,
            theta: &t,
            omega: Some(&t),
            alpha: None,
            tau: &tau,
            after_gap: &after_gap,
            measured: &[true; 100],
        };
        let fresh = Fresh::of(&whole).unwrap();
        let read = fresh.recording(&whole);
        assert_eq!((read.rate_hz, read.tau[3], read.t[3]), (200.0, 15.0, t[15]));
        // A gap between two readings is one before the second.
        assert_eq!(read.after_gap.iter().position(|gap| *gap), Some(9));
        assert!(Fresh::of(&Recording { tau: &t, ..whole }).is_none());
    }
}
