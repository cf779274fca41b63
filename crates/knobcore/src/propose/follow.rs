//! A law followed from where a scan found it to its best parameters: variable projection with steps of Levenberg and
//! Marquardt. What is linear is solved for at every step.

use super::grammar::{Factor, Shape, Variable};
use super::rows::Rows;
use super::sum::Sum;
use crate::algebra::dot;
use nalgebra::{DMatrix, DVector};

/// Steps at most.
const STEPS: usize = 25;
/// A step that takes less of the sum of squares than this ends it.
const ENOUGH: f64 = 1e-6;
/// Exponents of a power: below is a step, beyond nothing that mechanics knows.
const EXPONENTS: [f64; 2] = [0.05, 8.0];
/// Step of differences, as a share of a width or a range.
const DIFFERENCE: f64 = 1e-4;

/// A law at parameters, and what it takes off.
#[derive(Debug, Clone)]
pub struct Followed {
    /// The law.
    pub law: Sum,
    /// What it takes off the sum of squares, (N m)^2.
    pub gain: f64,
    /// Its linear coefficients.
    pub coefficients: Vec<f64>,
    left: Vec<f64>,
}

impl Followed {
    /// A law as it is.
    pub fn at(rows: &Rows<'_>, law: impl Into<Sum>) -> Option<Self> {
        let law = law.into();
        let (gain, coefficients, left) = rows.explained(&rows.columns(&law))?;
        Some(Self { law, gain, coefficients, left })
    }

    /// The law at its best parameters near to those that it has; `reach` bounds the widths by each variable's range.
    pub fn best(self, rows: &Rows<'_>, steps: usize, reach: &Reach) -> Self {
        let mut here = self;
        let mut damping = 1e-2;
        for _ in 0..steps.min(STEPS) {
            let places = free(&here.law);
            if places.is_empty() {
                break;
            }
            let mut slopes = Vec::new();
            for place in &places {
                let step = moved(&here.law, &[*place], &[DIFFERENCE], reach);
                let Some(beside) = Self::at(rows, step) else { return here };
                let slope: Vec<f64> =
                    beside.left.iter().zip(&here.left).map(|(b, a)| (b - a) / DIFFERENCE).collect();
                slopes.push(slope);
            }
            let gram = DMatrix::from_fn(places.len(), places.len(), |i, j| dot(&slopes[i], &slopes[j]));
            let right = DVector::from_fn(places.len(), |i, _| -dot(&slopes[i], &here.left));
            let mut went = false;
            for _ in 0..4 {
                let damped =
                    &gram + DMatrix::from_diagonal(&gram.diagonal().map(|x| damping * x + f64::MIN_POSITIVE));
                let Some(step) = damped.cholesky().map(|factor| factor.solve(&right)) else { return here };
                // A width changes by no more than a half at a time.
                let held: Vec<f64> = step.iter().map(|x| x.clamp(-0.7, 0.7)).collect();
                let next = Self::at(rows, moved(&here.law, &places, &held, reach));
                let before = here.gain;
                match next {
                    Some(next) if next.gain > before => {
                        let more = next.gain - before;
                        here = next;
                        damping = (damping * 0.2).max(1e-7);
                        went = more > ENOUGH * before;
                        break;
                    }
                    _ => damping *= 8.0,
                }
            }
            if !went {
                break;
            }
        }
        here
    }
}

/// How far each variable goes.
pub struct Reach {
    /// Least and most of each variable.
    pub ranges: [[f64; 2]; Variable::ALL.len()],
}

impl Reach {
    /// Of rows.
    pub fn of(rows: &Rows<'_>) -> Self {
        let range = |variable: Variable| {
            let column = rows.motions[variable as usize].iter().zip(&rows.scale).filter(|(_, w)| **w > 0.0);
            column.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], (x, _)| [l.min(*x), h.max(*x)])
        };
        Self { ranges: Variable::ALL.map(range) }
    }

    /// The range of one.
    pub fn span(&self, variable: Variable) -> f64 {
        let [low, high] = self.ranges[variable as usize];
        (high - low).max(f64::MIN_POSITIVE)
    }

    /// The farthest from nought.
    pub fn far(&self, variable: Variable) -> f64 {
        let [low, high] = self.ranges[variable as usize];
        high.abs().max(low.abs()).max(f64::MIN_POSITIVE)
    }
}

/// A parameter of a law: of which term, which function's, and which of it.
type Place = [usize; 3];

fn free(law: &Sum) -> Vec<Place> {
    let of = |term: usize, at: usize, factor: &Factor| (0..factor.shape.count()).map(move |i| [term, at, i]);
    let terms = law.0.iter().enumerate();
    terms
        .flat_map(|(term, own)| own.factors.iter().enumerate().flat_map(move |(at, one)| of(term, at, one)))
        .collect()
}

/// The law with some of its parameters moved: widths by a factor, centres by a part of the width, the frequency of a sine by
/// a part of a wave over the whole range.
fn moved(law: &Sum, places: &[Place], steps: &[f64], reach: &Reach) -> Sum {
    let mut law = law.clone();
    for ([term, at, i], step) in places.iter().zip(steps) {
        let factor = &mut law.0[*term].factors[*at];
        let (span, far) = (reach.span(factor.of), reach.far(factor.of));
        let [w, c] = &mut factor.at;
        match (factor.shape, i) {
            (Shape::Sine, _) => *w = (1.0 / *w + step / span).recip(),
            (Shape::Power, _) => *c = (*c + step).clamp(EXPONENTS[0], EXPONENTS[1]),
            (_, 1) => *c = (*c + step * w.abs()).clamp(-2.0 * far, 2.0 * far),
            // Time constants may be of what grows; all else narrows and widens.
            _ => {
                let [least, most] = [1e-3 * far, 20.0 * far];
                *w = w.signum() * (w.abs() * step.exp()).clamp(least, most);
            }
        }
    }
    law
}
