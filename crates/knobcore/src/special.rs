//! Special functions of statistics.

use std::f64::consts::SQRT_2;

/// Two-sided 95 % quantile of the normal distribution.
pub const Z95: f64 = 1.959_963_984_540_054;

/// The error function, to 1.2e-7 (the rational approximation of erfc in Press et al. 1992, Numerical
/// Recipes, 2nd ed., section 6.2).
pub fn erf(x: f64) -> f64 {
    const C: [f64; 10] = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let t = 1.0 / (1.0 + 0.5 * x.abs());
    let polynomial = C.iter().rev().fold(0.0, |sum, c| sum * t + c);
    (1.0 - t * (polynomial - x * x).exp()).copysign(x)
}

/// The standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * (1.0 + erf(z / SQRT_2))
}

/// The z that a standard normal number stays below with probability `p`, by bisection; within [-6, 6].
pub fn normal_quantile(p: f64) -> f64 {
    let (mut low, mut high) = (-6.0, 6.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if normal_cdf(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// What a chi-square of so many degrees over their number stays below as a normal number stays below `z`, by the cube root of
/// Wilson & Hilferty (1931).
pub fn chi_square_share(degrees: f64, z: f64) -> f64 {
    let part = 2.0 / (9.0 * degrees);
    (1.0 - part + z * part.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_and_its_quantiles_agree_with_tables() {
        for (z, p) in [(0.0, 0.5), (1.0, 0.841_344_746), (-1.959_963_985, 0.025), (3.0, 0.998_650_102)] {
            assert!((normal_cdf(z) - p).abs() < 2e-7 && (normal_quantile(p) - z).abs() < 1e-4);
        }
    }
}
