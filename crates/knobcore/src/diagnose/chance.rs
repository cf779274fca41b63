//! What becomes of an effect's signature where it is multiplied with noise.
//!
//! The products of a signature with noise behind the measurement filter are those with white noise of what becomes of it
//! behind that filter and the noise's colour. The samples that are kept of a column tell all that passes the filter, so
//! that of both no more is asked than what they do to the frequencies of those samples.

use super::thinned::Thinned;
use crate::noise::Noise;
use crate::signals::Signals;
use std::ops::Range;

/// Samples that are looked at: what chance gives does not depend on how many there are.
const ENOUGH: usize = 30_000;
/// Stretches of a segment that stand for one of more samples.
const STRETCHES: usize = 12;
/// Frequencies at which filter and colour are asked: an impulse is followed over half as many kept samples to either side.
/// And the share of its largest value that is nothing.
const FREQUENCIES: usize = 256;
const NOTHING: f64 = 1e-4;

/// How noise meets the kept samples of captures.
pub struct Chance {
    stretches: Vec<Stretch>,
    /// For each capture what becomes of an impulse at the kept samples: the same before it as after it.
    impulses: Vec<Vec<f64>>,
    /// The root of how many kept samples one that is looked at stands for.
    scale: f64,
}

/// Kept samples that are looked at, as rows of a column.
struct Stretch {
    capture: usize,
    rows: Range<usize>,
    /// All rows of their segment.
    within: Range<usize>,
}

impl Chance {
    pub fn of(data: &[&Signals], noises: &[Noise], thinned: &Thinned) -> Self {
        let samples: usize =
            data.iter().flat_map(|signals| &signals.segments).map(ExactSizeIterator::len).sum();
        let share = (ENOUGH as f64 / samples.max(1) as f64).min(1.0);
        let of_segment = |(capture, within): (usize, Range<usize>)| {
            stretches(&within, share).map(move |rows| Stretch { capture, rows, within: within.clone() })
        };
        Self {
            stretches: thinned.segments(data).into_iter().flat_map(of_segment).collect(),
            impulses: data.iter().zip(noises).map(|(signals, noise)| impulse(signals, noise)).collect(),
            scale: share.sqrt().recip(),
        }
    }

    /// What becomes of a column, at the samples that are looked at.
    pub fn met_by(&self, column: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.stretches.iter().map(|stretch| stretch.rows.len()).sum());
        for Stretch { capture, rows, within } in &self.stretches {
            let impulse = &self.impulses[*capture];
            let before = impulse.len() / 2;
            let from = all.len();
            all.resize(from + rows.len(), 0.0);
            for (late, tap) in impulse.iter().enumerate() {
                // Of the row that lies so many before it: none outside its segment.
                let first = (within.start + late).saturating_sub(before).clamp(rows.start, rows.end);
                let end = (within.end + late).saturating_sub(before).clamp(first, rows.end);
                if first == end {
                    continue;
                }
                let sums = &mut all[from + first - rows.start..from + end - rows.start];
                let terms = &column[first + before - late..end + before - late];
                sums.iter_mut().zip(terms).for_each(|(sum, x)| *sum += self.scale * tap * x);
            }
        }
        all
    }
}

/// What becomes of an impulse at kept samples.
fn impulse(signals: &Signals, noise: &Noise) -> Vec<f64> {
    let every = signals.spacing() as f64;
    // As shares of the fastest that the kept samples tell.
    let shares: Vec<f64> = (0..FREQUENCIES).map(|k| (k as f64 + 0.5) / FREQUENCIES as f64).collect();
    let gain = |share: &f64| noise.passed(signals.filter.as_ref(), 0.5 * share / every).sqrt();
    let gains: Vec<f64> = shares.iter().map(gain).collect();
    let at = |late: usize| {
        let wave = |share: &f64| (std::f64::consts::PI * late as f64 * share).cos();
        shares.iter().zip(&gains).map(|(share, gain)| gain * wave(share)).sum::<f64>() / FREQUENCIES as f64
    };
    let all: Vec<f64> = (0..FREQUENCIES / 2).map(at).collect();
    let most = all.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let last = all.iter().rposition(|x| x.abs() > NOTHING * most).unwrap_or(0);
    all[1..=last].iter().rev().chain(&all[..=last]).copied().collect()
}

