//! A spline over one variable times powers of others, its stiffness chosen on blocks that it did not see (Eilers & Marx
//! 1996, "Flexible smoothing with B-splines and penalties"): what a law looks like before it has a formula, and a law
//! by itself where none has.

use super::Law;
use super::follow::Reach;
use super::grammar::{Powers, Term, Variable};
use super::rows::Rows;
use super::sum::Sum;
use crate::algebra::dot;
use crate::rule::rule;
use crate::special::Z95;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Pieces of the spline.
const PIECES: usize = 36;
/// Cubic.
const DEGREE: usize = 3;
/// Blocks that are left out in turn.
const BLOCKS: usize = 10;
/// Stiffnesses that are tried.
const STIFFNESSES: usize = 12;
/// What holds the curve near nought where the data ask for nothing, or the model's parameters can say the same, beside the
/// mean of the diagonal.
const RIDGE: f64 = 1e-3;
/// Values of a written spline are rounded to this part of the largest.
const ROUNDED: f64 = 1e4;
/// What a spline that is a law may run over, and what it may be multiplied by.
const WRITTEN: [(Variable, &[Powers]); 4] = [
    (Variable::Theta, &[Powers::NONE, Powers::SIGN, Powers::OMEGA, Powers::ALPHA]),
    (Variable::Omega, &[Powers::NONE, Powers::ALPHA]),
    (Variable::Time, &[Powers::NONE, Powers::SIGN, Powers::OMEGA, Powers::ALPHA]),
    (Variable::Since, &[Powers::SIGN, Powers::OMEGA]),
];

/// A law that no formula says.
#[derive(Debug, Clone)]
pub struct Written {
    /// The law; its `complexity` is how many numbers the data decide of it.
    pub law: Law,
    /// What is left on blocks that it did not see, as a share of what the model leaves.
    pub heldout: f64,
}

/// A spline that was fitted to what is left.
pub struct Smooth {
    over: Variable,
    rest: Term,
    range: [f64; 2],
    /// How high each of its parts is.
    pub high: DVector<f64>,
    columns: Vec<Vec<f64>>,
    gram: DMatrix<f64>,
    right: DVector<f64>,
    solved: Cholesky<f64, Dyn>,
    /// By how much it changes the sum of squares of blocks that it did not see.
    unseen: f64,
}

impl Smooth {
    /// Over a variable, times the rest of a law. None where the motion says nothing of it.
    pub fn of(rows: &Rows<'_>, over: Variable, rest: Term, reach: &Reach) -> Option<Self> {
        let range @ [low, high] = reach.ranges[over as usize];
        let columns = rows.over(|motions| {
            let times = rest.columns(motions).swap_remove(0);
            let place = |x: &f64| (x - low) / (high - low);
            let part = |at: usize| {
                let spline = motions[over as usize].iter().map(|x| spline(at, place(x)));
                spline.zip(&times).map(|(a, b)| a * b).collect()
            };
            (0..PIECES + DEGREE).map(part).collect()
        });
        let k = columns.len();
        let block = rows.len().div_ceil(BLOCKS);
        let products = |from: usize, to: usize| {
            let part = |i: usize| &columns[i][from..to];
            let gram = DMatrix::from_fn(k, k, |i, j| if i <= j { dot(part(i), part(j)) } else { 0.0 });
            let gram = DMatrix::from_fn(k, k, |i, j| gram[(i.min(j), i.max(j))]);
            (gram, DVector::from_fn(k, |i, _| dot(part(i), &rows.residual[from..to])))
        };
        let blocks: Vec<_> =
            (0..rows.len()).step_by(block).map(|at| products(at, (at + block).min(rows.len()))).collect();
        let gram: DMatrix<f64> = blocks.iter().map(|(gram, _)| gram).sum();
        let right: DVector<f64> = blocks.iter().map(|(_, right)| right).sum();
        let size = gram.diagonal().mean();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let bent = bending(k);
        let factor = |gram: &DMatrix<f64>, stiff: f64| -> Option<Cholesky<f64, Dyn>> {
            Cholesky::new(gram + &bent * (stiff * size) + DMatrix::from_diagonal_element(k, k, RIDGE * size))
        };
        let missed = |stiff: f64| -> Option<f64> {
            let mut sum = 0.0;
            for (own, along) in &blocks {
                let found = factor(&(&gram - own), stiff)?.solve(&(&right - along));
                sum += found.dot(&(own * &found)) - 2.0 * found.dot(along);
            }
            Some(sum)
        };
        let stiffnesses = (0..STIFFNESSES).map(|at| 10_f64.powf(0.7 * at as f64 - 5.0));
        let (unseen, stiff) = stiffnesses
            .filter_map(|stiff| Some((missed(stiff)?, stiff)))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let solved = factor(&gram, stiff)?;
        let high = solved.solve(&right);
        Some(Self { over, rest, range, high, columns, gram, right, solved, unseen })
    }

