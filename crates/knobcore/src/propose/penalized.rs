//! Many columns that are held back: how high each is by least squares with penalties, of which the one is taken that does best on
//! blocks that it did not see.

use super::grammar::Variable;
use super::rows::Rows;
use crate::algebra::{dot, products, slices};
use nalgebra::{Cholesky, DMatrix, DVector, DVectorView, Dyn};

/// Blocks that are left out in turn.
const BLOCKS: usize = 10;
/// What holds the torque of all columns together near nought over the rows, beside its square: of what the model's parameters
/// can say as well, they keep what they have without the columns.
const RIDGE: f64 = 1e-3;
/// What holds a column where there are no rows and no penalty, beside the mean of the diagonal.
const FIRM: f64 = 1e-9;

/// Columns that were fitted to what is left.
pub struct Penalized {
    /// How high each is.
    pub high: DVector<f64>,
    columns: Vec<Vec<f64>>,
    /// Their products, with what the base has of them.
    whole: DMatrix<f64>,
    gram: DMatrix<f64>,
    right: DVector<f64>,
    solved: Cholesky<f64, Dyn>,
    /// By how much they change the sum of squares of blocks that they did not see.
    pub unseen: f64,
}

impl Penalized {
    /// Of what is left of rows, by columns that still have what the base has of them and the best of some penalties, each
    /// beside a mean square of one. None where the columns are nothing beside the base.
    pub fn of(rows: &Rows<'_>, columns: Vec<Vec<f64>>, penalties: &[DMatrix<f64>]) -> Option<Self> {
        let whole = products(&slices(&columns), &slices(&columns));
        let columns: Vec<Vec<f64>> = columns.into_iter().map(|column| rows.beside(column)).collect();
        let (residual, k, rows) = (&rows.residual, columns.len(), rows.len());
        let block = rows.div_ceil(BLOCKS).max(1);
        let within = |from: usize, to: usize| {
            let parts: Vec<&[f64]> = columns.iter().map(|column| &column[from..to]).collect();
            let along = products(&parts, &[&residual[from..to]]);
            (products(&parts, &parts), along.column(0).into_owned())
        };
        let blocks: Vec<_> = (0..rows).step_by(block).map(|at| within(at, (at + block).min(rows))).collect();
        let gram: DMatrix<f64> = blocks.iter().map(|(gram, _)| gram).sum();
        let right: DVector<f64> = blocks.iter().map(|(_, right)| right).sum();
        let size = gram.diagonal().mean();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let held = &whole * RIDGE + DMatrix::from_diagonal_element(k, k, FIRM * size);
        let factor = |gram: &DMatrix<f64>, penalty: &DMatrix<f64>| -> Option<Cholesky<f64, Dyn>> {
            Cholesky::new(gram + penalty * size + &held)
        };
        let missed = |penalty: &DMatrix<f64>| -> Option<f64> {
            let mut sum = 0.0;
            for (own, along) in &blocks {
                let found = factor(&(&gram - own), penalty)?.solve(&(&right - along));
                sum += found.dot(&(own * &found)) - 2.0 * found.dot(along);
            }
            Some(sum)
        };
        let (unseen, penalty) = penalties
            .iter()
            .filter_map(|penalty| Some((missed(penalty)?, penalty)))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let solved = factor(&gram, penalty)?;
        let high = solved.solve(&right);
        Some(Self { high, columns, whole, gram, right, solved, unseen })
    }

    fn taken(&self, high: DVectorView<'_, f64>, right: DVectorView<'_, f64>) -> f64 {
        2.0 * high.dot(&right) - high.dot(&(&self.gram * high))
    }

    /// What being off by so much costs: the squares of the data, the penalty, and the squares of the torque itself, so that what
    /// the base could say as well stays with the base.
    pub fn metric(&self) -> DMatrix<f64> {
        let factor = self.solved.l();
        &factor * factor.transpose() + &self.whole
    }

    /// What they take off the sum of squares.
    pub fn gain(&self) -> f64 {
        self.taken(self.high.column(0), self.right.column(0))
    }

