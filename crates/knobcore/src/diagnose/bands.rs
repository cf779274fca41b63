//! What noise alone gives the bins of an axis: worked out, not drawn.
//!
//! Noise of one colour behind one filter is steady. With F(n) the variance of its sum over n neighbouring samples, its sums
//! over stretches `a..b` and `c..d`, one after the other, have the covariance
//! (F(d - a) - F(c - a) - F(d - b) + F(c - b)) / 2, and a bin is the sum over some stretches.

use super::bins::{Bins, Stretch};
use crate::filter::ZeroPhase;
use crate::fourier::Transform;
use crate::noise::Noise;
use crate::special::{chi_square_share, normal_quantile};

/// Samples that stand for an endless spectrum: noise is taken to have forgotten what was half as many before.
const LENGTH: usize = 4096;
/// Of the sum over all lags, the part that those farther apart may have together.
const FORGOTTEN: f64 = 1e-2;
/// Bins that lie farther apart are taken to have nothing to do with each other.
const NEAR: usize = 128;

/// Noise of a capture, as it is summed.
pub struct Summed {
    /// Variances of the sums over 0, 1, 2, ... neighbours, (N m)^2; from then on they rise evenly.
    variances: Vec<f64>,
    rise: f64,
}

impl Summed {
    /// Noise behind a measurement filter.
    pub fn of(noise: &Noise, filter: Option<&ZeroPhase>) -> Self {
        let covariance = autocovariance(noise, filter);
        let sizes: f64 = covariance.iter().map(|x| x.abs()).sum();
        let mut beyond = 0.0;
        let seldom = covariance.iter().rposition(|x| {
            beyond += x.abs();
            beyond > FORGOTTEN * sizes
        });
        let reach = seldom.map_or(1, |last| last + 1);
        let (mut sum, mut rise) = (0.0, covariance[0]);
        let mut variances = vec![0.0];
        for later in covariance.iter().skip(1).take(reach) {
            sum += rise;
            variances.push(sum);
            rise += 2.0 * later;
        }
        Self { variances, rise }
    }

    /// The variance of the sum over so many neighbours.
    #[inline]
    fn over(&self, samples: usize) -> f64 {
        let last = self.variances.len() - 1;
        match self.variances.get(samples) {
            Some(variance) => *variance,
            None => self.variances[last] + self.rise * (samples - last) as f64,
        }
    }

    /// The covariance of the sums over a stretch and a later one.
    #[inline]
    fn both(&self, one: &Stretch, later: &Stretch) -> f64 {
        let (outer, inner) = (self.over(later.to - one.from), self.over(later.from - one.to));
        0.5 * (outer + inner - self.over(later.from - one.from) - self.over(later.to - one.to))
    }
}

/// Products of noise with itself so many samples later, (N m)^2, for 0, 1, 2, ... samples.
fn autocovariance(noise: &Noise, filter: Option<&ZeroPhase>) -> Vec<f64> {
    let power: Vec<f64> = (0..=LENGTH / 2).map(|k| noise.passed(filter, k as f64 / LENGTH as f64)).collect();
    let transform = Transform::of(LENGTH);
    let mut rows = transform.rows(1);
    // The other half of the spectrum is its image.
    (0..LENGTH).for_each(|k| rows[k % 2][k / 2] = power[k.min(LENGTH - k)]);
    let [mut sums, _] = transform.forward(1, &mut rows, 0..LENGTH / 2 + 1);
    sums.iter_mut().for_each(|sum| *sum /= LENGTH as f64);
    sums
}

/// What noise gives the bins of one axis.
pub struct Band {
    /// Standard deviation of the mean of each bin, N m.
    pub sd: Vec<f64>,
    /// Sum of squares that the means hold: what it is on average, and what it stays below in 95 of 100 captures, (N m)^2.
    pub held: [f64; 2],
}

impl Band {
    /// Of noise in each capture.
    pub fn of(bins: &Bins, noise: &[Summed]) -> Self {
        let many = bins.len();
        let near = many.min(NEAR);
        // Covariances of the sums of bins with those that come after them.
        let mut covariance = vec![0.0; many * near];
        for (runs, summed) in bins.runs.iter().zip(noise) {
            let reach = summed.variances.len();
            for (at, run) in runs.iter().enumerate() {
                covariance[run.bin * near] += summed.over(run.to - run.from);
                for later in runs[at + 1..].iter().take_while(|later| later.from < run.to + reach) {
                    let (low, high) = (run.bin.min(later.bin), run.bin.max(later.bin));
                    if high - low < near {
                        let twice = if high == low { 2.0 } else { 1.0 };
                        covariance[low * near + high - low] += twice * summed.both(run, later);
                    }
                }
            }
        }
        let share = |bin: usize| bins.count[bin].max(1.0).recip();
        let own = |bin: usize| covariance[bin * near].max(0.0);
        let expected: f64 = (0..many).map(|bin| share(bin) * own(bin)).sum();
        let mut spread = 0.0;
        for (bin, row) in covariance.chunks_exact(near.max(1)).enumerate() {
            for (apart, covariance) in row.iter().enumerate().take(many - bin) {
                let times = if apart > 0 { 4.0 } else { 2.0 };
                spread += times * covariance * covariance * share(bin) * share(bin + apart);
            }
        }
        let sd = (0..many).map(|bin| share(bin) * own(bin).sqrt()).collect();
        Self { sd, held: [expected, upper(expected, spread)] }
    }
}

