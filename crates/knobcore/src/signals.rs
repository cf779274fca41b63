//! Prepared signals: what a fit sees of one capture.

use crate::chain::{Begins, Follow};
use crate::filter::ZeroPhase;
use crate::isa;
use crate::model::Run;
use crate::motion::Motion;
use crate::param::Axis;
use std::ops::Range;

/// Samples that are evaluated and filtered at a time, so that memory does not grow with the capture.
const CHUNK: usize = 8192;
/// The same where there is no filter, which needs samples around them: what is worked on stays in the first cache.
const SHORT_CHUNK: usize = 512;

/// Gain of the measurement filter (forward and backward) at which a frequency counts as stopped.
const STOPPED: f64 = 0.0101;
/// What the knob remembers is carried across a gap of at most so many seconds: in so short a time the motion is that
/// between its ends, and a knob that began anew behind each lost row would be another one.
const CARRIED_S: f64 = 0.02;
/// Samples of which at least one is kept.
const SPARSEST: usize = 64;

/// Motion and torque of one capture, ready to be compared with a model.
///
/// All columns have the same length and SI units (rad or m by `axis`).
#[derive(Debug, Clone, Default)]
pub struct Signals {
    /// Which run of the knob it is.
    pub run: Run,
    /// Rotary or linear.
    pub axis: Axis,
    /// Nominal sampling rate, Hz.
    pub rate_hz: f64,
    /// Time since the first sample, s.
    pub t: Vec<f64>,
    /// Angle, rad.
    pub theta: Vec<f64>,
    /// Angular velocity, rad/s.
    pub omega: Vec<f64>,
    /// Angular acceleration, rad/s^2.
    pub alpha: Vec<f64>,
    /// Probability that the motion is forward; see [`Motion::forward`].
    pub forward: Vec<f64>,
    /// Standard deviation of `omega`, rad/s.
    pub omega_sd: Vec<f64>,
    /// Measured torque after the measurement filter, N m.
    pub tau: Vec<f64>,
    /// Measured torque as it came, N m.
    pub tau_raw: Vec<f64>,
    /// 1 where a sample counts, 0 where it is masked, trimmed or decimated away.
    pub weight: Vec<f64>,
    /// Contiguous stretches of good samples; nothing is filtered across their borders.
    pub segments: Vec<Range<usize>>,
    /// Stretches in which the knob stands still; they say nothing about sliding and do not count.
    pub stuck: Vec<Range<usize>>,
    /// Rows that were not measured, where straight lines stand for them.
    pub bridges: Vec<Range<usize>>,
    /// Stretches that do not count because a knob knocks there, which is no noise either.
    pub knocks: Vec<Range<usize>>,
    /// The measurement filter; the model's torque passes through it too. None: no filter.
    pub filter: Option<ZeroPhase>,
    /// Steps per sample of a motion that is simulated; at least one.
    pub substeps: usize,
    /// Samples at which a passage begins otherwise than with a knob that is with its shaft and has not moved, and how.
    pub begins: Vec<(usize, Begins)>,
}

/// A stretch of a segment that is evaluated at once: `whole` includes what the filter needs around `core`.
#[derive(Debug, Clone)]
pub struct Chunk {
    /// The samples to evaluate and filter.
    pub whole: Range<usize>,
    /// The samples of it whose filtered value is right.
    pub core: Range<usize>,
}

impl Chunk {
    /// The core, counted from the start of the whole.
    pub fn inner(&self) -> Range<usize> {
        self.within(&self.core)
    }

    /// Rows of the whole, counted from its start.
    pub fn within(&self, rows: &Range<usize>) -> Range<usize> {
        rows.start - self.whole.start..rows.end - self.whole.start
    }
}

/// How many of these numbers are positive.
struct Positive<'a>(&'a [f64]);

impl pulp::NullaryFnOnce for Positive<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        self.0.iter().filter(|w| **w > 0.0).count()
    }
}

impl Signals {
    /// The same without what these stretches tell of the knob and of the noise.
    pub fn without_knocks(&self, knocks: Vec<Range<usize>>) -> Self {
        let mut fewer = self.clone();
        for knock in &knocks {
            fewer.weight[knock.clone()].fill(0.0);
        }
        Self { knocks, ..fewer }
    }

