//! What a fitted model leaves, made small: the samples that tell all that passes the measurement filter, with what the
//! parameters of the model can absorb taken off.

use super::grammar::{Motions, Term};
use super::sum::Sum;
use crate::algebra::{dot, orthonormal, project};
use crate::diagnose::Thinned;
use crate::effects::formula::{STATES, follow};
use crate::model::Model;
use crate::signals::Signals;
use nalgebra::{DMatrix, DVector};

/// What a column has of its own beside others, at least, as a share.
const APART: f64 = 3e-5;

/// Rows of captures, each with its motion, the residual, and an orthonormal base of the model's derivatives.
pub struct Rows<'a> {
    /// The columns of the motion.
    pub motions: Motions,
    /// What a row counts: the root of how many samples it stands for; nought where none of them counts.
    pub scale: Vec<f64>,
    /// The residual, counted, off the base.
    pub residual: Vec<f64>,
    /// What the parameters of the model can absorb, orthonormal.
    pub base: Vec<Vec<f64>>,
    /// Rows that one is the mean of.
    every: usize,
    exact: Option<Exact<'a>>,
}

/// All samples, of which rows are picked behind the measurement filter.
struct Exact<'a> {
    data: &'a [&'a Signals],
    thinned: Thinned,
    /// The motion of all samples of all segments.
    whole: Motions,
    weight: Vec<f64>,
}

impl Exact<'_> {
    /// A column over all samples as it counts behind the measurement filter.
    fn measured(&self, mut column: Vec<f64>) -> Vec<f64> {
        let mut from = 0;
        for signals in self.data {
            for segment in &signals.segments {
                let to = from + segment.len();
                signals.measure(&mut [&mut column[from..to]]);
                from = to;
            }
        }
        column.iter_mut().zip(&self.weight).for_each(|(x, weight)| *x *= weight);
        self.thinned.pick(self.data, &column)
    }
}

impl<'a> Rows<'a> {
    /// Of captures beside a fitted model, and their sum of squares.
    pub fn of(data: &'a [&'a Signals], model: &Model) -> (Self, f64) {
        let thinned = Thinned::of(data);
        let free: Vec<usize> = model.free().collect();
        let (columns, mut residual, squares) = thinned.columns(data, model, &free);
        let base = orthonormal(&columns, residual.len());
        let rows = residual.len();
        project(&mut residual, &base, rows);
        let since: Vec<Vec<f64>> = data.iter().map(|signals| since_turned(signals)).collect();
        let pressing: Vec<Vec<f64>> = data.iter().map(|signals| pressing(signals, model)).collect();
        let all = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            let capture = |(at, signals): (usize, &&Signals)| {
                let samples = signals.segments.iter().cloned().flatten();
                samples.map(|sample| of(at, sample)).collect::<Vec<_>>()
            };
            data.iter().enumerate().flat_map(capture).collect()
        };
        let whole: Motions = [
            all(&|at, sample| data[at].t[sample]),
            all(&|at, sample| data[at].theta[sample]),
            all(&|at, sample| data[at].omega[sample]),
            all(&|at, sample| data[at].omega[sample].abs()),
            all(&|at, sample| data[at].alpha[sample]),
            all(&|at, sample| data[at].theta[sample].abs()),
            all(&|at, sample| data[at].alpha[sample].abs()),
            all(&|at, sample| since[at][sample]),
            all(&|at, sample| data[at].motion(sample).direction()),
            all(&|at, sample| pressing[at][sample]),
        ];
        let weight = all(&|at, sample| data[at].weight[sample]);
        let scale = thinned.pick(data, &weight);
        // What is picked is scaled as what is counted is; a motion is not.
        let one = thinned.pick(data, &vec![1.0; weight.len()]);
        let motions = whole.each_ref().map(|column| {
            let mut picked = thinned.pick(data, column);
            picked.iter_mut().zip(&one).for_each(|(x, one)| *x /= one);
            picked
        });
        (
            Self {
                motions,
                scale,
                residual,
                base,
                every: 1,
                exact: Some(Exact { data, thinned, whole, weight }),
            },
            squares,
        )
    }

    /// At most so many rows: the means of neighbours, which keep what is slow.
    pub fn coarse(&self, most: usize) -> Rows<'static> {
        let every = self.scale.len().div_ceil(most).max(1);
        let mean = |column: &[f64]| -> Vec<f64> {
            column.chunks(every).map(|few| few.iter().sum::<f64>() / few.len() as f64).collect()
        };
        // Of rows with the same noise, which a sum divided so has again.
        let scale = mean(&self.scale).iter().map(|scale| scale * (every as f64).sqrt()).collect::<Vec<_>>();
        let columns: Vec<Vec<f64>> = self.base.iter().map(|column| summed(column, every)).collect();
        let base = orthonormal(&columns, scale.len());
        let mut residual = summed(&self.residual, every);
        project(&mut residual, &base, scale.len());
        Rows {
            motions: self.motions.each_ref().map(|column| mean(column)),
            scale,
            residual,
            base,
            every,
            exact: None,
        }
    }

    /// The same rows where a law has taken its part off; behind no filter.
    pub fn without(&self, law: &Sum) -> Rows<'static> {
        let left = self.explained(&self.columns(law)).map(|(.., left)| left);
        Rows {
            motions: self.motions.clone(),
            scale: self.scale.clone(),
            residual: left.unwrap_or_else(|| self.residual.clone()),
            base: self.base.clone(),
            every: self.every,
            exact: None,
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.scale.len()
    }

    /// A column as it counts, off the base.
    pub fn counted(&self, column: &[f64]) -> Vec<f64> {
        self.beside(multiplied(column, &self.scale))
    }

    /// What of a counted column the base has not.
    pub fn beside(&self, mut column: Vec<f64>) -> Vec<f64> {
        project(&mut column, &self.base, self.scale.len());
        column
    }

    /// The square of a counted column (not yet off the base) less what the base has of it.
    pub fn own_square(&self, column: &[f64]) -> f64 {
        let within: f64 = self.base.iter().map(|direction| dot(direction, column).powi(2)).sum();
        dot(column, column) - within
    }

    /// The columns of a law as they count, off the base: behind the measurement filter where all samples are known.
    pub fn columns(&self, law: &Sum) -> Vec<Vec<f64>> {
        self.over(|motions| law.columns(motions))
    }

    /// The same of any columns of the motion.
    pub fn over(&self, columns: impl Fn(&Motions) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        self.with_base(columns).into_iter().map(|column| self.beside(column)).collect()
    }

    /// The same with what the base has of them.
    pub fn with_base(&self, columns: impl Fn(&Motions) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        match &self.exact {
            Some(exact) => columns(&exact.whole).into_iter().map(|column| exact.measured(column)).collect(),
            None => columns(&self.motions).iter().map(|column| multiplied(column, &self.scale)).collect(),
        }
    }

    /// The same as if there were no filter.
    pub fn seen(&self, term: &Term) -> Vec<Vec<f64>> {
        term.columns(&self.motions).iter().map(|column| self.counted(column)).collect()
    }

    /// How many rows count.
    pub fn counts(&self) -> f64 {
        self.scale.iter().filter(|scale| **scale > 0.0).count() as f64
    }

    /// A column of the rows that these are the means of, as these have it.
    pub fn summed(&self, column: &[f64]) -> Vec<f64> {
        summed(column, self.every)
    }

    /// What columns take off the sum of squares, their coefficients, and what is left of the residual. None where they are
    /// nothing, or no numbers.
    pub fn explained(&self, columns: &[Vec<f64>]) -> Option<(f64, Vec<f64>, Vec<f64>)> {
        let squares: Vec<f64> = columns.iter().map(|column| dot(column, column)).collect();
        if squares.iter().any(|square| !(square.is_finite() && *square > f64::MIN_POSITIVE)) {
            return None;
        }
        let along: Vec<f64> = columns.iter().map(|column| dot(column, &self.residual)).collect();
        let coefficients = solved(columns, &squares, &along)?;
        let gain = coefficients.iter().zip(&along).map(|(x, along)| x * along).sum();
        let mut left = self.residual.clone();
        for (column, by) in columns.iter().zip(&coefficients) {
            left.iter_mut().zip(column).for_each(|(x, column)| *x -= by * column);
        }
        Some((gain, coefficients, left))
    }
}

