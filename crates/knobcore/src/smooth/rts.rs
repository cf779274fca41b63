//! Backward: the fixed-interval smoother of Rauch, Tung and Striebel (1965).
//!
//! From the last sample to the first, with x filtered, P its covariance and F, Q the step to the next sample:
//!
//! ```text
//! G = P F' (F P F' + Q)^-1
//! x_smooth[k] = x[k] + G (x_smooth[k+1] - F x[k])
//! P_smooth[k] = (I - G F) P (I - G F)' + G (Q + P_smooth[k+1]) G'
//! ```
//!
//! The last line is theirs rewritten as a sum of squares, so that rounding cannot make it negative.
//!
//! The filter leaves a checkpoint every some ten thousand samples and runs again from there on the way back, so
//! that memory beyond the result does not grow with the capture.

use super::kalman::{Filter, Prediction, Prior};
use super::lifts::Lifts;
use super::sensors::Sensors;
use super::state::{Model, coast, transition};
use nalgebra::{Matrix3, Vector3};

/// Samples between two checkpoints: what is kept of them takes 1 MB.
const BLOCK: usize = 32_768;

/// Smoothed variances that change less than this have converged.
const STEADY: f64 = 1e-6;

/// The smoother's gains over one step.
struct Backward {
    gain: Matrix3<f64>,
    /// The part of the covariance that the next sample does not decide.
    own: Matrix3<f64>,
}

impl Backward {
    fn new(model: &Model, step: &Prediction) -> Self {
        // P F' = before turn after', so G = before turn after^-1: no covariance is inverted. A diagonal
        // entry of `after` is at least what the jerk adds, hence never zero.
        let unwound = step.after.transpose().solve_upper_triangular(&(step.before * step.turn).transpose());
        let gain = unwound.map_or_else(Matrix3::zeros, |gain| gain.transpose());
        let kept = step.before - gain * (transition(step.r) * step.before);
        let driven = gain * model.drive(step.r, step.lift);
        Self { gain, own: kept * kept.transpose() + driven * driven.transpose() }
    }
}

/// The smoother itself, on sensors that were checked.
pub fn smooth_rows(sensors: &Sensors<'_>, model: &Model, lifts: &Lifts) -> Motion {
    let (n, step) = (sensors.len(), model.scale[1]);

    let mut filter = Filter::start(*model, &Prior::new(sensors, step), &sensors.row(0));
    let mut checkpoints = vec![filter];
    let final_block = (n - 1) / BLOCK * BLOCK;
    for k in 1..=final_block {
        filter.advance((sensors.t[k] - sensors.t[k - 1]) / step, lifts.at(k), &sensors.row(k));
        if k % BLOCK == 0 {
            checkpoints.push(filter);
        }
    }

    let mut motion = Motion::new(n, model);
    let (mut x, mut covariance) = (Vector3::zeros(), Matrix3::zeros());
    let mut steady = false;
    for (block, checkpoint) in checkpoints.into_iter().enumerate().rev() {
        let first = block * BLOCK;
        let last = (first + BLOCK).min(n - 1);
        let pass = Pass::new(sensors, model, lifts, checkpoint, first..last);
        if last == n - 1 {
            (x, covariance) = (pass.end.x, pass.end.gains.covariance());
            motion.doubts(&covariance);
            motion.set(last, &x);
        }
        let mut used = usize::MAX;
        for k in (first..last).rev() {
            let (filtered, index) = pass.states[k - first];
            let Backward { gain, own } = &pass.gains[index];
            let r = (sensors.t[k + 1] - sensors.t[k]) / step;
            x = filtered + gain * (x - coast(&filtered, r));
            if !(steady && index == used) {
                let before = covariance.diagonal();
                covariance = own + gain * covariance * gain.transpose();
                let change = (covariance.diagonal() - before).component_div(&before).amax();
                steady = index == used && change < STEADY;
                used = index;
                motion.doubts(&covariance);
            }
            motion.set(k, &x);
        }
        steady = false;
    }
    motion
}

/// The filter over one block, kept for the way back: the state at each sample, and which gains lead from
/// it to the next.
struct Pass {
    states: Vec<(Vector3<f64>, usize)>,
    gains: Vec<Backward>,
    /// The filter after the last row of the block.
    end: Filter,
}

impl Pass {
    fn new(
        sensors: &Sensors<'_>,
        model: &Model,
        lifts: &Lifts,
        start: Filter,
        rows: std::ops::Range<usize>,
    ) -> Self {
        let mut pass = Self { states: Vec::with_capacity(rows.len()), gains: Vec::new(), end: start };
        let mut reusable = false;
        for k in rows {
            let x = pass.end.x;
            let r = (sensors.t[k + 1] - sensors.t[k]) / model.scale[1];
            pass.end.advance(r, lifts.at(k + 1), &sensors.row(k + 1));
            let steady = pass.end.gains.steady();
            if !(reusable && steady) {
                pass.gains.push(Backward::new(model, pass.end.gains.prediction()));
            }
            reusable = steady;
            pass.states.push((x, pass.gains.len() - 1));
        }
        pass
    }
}

/// The result, while it is filled from the end.
pub struct Motion {
    /// Theta, omega, alpha, SI.
    pub values: [Vec<f64>; 3],
    /// Their standard deviations.
    pub sds: [Vec<f64>; 3],
    scale: Vector3<f64>,
    /// The standard deviations of what is set next.
    sd: Vector3<f64>,
}

impl Motion {
    fn new(n: usize, model: &Model) -> Self {
        let columns = || [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        Self { values: columns(), sds: columns(), scale: model.scale, sd: Vector3::zeros() }
    }

    fn doubts(&mut self, covariance: &Matrix3<f64>) {
        self.sd = covariance.diagonal().map(f64::sqrt).component_div(&self.scale);
    }

    #[inline]
    fn set(&mut self, k: usize, x: &Vector3<f64>) {
        for i in 0..3 {
            self.values[i][k] = x[i] / self.scale[i];
            self.sds[i][k] = self.sd[i];
        }
    }
}
