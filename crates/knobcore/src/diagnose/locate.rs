//! Where the error sits: split over position, velocity, acceleration, time, load and history.
//!
//! Along each axis the residual is averaged in bins, and held against what noise of the sensor's level and colour gives
//! the same bins behind the same measurement filter.

use super::bands::{Band, Summed};
use super::bins::{Bins, Totals, all_axes};
use super::rest::{Region, Rest, Split};
use super::spectrum::split_frequency;
use crate::model::Model;
use crate::noise::Noise;
use crate::order::descending;
use crate::rule::rule;
use crate::signals::Signals;
use crate::special::normal_quantile;

/// Splits the error of a model over every axis.
pub fn locate(data: &[&Signals], model: &Model) -> Vec<Split> {
    let rest = Rest::of(data, model);
    let squares = rest.residual.iter().map(|part| part.iter().map(|r| r * r).collect()).collect();
    let measured = [rest.residual.clone(), squares].map(Totals::of);
    let of_capture = |(signals, noise): (&&Signals, &Noise)| Summed::of(noise, signals.filter.as_ref());
    let noise: Vec<Summed> = data.iter().zip(&rest.noise).map(of_capture).collect();
    let along = |bins: &Bins| {
        split(&rest, bins, measured.each_ref().map(|of| bins.sums(of)), &Band::of(bins, &noise))
    };
    let mut splits: Vec<Split> = all_axes(&rest, model).iter().map(along).collect();
    splits.push(split_frequency(&rest));
    splits
}

/// Sum of squares that the bin means hold.
fn held(bins: &Bins, sums: &[f64]) -> f64 {
    sums.iter().zip(&bins.count).map(|(sum, count)| sum * sum / count.max(1.0)).sum()
}

/// `sums` and `squares` of the residual per bin.
fn split(rest: &Rest<'_>, bins: &Bins, [sums, squares]: [Vec<f64>; 2], chance: &Band) -> Split {
    let [expected, upper] = chance.held;
    let mean: Vec<f64> = sums.iter().zip(&bins.count).map(|(sum, count)| sum / count.max(1.0)).collect();
    let limit = normal_quantile(1.0 - 0.5 * rule().alarm / bins.len().max(1) as f64);
    let fails = |bin: usize| bins.count[bin] > 0.0 && mean[bin].abs() > limit * chance.sd[bin];
    Split {
        axis: bins.axis,
        direction: bins.direction.clone(),
        rms: squares.iter().zip(&bins.count).map(|(s, count)| (s / count.max(1.0)).sqrt()).collect(),
        band: chance.sd.iter().map(|sd| crate::special::Z95 * sd).collect(),
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
