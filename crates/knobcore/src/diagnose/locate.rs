//! Where the error sits: split over position, velocity, acceleration, time, load and history.
//!
//! Along each axis the residual is averaged in bins. What chance gives is not looked up but made: noise
//! of the sensor's level and colour goes through the same measurement filter and into the same bins.

use super::bins::{Bins, Totals, all_axes};
use super::rest::{Region, Rest, Split};
use super::spectrum::split_frequency;
use super::watch::Watch;
use crate::model::Model;
use crate::order::descending;
use crate::random;
use crate::rule::rule;
use crate::signals::Signals;
use crate::special::normal_quantile;

/// Noise captures that stand for chance.
const DRAWS: usize = 64;
/// Of which so many are held at once: the filter takes four at a time.
const AT_ONCE: usize = 4;

/// Splits the error of a model over every axis.
pub fn locate(data: &[&Signals], model: &Model) -> Vec<Split> {
    let rest = Rest::of(data, model);
    let axes = all_axes(&rest, model);
    let squares = rest.residual.iter().map(|part| part.iter().map(|r| r * r).collect()).collect();
    let measured = [rest.residual.clone(), squares].map(Totals::of);
    let mut chance: Vec<Chance> = axes.iter().map(Chance::new).collect();
    let one = rest.data.iter().zip(&rest.noise).map(|(signals, noise)| signals.len() + noise.warm());
    let numbers = (AT_ONCE * one.sum::<usize>()) as u64;
    let batches: Vec<u64> = (0..(DRAWS / AT_ONCE) as u64).collect();
    // Each goes on in the one stream where the one before it ends, whichever is made first.
    let made = Watch::new(&|_| true, batches.len()).each(&batches, |batch| {
        let mut noise = random::Noise::new(0x6b6e_6f62).ahead(batch * numbers);
        let draws = noise_captures(&rest, &mut noise).into_iter().map(Totals::of);
        draws.map(|draw| axes.iter().map(|bins| bins.sums(&draw)).collect()).collect::<Vec<Vec<_>>>()
    });
    for sums in made.into_iter().flatten() {
        for ((bins, chance), sums) in axes.iter().zip(&mut chance).zip(&sums) {
            chance.add(bins, sums);
        }
    }
    let mut splits: Vec<Split> = axes
        .iter()
        .zip(chance)
        .map(|(bins, chance)| split(&rest, bins, measured.each_ref().map(|of| bins.sums(of)), &chance))
        .collect();
    splits.push(split_frequency(&rest));
    splits
}

/// What noise does to the bins of one axis.
struct Chance {
    /// Sum over the draws of the squared mean of each bin.
    squares: Vec<f64>,
    /// For each draw the sum of squares that the bin means hold.
    held: Vec<f64>,
}

impl Chance {
    fn new(bins: &Bins) -> Self {
        Self { squares: vec![0.0; bins.len()], held: Vec::with_capacity(DRAWS) }
    }

    fn add(&mut self, bins: &Bins, sums: &[f64]) {
        for ((square, sum), count) in self.squares.iter_mut().zip(sums).zip(&bins.count) {
            *square += (sum / count.max(1.0)).powi(2);
        }
        self.held.push(held(bins, sums));
    }

    fn sd(&self, bin: usize) -> f64 {
        (self.squares[bin] / self.held.len().max(1) as f64).sqrt()
    }
}

/// Sum of squares that the bin means hold.
fn held(bins: &Bins, sums: &[f64]) -> f64 {
    sums.iter().zip(&bins.count).map(|(sum, count)| sum * sum / count.max(1.0)).sum()
}

/// `sums` and `squares` of the residual per bin.
fn split(rest: &Rest<'_>, bins: &Bins, [sums, squares]: [Vec<f64>; 2], chance: &Chance) -> Split {
    let mut by_chance = chance.held.clone();
    by_chance.sort_by(f64::total_cmp);
    let expected = by_chance.iter().sum::<f64>() / by_chance.len().max(1) as f64;
    let upper = by_chance.get(by_chance.len() * 95 / 100).copied().unwrap_or(0.0);
    let mean: Vec<f64> = sums.iter().zip(&bins.count).map(|(sum, count)| sum / count.max(1.0)).collect();
    let limit = normal_quantile(1.0 - 0.5 * rule().alarm / bins.len().max(1) as f64);
    let fails = |bin: usize| bins.count[bin] > 0.0 && mean[bin].abs() > limit * chance.sd(bin);
    Split {
        axis: bins.axis,
        direction: bins.direction.clone(),
        rms: squares.iter().zip(&bins.count).map(|(s, count)| (s / count.max(1.0)).sqrt()).collect(),
        band: (0..bins.len()).map(|bin| crate::special::Z95 * chance.sd(bin)).collect(),
        share: rest.share(held(bins, &sums) - expected),
        part: (held(bins, &sums) - expected).max(0.0) / rest.squares,
        chance: rest.share(upper - expected),
        regions: regions(rest, bins, &sums, fails),
        mean,
        low: bins.low.clone(),
        high: bins.high.clone(),
        count: bins.count.clone(),
    }
}

/// Neighbouring bins that fail, joined; worst first.
fn regions(rest: &Rest<'_>, bins: &Bins, sums: &[f64], fails: impl Fn(usize) -> bool) -> Vec<Region> {
    let mut regions = Vec::new();
    let mut bin = 0;
    while bin < bins.len() {
        let start = bin;
        let joins =
            |bin: usize| bin < bins.len() && fails(bin) && bins.direction[bin] == bins.direction[start];
        while joins(bin) && sums[bin] * sums[start] > 0.0 {
            bin += 1;
        }
        if bin > start {
            let part = start..bin;
            let count: f64 = bins.count[part.clone()].iter().sum();
            let squares: f64 = part.clone().map(|b| sums[b] * sums[b] / bins.count[b]).sum();
            regions.push(Region {
                from: bins.low[start],
                to: bins.high[bin - 1],
                direction: bins.direction[start],
                mean: sums[part].iter().sum::<f64>() / count,
                share: rest.share(squares),
            });
        } else {
            bin += 1;
        }
    }
    regions.sort_by_cached_key(|region| descending(region.share));
    regions
}

/// A few captures of noise alone, through the measurement filter. Uniform noise does: a filtered sum of many
/// samples is as good as normal, and it costs a tenth.
fn noise_captures(rest: &Rest<'_>, random: &mut random::Noise) -> Vec<Vec<Vec<f64>>> {
    let mut draws = vec![Vec::new(); AT_ONCE];
    for (signals, noise) in rest.data.iter().zip(&rest.noise) {
        let mut white = || random.even(signals.len() + noise.warm());
        let mut raw: Vec<Vec<f64>> = (0..AT_ONCE).map(|_| noise.colour(white())).collect();
        for segment in &signals.segments {
            let mut columns: Vec<&mut [f64]> =
                raw.iter_mut().map(|draw| &mut draw[segment.clone()]).collect();
            signals.measure(&mut columns);
        }
        for (draw, raw) in draws.iter_mut().zip(raw) {
            draw.push(raw);
        }
    }
    draws
}
