//! What a capture that nobody has recorded yet would tell a fit: before a motion is made.
//!
//! Of a torque that another model predicts on that motion, refitting leaves
//! D = r' (Sigma + J V J')^-1 r, with the difference r of the two predictions, the derivatives J of this one, its
//! covariance V from the data so far and the noise Sigma: what a T-optimal design makes large (Atkinson & Fedorov 1975),
//! with a memory (Box & Hill 1967). Behind the measurement filter noise is as loud as white noise is within its band, so
//! that only the squares of what passes it count.

use super::{Fit, moments::moments};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::predict::Seeds;
use crate::signals::Signals;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

/// What is not determined may be anything: so many times the value that it has.
const ANYTHING: f64 = 10.0;
/// The least variance along any direction of parameters in units of their errors.
const ROUNDING: f64 = 1e-12;

/// What a motion would tell.
#[derive(Debug, Clone)]
pub struct Expected {
    /// What a refit would leave of the torque, in variances of white noise.
    pub left: f64,
    /// Standard error of each determined parameter after it, in the order of [`Fit::free`].
    pub standard_errors: Vec<f64>,
}

impl Fit {
    /// What signals would tell this fit whose torque is that of another model; `white` is the variance of white noise of
    /// the raw torque, (N m)^2.
    ///
    /// # Errors
    /// The covariance of the fit is none.
    pub fn expected(&self, signals: &Signals, white: f64) -> Result<Expected> {
        let (free, spread) = self.spread();
        let root = root(&spread).ok_or_else(|| {
            Error::invalid(
                "fit",
                "has parameters whose errors are not known; fix one of those that it cannot tell",
            )
        })?;
        let seeds = Seeds::of(&self.model, &free);
        let sum = moments(&[signals], &self.model, &self.model.values(), &seeds);
        let k = free.len();
        let gram = DMatrix::from_fn(k, k, |i, j| sum.gram(i, j));
        let slope = root.transpose() * DVector::from_fn(k, |i, _| sum.slope(i));
        // In units of the prior, V^-1 is one.
        let after = root.transpose() * gram * &root / white + DMatrix::identity(k, k);
        let after = Cholesky::new(after)
            .ok_or_else(|| Error::invalid("motion", "is none that the model can follow"))?;
        let left = (sum.squares() - slope.dot(&after.solve(&slope)) / white) / white;
        let covariance = &root * after.inverse() * root.transpose();
        let standard_errors = (0..self.free.len()).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
        Ok(Expected { left: left.max(0.0), standard_errors })
    }

    /// The model with its parameters as far from their values as `normals` say, numbers of a normal distribution: one that
    /// the data so far allow. What is not determined stays.
    pub fn drawn(&self, normals: &[f64]) -> Model {
        let mut model = self.model.clone();
        let Some(root) = root(&self.covariance) else { return model };
        let by = root * DVector::from_fn(self.free.len(), |i, _| normals.get(i).copied().unwrap_or(0.0));
        let (mut values, slots) = (model.values(), model.slots());
        for (&i, by) in self.free.iter().zip(by.iter()) {
            values[i] = (values[i] + by).clamp(slots[i].param.lower, slots[i].param.upper);
        }
        model.set_values(&values);
        model
    }

    /// The parameters that a refit may move and their covariance: those that are determined first.
    fn spread(&self) -> (Vec<usize>, DMatrix<f64>) {
        let undetermined = self.undetermined.iter().filter_map(|one| self.model.index(&one.name).ok());
        let mut free = self.free.clone();
        free.extend(undetermined.filter(|&i| self.model.values()[i] != 0.0));
        let (known, values) = (self.free.len(), self.model.values());
        let covariance = DMatrix::from_fn(free.len(), free.len(), |i, j| match (i < known, j < known) {
            (true, true) => self.covariance[(i, j)],
            (false, false) if i == j => (ANYTHING * values[free[i]]).powi(2),
            _ => 0.0,
        });
        (free, covariance)
    }
}

/// Covariance of parameters, of an inverse on both sides of what residuals make of their columns.
///
/// Of columns that hardly differ rounding may be more than what is left, and a variance negative: none is that of a square.
pub(super) fn sandwich(bread: &DMatrix<f64>, middle: &DMatrix<f64>) -> DMatrix<f64> {
    let plain = bread * middle * bread;
    if plain.diagonal().iter().all(|variance| *variance > 0.0) {
        return plain;
    }
    match root(middle) {
        Some(root) => {
            let half = bread * root;
            &half * half.transpose()
        }
        None => plain,
    }
}

