//! Forward: the Kalman filter, on square roots of covariances.
//!
//! A covariance is kept as S with P = S S'. Prediction: modified Gram-Schmidt on [S'F'; drive'].
//! Measurement, one sensor after the other: Potter's update (R. H. Battin, "Astronautical Guidance",
//! McGraw-Hill 1964; G. J. Bierman, "Factorization Methods for Discrete Sequential Estimation", Academic
//! Press 1977, chapter V). Neither can lose symmetry or positivity, even after a gap when the theta
//! variance falls by 20 decades in one sample.
//!
//! Covariances do not depend on what was measured. While the step and the set of sensors stay the same they
//! converge; from then on a sample costs a few multiplications.

use super::sensors::Sensors;
use super::state::{Model, coast, transition};
use nalgebra::{Matrix3, Vector3, Vector6};

/// Steps within this part of the usual one count as equal for the gains (never for the motion itself).
const SAME_STEP: f64 = 1e-3;

/// Variances that change less than this from sample to sample have converged.
const STEADY: f64 = 1e-6;

/// Square roots before and after a prediction; the smoother's gain follows from them.
#[derive(Debug, Clone, Copy)]
pub struct Prediction {
    /// Length, in usual steps.
    pub r: f64,
    /// Jerk over this step, in units of the usual.
    pub lift: f64,
    /// Before: filtered at the sample before.
    pub before: Matrix3<f64>,
    /// After: lower triangular.
    pub after: Matrix3<f64>,
    /// before' F' = turn after'.
    pub turn: Matrix3<f64>,
}

/// The side of the filter that does not depend on what was measured: covariance and gains.
#[derive(Debug, Clone, Copy)]
pub struct Gains {
    model: Model,
    root: Matrix3<f64>,
    /// What one radian of innovation of each sensor, one after the other, does to the state.
    weights: [Vector3<f64>; 3],
    seen: [bool; 3],
    prediction: Prediction,
    steady: bool,
}

/// The filter after some sample.
#[derive(Debug, Clone, Copy)]
pub struct Filter {
    /// Filtered state.
    pub x: Vector3<f64>,
    /// Its covariance, and how it came about.
    pub gains: Gains,
}

/// What is known before the first sample: next to nothing. Ten times the largest change of the capture is
/// loose enough not to be felt and tight enough for double precision.
#[derive(Debug, Clone, Copy)]
pub struct Prior {
    theta: f64,
    widest: Vector3<f64>,
}

impl Prior {
    /// From the largest change of theta in `step` seconds, seen by theta or omega, and how late the first
    /// reading of theta is.
    pub fn new(sensors: &Sensors<'_>, step: f64) -> Self {
        let readings = || sensors.t.iter().zip(sensors.theta).filter(|(_, theta)| theta.is_finite());
        let later = readings().skip(1);
        let rate = |((t, theta), (after, next)): ((&f64, &f64), (&f64, &f64))| {
            (next - theta).abs() / ((after - t) / step).max(1.0)
        };
        let speeds = sensors.omega.unwrap_or_default().iter().filter(|omega| omega.is_finite());
        let fastest = speeds.fold(0.0_f64, |most, omega| most.max(omega.abs()));
        let change = readings().zip(later).map(rate).fold(fastest * step, f64::max);
        let first = readings().next();
        let late = first.map_or(0.0, |(t, _)| (t - sensors.t[0]) / step);
        let theta = first.map_or(0.0, |(_, theta)| *theta);
        Self { theta, widest: Vector3::new(change * (1.0 + late), change, change) }
    }

    fn state(&self) -> Vector3<f64> {
        Vector3::new(self.theta, 0.0, 0.0)
    }
}

impl Filter {
    /// At the first sample, `z` = (theta, omega, alpha) in SI.
    pub fn start(model: Model, prior: &Prior, z: &Vector3<f64>) -> Self {
        let mut filter = Self { x: prior.state(), gains: Gains::start(model, prior, z) };
        filter.gains.update(&mut filter.x, z);
        filter
    }

