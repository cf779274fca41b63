//! What chance gives: the gain of every effect where nothing is missing.
//!
//! The parametric bootstrap through the whole chain: noise of the sensor, the measurement filter, the
//! projection off the base model, every start of every effect. All of it is linear, so the noise need not be drawn
//! sample by sample: the products of the signatures with filtered noise are normal, with the covariance of the
//! filtered signatures.

use super::chosen;
use super::screen::{Screen, Start, evenly};
use crate::effects::{Id, Place};
use crate::fit::add_products;
use crate::floor::doubt;
use crate::noise::Noise;
use crate::random;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::collections::BTreeMap;

/// Captures of noise alone.
const DRAWS: usize = 999;
/// Signatures of an effect that are looked at, over all of its starts.
const MOST: usize = 40;
/// Cube root of the smallest variance that noise is drawn with, of what it was read to have.
const SMALLEST: f64 = 0.3;

/// Gains of effects by chance.
pub struct Null {
    /// For each effect mean and standard deviation of its gain by chance.
    scale: BTreeMap<Id, (f64, f64)>,
    /// The largest standardised gain over all effects in each draw, ascending.
    largest: Vec<f64>,
}

impl Null {
    /// Of these effects and starts (some of them, if no longer wanted) and the noise of each capture; gains are in
    /// variances of white noise that would leave as much, `white`. The screen tells of `chance`.
    pub fn of<'b>(
        screen: &Screen<'_>,
        noises: &[Noise],
        white: f64,
        effects: impl Iterator<Item = (Id, &'b [Start])>,
    ) -> Self {
        // Start by start the signatures that it spans. The hidden motion of a coupling has none at its neutral values.
        let (scanned, effects): (Vec<_>, Vec<_>) = effects
            .filter(|(id, starts)| id.info().place != Place::Coupling && !starts.is_empty())
            .partition(|(id, _)| chosen::scanned(*id));
        let starts: Vec<(Id, &Start)> = effects
            .into_iter()
            .flat_map(|(id, starts)| evenly(starts, MOST).map(move |start| (id, start)))
            .collect();
        let mut groups: Vec<(Id, std::ops::Range<usize>)> = Vec::new();
        let mut columns: Vec<&[f64]> = Vec::new();
        let mut of: BTreeMap<Id, usize> = BTreeMap::new();
        for (id, Start { by_chance: own, .. }) in starts {
            let before = of.entry(id).or_default();
            if *before < MOST {
                *before += own.len();
                groups.push((id, columns.len()..columns.len() + own.len()));
                columns.extend(own.iter().map(Vec::as_slice));
            }
        }
        let factor = covariance_root(&columns, white);
        let mut noise = random::Noise::new(0x6e75_6c6c);
        let mut gains: BTreeMap<Id, Vec<f64>> = BTreeMap::new();
        for _ in 0..DRAWS {
            let z = &factor * DVector::from_fn(factor.nrows(), |_, _| noise.normal());
            let mut best: BTreeMap<Id, f64> = BTreeMap::new();
            // What a model absorbs whole, as a constant torque beside friction of either direction, gains nothing.
            for (id, group) in groups.iter().filter(|(_, group)| !group.is_empty()) {
                let gain: f64 = z.as_slice()[group.clone()].iter().map(|z| z * z).sum();
                let slot = best.entry(*id).or_default();
                *slot = slot.max(gain);
            }
            best.into_iter().for_each(|(id, gain)| gains.entry(id).or_default().push(gain));
        }
        if let Some(chance) = &screen.chance {
            let waves = screen
                .watch
                .each(&scanned, |(id, _)| (*id, chosen::gains(screen, chance, white, *id, DRAWS)));
            gains.extend(waves.into_iter().filter(|(_, gains)| !gains.is_empty()));
        }
        let off = off(doubt(screen.data, noises));
        gains.values_mut().for_each(|gains| gains.iter_mut().zip(&off).for_each(|(gain, off)| *gain *= off));
        let scale: BTreeMap<Id, (f64, f64)> = gains.iter().map(|(id, g)| (*id, spread(g))).collect();
        let mut largest: Vec<f64> = (0..DRAWS)
            .map(|draw| {
                let standardised = gains.iter().map(|(id, g)| (g[draw] - scale[id].0) / scale[id].1);
                standardised.fold(f64::NEG_INFINITY, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        Self { scale, largest }
    }

    /// Chance that any effect of the catalogue gains so much, in its own scale, where nothing is missing.
    pub fn p_value(&self, id: Id, gain: f64) -> f64 {
        // A coupling has as many parameters as the widest of the others.
        let widest = self.scale.values().copied().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((mean, sd)) = self.scale.get(&id).copied().or(widest) else { return 1.0 };
        if gain <= mean {
            return 1.0;
        }
        let standardised = (gain - mean) / sd;
        let above = self.largest.len() - self.largest.partition_point(|x| *x < standardised);
        (1 + above) as f64 / (1 + self.largest.len()) as f64
    }
}

/// What gains are off by in each draw, for a noise of which the variance is known to this share alone: it is one over that
/// of as many independent samples (Student 1908), by Wilson & Hilferty 1931.
fn off(error: f64) -> Vec<f64> {
    let ninth = error * error / 9.0; // 2 / (9 n) of n samples
    let mut noise = random::Noise::new(0x6f66_6600);
    let square = |_| (1.0 - ninth + noise.normal() * ninth.sqrt()).max(SMALLEST).powi(3);
    (0..DRAWS).map(square).map(f64::recip).collect()
}

fn spread(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (mean, variance.sqrt().max(f64::MIN_POSITIVE))
}

/// A root of the covariance of the products of signatures with noise, given what they become.
fn covariance_root(columns: &[&[f64]], white: f64) -> DMatrix<f64> {
    let k = columns.len();
    let mut gram = DMatrix::zeros(k, k);
    add_products(columns, gram.as_mut_slice());
    // Signatures of neighbouring starts are nearly the same.
    gram /= white;
    let ridge = 1e-9 * gram.diagonal().amax();
    gram += DMatrix::from_diagonal_element(k, k, ridge);
    Cholesky::new(gram).map_or_else(|| DMatrix::zeros(k, k), Cholesky::unpack)
}

#[cfg(test)]
mod tests {
    use super::super::chance::Chance;
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::super::watch::Watch;
    use super::*;

    #[test]
    fn gains_by_chance_have_a_mean_and_a_spread() {
        assert_eq!(spread(&[1.0, 2.0, 3.0, 4.0]), (2.5, 1.25_f64.sqrt()));
        let null =
            Null { scale: BTreeMap::from([(Id::Stribeck, (10.0, 2.0))]), largest: vec![-1.0, 0.0, 1.0, 2.0] };
        let p = |gain: f64| null.p_value(Id::Stribeck, gain);
        // One of four is above 1.5 standard deviations; no gain below the mean is rare.
        assert_eq!((p(13.0), p(16.0), p(9.0)), (0.4, 0.2, 1.0));
    }

    #[test]
    fn gains_by_chance_are_chi_square_in_variances_of_the_noise() {
        let model = knob(&[], &[]);
        let data = recorded(&model, "a");
        let data = [&data];
        let watch = Watch::new(&|_| true, 1);
        let mut screen = Screen::new(&data, &model, &watch);
        let (one, three) = ([1.642, 3.841, 6.635], [4.642, 7.815, 11.345]);
        // Two that are nearly independent have twice the chance that either gains so much.
        let cases = [
            (&[Id::QuadraticDrag][..], one, 1.0),
            (&[Id::PositionPolynomial], three, 1.0),
            (&[Id::QuadraticDrag, Id::ReturnSpring], one, 2.0),
        ];
        for (effects, gains, times) in cases {
            for louder in [1.0, 4.0] {
                let noises = [Noise::white(louder * SD * SD)];
                screen.chance = Some(Chance::of(&data, &noises, &screen.thinned));
                let starts: Vec<Vec<Start>> = effects.iter().map(|id| screen.starts(*id)).collect();
                let of = effects.iter().zip(&starts).map(|(id, starts)| (*id, &starts[..]));
                let null = Null::of(&screen, &noises, SD * SD, of);
                for (gain, chance) in gains.into_iter().zip([0.2, 0.05, 0.01]) {
                    let chance = 1.0 - (1.0_f64 - chance).powf(times);
                    let said = null.p_value(effects[0], louder * gain);
                    // Of 999 draws, three standard deviations.
                    let error = 3.0 * (chance * (1.0 - chance) / 999.0_f64).sqrt() + 1e-3;
                    assert!((said - chance).abs() < error, "{effects:?} {louder}: {said} {chance}");
                }
            }
        }
    }

    #[test]
    fn of_a_noise_that_is_hardly_known_rare_gains_are_less_rare() {
        assert!(off(0.0).iter().all(|off| *off == 1.0));
        let known = off(0.3);
        let variances: Vec<f64> = known.iter().map(|off| off.recip()).collect();
        let (mean, sd) = spread(&variances);
        assert!((mean - 1.0).abs() < 0.03 && (sd - 0.3).abs() < 0.03, "{mean} {sd}");
        // Of 22 independent samples in one of a hundred the variance is below 9.54 / 22 of what it is.
        let rare = known.iter().filter(|off| **off > 22.0 / 9.54).count();
        assert!((4..=20).contains(&rare), "{rare}");
    }

    #[test]
    fn slow_noise_is_known_less_and_that_of_two_captures_better() {
        let data = recorded(&knob(&[], &[]), "a");
        let white = Noise::white(1.0);
        let slow = Noise { coefficients: vec![-0.97], innovation: 0.0591 };
        let one = doubt(&[&data], std::slice::from_ref(&white));
        let ratio = doubt(&[&data], std::slice::from_ref(&slow)) / one;
        let alike = (1.0 + 0.97_f64.powi(2)) / (1.0 - 0.97_f64.powi(2)); // Bartlett 1946
        assert!((ratio / alike.sqrt() - 1.0).abs() < 1e-2, "{ratio}");
        assert!((doubt(&[&data, &data], &[white.clone(), white]) * 2.0_f64.sqrt() / one - 1.0).abs() < 1e-9);
    }
}