/// A matrix L with L L' = V, of parameters of any units.
fn root(covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let se: Vec<f64> = covariance.diagonal().iter().map(|x| x.max(0.0).sqrt()).collect();
    let correlation = DMatrix::from_fn(se.len(), se.len(), |i, j| match se[i] * se[j] {
        both if i == j || both == 0.0 => f64::from(i == j),
        both => covariance[(i, j)] / both,
    });
    if correlation.iter().any(|x| !x.is_finite()) {
        return None;
    }
    // Those of a sandwich may be a little beyond one: what is negative by that counts as nothing.
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(correlation);
    let scale = |i: usize| eigenvalues[i].max(ROUNDING).sqrt();
    Some(DMatrix::from_fn(se.len(), se.len(), |i, j| se[i] * eigenvectors[(i, j)] * scale(j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::fit::tests::turned;
    use crate::fit::{Detents, fit};
    use crate::param::Axis;
    use crate::predict::torque_raw;

    fn white(fit: &Fit, data: &Signals) -> f64 {
        fit.noise_floor.powi(2) * data.used() as f64 / fit.white_squares
    }

    #[test]
    fn what_a_refit_leaves_is_what_is_expected_of_it() {
        // Of a knob with a spring that a first motion hardly shows; the rival has none and is refitted to both motions.
        let spring = |theta: f64| 0.005 * theta;
        let first = turned(0.3, 1e-2, |theta, _| spring(theta));
        let rival = fit(&[&first], &Model::equation_1(Axis::Rotary, false), Detents::AsModel).unwrap();
        let right = fit(&[&first], &rival.model.with(Id::ReturnSpring).unwrap(), Detents::AsModel).unwrap();
        let mut second = turned(3.0, 0.0, |_, _| 0.0);
        second.tau_raw = torque_raw(&right.model, &second);
        second.filter_torque();
        let white = white(&right, &first);
        let expected = rival.expected(&second, white).unwrap();
        let cost = |fit: &Fit, data: &[&Signals]| {
            fit.rmse.powi(2) * data.iter().map(|one| one.used() as f64).sum::<f64>() / white
        };
        let both = fit(&[&first, &second], &rival.model, Detents::AsModel).unwrap();
        let left = cost(&both, &[&first, &second]) - cost(&rival, &[&first]);
        assert!(left > 100.0, "{left}");
        assert!((expected.left / left - 1.0).abs() < 0.05, "{} {left}", expected.left);
        // The one that made the torque is left nothing to explain, and knows its parameters better.
        let own = right.expected(&second, white).unwrap();
        assert!(own.left < 1e-9 * expected.left);
        for (after, before) in own.standard_errors.iter().zip(right.standard_errors()) {
            assert!(*after > 0.0 && *after < before);
        }
    }

    #[test]
    fn no_variance_is_negative_by_rounding() {
        // Two columns that differ by less than rounding lets their inverse know.
        let bread = DMatrix::from_row_slice(2, 2, &[1e16, -1e16, -1e16, 1e16 + 2.0]);
        let middle = DMatrix::from_row_slice(2, 2, &[1.0, 1.0 + 2e-16, 1.0 + 2e-16, 1.0]);
        assert!((&bread * &middle * &bread).diagonal().iter().any(|variance| *variance <= 0.0));
        assert!(sandwich(&bread, &middle).diagonal().iter().all(|variance| *variance > 0.0));
        let plain = DMatrix::from_row_slice(2, 2, &[2.0, 0.1, 0.1, 1.0]);
        assert_eq!(sandwich(&plain, &middle), &plain * &middle * &plain);
        let none = DMatrix::zeros(0, 0);
        assert_eq!(sandwich(&none, &none), none, "of a model without a free parameter");
    }

    #[test]
    fn models_are_drawn_as_the_covariance_says() {
        let data = turned(0.9, 1e-2, |theta, _| 0.05 * theta);
        let model = Model::equation_1(Axis::Rotary, false).with(Id::ReturnSpring).unwrap();
        let fitted = fit(&[&data], &model, Detents::AsModel).unwrap();
        let mut noise = crate::random::Noise::new(3);
        let draws: Vec<Vec<f64>> = (0..4000)
            .map(|_| {
                let normals: Vec<f64> = fitted.free.iter().map(|_| noise.normal()).collect();
                let values = fitted.drawn(&normals).values();
                fitted.free.iter().map(|&i| values[i] - fitted.model.values()[i]).collect()
            })
            .collect();
        for i in 0..fitted.free.len() {
            for j in 0..fitted.free.len() {
                let mean = draws.iter().map(|draw| draw[i] * draw[j]).sum::<f64>() / 4000.0;
                let scale = (fitted.covariance[(i, i)] * fitted.covariance[(j, j)]).sqrt();
                assert!((mean - fitted.covariance[(i, j)]).abs() < 0.1 * scale, "{i} {j}");
            }
        }
    }
}