    /// What it takes off the sum of squares.
    fn gain(&self) -> f64 {
        2.0 * self.high.dot(&self.right) - self.high.dot(&(&self.gram * &self.high))
    }

    /// As many parameters as the data decide of it (Hastie & Tibshirani 1990).
    fn free(&self) -> f64 {
        self.solved.solve(&self.gram).trace()
    }

    /// How high its parts are where a column was left.
    pub fn like(&self, column: &[f64]) -> DVector<f64> {
        let along = self.columns.iter().map(|own| dot(own, column)).collect::<Vec<_>>();
        self.solved.solve(&DVector::from_vec(along))
    }

    /// A spline with parts so high, at some places.
    pub fn over(&self, x: &[f64], high: &DVector<f64>) -> Vec<f64> {
        x.iter().map(|x| self.base(*x).dot(high)).collect()
    }

    /// Half-width of its 95 % band at some places.
    pub fn band(&self, x: &[f64], rows: &Rows<'_>) -> Vec<f64> {
        let left = dot(&rows.residual, &rows.residual) - self.gain();
        let variance = left.max(0.0) / rows.counts().max(1.0);
        let width = |x: &f64| {
            let weights = self.solved.solve(&self.base(*x));
            Z95 * (variance * weights.dot(&(&self.gram * &weights))).max(0.0).sqrt()
        };
        x.iter().map(width).collect()
    }

    fn base(&self, x: f64) -> DVector<f64> {
        let [low, high] = self.range;
        DVector::from_fn(self.high.len(), |at, _| spline(at, (x - low) / (high - low)))
    }

    /// As an effect is written: how high it is are numbers, its amplitude, place and width parameters.
    fn written(&self, white: f64) -> Law {
        let largest = self.high.amax();
        let rounded = |x: &f64| format!("{}", (x / largest * ROUNDED).round() / ROUNDED);
        let values: Vec<String> = self.high.iter().map(rounded).collect();
        let before = Sum::from(self.rest.clone()).written(&[largest]);
        let step = (self.range[1] - self.range[0]) / PIECES as f64;
        let own = [("from".to_owned(), self.range[0] - step), ("step".to_owned(), step)];
        let mut variables = self.rest.variables();
        variables.push(self.over.name());
        variables.sort_unstable();
        variables.dedup();
        Law {
            text: format!(
                "{}*spline(({} - from)/step, {})",
                before.text,
                self.over.text(),
                values.join(", ")
            ),
            params: before.params.into_iter().chain(own).collect(),
            variables,
            gain: self.gain() / white,
            alike: false,
            complexity: self.free().ceil() as usize,
            terms: 1,
        }
    }
}

/// The spline that explains more than each of some laws, if one does. It is chosen among `few` rows; `white` is the variance
/// of the raw noise.
pub fn beyond(
    laws: &[Law],
    [fine, few]: [&Rows<'_>; 2],
    among: &[Variable],
    reach: &Reach,
    white: f64,
) -> Option<Written> {
    let price = rule().price;
    let best = laws.iter().map(|law| law.gain - price * law.params.len() as f64).fold(0.0, f64::max);
    let pairs = WRITTEN.iter().filter(|(over, _)| among.contains(over));
    let pairs = pairs.flat_map(|(over, all)| all.iter().map(|powers| (*over, *powers)));
    let tried = pairs.filter_map(|(over, powers)| {
        let smooth = Smooth::of(few, over, Term { powers, factors: Vec::new() }, reach)?;
        Some((smooth.unseen, over, smooth.rest))
    });
    let (_, over, rest) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let smooth = Smooth::of(fine, over, rest, reach)?;
    let law = smooth.written(white);
    let more = law.gain - price * smooth.free() - best;
    let heldout = (1.0 + smooth.unseen / dot(&fine.residual, &fine.residual)).max(0.0).sqrt();
    (more > rule().alike.max(rule().relative * best)).then_some(Written { law, heldout })
}

/// A B-spline of a place between 0 and 1 (Cox 1972, de Boor 1972), of equal pieces.
fn spline(at: usize, x: f64) -> f64 {
    let u = x * PIECES as f64 - at as f64 + DEGREE as f64;
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

/// Squares of second differences of neighbouring coefficients.
fn bending(k: usize) -> DMatrix<f64> {
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