    /// The same torque beside the motion of an instant that is so much later, s, up to a row: what is logged of a command
    /// that acts later. The noise of the torque is left as it is.
    pub fn later(&self, delay_s: f64) -> Self {
        let mut later = self.clone();
        for segment in &self.segments {
            for at in segment.clone() {
                let next = if delay_s > 0.0 { at + 1 } else { at.wrapping_sub(1) };
                let next = if segment.contains(&next) { next } else { at };
                let apart = self.t[next] - self.t[at];
                let share = if apart == 0.0 { 0.0 } else { delay_s / apart };
                let between = |column: &[f64]| column[at] + share * (column[next] - column[at]);
                let (omega, alpha, then) = (self.omega[at], self.alpha[at], between(&self.alpha));
                later.theta[at] += delay_s * (omega + delay_s * (2.0 * alpha + then) / 6.0);
                later.omega[at] += delay_s * 0.5 * (alpha + then);
                later.alpha[at] = then;
                later.forward[at] = between(&self.forward).clamp(0.0, 1.0);
            }
        }
        later
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Number of samples that count.
    pub fn used(&self) -> usize {
        isa::dispatch(Positive(&self.weight))
    }

    /// t, theta, omega, alpha and forward over a range of samples.
    pub fn motion_columns(&self, range: Range<usize>) -> [&[f64]; 5] {
        [&self.t, &self.theta, &self.omega, &self.alpha, &self.forward].map(|x| &x[range.clone()])
    }

    /// How a knob is followed from a sample on.
    pub fn follow(&self, from: usize) -> Follow {
        let begins = self.begins.iter().find(|(at, _)| *at == from).map(|(_, begins)| *begins);
        Follow { substeps: self.substeps, begins: begins.unwrap_or_default() }
    }

    /// The motion at sample `at`; past the end, rest.
    pub fn motion(&self, at: usize) -> Motion<f64> {
        let [t, theta, omega, alpha, forward] =
            [&self.t, &self.theta, &self.omega, &self.alpha, &self.forward]
                .map(|x| x.get(at).copied().unwrap_or(0.0));
        Motion { t, theta, omega, alpha, forward }
    }

    /// Ranges over which the knob's history is known: segments, together where next to nothing was lost between them.
    /// Between them there may be rows that are in none: a stretch that is too short for the filter.
    pub fn passages(&self) -> Vec<Range<usize>> {
        let mut passages: Vec<Range<usize>> = Vec::with_capacity(self.segments.len());
        for segment in &self.segments {
            let near = |before: &&mut Range<usize>| {
                let clock = &self.t[before.end.saturating_sub(1)..=segment.start];
                clock.windows(2).all(|pair| pair[1] - pair[0] <= CARRIED_S)
                    && self.theta[before.end..segment.start].iter().all(|theta| theta.is_finite())
            };
            match passages.last_mut().filter(near) {
                Some(before) => before.end = segment.end,
                None => passages.push(segment.clone()),
            }
        }
        passages
    }

    /// What segments have of these rows.
    pub fn parts(&self, rows: &Range<usize>) -> impl Iterator<Item = Range<usize>> + '_ {
        let (start, end) = (rows.start, rows.end);
        let first = self.segments.partition_point(|segment| segment.end <= start);
        let within = self.segments[first..].iter().take_while(move |segment| segment.start < end);
        within.map(move |segment| segment.start.max(start)..segment.end.min(end))
    }

    /// The capture in pieces that fit in the cache, each with the surroundings that the filter needs; for a
    /// model that `remembers` in whole passages.
    pub fn chunks(&self, remembers: bool) -> Vec<Chunk> {
        if remembers {
            let whole = |passage: Range<usize>| Chunk { core: passage.clone(), whole: passage };
            return self.passages().into_iter().map(whole).collect();
        }
        let halo = self.filter.as_ref().map_or(0, |filter| filter.sos().settle());
        let mut chunks = Vec::new();
        for segment in &self.segments {
            if halo == 0 {
                let from = segment.clone().step_by(SHORT_CHUNK);
                let pieces = from.map(|start| start..(start + SHORT_CHUNK).min(segment.end));
                chunks.extend(pieces.map(|piece| Chunk { whole: piece.clone(), core: piece }));
                continue;
            }
            let pieces = segment.len().div_ceil(CHUNK.max(2 * halo)).max(1);
            for piece in 0..pieces {
                let border = |k: usize| segment.start + k * segment.len() / pieces;
                let core = border(piece)..border(piece + 1);
                let whole =
                    core.start.saturating_sub(halo).max(segment.start)..(core.end + halo).min(segment.end);
                chunks.push(Chunk { whole, core });
            }
        }
        chunks
    }

