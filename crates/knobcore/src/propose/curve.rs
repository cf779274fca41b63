//! What is left, as a smooth curve: a spline over one variable times the rest of a law, its stiffness chosen on blocks that
//! it did not see (Eilers & Marx 1996, "Flexible smoothing with B-splines and penalties").

use super::follow::{Followed, Reach};
use super::grammar::{Powers, Term, Variable};
use super::rows::Rows;
use crate::fit::dot;
use crate::special::Z95;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::f64::consts::TAU;

/// Pieces of the spline.
const PIECES: usize = 36;
/// Cubic.
const DEGREE: usize = 3;
/// Blocks that are left out in turn.
const BLOCKS: usize = 10;
/// Stiffnesses that are tried.
const STIFFNESSES: usize = 12;
/// Places at which the curve is told.
const PLACES: usize = 181;
/// Waves over the range that the spline can still follow.
const WAVES: f64 = 9.0;
/// What holds the curve near nought where the data ask for nothing, or the model's parameters can say the same, beside the
/// mean of the diagonal.
const RIDGE: f64 = 1e-3;

/// A curve of what is left.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The variable that it runs over.
    pub over: &'static str,
    /// What it is multiplied by, as text; empty for nothing.
    pub times: String,
    /// Places, in the variable's unit.
    pub x: Vec<f64>,
    /// Its value.
    pub value: Vec<f64>,
    /// Half-width of its 95 % band.
    pub band: Vec<f64>,
    /// The same of the first laws: what the parameters of the model can absorb is taken off each alike.
    pub laws: Vec<Vec<f64>>,
}

/// The curve over the variable of a law, with some laws on it. None for a law that is faster than a spline.
pub fn of(rows: &Rows<'_>, laws: &[Followed]) -> Option<Curve> {
    let reach = Reach::of(rows);
    let (over, rest) = parted(&laws.first()?.term, &reach)?;
    let [low, high] = reach.ranges[over as usize];
    let motions = rows.whole()?;
    let times = rest.columns(motions).into_iter().next()?;
    let columns: Vec<Vec<f64>> = (0..PIECES + DEGREE)
        .map(|at| {
            let spline = motions[over as usize].iter().map(|x| spline(at, (x - low) / (high - low)));
            rows.measured(spline.zip(&times).map(|(a, b)| a * b).collect())
        })
        .collect();
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
    let (_, stiff) =
        stiffnesses.filter_map(|stiff| Some((missed(stiff)?, stiff))).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let solved = factor(&gram, stiff)?;
    let x: Vec<f64> = (0..PLACES).map(|at| low + (high - low) * at as f64 / (PLACES - 1) as f64).collect();
    let bases: Vec<DVector<f64>> =
        x.iter().map(|x| DVector::from_fn(k, |at, _| spline(at, (x - low) / (high - low)))).collect();
    let along = |right: &DVector<f64>| -> Vec<f64> {
        let found = solved.solve(right);
        bases.iter().map(|base| base.dot(&found)).collect()
    };
    let value = along(&right);
    let found = solved.solve(&right);
    let left = dot(&rows.residual, &rows.residual) - 2.0 * found.dot(&right) + found.dot(&(&gram * &found));
    let variance = left.max(0.0) / rows.counts().max(1.0);
    let band = bases
        .iter()
        .map(|base| {
            let weights = solved.solve(base);
            Z95 * (variance * weights.dot(&(&gram * &weights))).max(0.0).sqrt()
        })
        .collect();
    let laws = laws
        .iter()
        .map(|law| {
            let mut torque = vec![0.0; rows.len()];
            for (column, by) in rows.columns(&law.term).iter().zip(&law.coefficients) {
                torque.iter_mut().zip(column).for_each(|(sum, x)| *sum += by * x);
            }
            along(&DVector::from_fn(k, |at, _| dot(&columns[at], &torque)))
        })
        .collect();
    let times = if rest == Term::none() { String::new() } else { rest.written(&[1.0]).text };
    Some(Curve { over: over.name(), times: times.trim_start_matches("a*").to_owned(), x, value, band, laws })
}

/// The variable of a law that a curve is drawn over, and the rest of the law.
fn parted(term: &Term, reach: &Reach) -> Option<(Variable, Term)> {
    let mut rest = term.clone();
    let slow = |at: &usize| {
        let factor = &term.factors[*at];
        !factor.shape.is_wave() && factor.shape.count() > 0
            || reach.span(factor.of) / factor.at[0].abs() < WAVES * TAU
    };
    if let Some(at) = (0..term.factors.len()).find(slow) {
        let over = rest.factors.remove(at).of;
        // A sine that stays has two columns: no curve times one of them.
        if rest.sine().is_some() {
            return None;
        }
        // A function of the speed with the sign of the velocity is one of the velocity.
        if over == Variable::Speed && rest.powers == Powers::SIGN {
            rest.powers = Powers::NONE;
            return Some((Variable::Omega, rest));
        }
        return Some((over, rest));
    }
    if !term.factors.is_empty() {
        return None;
    }
    // Of powers alone: over the first variable, times the rest where that has a name of its own.
    let over = term.powers.of.first().map(|(variable, _)| *variable)?;
    let rest: Vec<_> = term.powers.of.iter().filter(|(variable, _)| *variable != over).collect();
    let same =
        |powers: &&Powers| powers.signed == term.powers.signed && powers.of.iter().eq(rest.iter().copied());
    let powers = *Powers::ALL.iter().find(same)?;
    let over = if over == Variable::Speed { Variable::Omega } else { over };
    Some((over, Term { powers, factors: Vec::new() }))
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
