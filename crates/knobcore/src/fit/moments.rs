//! Normal equations: what one pass over the data leaves of it.
//!
//! A pass evaluates the model and its derivatives chunk by chunk and keeps only the products of the
//! columns, so that memory does not grow with the capture.

use crate::isa;
use crate::model::Model;
use crate::predict::{Columns, Seeds, measured};
use crate::scalar::{LANES, Pack, Scalar};
use crate::signals::{Chunk, Signals};

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
    isa::dispatch(Products { columns, products });
}

/// Rows that are multiplied at a time: ten columns of them stay in the first cache.
const ROWS: usize = 256;

struct Products<'a> {
    columns: &'a [&'a [f64]],
    products: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let side = self.columns.len();
        let rows = self.columns.first().map_or(0, |column| column.len());
        for start in (0..rows).step_by(ROWS) {
            let end = (start + ROWS).min(rows);
            for i in 0..side {
                let own = &self.columns[i][start..end];
                let (row, others) = (&mut self.products[i * side..], &self.columns[..=i]);
                for (at, four) in others.chunks(4).enumerate() {
                    let others: [&[f64]; 4] =
                        std::array::from_fn(|j| &four[j.min(four.len() - 1)][start..end]);
                    for (j, product) in inner_of_four(own, others).into_iter().enumerate().take(four.len()) {
                        row[4 * at + j] += product;
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

/// Sum of products of two columns of one length.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    isa::dispatch(Dot { a, b })
}

struct Dot<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl pulp::NullaryFnOnce for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        inner(self.a, self.b)
    }
}

/// Products of one column with four others, so that it is read once.
#[inline(always)]
fn inner_of_four(a: &[f64], others: [&[f64]; 4]) -> [f64; 4] {
    let mut sums = [Pack::of(0.0); 4];
    let whole = a.len() - a.len() % LANES;
    for at in (0..whole).step_by(LANES) {
        let x = Pack::of_packs(a, at);
        for i in 0..4 {
            sums[i] = sums[i] + x * Pack::of_packs(others[i], at);
        }
    }
    let mut out = [0.0; 4];
    for i in 0..4 {
        let tail: f64 = a[whole..].iter().zip(&others[i][whole..]).map(|(x, y)| x * y).sum();
        out[i] = sums[i].0.iter().sum::<f64>() + tail;
    }
    out
}

#[inline(always)]
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let (mut first, mut second) = (Pack::of(0.0), Pack::of(0.0));
    for (x, y) in a.chunks_exact(2 * LANES).zip(b.chunks_exact(2 * LANES)) {
        first = first + Pack::of_packs(x, 0) * Pack::of_packs(y, 0);
        second = second + Pack::of_packs(x, LANES) * Pack::of_packs(y, LANES);
    }
    let done = a.len() - a.len() % (2 * LANES);
    let tail: f64 = a[done..].iter().zip(&b[done..]).map(|(x, y)| x * y).sum();
    (first + second).0.iter().sum::<f64>() + tail
}

/// One chunk of a pass: the derivative columns and then the residual, zero where a sample does not count.
pub struct Evaluated<'a> {
    /// Which capture.
    pub capture: usize,
    /// Its samples.
    pub signals: &'a Signals,
    /// Which samples.
    pub chunk: &'a Chunk,
    /// k derivative columns and the residual, each as long as the chunk's core.
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
            let inner = chunk.inner();
            let (tau, weight) = (&signals.tau[chunk.core.clone()], &signals.weight[chunk.core.clone()]);
            let (model_torque, derivatives) = columns.split();
            for ((f, tau), w) in model_torque[inner.clone()].iter_mut().zip(tau).zip(weight) {
                *f = (tau - *f) * w;
            }
            if weight.iter().any(|w| *w < 1.0) {
                for column in derivatives.iter_mut() {
                    for (d, w) in column[inner.clone()].iter_mut().zip(weight) {
                        *d *= w;
                    }
                }
            }
            let mut views: Vec<&[f64]> = derivatives.iter().map(|column| &column[inner.clone()]).collect();
            views.push(&model_torque[inner]);
            visit(&Evaluated { capture, signals, chunk: &chunk, columns: &views });
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
        let weight = &evaluated.signals.weight[evaluated.chunk.core.clone()];
        let mut from = 0;
        while from < weight.len() {
            let Some(block) = self.blocks.last_mut() else { return };
            let room = self.samples - block.rows;
            let mut counted = 0.0;
            let take = weight[from..].iter().take_while(|w| {
                counted += **w;
                counted <= room
            });
            let to = from + take.count();
            let views: Vec<&[f64]> = evaluated.columns.iter().map(|column| &column[from..to]).collect();
            block.add_columns(&views);
            block.rows += weight[from..to].iter().sum::<f64>();
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