    /// Does to columns over these rows what was done to the measured torque: straight lines where a reversal was not
    /// measured, then the measurement filter, in each segment apart.
    pub fn measure_over(&self, rows: &Range<usize>, columns: &mut [&mut [f64]]) {
        for part in self.parts(rows) {
            let (from, to) = (part.start - rows.start, part.end - rows.start);
            let mut parts: Vec<&mut [f64]> = columns.iter_mut().map(|column| &mut column[from..to]).collect();
            self.bridge(&part, &mut parts);
            self.measure(&mut parts);
        }
    }

    /// Straight lines over what was not measured of these rows of a segment where the direction changed, and friction
    /// with it. Elsewhere a torque is as straight over so few rows, or so fast that nobody knows it.
    fn bridge(&self, rows: &Range<usize>, columns: &mut [&mut [f64]]) {
        let first = self.bridges.partition_point(|bridge| bridge.start <= rows.start);
        for bridge in self.bridges[first..].iter().take_while(|bridge| bridge.end < rows.end) {
            let [from, to] = [bridge.start - 1, bridge.end].map(|at| self.forward[at] > 0.5);
            if from == to {
                continue;
            }
            let (before, after) = (bridge.start - rows.start - 1, bridge.end - rows.start);
            let step = 1.0 / (after - before) as f64;
            for column in columns.iter_mut() {
                let (from, slope) = (column[before], step * (column[after] - column[before]));
                (1..after - before).for_each(|i| column[before + i] = from + i as f64 * slope);
            }
        }
    }

    /// Does to columns over rows of one segment what the measurement filter did to the measured torque.
    pub fn measure(&self, columns: &mut [&mut [f64]]) {
        if let Some(filter) = &self.filter {
            // Segments are longer than the padding, and all columns as long as the chunk: it cannot refuse.
            let _ = filter.filter_channels(columns);
        }
    }

    /// The bandwidth of what passes the measurement filter, Hz: white noise behind it has as much of its power.
    pub fn passes_hz(&self) -> f64 {
        0.5 * self.rate_hz * self.filter.as_ref().map_or(1.0, |filter| filter.sos().mean_power())
    }

    /// Every how many samples tell all that passes the measurement filter.
    pub fn spacing(&self) -> usize {
        let Some(filter) = &self.filter else { return 1 };
        let sos = filter.sos();
        let passes = |every: &usize| {
            let fastest = 0.5 * self.rate_hz / *every as f64;
            // The least frequency that would be mistaken for one that passes.
            sos.power_gain(fastest) <= STOPPED
        };
        (1..=SPARSEST).take_while(passes).last().unwrap_or(1)
    }

