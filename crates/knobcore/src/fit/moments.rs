//! Normal equations: what one pass over the data leaves of it.
//!
//! A pass evaluates the model and its derivatives chunk by chunk and keeps only the products of the
//! columns, so that memory does not grow with the capture.

use crate::algebra::squares;
use crate::isa;
use crate::model::Model;
use crate::predict::{Columns, Seeds, measured, several};
use crate::signals::Signals;
use pulp::Simd;
use std::ops::Range;

/// Products of the `k` derivative columns with each other and with the residual, over the used samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// Number of derivative columns.
    pub k: usize,
    /// (k+1) x (k+1) products, row by row, symmetric; the last row and column belong to the residual.
    products: Vec<f64>,
    /// Number of samples that count.
    pub rows: f64,
}

impl Moments {
    /// Of no data.
    pub fn empty(k: usize) -> Self {
        Self { k, products: vec![0.0; (k + 1) * (k + 1)], rows: 0.0 }
    }

    /// Of the data of several, of `k` columns each.
    pub fn of_all(k: usize, parts: &[Self]) -> Self {
        let mut all = Self::empty(k);
        parts.iter().for_each(|part| all.add(part));
        all
    }

    /// Columns `i` and `j` multiplied.
    #[inline(always)]
    pub fn gram(&self, i: usize, j: usize) -> f64 {
        self.products[i * (self.k + 1) + j]
    }

    /// Column `i` times the residual.
    #[inline(always)]
    pub fn slope(&self, i: usize) -> f64 {
        self.gram(i, self.k)
    }

    /// Sum of the squared residual, (N m)^2.
    #[inline(always)]
    pub fn squares(&self) -> f64 {
        self.gram(self.k, self.k)
    }

    /// Adds the products of further data.
    pub fn add(&mut self, other: &Self) {
        self.add_scaled(other, 1.0);
    }

    /// Adds `weight` times the products of further data (-1 takes them away again).
    pub fn add_scaled(&mut self, other: &Self, weight: f64) {
        for (own, more) in self.products.iter_mut().zip(&other.products) {
            *own += weight * more;
        }
        self.rows += weight * other.rows;
    }

    /// Sum of squares after the parameters move by `delta`, to first order (exact where they are linear).
    pub fn squares_after(&self, delta: &[f64]) -> f64 {
        let mut sum = self.squares();
        for i in 0..self.k {
            sum -= 2.0 * delta[i] * self.slope(i);
            for j in 0..self.k {
                sum += delta[i] * self.gram(i, j) * delta[j];
            }
        }
        sum
    }

    /// Adds the products of weighted columns, each of the same length; the last one is the residual.
    pub(super) fn add_columns(&mut self, columns: &[&[f64]]) {
        add_products(columns, &mut self.products);
    }
}

/// Adds the products of columns of one length with each other to a symmetric matrix, row by row.
pub fn add_products(columns: &[&[f64]], products: &mut [f64]) {
    isa::dispatch_wide(Products { columns, products });
}

/// Rows that are multiplied at a time: nine columns of them stay in the first cache.
const ROWS: usize = 512;

struct Products<'a> {
    columns: &'a [&'a [f64]],
    products: &'a mut [f64],
}

impl pulp::WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let side = self.columns.len();
        let rows = self.columns.first().map_or(0, |column| column.len());
        for start in (0..rows).step_by(ROWS) {
            let end = (start + ROWS).min(rows);
            // Of three columns that are not there, the last takes the place.
            let three = |at: usize| [at, at + 1, at + 2].map(|i| &self.columns[i.min(side - 1)][start..end]);
            for i in (0..side).step_by(3) {
                for j in (0..=i).step_by(3) {
                    let sums = nine(simd, three(i), three(j));
                    for (i, sums) in (i..side).zip(sums) {
                        for (j, sum) in (j..=i).zip(sums) {
                            self.products[i * side + j] += sum;
                        }
                    }
                }
            }
        }
        for i in 0..side {
            for j in 0..i {
                self.products[j * side + i] = self.products[i * side + j];
            }
        }
    }
}

/// Products of three columns with three others, so that each is read once for three.
#[inline(always)]
fn nine<S: Simd>(simd: S, [a, b, c]: [&[f64]; 3], [x, y, z]: [&[f64]; 3]) -> [[f64; 3]; 3] {
    let n = a.len() / S::F64_LANES;
    let packs = |column| &S::as_simd_f64s(column).0[..n];
    let own = (packs(a), packs(b), packs(c));
    let others = (packs(x), packs(y), packs(z));
    let mut sums = [[simd.splat_f64s(0.0); 3]; 3];
    for at in 0..n {
        let (own, others) = ([own.0[at], own.1[at], own.2[at]], [others.0[at], others.1[at], others.2[at]]);
        for i in 0..3 {
            for j in 0..3 {
                sums[i][j] = simd.mul_add_e_f64s(own[i], others[j], sums[i][j]);
            }
        }
    }
    let mut out = [[0.0; 3]; 3];
    for (i, own) in [a, b, c].into_iter().enumerate() {
        for (j, other) in [x, y, z].into_iter().enumerate() {
            out[i][j] = simd.reduce_sum_f64s(sums[i][j]);
            for at in n * S::F64_LANES..a.len() {
                out[i][j] += own[at] * other[at];
            }
        }
    }
    out
}

