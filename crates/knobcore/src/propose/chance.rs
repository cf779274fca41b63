//! What a scan finds where nothing is missing: the largest of all that it looks at, of noise through the whole chain.

use super::grammar::{Factor, Powers, Variable};
use super::penalized::Penalized;
use super::rows::Rows;
use super::scan::Seen;
use crate::algebra::{dot, products, slices};
use crate::diagnose::{Thinned, Watch};
use crate::noise::Noise;
use crate::random;
use crate::signals::Signals;
use std::sync::OnceLock;

/// Captures of noise alone.
const DRAWS: usize = 199;
/// Columns of the scan that stand for all.
const MOST: usize = 600;
/// What is rarer is not told apart.
const LEAST: f64 = 1e-6;
/// Frequencies by which a power spectrum is known.
const FREQUENCIES: usize = 512;

/// Noise through the whole chain, and what may be found in it.
pub struct Chance<'a> {
    data: &'a [&'a Signals],
    noises: &'a [Noise],
    rows: &'a Rows<'a>,
    /// Variance of the raw noise.
    pub white: f64,
    /// The powers and functions of a scan.
    scanned: (&'a [Powers], &'a [Factor]),
    drawn: OnceLock<Vec<Vec<f64>>>,
    /// The most that a scan takes off each.
    most: OnceLock<Vec<f64>>,
}

impl<'a> Chance<'a> {
    /// Of captures with these noises, as some rows see it, to a scan of these powers and functions; `white` is the variance
    /// of the raw noise.
    pub fn of(
        (data, noises): (&'a [&'a Signals], &'a [Noise]),
        rows: &'a Rows<'a>,
        scanned: (&'a [Powers], &'a [Factor]),
        white: f64,
    ) -> Self {
        Self { data, noises, rows, white, scanned, drawn: OnceLock::new(), most: OnceLock::new() }
    }

    fn drawn(&self) -> &[Vec<f64>] {
        self.drawn.get_or_init(|| {
            let thinned = Thinned::of(self.data);
            let mut random = random::Noise::new(0x6c61_7773);
            let mut draw = || self.rows.summed(&drawn(self.data, self.noises, &thinned, &mut random));
            (0..DRAWS).map(|_| draw()).collect()
        })
    }

    /// How often the best of several curves and surfaces takes off as much of noise as each does of what is left, every one
    /// held against what it usually takes of noise.
    pub fn of_each(&self, each: &[&Penalized], watch: &Watch<'_>) -> Vec<f64> {
        let alone = watch.each(each, |one| {
            let gains = one.gains_of(self.drawn());
            let mean = gains.iter().sum::<f64>() / DRAWS as f64;
            let spread = gains.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / DRAWS as f64;
            let beyond = |gain: f64| (gain - mean) / spread.sqrt().max(f64::MIN_POSITIVE);
            (gains.into_iter().map(beyond).collect::<Vec<f64>>(), beyond(one.gain()))
        });
        let best = (0..DRAWS).map(|at| alone.iter().map(|(drawn, _)| drawn[at]).fold(f64::MIN, f64::max));
        let best: Vec<f64> = best.collect();
        let p = |own: f64| best.iter().filter(|drawn| **drawn >= own).count();
        alone.iter().map(|(_, own)| (1 + p(*own)) as f64 / (1 + DRAWS) as f64).collect()
    }

    /// Chance that a scan finds as much as what it saw where nothing is missing.
    pub fn p_value(&self, Seen { term, gain }: &Seen) -> f64 {
        if let Some(sine) = term.sine() {
            // Sines at frequencies a wave over the range apart are independent; each takes off what two numbers of the
            // loudest part of the noise do.
            let power = |noise: &Noise| {
                (0..FREQUENCIES).map(|k| noise.power(0.5 * k as f64 / FREQUENCIES as f64)).fold(0.0, f64::max)
            };
            let loudest = self.noises.iter().map(power).fold(self.white, f64::max);
            let waves = if sine.of == Variable::Time { 3.0 } else { self.scanned.0.len() as f64 };
            let looks = waves * Thinned::of(self.data).rows() as f64 * 0.5;
            return (looks * (-0.5 * gain / loudest).exp()).clamp(LEAST, 1.0);
        }
        let above = self.most().iter().filter(|most| *most >= gain).count();
        (1 + above) as f64 / (1 + DRAWS) as f64
    }

    fn most(&self) -> &[f64] {
        self.most.get_or_init(|| {
            let ((powers, functions), rows) = (self.scanned, self.rows);
            let every = (powers.len() * functions.len()).div_ceil(MOST).max(1);
            let looks = (0..powers.len() * functions.len()).step_by(every);
            let column = |at: usize| {
                let Factor { of, shape, at: [w, c] } = functions[at % functions.len()];
                let mut column = powers[at / functions.len()].over(&rows.motions);
                let x = &rows.motions[of as usize];
                column.iter_mut().zip(x).for_each(|(own, x)| *own *= shape.at(*x, w, c));
                let square = dot(&column, &column);
                let mut column = rows.counted(&column);
                let own = dot(&column, &column);
                column.iter_mut().for_each(|x| *x /= own.sqrt());
                (own > 1e-9 * square && own.is_finite()).then_some(column)
            };
            let columns: Vec<Vec<f64>> = looks.filter_map(column).collect();
            let along = products(&slices(&columns), &slices(self.drawn()));
            along.column_iter().map(|along| along.amax().powi(2)).collect()
        })
    }
}

/// Noise alone, through the measurement filter, thinned.
fn drawn(data: &[&Signals], noises: &[Noise], thinned: &Thinned, random: &mut random::Noise) -> Vec<f64> {
    let scale = 12.0_f64.sqrt();
    let mut whole = Vec::new();
    for (signals, noise) in data.iter().zip(noises) {
        let white = (0..signals.len() + noise.warm()).map(|_| scale * (random.uniform() - 0.5)).collect();
        let raw = noise.colour(white);
        for segment in &signals.segments {
            let mut part = raw[segment.clone()].to_vec();
            signals.measure(&mut [&mut part]);
            part.iter_mut().zip(&signals.weight[segment.clone()]).for_each(|(x, weight)| *x *= weight);
            whole.extend(part);
        }
    }
    thinned.pick(data, &whole)
}