/// Stretches of a segment that are this share of it, evenly.
fn stretches(segment: &Range<usize>, share: f64) -> impl Iterator<Item = Range<usize>> + use<> {
    let pieces = if share < 1.0 { STRETCHES } else { 1 };
    let piece = segment.len() as f64 / pieces as f64;
    let start = segment.start;
    (0..pieces).map(move |k| {
        let from = k as f64 * piece;
        start + from as usize..start + (from + share * piece) as usize
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::*;
    use crate::algebra::dot;
    use crate::filter::{ZeroPhase, cheby2};
    use crate::random;

    #[test]
    fn what_lasts_longer_than_a_segment_reaches_no_further_than_that() {
        let short = Stretch { capture: 0, rows: 4..6, within: 0..40 };
        let chance = Chance { stretches: vec![short], impulses: vec![vec![1.0; 61]], scale: 1.0 };
        // Sixty taps about each row, of which the segment has those that lie within it.
        let column: Vec<f64> = (0..40).map(f64::from).collect();
        let sum = |row: usize| column[row.saturating_sub(30)..(row + 31).min(40)].iter().sum::<f64>();
        assert_eq!(chance.met_by(&column), [sum(4), sum(5)]);
    }

    #[test]
    fn stretches_are_spread_over_a_segment() {
        assert!(stretches(&(5..10), 1.0).eq(std::iter::once(5..10)));
        let few: Vec<_> = stretches(&(1000..2200), 0.1).collect();
        assert_eq!((few.len(), few[0].clone(), few[11].clone()), (12, 1000..1010, 2100..2110));
    }

    /// Any column as it is behind a capture's filter, and nothing at the ends, which do not count.
    fn measured(signals: &Signals, random: &mut random::Noise) -> Vec<f64> {
        let mut column: Vec<f64> = (0..signals.len()).map(|_| random.normal()).collect();
        for segment in &signals.segments {
            let part = &mut column[segment.clone()];
            signals.measure(&mut [&mut *part]);
            let step = std::f64::consts::PI / part.len() as f64;
            part.iter_mut().enumerate().for_each(|(at, x)| *x *= (step * at as f64).sin().powi(2));
        }
        column
    }

    #[test]
    fn what_comes_back_through_kept_samples_is_what_comes_back_through_all() {
        let mut random = random::Noise::new(3);
        let coloured = Noise { coefficients: vec![-0.9], innovation: 0.19 * SD * SD };
        for (edge_hz, noise) in
            [(Some(90.0), Noise::white(SD * SD)), (Some(90.0), coloured), (None, Noise::white(1.0))]
        {
            let mut signals = recorded(&knob(&[], &[]), "a");
            let n = signals.len();
            signals.segments = vec![0..n / 3, n / 3 + 50..n];
            signals.filter = edge_hz.map(|hz| ZeroPhase::new(cheby2(3, 20.0, hz, signals.rate_hz).unwrap()));
            let data = [&signals];
            let thinned = Thinned::of(&data);
            let chance = Chance::of(&data, std::slice::from_ref(&noise), &thinned);
            assert!(edge_hz.is_none() || thinned.rows() < n / 2);
            let columns = [(); 3].map(|()| measured(&signals, &mut random));
            let counted = |column: &[f64]| -> Vec<f64> {
                signals.segments.iter().flat_map(|segment| column[segment.clone()].to_vec()).collect()
            };
            let few = columns.each_ref().map(|column| chance.met_by(&thinned.pick(&data, &counted(column))));
            let all = columns.each_ref().map(|column| {
                let mut back = column.clone();
                for segment in &signals.segments {
                    signals.measure(&mut [&mut back[segment.clone()]]);
                    noise.colour_back(&mut back[segment.clone()]);
                }
                counted(&back)
            });
            for i in 0..3 {
                for j in 0..=i {
                    let size = (dot(&all[i], &all[i]) * dot(&all[j], &all[j])).sqrt();
                    let off = (dot(&few[i], &few[j]) - dot(&all[i], &all[j])) / size;
                    assert!(off.abs() < 5e-3, "{edge_hz:?} {i} {j}: {off}");
                }
            }
        }
    }

    #[test]
    fn of_a_long_capture_a_part_stands_for_all_of_it() {
        let signals = recorded(&knob(&[], &[]), "a");
        let (n, times) = (signals.len(), 3 * ENOUGH / signals.len() + 1);
        let long = Signals {
            weight: vec![1.0; n * times],
            segments: (0..times).map(|k| k * n..(k + 1) * n).collect(),
            ..signals
        };
        let data = [&long];
        let thinned = Thinned::of(&data);
        let chance = Chance::of(&data, &[Noise::white(4.0)], &thinned);
        let mut random = random::Noise::new(4);
        let column: Vec<f64> = (0..n * times).map(|_| random.normal()).collect();
        let back = chance.met_by(&column);
        assert!(back.len() <= ENOUGH && back.len() > ENOUGH - 12 * times);
        assert!((dot(&back, &back) / (4.0 * dot(&column, &column)) - 1.0).abs() < 0.03);
    }
}