/// Products, place by place.
pub fn multiplied(column: &[f64], by: &[f64]) -> Vec<f64> {
    column.iter().zip(by).map(|(x, by)| x * by).collect()
}

/// The coefficients of columns with these squares, of products with these. None where one is as good as another.
fn solved(columns: &[Vec<f64>], squares: &[f64], along: &[f64]) -> Option<Vec<f64>> {
    if let ([square], [along]) = (squares, along) {
        return Some(vec![along / square]);
    }
    let k = columns.len();
    let sizes = DVector::from_iterator(k, squares.iter().map(|square| square.sqrt()));
    let gram = DMatrix::from_fn(k, k, |i, j| {
        if i == j { 1.0 } else { dot(&columns[i], &columns[j]) / (sizes[i] * sizes[j]) }
    });
    let factor = gram.cholesky().filter(|factor| factor.l_dirty().diagonal().min() > APART)?;
    let scaled = factor.solve(&DVector::from_column_slice(along).component_div(&sizes));
    Some(scaled.component_div(&sizes).as_slice().to_vec())
}

/// Sums of neighbours, divided so that noise stays as large.
fn summed(column: &[f64], every: usize) -> Vec<f64> {
    column.chunks(every).map(|few| few.iter().sum::<f64>() / (every as f64).sqrt()).collect()
}

/// What formulas know as `load`: of the model as it is. Behind a joint, whose motion is not known, none.
fn pressing(signals: &Signals, model: &Model) -> Vec<f64> {
    let mut pressing = vec![0.0; signals.len()];
    let values = model.values();
    let p = model.of_run(&signals.run, &values);
    for passage in signals.passages().into_iter().filter(|_| !model.is_coupled()) {
        let mut state = vec![0.0; model.states()];
        for at in passage {
            let motion = signals.motion(at);
            pressing[at] = model.load(&p, &mut state, &motion).pressing(motion.alpha);
        }
    }
    pressing
}

/// What formulas know as `s`; every passage begins anew.
fn since_turned(signals: &Signals) -> Vec<f64> {
    let mut since = vec![0.0; signals.len()];
    for passage in signals.passages() {
        let mut state = [0.0; STATES];
        passage.for_each(|at| since[at] = follow(&mut state, &signals.motion(at)));
    }
    since
}
