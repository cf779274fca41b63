//! Small dense systems: which parameters the data determine, and where the equations have their solution.

use super::moments::Moments;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A column counts as a combination of others when less than this share of its squared length is its own.
///
/// Products of columns carry a relative rounding error of about 1e-16 times the square root of the number
/// of samples; what is left of a truly dependent column is far below this.
const OWN_SHARE: f64 = 1e-10;

/// Splits columns into those that the data determine and those that they do not.
///
/// Columns are taken in the order given; one that is zero, or a combination of those kept before it, is
/// undetermined (a pivot-free Cholesky factorisation of the equilibrated Gram matrix).
pub fn independent(gram: impl Fn(usize, usize) -> f64, order: &[usize]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    let mut factor: Vec<Vec<f64>> = Vec::new();
    for &column in order {
        let length = gram(column, column);
        if !(length.is_finite() && length > 0.0) {
            continue;
        }
        let mut row = Vec::with_capacity(kept.len() + 1);
        let mut own = 1.0;
        for (at, &earlier) in kept.iter().enumerate() {
            let mut value = gram(column, earlier) / (length * gram(earlier, earlier)).sqrt();
            for (a, b) in row.iter().zip(&factor[at]) {
                value -= a * b;
            }
            value /= factor[at][at];
            own -= value * value;
            row.push(value);
        }
        if own > OWN_SHARE {
            row.push(own.sqrt());
            factor.push(row);
            kept.push(column);
        }
    }
    kept
}

/// The Gram matrix of the columns `kept`, each scaled to unit length, factored.
pub struct Normal {
    scale: Vec<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Normal {
    /// None where the matrix is not positive definite.
    pub fn of(gram: impl Fn(usize, usize) -> f64, kept: &[usize]) -> Option<Self> {
        let scale: Vec<f64> = kept.iter().map(|&i| gram(i, i).sqrt().recip()).collect();
        let matrix =
            DMatrix::from_fn(kept.len(), kept.len(), |i, j| gram(kept[i], kept[j]) * scale[i] * scale[j]);
        let factor = Cholesky::new(matrix)?;
        Some(Self { scale, factor })
    }

    /// The solution for one right-hand side.
    pub fn solve(&self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let x = self.factor.solve(&DVector::from_fn(self.scale.len(), |i, _| right(i) * self.scale[i]));
        x.iter().zip(&self.scale).map(|(x, scale)| x * scale).collect()
    }

    /// The inverse, row by row.
    pub fn inverse(&self) -> DMatrix<f64> {
        let mut inverse = self.factor.inverse();
        for (at, x) in inverse.iter_mut().enumerate() {
            let n = self.scale.len();
            *x *= self.scale[at % n] * self.scale[at / n];
        }
        inverse
    }
}

/// The columns that stay when the last are given up until the rest can be solved: rounding may leave a matrix
/// that [`independent`] passes and a factorisation does not.
pub fn solvable(gram: impl Fn(usize, usize) -> f64, mut kept: Vec<usize>) -> Vec<usize> {
    while !kept.is_empty() && Normal::of(&gram, &kept).is_none() {
        kept.pop();
    }
    kept
}

/// The combination of `many` columns that is nearest to a right-hand side, by their products. Each is held back as if so
/// much of its squares more asked for nothing of it: what others say nearly as well stays small.
pub fn least(
    many: usize,
    gram: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
    held: f64,
) -> Option<Vec<f64>> {
    let all: Vec<usize> = (0..many).collect();
    let held = |i: usize, j: usize| gram(i, j) * if i == j { 1.0 + held } else { 1.0 };
    Some(Normal::of(held, &all)?.solve(right))
}

/// The step in the columns `kept` that minimises the sum of squares to first order; zero in the others.
pub fn least_squares(moments: &Moments, kept: &[usize]) -> Option<Vec<f64>> {
    let solution = Normal::of(|i, j| moments.gram(i, j), kept)?.solve(|i| moments.slope(kept[i]));
    let mut step = vec![0.0; moments.k];
    for (&column, value) in kept.iter().zip(solution) {
        step[column] = value;
    }
    Some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_that_repeats_others_is_named_undetermined() {
        let columns = [[1.0, 0.0, 2.0], [0.0, 1.0, 1.0], [1.0, 2.0, 4.0], [0.0, 0.0, 0.0], [1.0, 1.0, -1.0]];
        let gram = |i: usize, j: usize| columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum::<f64>();
        assert_eq!(independent(gram, &[0, 1, 2, 3, 4]), vec![0, 1, 4]);
        assert_eq!(independent(gram, &[2, 4, 0, 1]), vec![2, 4, 0]);
    }

    #[test]
    fn columns_that_say_the_same_share_what_they_are_held_back_by() {
        let both = least(2, |_, _| 1.0, |_| 1.0, 0.5).unwrap();
        assert!(both.iter().all(|x| (x - 0.4).abs() < 1e-12), "{both:?}");
    }
}