    /// Filters the raw torque into `tau`, by the same route that a model's torque takes.
    pub fn filter_torque(&mut self) {
        let mut tau = self.tau_raw.clone();
        for chunk in self.chunks(false) {
            let mut column = self.tau_raw[chunk.whole.clone()].to_vec();
            self.measure(&mut [&mut column]);
            tau[chunk.core.clone()].copy_from_slice(&column[chunk.inner()]);
        }
        self.tau = tau;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::model::Model;
    use crate::predict;

    #[test]
    fn lost_rows_leave_what_the_knob_remembers_as_it_was() {
        let (rate_hz, w) = (1000.0, 9.0_f64);
        // Rows of a second of swinging, without those from `lost`.
        let over = |lost: Range<usize>| {
            let rows: Vec<usize> = (0..1000).filter(|row| !lost.contains(row)).collect();
            let column = |f: &dyn Fn(f64) -> f64| rows.iter().map(|row| f(*row as f64 / rate_hz)).collect();
            // Next to what was lost some rows are in no segment.
            let segments = match lost.start {
                0 => vec![0..1000; 1],
                start => vec![0..start - 3, start + 2..rows.len()],
            };
            let forward = |t: f64| f64::from(u8::from((w * t).cos() > 0.0));
            Signals {
                rate_hz,
                substeps: 4,
                t: column(&|t| t),
                theta: column(&|t| 0.3 * (w * t).sin()),
                omega: column(&|t| 0.3 * w * (w * t).cos()),
                alpha: column(&|t| -0.3 * w * w * (w * t).sin()),
                forward: column(&forward),
                weight: vec![1.0; rows.len()],
                segments,
                ..Signals::default()
            }
        };
        let (short, long) = (400..415, 400..460);
        assert_eq!(over(short.clone()).passages(), vec![0..985; 1]);
        assert_eq!(over(long.clone()).passages(), [0..397, 402..940]);
        for id in [Id::Presliding, Id::Backlash, Id::Compliance] {
            let mut model = Model::equation_1(Axis::Rotary, false).with(id).unwrap();
            let base = [("inertia.M", 1e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.02)];
            let own: &[(&str, f64)] = match id {
                Id::Presliding => &[("presliding.s", 0.5), ("presliding.w1", 0.7)],
                Id::Backlash => &[("backlash.gap", 0.05), ("backlash.k", 2.0), ("backlash.d", 1e-3)],
                _ => &[("compliance.k", 0.5), ("compliance.d", 1e-3)],
            };
            base.iter().chain(own).for_each(|(name, value)| model.set(name, *value).unwrap());
            let whole = predict::torque_raw(&model, &over(0..0));
            let off = |lost: Range<usize>| {
                let torque = predict::torque_raw(&model, &over(lost.clone()));
                // What the joint did right behind the gap has faded by then; friction has not turned round yet.
                (lost.end + 10..500)
                    .fold(0.0_f64, |off, row| off.max((torque[row - lost.len()] - whole[row]).abs()))
            };
            assert!(off(short.clone()) < 1e-4, "{id:?}: {}", off(short));
            assert!(off(long.clone()) > 1e-3, "{id:?}: {}", off(long));
        }
    }

    #[test]
    fn a_modelled_torque_has_straight_lines_where_the_measured_one_has_them_over_a_reversal() {
        let squares = |rows: Range<u32>| rows.map(|row| f64::from(row * row)).collect::<Vec<f64>>();
        let signals = Signals {
            forward: (0..20).map(|row| f64::from(u8::from(!(4..10).contains(&row) && row != 19))).collect(),
            segments: vec![0..6, 6..20],
            bridges: vec![3..4, 9..12, 14..15, 18..19],
            ..Signals::default()
        };
        let mut column = squares(0..20);
        signals.measure_over(&(0..20), &mut [&mut column]);
        let mut lines = squares(0..20);
        for (at, tau) in [(3, 10.0), (9, 84.0), (10, 104.0), (11, 124.0), (18, 325.0)] {
            lines[at] = tau;
        }
        assert_eq!(column, lines);
        // Of a piece whose border is on a line the rest stays: it is what the filter needs around, and less.
        let mut piece = squares(10..19);
        signals.measure_over(&(10..19), &mut [&mut piece]);
        assert_eq!(piece, squares(10..19));
    }

    #[test]
    fn a_motion_that_is_seen_later_is_where_it_will_be_and_its_torque_is_left_as_it_is() {
        let (rate_hz, w) = (200.0, 9.0_f64);
        let over = |f: &dyn Fn(f64) -> f64| (0..400).map(|i| f(f64::from(i) / rate_hz)).collect::<Vec<f64>>();
        let at = |delay: f64| Signals {
            rate_hz,
            t: over(&|t| t),
            theta: over(&|t| (w * (t + delay)).sin()),
            omega: over(&|t| w * (w * (t + delay)).cos()),
            alpha: over(&|t| -w * w * (w * (t + delay)).sin()),
            forward: over(&|t| f64::from(u8::from((w * (t + delay)).cos() > 0.0))),
            tau: over(&|t| 3.0 * t),
            tau_raw: over(&|t| 3.0 * t),
            weight: vec![1.0; 400],
            segments: vec![0..180, 200..400],
            ..Signals::default()
        };
        for delay in [2.5e-3, -4e-3, 0.0] {
            let (seen, there) = (at(0.0).later(delay), at(delay));
            for row in (1..179).chain(201..399) {
                let off = |a: &[f64], b: &[f64]| (a[row] - b[row]).abs();
                assert!(off(&seen.theta, &there.theta) < 3e-7, "{delay} {row}");
                assert!(off(&seen.omega, &there.omega) < 1e-4 && off(&seen.alpha, &there.alpha) < 0.05);
            }
            assert_eq!((&seen.tau, &seen.tau_raw, &seen.t), (&there.tau, &there.tau_raw, &there.t));
        }
    }
}