/// What a sum of squares with this mean and variance stays below in 95 of 100 cases, as a chi-square of as many degrees
/// (Satterthwaite 1946).
fn upper(mean: f64, variance: f64) -> f64 {
    if variance <= 0.0 {
        return mean;
    }
    mean * chi_square_share(2.0 * mean * mean / variance, normal_quantile(0.95))
}

#[cfg(test)]
mod tests {
    use super::super::bins::all_axes;
    use super::super::rest::Rest;
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::*;
    use crate::filter::cheby2;
    use crate::random;
    use crate::signals::Signals;

    const DRAWS: usize = 2000;
    const ENDS: usize = 60;

    /// Means of drawn noise in the bins of each axis, draw by draw.
    fn drawn(signals: &Signals, noise: &Noise, axes: &[Bins]) -> Vec<Vec<Vec<f64>>> {
        let mut random = random::Noise::new(5);
        let mut draws = vec![Vec::with_capacity(DRAWS); axes.len()];
        for _ in 0..DRAWS {
            let white = (0..signals.len() + noise.warm()).map(|_| random.normal());
            let mut column = noise.colour(white.collect());
            signals.measure(&mut [&mut column]);
            for (bins, draws) in axes.iter().zip(&mut draws) {
                let mut means = vec![0.0; bins.len()];
                for run in &bins.runs[0] {
                    means[run.bin] += column[run.from..run.to].iter().sum::<f64>() / bins.count[run.bin];
                }
                draws.push(means);
            }
        }
        draws
    }

    #[test]
    fn bins_hold_of_noise_of_any_colour_what_drawn_noise_puts_there() {
        let model = knob(&[], &[]);
        for coefficients in [vec![], vec![-0.9], vec![-1.2, 0.6]] {
            let noise = Noise { coefficients, innovation: SD * SD };
            let mut signals = recorded(&model, "a");
            signals.filter = Some(ZeroPhase::new(cheby2(3, 20.0, 150.0, signals.rate_hz).unwrap()));
            signals.filter_torque();
            let counted = ENDS..signals.len() - ENDS;
            signals.weight.iter_mut().enumerate().for_each(|(at, w)| *w = f64::from(counted.contains(&at)));
            let data = [&signals];
            let summed = [Summed::of(&noise, signals.filter.as_ref())];
            assert!(summed[0].variances.len() < 400);
            let axes = all_axes(&Rest::of(&data, &model), &model);
            for (bins, draws) in axes.iter().zip(drawn(&signals, &noise, &axes)) {
                let band = Band::of(bins, &summed);
                for bin in (0..bins.len()).filter(|bin| bins.count[*bin] > 0.0) {
                    let square = draws.iter().map(|draw| draw[bin].powi(2)).sum::<f64>() / DRAWS as f64;
                    let ratio = band.sd[bin] / square.sqrt();
                    assert!((ratio - 1.0).abs() < 0.08, "{} {bin}: {ratio}", bins.axis);
                }
                let held =
                    |draw: &Vec<f64>| draw.iter().zip(&bins.count).map(|(x, n)| n * x * x).sum::<f64>();
                let mut held: Vec<f64> = draws.iter().map(held).collect();
                held.sort_by(f64::total_cmp);
                let mean = held.iter().sum::<f64>() / DRAWS as f64;
                let ratios = [band.held[0] / mean, band.held[1] / held[DRAWS * 95 / 100]];
                assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.05), "{} {ratios:?}", bins.axis);
            }
        }
    }

    #[test]
    fn white_noise_sums_to_its_variance_times_how_many_there_are() {
        let summed = Summed::of(&Noise::white(4.0), None);
        for samples in [0, 1, 2, 3000, 100_000] {
            let expected = 4.0 * samples as f64;
            assert!((summed.over(samples) - expected).abs() <= 1e-6 * expected, "{samples}");
        }
        assert_eq!(upper(0.0, 0.0), 0.0);
        // The 95 % quantile of a chi-square of ten degrees, whose variance is twenty.
        assert!((upper(10.0, 20.0) - 18.307).abs() < 0.05);
    }
}
