//! The error along frequency: periodograms of the residual beside those of noise alone.

use super::rest::{Region, Rest, Split};
use crate::order::{descending, nth};
use crate::periodogram::{Periodogram, windows};
use crate::rule::rule;
use crate::signals::Signals;
use crate::special::{chi_square_share, normal_quantile};

/// Longest window, samples: resolves a line to about a hertz at 5 kHz.
const LONGEST: usize = 8192;
/// Shortest window that is worth a spectrum.
const SHORTEST: usize = 256;
/// First bin that can hold a line: slower than that it is a drift.
const SLOWEST: usize = 4;
/// Bins to either side that count as around.
const AROUND: usize = 20;

/// Splits the error over frequency: what stands out as lines.
pub fn split_frequency(rest: &Rest<'_>) -> Split {
    let longest =
        rest.data.iter().flat_map(|s| s.segments.iter().map(ExactSizeIterator::len)).max().unwrap_or(0);
    let mut window = SHORTEST;
    while 2 * window <= LONGEST && 8 * window <= longest {
        window *= 2;
    }
    let periodogram = Periodogram::of(window);
    let cells = window / 2 + 1;
    let (mut power, mut noise, mut count) = (vec![0.0; cells], vec![0.0; cells], 0.0);
    let rate = rest.data.first().map_or(1.0, |s| s.rate_hz);
    for ((signals, residual), of_sensor) in rest.data.iter().zip(&rest.residual).zip(&rest.noise) {
        let starts = windows(&signals.segments, window);
        for own in periodogram.powers(residual, &starts, 0..cells).windows() {
            power.iter_mut().zip(own).for_each(|(sum, power)| *sum += power);
        }
        count += starts.len() as f64;
        for (cell, sum) in noise.iter_mut().enumerate() {
            let share = cell as f64 / window as f64;
            *sum += starts.len() as f64 * of_sensor.power(share) * gain(signals, share);
        }
    }
    let windows = f64::max(count, 1.0);
    // A mean of K overlapping periodograms is chi-square with about 1.9 K / 1.05 degrees of freedom (Welch
    // 1967).
    let degrees = 1.8 * windows;
    let quantile = |p: f64| chi_square_share(degrees, normal_quantile(p));
    let (usual, limit) = (quantile(0.95), quantile(1.0 - rule().alarm / cells as f64));
    // Power per bin is scaled so that its mean over both halves of the spectrum is the variance.
    let used: f64 = rest.data.iter().map(|s| s.used() as f64).sum();
    let scale = 2.0 / window as f64 / windows;
    let (power, noise): (Vec<f64>, Vec<f64>) =
        power.iter().zip(&noise).map(|(p, n)| (p * scale, n * scale)).unzip();
    let hz = |cell: f64| (cell * rate / window as f64).max(0.0);
    let fails = |cell: usize| power[cell] > limit * noise[cell] && power[cell] > 0.0;
    // Only lines count: a residual that lies over position or velocity fills the spectrum broadly as well, and
    // frequency says nothing about it.
    let floor = surroundings(&power);
    let line = |cell: usize| cell >= SLOWEST && fails(cell) && power[cell] > rule().line * floor[cell];
    let mut beyond = 0.0;
    let mut regions = Vec::new();
    let mut cell = 0;
    while cell < cells {
        let start = cell;
        while cell < cells && line(cell) {
            cell += 1;
        }
        if cell > start {
            let squares: f64 = (start..cell).map(|c| power[c] - floor[c]).sum();
            beyond += squares;
            let (from, to) = (hz(start as f64 - 0.5), hz(cell as f64 - 0.5));
            regions.push(Region {
                from,
                to,
                direction: 0,
                mean: squares.sqrt(),
                share: rest.share(squares * used),
            });
        } else {
            cell += 1;
        }
    }
    regions.sort_by_cached_key(|region| descending(region.share));
    Split {
        axis: "frequency",
        low: (0..cells).map(|c| hz(c as f64 - 0.5)).collect(),
        high: (0..cells).map(|c| hz(c as f64 + 0.5)).collect(),
        direction: vec![0; cells],
        count: vec![windows; cells],
        mean: power.iter().map(|p| p.sqrt()).collect(),
        rms: power.iter().map(|p| p.sqrt()).collect(),
        band: noise.iter().map(|n| (n * usual).sqrt()).collect(),
        share: rest.share(beyond * used),
        part: beyond * used / rest.squares,
        chance: 0.0,
        regions,
    }
}

/// Median power around each bin.
fn surroundings(power: &[f64]) -> Vec<f64> {
    let around = |cell: usize| {
        let mut near = power[cell.saturating_sub(AROUND)..(cell + AROUND + 1).min(power.len())].to_vec();
        let middle = near.len() / 2;
        nth(&mut near, middle).unwrap_or(0.0)
    };
    (0..power.len()).map(around).collect()
}

/// What the forward-backward filter does to the power of noise at this share of the sampling rate.
fn gain(signals: &Signals, share: f64) -> f64 {
    signals.filter.as_ref().map_or(1.0, |f| f.sos().power_gain(share * f.sos().rate_hz()).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;
    use crate::random;
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 1000.0;

    /// The regions of a residual of eight seconds: noise, and a wave of this frequency and size beside it.
    fn lines(hz: f64, size: f64, sd: f64) -> Vec<Region> {
        let n = 8192;
        let signals =
            Signals { rate_hz: RATE_HZ, weight: vec![1.0; n], segments: vec![0..n; 1], ..Signals::default() };
        let mut noise = random::Noise::new(4);
        let wave = |at: usize| size * (TAU * hz * at as f64 / RATE_HZ).sin();
        let residual: Vec<f64> = (0..n).map(|at| wave(at) + sd * noise.normal()).collect();
        let squares: f64 = residual.iter().map(|x| x * x).sum();
        let rest = Rest {
            data: &[&signals],
            residual: vec![residual],
            torque: Vec::new(),
            noise: vec![Noise::white(1.0)],
            excess: squares - n as f64,
            squares,
        };
        split_frequency(&rest).regions
    }

    #[test]
    fn a_line_is_one_where_it_is_faster_than_a_drift_and_beyond_chance() {
        // Steps of half a hertz, with eight windows and more in a capture.
        let line = &lines(50.0, 1.0, 1.0)[..];
        assert!(line.len() == 1 && line[0].from < 50.0 && 50.0 < line[0].to, "{line:?}");
        assert!(line[0].to - line[0].from < 4.0 && (line[0].mean - 0.5_f64.sqrt()).abs() < 0.1, "{line:?}");
        assert!(lines(0.5 * RATE_HZ / 512.0, 1.0, 1.0).is_empty(), "slower than the slowest");
        assert!(lines(50.0, 0.08, 0.01).is_empty(), "far above what is around, but within what noise may be");
        assert!(lines(50.0, 0.0, 1.0).is_empty());
    }
}
