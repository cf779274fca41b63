//! What a model leaves of captures, and how it is told along an axis.

use crate::floor::noises;
use crate::model::Model;
use crate::noise::Noise;
use crate::predict::torque;
use crate::signals::Signals;

/// A stretch of an axis in which the model fails beyond chance.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Where it begins and ends, in the unit of the axis.
    pub from: f64,
    /// See `from`.
    pub to: f64,
    /// Direction of motion: 1 forward, -1 backward, 0 both.
    pub direction: i8,
    /// Mean residual in it, N m (along frequency: root mean square).
    pub mean: f64,
    /// Its share of the squared error beyond the noise.
    pub share: f64,
}

/// The error along one axis, bin by bin.
#[derive(Debug, Clone)]
pub struct Split {
    /// position, velocity, acceleration, time, frequency, load or history.
    pub axis: &'static str,
    /// Lower border of each bin.
    pub low: Vec<f64>,
    /// Upper border of each bin.
    pub high: Vec<f64>,
    /// Direction of motion of each bin: 1 forward, -1 backward, 0 both.
    pub direction: Vec<i8>,
    /// Samples in each bin.
    pub count: Vec<f64>,
    /// Mean residual, N m (along frequency: root mean square).
    pub mean: Vec<f64>,
    /// Root mean square residual, N m.
    pub rms: Vec<f64>,
    /// Half-width of the 95 % band of the mean by chance, N m (along frequency: the level that chance
    /// stays below).
    pub band: Vec<f64>,
    /// Share of the squared error beyond the noise that the bin means hold.
    pub share: f64,
    /// The part of the whole squared error, noise and all, that the bin means hold beyond chance.
    pub part: f64,
    /// The share that chance stays below in 95 % of captures.
    pub chance: f64,
    /// Where the model fails beyond chance, worst first.
    pub regions: Vec<Region>,
}

/// The residual of a model, its noise level, and what it is compared with.
pub struct Rest<'a> {
    pub data: &'a [&'a Signals],
    /// Residual of every sample; zero where it does not count.
    pub residual: Vec<Vec<f64>>,
    /// Torque of the model at every sample.
    pub torque: Vec<Vec<f64>>,
    /// Noise of each raw torque.
    pub noise: Vec<Noise>,
    /// Sum of squares beyond what noise leaves.
    pub excess: f64,
    /// Sum of squares.
    pub squares: f64,
}

impl<'a> Rest<'a> {
    pub fn of(data: &'a [&'a Signals], model: &Model) -> Self {
        let torque: Vec<Vec<f64>> = data.iter().map(|signals| torque(model, signals)).collect();
        let rest = |(signals, torque): (&&Signals, &Vec<f64>)| -> Vec<f64> {
            let triples = signals.tau.iter().zip(torque).zip(&signals.weight);
            triples.map(|((tau, f), w)| if *w > 0.0 { tau - f } else { 0.0 }).collect()
        };
        let residual: Vec<Vec<f64>> = data.iter().zip(&torque).map(rest).collect();
        // Where a capture is too short to know its noise, none is assumed.
        let known = |noise: Option<Noise>| noise.unwrap_or(Noise::white(0.0));
        let noise: Vec<Noise> = noises(data, model).into_iter().map(known).collect();
        let left = |(signals, noise): (&&Signals, &Noise)| {
            noise.behind(signals.filter.as_ref()) * signals.used() as f64
        };
        let noise_squares: f64 = data.iter().zip(&noise).map(left).sum();
        let squares: f64 = residual.iter().flatten().map(|r| r * r).sum();
        let excess = squares - noise_squares;
        let squares = squares.max(f64::MIN_POSITIVE);
        Self { data, residual, torque, noise, excess, squares }
    }

    /// `share` of the excess, as a number between 0 and 1 even where noise alone explains everything.
    pub fn share(&self, squares: f64) -> f64 {
        if self.excess > 0.0 { (squares / self.excess).clamp(0.0, 1.0) } else { 0.0 }
    }
}
