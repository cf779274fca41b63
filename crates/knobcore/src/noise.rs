//! Noise of any spectrum: an autoregression of white noise.

use crate::filter::ZeroPhase;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Longest memory, samples.
pub const MOST: usize = 40;
/// Frequencies over which a spectrum is summed.
const FREQUENCIES: usize = 4096;
/// Samples after which a recursion has forgotten how it began.
const WARM: usize = 512;

/// n_t = e_t - a_1 n_(t-1) - a_2 n_(t-2) - ... with white e.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// a_1, a_2, ...; none where the noise is white.
    pub coefficients: Vec<f64>,
    /// Variance of e, (N m)^2.
    pub innovation: f64,
}

impl Noise {
    /// White noise of this variance.
    pub fn white(variance: f64) -> Self {
        Self { coefficients: Vec::new(), innovation: variance }
    }

    /// Of autocovariances at the lags 0, 1, ... of `n` samples, by the Yule-Walker equations (Levinson 1947, Durbin
    /// 1960); the order by BIC.
    pub fn autoregressive(covariance: &[f64], n: f64) -> Self {
        let most = MOST.min(covariance.len().saturating_sub(1));
        let (mut a, mut error) = (Vec::<f64>::new(), covariance.first().copied().unwrap_or(0.0));
        let mut best = (f64::INFINITY, a.clone(), error);
        for order in 0..=most {
            if error.is_nan() || error <= 0.0 {
                break;
            }
            let bic = n * error.ln() + order as f64 * n.ln();
            if bic < best.0 {
                best = (bic, a.clone(), error);
            }
            if order == most {
                break;
            }
            let forecast: f64 = a.iter().enumerate().map(|(i, a)| a * covariance[order - i]).sum();
            let reflection = -(covariance[order + 1] + forecast) / error;
            let mirrored: Vec<f64> = a.iter().rev().map(|x| x * reflection).collect();
            for (own, more) in a.iter_mut().zip(mirrored) {
                *own += more;
            }
            a.push(reflection);
            error *= 1.0 - reflection * reflection;
        }
        Self { coefficients: best.1, innovation: best.2 }
    }

    /// Power at this share of the sampling rate; its mean over all is the variance, (N m)^2.
    pub fn power(&self, share: f64) -> f64 {
        let once = Complex64::cis(-TAU * share);
        let (mut turn, mut sum) = (once, Complex64::ONE);
        for a in &self.coefficients {
            sum += turn * *a;
            turn *= once;
        }
        self.innovation / sum.norm_sqr()
    }

    /// Power behind a measurement filter at this share of the sampling rate, (N m)^2.
    pub fn passed(&self, filter: Option<&ZeroPhase>, share: f64) -> f64 {
        let gain =
            filter.map_or(1.0, |filter| filter.sos().power_gain(share * filter.sos().rate_hz()).powi(2));
        gain * self.power(share)
    }

    /// Variance behind a measurement filter, (N m)^2.
    pub fn behind(&self, filter: Option<&ZeroPhase>) -> f64 {
        if self.coefficients.is_empty() {
            return self.innovation * filter.map_or(1.0, |filter| filter.sos().mean_power());
        }
        let shares = (0..FREQUENCIES).map(|k| (k as f64 + 0.5) / (2 * FREQUENCIES) as f64);
        shares.map(|share| self.passed(filter, share)).sum::<f64>() / FREQUENCIES as f64
    }

    /// Samples behind a measurement filter that tell of its variance what an independent one would.
    pub fn alike(&self, filter: Option<&ZeroPhase>) -> f64 {
        let (mut sum, mut squares) = (0.0, 0.0);
        for share in (0..FREQUENCIES).map(|k| (k as f64 + 0.5) / (2 * FREQUENCIES) as f64) {
            let power = self.passed(filter, share);
            (sum, squares) = (sum + power, squares + power * power);
        }
        squares * FREQUENCIES as f64 / (sum * sum)
    }

    /// Samples that have to go through it before its noise is steady.
    pub fn warm(&self) -> usize {
        if self.coefficients.is_empty() { 0 } else { WARM }
    }

    /// Makes noise of this colour from white noise of unit variance, which has [`Noise::warm`] samples more in front.
    pub fn colour(&self, mut white: Vec<f64>) -> Vec<f64> {
        let scale = self.innovation.sqrt();
        white.iter_mut().for_each(|x| *x *= scale);
        self.recur(&mut white);
        white.split_off(self.warm())
    }

    /// The transpose of the recursion, in place: what white noise of unit variance is multiplied with where the noise
    /// is multiplied with `column`.
    pub fn colour_back(&self, column: &mut [f64]) {
        let scale = self.innovation.sqrt();
        column.iter_mut().for_each(|x| *x *= scale);
        column.reverse();
        self.recur(column);
        column.reverse();
    }

    fn recur(&self, y: &mut [f64]) {
        let order = self.coefficients.len();
        for at in 0..if order > 0 { y.len() } else { 0 } {
            let past = y[at.saturating_sub(order)..at].iter().rev();
            let memory: f64 = self.coefficients.iter().zip(past).map(|(a, y)| a * y).sum();
            y[at] -= memory;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    fn slow() -> Noise {
        Noise { coefficients: vec![-0.9], innovation: 0.19 }
    }

    #[test]
    fn an_autoregression_is_found_from_its_covariance_and_has_its_variance() {
        let covariance: Vec<f64> = (0..20).map(|lag| 0.9_f64.powi(lag)).collect();
        let found = Noise::autoregressive(&covariance, 1e4);
        assert!((found.innovation - 0.19).abs() < 1e-12 && (found.coefficients[0] + 0.9).abs() < 1e-12);
        assert_eq!(found.coefficients.len(), 1);
        assert!((slow().behind(None) - 1.0).abs() < 1e-6);
        let alike = (1.0 + 0.81) / (1.0 - 0.81); // Bartlett 1946
        assert!((slow().alike(None) / alike - 1.0).abs() < 1e-6 && Noise::white(2.0).alike(None) == 1.0);
    }

    #[test]
    fn coloured_noise_has_the_variance_that_is_promised() {
        let mut noise = random::Noise::new(7);
        let made = slow().colour((0..200_000 + WARM).map(|_| noise.normal()).collect());
        let variance = made.iter().map(|x| x * x).sum::<f64>() / made.len() as f64;
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
    }

    #[test]
    fn the_product_with_coloured_noise_is_that_of_the_transpose_with_white_noise() {
        let mut noise = random::Noise::new(8);
        let white: Vec<f64> = (0..50 + WARM).map(|_| noise.normal()).collect();
        let column: Vec<f64> = (0..50).map(|i| f64::from(i).sin()).collect();
        let product: f64 = slow().colour(white.clone()).iter().zip(&column).map(|(a, b)| a * b).sum();
        let mut back = [vec![0.0; WARM], column].concat();
        slow().colour_back(&mut back);
        let transposed: f64 = back.iter().zip(&white).map(|(a, b)| a * b).sum();
        assert!((product - transposed).abs() < 1e-9);
    }
}
