//! Noise levels from the capture itself: maximum likelihood of the filter's innovations.
//!
//! With nu the innovation of a sensor and s its variance, -2 log L = sum of nu^2 / s + log s (F. C.
//! Schweppe, "Evaluation of likelihood functions for Gaussian signals", IEEE Transactions on Information
//! Theory 11(1), 1965), minimised over the logarithms of the noise levels and of the jerk.

use super::activity::{Row, stretches};
use super::kalman::{Gains, Prior, nominal};
use super::minimise::minimise;
use super::resolution::least_noise;
use super::sensors::{Noise, Sensors};
use super::staircase::one_reading_per_step;
use super::state::{Model, coast};
use crate::error::Result;
use nalgebra::{Vector3, Vector4};

type Part = Vec<Row>;

/// First samples of a stretch, which only find the state.
const FINDING: usize = 8;

/// Memories, in samples, tried for a first jerk: 10^4 down to 0.05, by a factor of 3.
const MEMORIES: i32 = 12;

/// A fall of -2 log L that changes the levels by less than their own uncertainty.
const ENOUGH: f64 = 0.02;

/// The noise of each sensor and the strength of the jerk, from the capture alone.
///
/// # Errors
/// Lengths that differ, times that do not increase, fewer than three finite angles.
pub fn noise_from_capture(sensors: &Sensors<'_>) -> Result<Noise> {
    sensors.check()?;
    let readings = one_reading_per_step(sensors.theta);
    let sensors = Sensors { theta: readings.as_deref().unwrap_or(sensors.theta), ..*sensors };
    let step = sensors.step();
    let parts = stretches(&sensors, step);
    let least = [Some(sensors.theta), sensors.omega, sensors.alpha].map(least_level);
    let quick = [0, 1, 2].map(|i| roughness(&parts, i).max(least[i]));
    let samples = parts.iter().map(Vec::len).sum::<usize>();
    let groups = groups(parts);
    let levels = Levels { least, step };
    let prior = Prior::new(&sensors, step);
    let cost = |x: &Vector4<f64>| surprise(&groups, &Model::new(&levels.noise(x), step), &prior);

    let start = (0..MEMORIES)
        .map(|i| {
            let memory = 1e4 / 3.0_f64.powi(i);
            let jerk = quick[0] / (memory.powi(3) * step.powf(2.5));
            let x = Vector4::new(quick[0].ln(), quick[1].ln(), quick[2].ln(), jerk.ln());
            (cost(&x), x)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(Vector4::zeros, |(_, x)| x);
    let free = [0, 1, 2, 3].map(|i| start[i].is_finite());
    // n samples carry Fisher information 2 n on the logarithm of their standard deviation; -2 log L doubles it.
    let curvature = 4.0 * samples as f64;
    Ok(levels.noise(&minimise(cost, start, free, curvature, ENOUGH)))
}

/// The least noise that a sensor can have; infinite if it is absent.
fn least_level(column: Option<&[f64]>) -> f64 {
    let seen = column.filter(|column| column.iter().any(|value| value.is_finite()));
    seen.map_or(f64::INFINITY, least_noise)
}

/// What a noise level may be.
struct Levels {
    least: [f64; 3],
    step: f64,
}

impl Levels {
    /// From logarithms of (theta, omega, alpha, jerk).
    fn noise(&self, x: &Vector4<f64>) -> Noise {
        let [theta, omega, alpha] = [0, 1, 2].map(|i| x[i].exp().max(self.least[i]));
        let largest_jerk = (theta / self.step.powf(2.5)) * 1e12;
        Noise { theta, omega, alpha, jerk: x[3].exp().min(largest_jerk) }
    }
}

/// -2 log likelihood of all groups, less a constant.
fn surprise(groups: &[Vec<Part>], model: &Model, prior: &Prior) -> f64 {
    groups.iter().map(|group| surprise_of(group, model, prior)).sum()
}

/// The same of stretches whose steps and missing samples are the same: they share their gains.
fn surprise_of(group: &[Part], model: &Model, prior: &Prior) -> f64 {
    let Some(lead) = group.first() else { return 0.0 };
    let mut gains = Gains::start(*model, prior, &lead[0].1);
    let mut states: Vec<Vector3<f64>> = group.iter().map(|part| prior.state(&part[0].1)).collect();
    for (state, part) in states.iter_mut().zip(group) {
        gains.update(state, &part[0].1);
    }
    let mut sum = 0.0;
    for (k, (r, z)) in lead.iter().enumerate().skip(1) {
        gains.advance(*r, z);
        for (state, part) in states.iter_mut().zip(group) {
            let (r, z) = &part[k];
            *state = coast(state, *r);
            let surprise = gains.update(state, z);
            if k >= FINDING {
                sum += surprise;
            }
        }
    }
    sum
}

/// Stretches in groups of like ones: one group if all are alike, else each by itself.
fn groups(parts: Vec<Part>) -> Vec<Vec<Part>> {
    let alike = |part: &Part| {
        part.len() == parts[0].len()
            && part.iter().zip(&parts[0]).skip(1).all(|((r, z), (lead_r, lead_z))| {
                nominal(*r) == nominal(*lead_r) && z.map(f64::is_finite) == lead_z.map(f64::is_finite)
            })
    };
    if parts.iter().all(alike) { vec![parts] } else { parts.into_iter().map(|part| vec![part]).collect() }
}

/// White noise that would leave the sixth differences that sensor `i` shows: 924 = C(12, 6) times its
/// variance. Infinite if it is absent.
fn roughness(parts: &[Part], i: usize) -> f64 {
    const SIXTH: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let mut sizes = Vec::new();
    for part in parts {
        let seen: Vec<f64> = part.iter().map(|(_, z)| z[i]).filter(|z| z.is_finite()).collect();
        sizes.extend(seen.windows(7).map(|z| z.iter().zip(SIXTH).map(|(z, c)| z * c).sum::<f64>().abs()));
    }
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    // The median of |x| is 0.6745 standard deviations.
    *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / (0.6745 * 924.0_f64.sqrt())
}