    /// The same of other residuals, as stiff as they are.
    pub fn gains_of(&self, residuals: &[Vec<f64>]) -> Vec<f64> {
        let right = self.along(residuals);
        let high = self.solved.solve(&right);
        high.column_iter().zip(right.column_iter()).map(|(high, right)| self.taken(high, right)).collect()
    }

    /// The variance of a row of what they leave.
    pub fn left(&self, rows: &Rows<'_>) -> f64 {
        (dot(&rows.residual, &rows.residual) - self.gain()).max(0.0) / rows.counts().max(1.0)
    }

    /// As many parameters as the data decide of them (Hastie & Tibshirani 1990).
    pub fn free(&self) -> f64 {
        self.solved.solve(&self.gram).trace()
    }

    /// How high they are where a column was left.
    pub fn like(&self, column: Vec<f64>) -> DVector<f64> {
        self.solved.solve(&self.along(&[column]).column(0))
    }

    fn along(&self, columns: &[Vec<f64>]) -> DMatrix<f64> {
        products(&slices(&self.columns), &slices(columns))
    }

    /// The variance of a sum of them with these weights, in that of a row: by the noise alone.
    pub fn variance(&self, weights: &DVector<f64>) -> f64 {
        let weights = self.solved.solve(weights);
        weights.dot(&(&self.gram * &weights)).max(0.0)
    }

    /// The same, with the doubt where the data say nothing (Nychka 1988).
    pub fn doubt(&self, weights: &DVector<f64>) -> f64 {
        weights.dot(&self.solved.solve(weights)).max(0.0)
    }
}

/// What remains of an error on blocks that were not seen, as a share: of its squares, and by how much those change there.
pub fn remains(unseen: f64, squares: f64) -> f64 {
    (1.0 + unseen / squares).max(0.0).sqrt()
}

/// Squares of second differences of neighbours.
pub fn bending(k: usize) -> DMatrix<f64> {
    let mut bent = DMatrix::zeros(k, k);
    for at in 1..k - 1 {
        for (i, a) in [(at - 1, 1.0), (at, -2.0), (at + 1, 1.0)] {
            for (j, b) in [(at - 1, 1.0), (at, -2.0), (at + 1, 1.0)] {
                bent[(i, j)] += a * b;
            }
        }
    }
    bent
}

/// A cubic B-spline of a place between 0 and 1 (Cox 1972, de Boor 1972), of so many equal pieces.
pub fn spline(at: usize, x: f64, pieces: usize) -> f64 {
    let u = x * pieces as f64 - at as f64 + DEGREE as f64;
    match u {
        u if (0.0..1.0).contains(&u) => u.powi(3) / 6.0,
        u if (1.0..2.0).contains(&u) => {
            let v = u - 1.0;
            (1.0 + 3.0 * v + 3.0 * v * v - 3.0 * v.powi(3)) / 6.0
        }
        u if (2.0..3.0).contains(&u) => {
            let v = u - 2.0;
            (4.0 - 6.0 * v * v + 3.0 * v.powi(3)) / 6.0
        }
        u if (3.0..=4.0).contains(&u) => (4.0 - u).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// How high a spline's parts are as they are written: in so many parts of the largest.
pub fn rounded(high: &[f64], largest: f64, parts: f64) -> Vec<f64> {
    high.iter().map(|x| (x / largest * parts).round() / parts).collect()
}

/// A spline as formulas have it; `number` is what the names of its place and width end in.
pub fn said(over: Variable, number: &str, high: &[f64]) -> String {
    let values: Vec<String> = high.iter().map(f64::to_string).collect();
    format!("spline(({} - from{number})/step{number}, {})", over.text(), values.join(", "))
}

/// Its place and width, over a range in so many pieces.
pub fn placed([low, high]: [f64; 2], number: &str, pieces: usize) -> [(String, f64); 2] {
    let step = (high - low) / pieces as f64;
    [(format!("from{number}"), low - step), (format!("step{number}"), step)]
}

/// Cubic.
pub const DEGREE: usize = 3;