/// One chunk of a pass: the derivative columns and then the residual, zero where a sample does not count.
pub struct Evaluated<'a> {
    /// Which capture.
    pub capture: usize,
    /// Its samples.
    pub signals: &'a Signals,
    /// Which of them, all in one segment.
    pub rows: Range<usize>,
    /// k derivative columns and the residual, each as long as these rows.
    pub columns: &'a [&'a [f64]],
}

/// Passes over all captures: evaluates the model with derivatives and hands over chunk after chunk.
pub fn evaluate(
    data: &[&Signals],
    model: &Model,
    p: &[f64],
    seeds: &Seeds,
    mut visit: impl FnMut(&Evaluated<'_>),
) {
    let mut columns = Columns::default();
    for (capture, signals) in data.iter().enumerate() {
        for chunk in signals.chunks(model.remembers()) {
            measured(model, p, seeds, signals, &chunk, &mut columns);
            for rows in signals.parts(&chunk.core) {
                let inner = chunk.within(&rows);
                let (tau, weight) = (&signals.tau[rows.clone()], &signals.weight[rows.clone()]);
                let (model_torque, derivatives) = columns.split();
                leave(&mut model_torque[inner.clone()], tau, weight);
                mask(derivatives, &inner, weight);
                let mut views: Vec<&[f64]> =
                    derivatives.iter().map(|column| &column[inner.clone()]).collect();
                views.push(&model_torque[inner]);
                visit(&Evaluated { capture, signals, rows, columns: &views });
            }
        }
    }
}

/// Makes the residual of a modelled torque, zero where a sample does not count.
#[inline(always)]
fn leave(modelled: &mut [f64], tau: &[f64], weight: &[f64]) {
    for ((f, tau), w) in modelled.iter_mut().zip(tau).zip(weight) {
        *f = (tau - *f) * w;
    }
}

/// Makes these rows of columns zero where a sample does not count.
#[inline(always)]
fn mask(columns: &mut [Vec<f64>], rows: &Range<usize>, weight: &[f64]) {
    // Eight at a time, which are compared side by side.
    if weight.chunks(8).any(|few| few.iter().fold(false, |any, w| any | (*w < 1.0))) {
        for column in columns.iter_mut() {
            column[rows.clone()].iter_mut().zip(weight).for_each(|(d, w)| *d *= w);
        }
    }
}

/// Passes over all captures with several sets of parameters: hands over a residual for each, chunk after chunk.
pub fn residuals(data: &[&Signals], model: &Model, sets: &[Vec<f64>], mut visit: impl FnMut(&Evaluated<'_>)) {
    let mut columns = Vec::new();
    for (capture, signals) in data.iter().enumerate() {
        for chunk in signals.chunks(model.remembers()) {
            several(model, sets, signals, &chunk, &mut columns);
            for rows in signals.parts(&chunk.core) {
                let inner = chunk.within(&rows);
                let (tau, weight) = (&signals.tau[rows.clone()], &signals.weight[rows.clone()]);
                columns.iter_mut().for_each(|column| leave(&mut column[inner.clone()], tau, weight));
                let views: Vec<&[f64]> = columns.iter().map(|column| &column[inner.clone()]).collect();
                visit(&Evaluated { capture, signals, rows, columns: &views });
            }
        }
    }
}

/// The normal equations at `p`.
pub fn moments(data: &[&Signals], model: &Model, p: &[f64], seeds: &Seeds) -> Moments {
    let mut sum = Moments::empty(seeds.columns());
    evaluate(data, model, p, seeds, |evaluated| sum.add_columns(evaluated.columns));
    sum.rows = used(data);
    sum
}

/// Samples that count.
pub fn used(data: &[&Signals]) -> f64 {
    data.iter().map(|signals| signals.used() as f64).sum()
}

/// Sum of squares of the measured torque, (N m)^2.
pub fn measured_squares(data: &[&Signals]) -> f64 {
    data.iter().map(|signals| squares(&signals.tau, &signals.weight)).sum()
}

/// The normal equations apart for consecutive blocks of about so many used samples; a block never spans two
/// captures.
pub struct Blocks {
    samples: f64,
    capture: usize,
    blocks: Vec<Moments>,
}

impl Blocks {
    /// None yet.
    pub fn of(samples: f64) -> Self {
        Self { samples: samples.max(1.0), capture: usize::MAX, blocks: Vec::new() }
    }

    /// Takes one chunk of a pass.
    pub fn add(&mut self, evaluated: &Evaluated<'_>) {
        let k = evaluated.columns.len() - 1;
        if evaluated.capture != self.capture {
            self.capture = evaluated.capture;
            self.blocks.push(Moments::empty(k));
        }
        let weight = &evaluated.signals.weight[evaluated.rows.clone()];
        let mut from = 0;
        while from < weight.len() {
            let Some(block) = self.blocks.last_mut() else { return };
            let room = self.samples - block.rows;
            let (mut to, mut counted) = (from, 0.0);
            // No sample counts for more than one: so many at least are there room for.
            while let take @ 1.. = ((room - counted) as usize).min(weight.len() - to) {
                counted += weight[to..to + take].iter().sum::<f64>();
                to += take;
            }
            let views: Vec<&[f64]> = evaluated.columns.iter().map(|column| &column[from..to]).collect();
            block.add_columns(&views);
            block.rows += counted;
            if to < weight.len() {
                self.blocks.push(Moments::empty(k));
            }
            from = to;
        }
    }

    /// Those that hold samples.
    pub fn done(mut self) -> Vec<Moments> {
        self.blocks.retain(|block| block.rows > 0.0);
        self.blocks
    }
}
