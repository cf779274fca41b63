//! A spline over one variable times powers of others, its stiffness chosen on blocks that it did not see (Eilers & Marx
//! 1996, "Flexible smoothing with B-splines and penalties"): what a law looks like before it has a formula, and a law
//! by itself where none has.

use super::Law;
use super::follow::Reach;
use super::grammar::{Powers, Term, Variable};
use super::penalized::{DEGREE, Penalized, bending, placed, remains, rounded, said, spline};
use super::rows::Rows;
use super::sum::Sum;
use super::surface::Surface;
use crate::algebra::dot;
use crate::diagnose::Watch;
use crate::rule::rule;
use crate::special::Z95;
use nalgebra::DVector;

/// Pieces of the spline.
const PIECES: usize = 36;
/// Stiffnesses that are tried.
const STIFFNESSES: usize = 12;
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
    /// Its parts.
    pub held: Penalized,
}

impl Smooth {
    /// Over a variable, times the rest of a law. None where the motion says nothing of it.
    pub fn of(rows: &Rows<'_>, over: Variable, rest: Term, reach: &Reach) -> Option<Self> {
        let range @ [low, high] = reach.ranges[over as usize];
        let columns = rows.with_base(|motions| {
            let times = rest.columns(motions).swap_remove(0);
            let place = |x: &f64| (x - low) / (high - low);
            let part = |at: usize| {
                let spline = motions[over as usize].iter().map(|x| spline(at, place(x), PIECES));
                spline.zip(&times).map(|(a, b)| a * b).collect()
            };
            (0..PIECES + DEGREE).map(part).collect()
        });
        let bent = bending(PIECES + DEGREE);
        let penalties: Vec<_> = stiffnesses().map(|stiff| &bent * stiff).collect();
        let held = Penalized::of(rows, columns, &penalties)?;
        Some(Self { over, rest, range, held })
    }

    /// What it and what it is multiplied by are of.
    pub fn variables(&self) -> Vec<&'static str> {
        let mut variables = self.rest.variables();
        variables.push(self.over.name());
        variables.sort_unstable();
        variables.dedup();
        variables
    }

    /// A spline with parts so high, at some places.
    pub fn over(&self, x: &[f64], high: &DVector<f64>) -> Vec<f64> {
        x.iter().map(|x| self.base(*x).dot(high)).collect()
    }

    /// Half-width of its 95 % band at some places.
    pub fn band(&self, x: &[f64], rows: &Rows<'_>) -> Vec<f64> {
        let variance = self.held.left(rows);
        let width = |x: &f64| Z95 * (variance * self.held.variance(&self.base(*x))).sqrt();
        x.iter().map(width).collect()
    }

    fn base(&self, x: f64) -> DVector<f64> {
        let [low, high] = self.range;
        DVector::from_fn(PIECES + DEGREE, |at, _| spline(at, (x - low) / (high - low), PIECES))
    }

    /// As an effect is written: how high it is are numbers, its amplitude, place and width parameters.
    fn written(&self, white: f64) -> Law {
        let largest = self.held.high.amax();
        let values = rounded(self.held.high.as_slice(), largest, ROUNDED);
        let before = Sum::from(self.rest.clone()).written(&[largest]);
        Law {
            text: format!("{}*{}", before.text, said(self.over, "", &values)),
            params: before.params.into_iter().chain(placed(self.range, "", PIECES)).collect(),
            variables: self.variables(),
            gain: self.held.gain() / white,
            alike: false,
            count: 3,
            complexity: self.held.free().ceil() as usize,
            terms: 1,
        }
    }
}

/// All splines that may be a law, over some rows.
pub fn all(rows: &Rows<'_>, reach: &Reach, watch: &Watch<'_>) -> Vec<Smooth> {
    let pairs = WRITTEN.iter().flat_map(|(over, all)| all.iter().map(|powers| (*over, *powers)));
    let of = |(over, powers): &(Variable, Powers)| {
        Smooth::of(rows, *over, Term { powers: *powers, factors: Vec::new() }, reach)
    };
    watch.each(&pairs.collect::<Vec<_>>(), of).into_iter().flatten().collect()
}

fn stiffnesses() -> impl Iterator<Item = f64> {
    (0..STIFFNESSES).map(|at| 10_f64.powf(0.7 * at as f64 - 5.0))
}

/// The best of splines that were chosen among few rows, or a surface, where it explains more than the best formula does, the price
/// of its parameters taken off; `white` is the variance of the raw noise.
pub fn beyond(
    best: f64,
    (splines, surface): (&[Smooth], Option<Surface>),
    fine: &Rows<'_>,
    reach: &Reach,
    white: f64,
) -> Option<Written> {
    let price = rule().price;
    let squares = dot(&fine.residual, &fine.residual);
    let said = |(law, unseen): (Law, f64)| {
        let more = law.gain - price * law.complexity as f64 - best;
        (more, Written { law, heldout: remains(unseen, squares) })
    };
    let curve = splines.iter().min_by(|a, b| a.held.unseen.total_cmp(&b.held.unseen)).and_then(|one| {
        let smooth = Smooth::of(fine, one.over, one.rest.clone(), reach)?;
        Some((smooth.written(white), smooth.held.unseen))
    });
    let surface = surface.and_then(|one| one.written(fine, white));
    let enough = |(more, _): &(f64, Written)| *more > rule().alike.max(rule().relative * best);
    let found = [curve, surface].into_iter().flatten().map(said).filter(enough).map(|(_, written)| written);
    found.min_by(|a, b| a.heldout.total_cmp(&b.heldout))
}