    /// The next sample, `r` steps later, with `lift` times the usual jerk in between.
    #[inline]
    pub fn advance(&mut self, r: f64, lift: f64, z: &Vector3<f64>) {
        self.gains.advance(r, lift, z);
        self.x = coast(&self.x, r);
        self.gains.update(&mut self.x, z);
    }
}

impl Gains {
    /// At the first sample.
    fn start(model: Model, prior: &Prior, z: &Vector3<f64>) -> Self {
        let least = model.variance[0].sqrt() + model.jerk;
        let root = Matrix3::from_diagonal(&prior.widest.map(|widest| 10.0 * (widest + least)));
        let weights = [Vector3::zeros(); 3];
        let prediction =
            Prediction { r: 0.0, lift: 1.0, before: root, after: root, turn: Matrix3::identity() };
        let mut gains = Self { model, root, weights, seen: [false; 3], prediction, steady: false };
        gains.weigh(gains.sees(z));
        gains
    }

    /// To the next sample `z`, `r` steps later; of `z`, only what is missing matters here.
    #[inline]
    fn advance(&mut self, r: f64, lift: f64, z: &Vector3<f64>) {
        let r = if (r - 1.0).abs() < SAME_STEP { 1.0 } else { r };
        let seen = self.sees(z);
        let same = r == self.prediction.r && lift == self.prediction.lift && seen == self.seen;
        if !(same && self.steady) {
            let before = variances(&self.root);
            self.predict(r, lift);
            self.weigh(seen);
            let change = (variances(&self.root) - before).component_div(&before).amax();
            self.steady = same && change < STEADY;
        }
    }

    /// Corrects the predicted state `x` by the sample `z`.
    #[inline]
    fn update(&self, x: &mut Vector3<f64>, z: &Vector3<f64>) {
        for i in 0..3 {
            if self.seen[i] {
                *x += self.weights[i] * (z[i] * self.model.scale[i] - x[i]);
            }
        }
    }

    /// Whether the next sample like this one will have the same gains.
    pub fn steady(&self) -> bool {
        self.steady
    }

    /// The prediction that led to this sample.
    pub fn prediction(&self) -> &Prediction {
        &self.prediction
    }

    /// Covariance of the filtered state.
    pub fn covariance(&self) -> Matrix3<f64> {
        self.root * self.root.transpose()
    }

    /// Which sensors count in the sample `z`.
    #[inline]
    fn sees(&self, z: &Vector3<f64>) -> [bool; 3] {
        [0, 1, 2].map(|i| z[i].is_finite() && self.model.variance[i].is_finite())
    }

    fn predict(&mut self, r: f64, lift: f64) {
        let before = self.root;
        let (top, bottom) = ((transition(r) * before).transpose(), self.model.drive(r, lift).transpose());
        let mut columns = [0, 1, 2].map(|j| {
            let (a, b) = (top.column(j), bottom.column(j));
            Vector6::new(a[0], a[1], a[2], b[0], b[1], b[2])
        });
        let mut after = Matrix3::zeros();
        for j in 0..3 {
            after[(j, j)] = columns[j].norm();
            columns[j] /= after[(j, j)];
            for k in j + 1..3 {
                after[(k, j)] = columns[j].dot(&columns[k]);
                columns[k] -= columns[j] * after[(k, j)];
            }
        }
        let turn = Matrix3::from_fn(|i, j| columns[j][i]);
        self.prediction = Prediction { r, lift, before, after, turn };
        self.root = after;
    }

    /// Gains of the sensors that are there, and the covariance after them.
    fn weigh(&mut self, seen: [bool; 3]) {
        self.seen = seen;
        for i in (0..3).filter(|&i| seen[i]) {
            let row = self.root.row(i).transpose();
            let variance = row.norm_squared() + self.model.variance[i];
            let gain = self.root * row / variance;
            let shrink = 1.0 / (1.0 + (self.model.variance[i] / variance).sqrt());
            self.root -= gain * row.transpose() * shrink;
            self.weights[i] = gain;
        }
    }
}

fn variances(root: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| root.row(i).norm_squared())
}
