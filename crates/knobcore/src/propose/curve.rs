//! What is left, as a smooth curve over the variable of the first law, with laws on it.

use super::follow::{Followed, Reach};
use super::grammar::{Powers, Term, Variable};
use super::rows::Rows;
use super::spline::Smooth;
use super::sum::Sum;
use std::f64::consts::TAU;

/// Places at which the curve is told.
const PLACES: usize = 181;
/// Waves over the range that the spline can still follow.
const WAVES: f64 = 9.0;

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

/// The curve over the variable of the first of some laws that is no sum, with them on it. None for a law that is faster than a spline.
pub fn of(rows: &Rows<'_>, laws: &[Followed]) -> Option<Curve> {
    let reach = Reach::of(rows);
    let (over, rest) = parted(laws.iter().find_map(|one| one.law.alone())?, &reach)?;
    let times =
        if rest == Term::none() { String::new() } else { Sum::from(rest.clone()).written(&[1.0]).text };
    let smooth = Smooth::of(rows, over, rest, &reach)?;
    let [low, high] = reach.ranges[over as usize];
    let x: Vec<f64> = (0..PLACES).map(|at| low + (high - low) * at as f64 / (PLACES - 1) as f64).collect();
    let torque = |law: &Followed| {
        let mut torque = vec![0.0; rows.len()];
        for (column, by) in rows.columns(&law.law).iter().zip(&law.coefficients) {
            torque.iter_mut().zip(column).for_each(|(sum, x)| *sum += by * x);
        }
        smooth.over(&x, &smooth.held.like(torque))
    };
    let laws = laws.iter().map(torque).collect();
    let (value, band) = (smooth.over(&x, &smooth.held.high), smooth.band(&x, rows));
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
    let same = |powers: &&Powers| {
        let kind = |powers: &Powers| (powers.signed, powers.pressed);
        kind(powers) == kind(&term.powers) && powers.of.iter().eq(rest.iter().copied())
    };
    let powers = *Powers::ALL.iter().find(same)?;
    let over = if over == Variable::Speed { Variable::Omega } else { over };
    Some((over, Term { powers, factors: Vec::new() }))
}
