//! A function of the user's own along whole columns, differentiated by central differences.

use super::{Along, D, Gradient, Response, Totals};
use crate::effects::{Carrier, Joint, Place, Survey, User};
use crate::scalar::Dual;

/// Change of a torque, as a share of its size, by which a sensor is differentiated.
const SHARE: f64 = 1e-6;

impl User {
    /// Its joint, with derivatives where the parameters have some.
    fn carried(&self, p: &[D]) -> Option<Joint<D>> {
        let values: Vec<f64> = p.iter().map(|p| p.v).collect();
        let joint = self.joined(&values)?;
        let [mut gap, mut stiffness, mut damping, mut share] =
            [joint.gap, joint.stiffness, joint.damping, joint.share].map(Dual::constant);
        for (i, p) in p.iter().enumerate().filter(|(_, p)| p.d.iter().any(|d| *d != 0.0)) {
            let [below, above] = self.beside(&values, i).map(|(x, p)| (x, self.joined(&p)));
            let (Some(low), Some(high)) = (below.1, above.1) else { continue };
            let by = |of: fn(&Joint<f64>) -> f64| (of(&high) - of(&low)) / (above.0 - below.0);
            let slopes = [by(|j| j.gap), by(|j| j.stiffness), by(|j| j.damping), by(|j| j.share)];
            for (part, slope) in [&mut gap, &mut stiffness, &mut damping, &mut share].into_iter().zip(slopes)
            {
                *part = *part + Dual { v: 0.0, d: p.d.map(|d| slope * d) };
            }
        }
        Some(Joint { gap, stiffness, damping, share, welded: joint.welded })
    }
}

impl Along for User {
    fn starts(&self, _: &Survey) -> Vec<Vec<f64>> {
        if self.starts.is_empty() {
            return vec![self.info.params.iter().map(|param| param.neutral).collect()];
        }
        self.starts.clone()
    }

    fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64> {
        carrier.by_unit(self.info.params)
    }

    fn kept(&self, p: &[f64], columns: &[Option<usize>], motion: [&[f64]; 5]) -> Vec<f64> {
        if !self.loads() {
            return Vec::new();
        }
        let mut kept = self.over(p, &motion);
        let asked = columns.iter().enumerate().filter(|(_, column)| column.is_some());
        asked.for_each(|(i, _)| kept.extend(self.slope(p, i, &motion)));
        kept
    }

    fn joint_carried(&self, p: &[D]) -> Option<Joint<D>> {
        self.carried(p)
    }

    fn total(&self, _: &[f64], kept: &mut [f64], totals: &mut Totals<'_>) {
        if self.loads() {
            totals.add_column(self.channel(), kept);
        }
    }

    fn slopes(&self, _: &[f64], columns: &[Option<usize>], kept: &mut [f64], gradient: &mut Gradient<'_>) {
        if self.loads() {
            gradient.chain_columns(self.channel(), columns, kept);
        }
    }

    fn pass(&self, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
        if self.info.place != Place::Sensor {
            return;
        }
        let [t, theta, omega, alpha, forward] = over.motion;
        let read = |tau: &[f64], p: &[f64]| self.over(p, &[t, theta, omega, alpha, forward, tau]);
        let tau = over.torque.to_vec();
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for column in over.slopes.iter_mut() {
            // Along the derivative: that holds whether or not the sensor remembers.
            let size = largest(column);
            if size > 0.0 {
                let step = SHARE * largest(&tau).max(f64::MIN_POSITIVE) / size;
                let moved = |by: f64| -> Vec<f64> {
                    tau.iter().zip(column.iter()).map(|(tau, slope)| tau + by * slope).collect()
                };
                let (low, high) = (read(&moved(-step), p), read(&moved(step), p));
                column
                    .iter_mut()
                    .zip(high.iter().zip(low))
                    .for_each(|(slope, (high, low))| *slope = (high - low) / (2.0 * step));
            }
        }
        for (i, column) in columns.iter().enumerate() {
            if let Some(column) = column.and_then(|c| over.slopes.get_mut(c)) {
                let own = self.slope(p, i, &[t, theta, omega, alpha, forward, &tau]);
                column.iter_mut().zip(own).for_each(|(slope, own)| *slope += own);
            }
        }
        over.torque.copy_from_slice(&read(&tau, p));
    }
}
