//! What chance gives an effect whose wave the data choose: the best of all that a scan looks at.
//!
//! The gain of the best of many frequencies is that of noise at its luckiest: for K independent ones and all between them
//! the chance to exceed z (in half variances) is 1 - exp(-K sqrt(pi/3) sqrt(z) e^-z), the expected number of upcrossings of
//! a periodogram (Baluev 2008, MNRAS 385, Equation 6; Rice 1944). Noise that is not white is louder at some frequencies
//! than at others: each band has its own share of them, and its own noise.

use super::chance::Chance;
use super::screen::Screen;
use crate::algebra::dot;
use crate::effects::{Id, Wave};
use crate::fit::band;
use crate::order::descending;
use crate::random::Noise;
use std::f64::consts::{FRAC_PI_3, LN_10};

/// Bands of frequencies, each as wide as the one before times the same factor.
const BANDS: usize = 12;
/// Columns of a wave: sine and cosine.
const WAVE: usize = 2;
/// Waves that an effect with more than one is tried at: the strongest, as the first, second and third of a series, and
/// others that are nearly as strong.
const TRIED: usize = 6;
/// Rounds in which an exceedance is solved for.
const ROUNDS: usize = 8;

/// Whether the data choose where an effect's wave is, out of all frequencies.
pub fn scanned(id: Id) -> bool {
    matches!(id.info().scan, Some(Wave::Torque | Wave::Friction))
}

/// A band: how many independent frequencies it has, and what noise is in a column there, in variances of white noise.
struct Band {
    many: f64,
    noise: f64,
    columns: usize,
}

/// So many gains of an effect by chance; none where there is no motion to scan over.
pub fn gains(screen: &Screen<'_>, chance: &Chance, white: f64, id: Id, draws: usize) -> Vec<f64> {
    let bands = bands(screen, chance, white, id);
    let mut noise = Noise::new(0x7761_7665);
    let many = if bands.is_empty() { 0 } else { draws };
    (0..many).map(|_| drawn(&bands, &mut noise)).collect()
}

fn bands(screen: &Screen<'_>, chance: &Chance, white: f64, id: Id) -> Vec<Band> {
    let Some(([first, last], between)) = band(screen.data) else { return Vec::new() };
    let factor = (last / first).powf((BANDS as f64).recip());
    let amplitude = white.sqrt();
    let at = |band: usize| {
        let low = first * factor.powi(band as i32);
        let model = screen.at_wave(id, [amplitude, (low * factor.sqrt()).recip(), 0.0])?;
        let columns = screen.by_chance(chance, id, &model);
        let noise =
            columns.iter().map(|column| dot(column, column)).sum::<f64>() / (white * columns.len() as f64);
        let many = between * (factor - 1.0) * low / (last - first);
        (noise.is_finite() && many > 0.0).then_some(Band { many, noise, columns: columns.len() })
    };
    (0..BANDS).filter_map(at).collect()
}

/// The gain of the luckiest frequency, and of the waves that come with it.
fn drawn(bands: &[Band], noise: &mut Noise) -> f64 {
    let luckiest = |band: &Band, noise: &mut Noise| band.noise * 2.0 * exceeded(band.many, noise.uniform());
    let mut best: Vec<(f64, &Band)> = bands.iter().map(|band| (luckiest(band, noise), band)).collect();
    best.sort_by_cached_key(|(wave, _)| descending(*wave));
    let Some((wave, band)) = best.first() else { return 0.0 };
    // A wave with its period and phase is two columns, whatever it is written as.
    if band.columns <= WAVE + 1 {
        return *wave;
    }
    let others =
        |noise: &mut Noise| (WAVE..band.columns).map(|_| noise.normal().powi(2)).sum::<f64>() * band.noise;
    wave + (0..TRIED).map(|_| others(noise)).fold(0.0, f64::max)
}

/// What the best of so many independent frequencies and all between them exceeds with this chance, in half variances.
fn exceeded(many: f64, chance: f64) -> f64 {
    // -ln(1 - chance) is how many frequencies exceed it by expectation.
    let expected = -(1.0 - chance).max(f64::MIN_POSITIVE).ln();
    let most = many * FRAC_PI_3.sqrt() / expected.max(f64::MIN_POSITIVE);
    let mut z = most.max(1.0).ln();
    for _ in 0..ROUNDS {
        z = (most.ln() + 0.5 * z.max(0.1).ln()).clamp(0.0, 100.0 * LN_10);
    }
    z
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::super::watch::Watch;
    use super::*;
    use crate::noise;
    use crate::signals::Signals;
    use std::f64::consts::TAU;

    #[test]
    fn the_best_of_many_frequencies_exceeds_what_a_periodogram_of_noise_does() {
        // 60 independent frequencies, looked at sixteen times as densely, over 400 positions at random.
        let (many, draws) = (60.0, 400);
        let mut noise = Noise::new(5);
        let mut largest: Vec<f64> = (0..draws)
            .map(|_| {
                let samples: Vec<(f64, f64)> = (0..400).map(|_| (noise.uniform(), noise.normal())).collect();
                let power = |k: usize| {
                    let w = std::f64::consts::TAU * k as f64 / 16.0;
                    let (mut c, mut s) = (0.0, 0.0);
                    for (x, y) in &samples {
                        let (sin, cos) = (w * x).sin_cos();
                        (c, s) = (c + y * cos, s + y * sin);
                    }
                    (c * c + s * s) / 400.0
                };
                (16..=16 * 61).map(power).fold(0.0, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        for share in [0.5, 0.9] {
            let (seen, said) = (largest[(share * f64::from(draws)) as usize], exceeded(many, 1.0 - share));
            assert!((seen - said).abs() < 0.6, "{share}: {seen} {said}");
        }
    }

    #[test]
    fn what_is_exceeded_by_chance_has_the_upcrossings_that_the_chance_asks_for() {
        for many in [5.0_f64, 60.0, 1e4] {
            for chance in [0.3, 0.1, 1e-3] {
                let z = exceeded(many, chance);
                let expected = many * FRAC_PI_3.sqrt() * z.sqrt() * (-z).exp();
                assert!((expected / -(1.0_f64 - chance).ln() - 1.0).abs() < 1e-3, "{many} {chance}: {z}");
            }
        }
    }

    #[test]
    fn gains_grow_with_the_noise_and_with_the_waves_that_come_along() {
        let drawn = |noise: f64, columns: usize| {
            let band = |many: f64| Band { many, noise, columns };
            let mut random = Noise::new(9);
            (0..200).map(|_| drawn(&[band(5.0), band(40.0)], &mut random)).sum::<f64>() / 200.0
        };
        let one = drawn(1.0, 2);
        for columns in [2, 3, 4, 6] {
            let many = drawn(1.0, columns);
            assert!((drawn(3.0, columns) / many - 3.0).abs() < 1e-9, "{columns}");
            // Each column more adds a chi-square number of mean one, the best of a few of them.
            let more = (columns as f64 - 2.0).max(0.0) - f64::from(u8::from(columns == 3));
            assert!(many >= one + more && many <= one + 6.0 * more + 0.5, "{columns}: {many} {one}");
        }
    }

    #[test]
    fn a_band_of_waves_has_the_noise_of_its_middle_and_all_bands_have_all_frequencies() {
        const SPEED: f64 = 8.0;
        let model = knob(&[], &[]);
        let still = recorded(&model, "a");
        let n = still.len();
        let turned = Signals {
            theta: still.t.iter().map(|t| SPEED * t).collect(),
            omega: vec![SPEED; n],
            alpha: vec![0.0; n],
            forward: vec![1.0; n],
            ..still
        };
        let data = [&turned];
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &model, &watch);
        let ([first, last], between) = band(&data).unwrap();
        let slow = noise::Noise { coefficients: vec![-0.9], innovation: 0.19 * SD * SD };
        let white = noise::Noise::white(SD * SD);
        for noise in [slow, white] {
            let noises = [noise];
            let chance = Chance::of(&data, &noises, &screen.thinned);
            let found = bands(&screen, &chance, SD * SD, Id::Detent);
            assert_eq!(found.len(), BANDS);
            let many: f64 = found.iter().map(|band| band.many).sum();
            assert!((many / between - 1.0).abs() < 1e-9, "{many} {between}");
            for (at, band) in found.iter().enumerate() {
                // Turned at this speed, a wave over position is one over time.
                let middle = first * (last / first).powf((at as f64 + 0.5) / BANDS as f64);
                let power = noises[0].power(middle * SPEED / TAU / turned.rate_hz) / (SD * SD);
                assert!((band.noise / power - 1.0).abs() < 0.1, "{at}: {} {power}", band.noise);
            }
            let mut gains = gains(&screen, &chance, SD * SD, Id::Detent, 399);
            assert_eq!(gains.len(), 399);
            gains.sort_by(f64::total_cmp);
            if noises[0].coefficients.is_empty() {
                let half = 2.0 * exceeded(between, 0.5);
                assert!((gains[199] - half).abs() < 1.0, "{} {half}", gains[199]);
            }
        }
    }
}
