//! A surface over two variables: every product of a spline over the one with a spline over the other, its two stiffnesses
//! chosen on blocks that it did not see (Marx & Eilers 2005, "Multidimensional penalized signal regression"). Where in a
//! plane what is left lives, and a law by itself where neither a formula nor a curve says it.

use super::Law;
use super::follow::Reach;
use super::grammar::{Motions, Powers, Term, Variable};
use super::penalized::{DEGREE, Penalized, bending, placed, rounded, said, spline};
use super::rows::Rows;
use crate::diagnose::Watch;
use crate::order::firsts;
use crate::rule::rule;
use crate::special::Z95;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Pieces in each direction.
const PIECES: usize = 9;
/// Splines in each direction.
const SIDE: usize = PIECES + DEGREE;
/// Stiffnesses that are tried in each direction.
const STIFFNESSES: [f64; 5] = [1e-4, 3e-3, 1e-1, 3.0, 100.0];
/// Places at which a map is told, in each direction.
const PLACES: usize = 41;
/// A map is not known where its band is this many times what it usually is.
const SURE: f64 = 4.0;
/// Products of two curves that a written surface has at most: as many as a law has room for.
const PRODUCTS: usize = 3;
/// How often each side of the products is looked for.
const TURNS: usize = 10;
/// What keeps products apart that are nearly the same, beside the mean of the diagonal.
const FIRM: f64 = 1e-9;
/// Values of a written surface are rounded to this part of the largest.
const ROUNDED: f64 = 1e3;
/// The planes: what is of the velocity as well with a step where that turns round.
const PLANES: [(Variable, Variable, Powers); 8] = [
    (Variable::Theta, Variable::Omega, Powers::NONE),
    (Variable::Theta, Variable::Speed, Powers::SIGN),
    (Variable::Theta, Variable::Alpha, Powers::NONE),
    (Variable::Omega, Variable::Alpha, Powers::NONE),
    (Variable::Time, Variable::Theta, Powers::NONE),
    (Variable::Time, Variable::Omega, Powers::NONE),
    (Variable::Time, Variable::Speed, Powers::SIGN),
    (Variable::Since, Variable::Speed, Powers::SIGN),
];

/// A surface that was fitted to what is left.
pub struct Surface {
    plane: [Variable; 2],
    powers: Powers,
    ranges: [[f64; 2]; 2],
    /// Its parts, those of the second variable next to each other.
    pub held: Penalized,
}

/// What is left, over a plane.
#[derive(Debug, Clone)]
pub struct Map {
    /// The variables.
    pub over: [&'static str; 2],
    /// What it is multiplied by, as text; empty for nothing.
    pub times: String,
    /// Places of the first variable, and of the second.
    pub places: [Vec<f64>; 2],
    /// Its values, those of the second variable next to each other; no numbers where it is not known.
    pub value: Vec<f64>,
    /// Half-width of its 95 % band, alike.
    pub band: Vec<f64>,
}

impl Surface {
    fn of(
        rows: &Rows<'_>,
        plane: [Variable; 2],
        powers: Powers,
        reach: &Reach,
        stiffnesses: &[[f64; 2]],
    ) -> Option<Self> {
        let ranges = plane.map(|variable| reach.ranges[variable as usize]);
        let columns = rows.with_base(|motions| {
            let times = powers.over(motions);
            let sides = sides(plane, ranges, motions);
            let product = |at: usize| {
                let both = sides[0][at / SIDE].iter().zip(&sides[1][at % SIDE]);
                both.zip(&times).map(|((a, b), c)| a * b * c).collect()
            };
            (0..SIDE * SIDE).map(product).collect()
        });
        let (bent, one) = (bending(SIDE), DMatrix::identity(SIDE, SIDE));
        let along = [bent.kronecker(&one), one.kronecker(&bent)];
        let penalty = |[a, b]: &[f64; 2]| &along[0] * *a + &along[1] * *b;
        let penalties: Vec<_> = stiffnesses.iter().map(penalty).collect();
        let held = Penalized::of(rows, columns, &penalties)?;
        Some(Self { plane, powers, ranges, held })
    }

    /// The same over other rows, each direction as stiff as is best.
    pub fn better(&self, rows: &Rows<'_>, reach: &Reach) -> Option<Self> {
        let each = |a: f64| STIFFNESSES.map(|b| [a, b]);
        Self::of(rows, self.plane, self.powers, reach, &STIFFNESSES.map(each).concat())
    }

    /// What it is over.
    pub fn variables(&self) -> [&'static str; 2] {
        self.plane.map(Variable::name)
    }

    /// What is left over its plane, as rows tell it.
    pub fn map(&self, rows: &Rows<'_>) -> Map {
        let variance = self.held.left(rows);
        let place = |[low, high]: [f64; 2], at: usize| low + (high - low) * at as f64 / (PLACES - 1) as f64;
        let places = self.ranges.map(|range| (0..PLACES).map(|at| place(range, at)).collect::<Vec<_>>());
        let base = |side: usize, x: f64| -> Vec<f64> {
            let [low, high] = self.ranges[side];
            (0..SIDE).map(|at| spline(at, (x - low) / (high - low), PIECES)).collect()
        };
        let bases = [0, 1].map(|side| places[side].iter().map(|x| base(side, *x)).collect::<Vec<_>>());
        let at = |cell: usize| {
            let [a, b] = [&bases[0][cell / PLACES], &bases[1][cell % PLACES]];
            let weights = DVector::from_fn(SIDE * SIDE, |at, _| a[at / SIDE] * b[at % SIDE]);
            (weights.dot(&self.held.high), Z95 * (variance * self.held.doubt(&weights)).sqrt())
        };
        let (mut value, band): (Vec<f64>, Vec<f64>) = (0..PLACES * PLACES).map(at).unzip();
        let seen = self.seen(rows);
        let mut usual: Vec<f64> =
            band.iter().zip(&seen).filter(|(_, seen)| **seen).map(|(x, _)| *x).collect();
        usual.sort_by(f64::total_cmp);
        let most = SURE * usual.get(usual.len() / 2).copied().unwrap_or(0.0);
        for ((value, band), seen) in value.iter_mut().zip(&band).zip(seen) {
            if !seen || *band > most {
                *value = f64::NAN;
            }
        }
        let times = if self.powers.signed { "sign(omega)" } else { "" };
        Map { over: self.variables(), times: times.to_owned(), places, value, band }
    }

    /// Where on a map the motion has been, or beside.
    fn seen(&self, rows: &Rows<'_>) -> Vec<bool> {
        let mut seen = vec![false; PLACES * PLACES];
        let [x, y] = self.plane.map(|variable| &rows.motions[variable as usize]);
        let cell = |side: usize, x: f64| {
            let [low, high] = self.ranges[side];
            (((x - low) / (high - low) * (PLACES - 1) as f64).round().max(0.0) as usize).min(PLACES - 1)
        };
        for ((x, y), scale) in x.iter().zip(y).zip(&rows.scale) {
            if *scale > 0.0 {
                let (i, j) = (cell(0, *x), cell(1, *y));
                for i in i.saturating_sub(1)..=(i + 1).min(PLACES - 1) {
                    for j in j.saturating_sub(1)..=(j + 1).min(PLACES - 1) {
                        seen[i * PLACES + j] = true;
                    }
                }
            }
        }
        seen
    }

    /// As an effect is written, and by how much it changes the squares of blocks that it did not see: a sum of products of
    /// two splines, as few as say nearly all of it.
    pub fn written(&self, fine: &Rows<'_>, white: f64) -> Option<(Law, f64)> {
        let explained =
            |curves: &[[Vec<f64>; 2]]| fine.explained(&fine.over(|motions| self.over(curves, motions)));
        let curve = |column: Vec<f64>| {
            let largest = column.iter().fold(0.0_f64, |most, x| if x.abs() > most.abs() { *x } else { most });
            rounded(&column, largest, ROUNDED)
        };
        let products = |count: usize| -> Option<Vec<[Vec<f64>; 2]>> {
            let sides = self.products(count)?;
            let column =
                |at: usize| sides.each_ref().map(|side| curve(side.column(at).iter().copied().collect()));
            Some((0..count).map(column).collect())
        };
        let mut curves = products(PRODUCTS)?;
        let (most, ..) = explained(&curves)?;
        let spare = (white * rule().alike).max(rule().law.powi(2) * most);
        for count in 1..PRODUCTS {
            let Some(fewer) = products(count) else { continue };
            if explained(&fewer).is_some_and(|(gain, ..)| most - gain <= spare) {
                curves = fewer;
                break;
            }
        }
        let (gain, amplitudes, _) = explained(&curves)?;
        let lost = (self.held.gain() - gain).max(0.0);
        // The numbers of a few products are fewer than those of a surface.
        let numbers = curves.len() * (2 * SIDE - curves.len());
        let count = self.held.free().ceil().min(numbers as f64) as usize;
        Some((self.law(&curves, &amplitudes, gain / white, count), self.held.unseen + lost))
    }

    /// The sum of so many products that is nearest to it where the data say something: each side in turn by least squares.
    fn products(&self, count: usize) -> Option<[DMatrix<f64>; 2]> {
        let high = DMatrix::from_fn(SIDE, SIDE, |i, j| self.held.high[i * SIDE + j]);
        let metric = self.held.metric();
        let right = &metric * &self.held.high;
        let parts = high.svd(true, true);
        let mut sides = [parts.u?.columns(0, count).into_owned(), parts.v_t?.rows(0, count).transpose()];
        for turn in 0..2 * TURNS {
            let (own, other) = (turn % 2, &sides[1 - turn % 2]);
            let base = DMatrix::from_fn(SIDE * SIDE, SIDE * count, |at, column| {
                let places = [at / SIDE, at % SIDE];
                if places[own] == column % SIDE { other[(places[1 - own], column / SIDE)] } else { 0.0 }
            });
            let gram = base.tr_mul(&(&metric * &base));
            let held = gram.diagonal().mean() * FIRM;
            let firm = gram + DMatrix::from_diagonal_element(SIDE * count, SIDE * count, held);
            let found = Cholesky::new(firm)?.solve(&base.tr_mul(&right));
            let mut side = DMatrix::from_column_slice(SIDE, count, found.as_slice());
            // Sizes are the amplitudes'.
            side.column_iter_mut().for_each(|mut column| {
                let size = column.norm();
                column /= if size > 0.0 { size } else { 1.0 };
            });
            sides[own] = side;
        }
        Some(sides)
    }

    fn over(&self, curves: &[[Vec<f64>; 2]], motions: &Motions) -> Vec<Vec<f64>> {
        let (times, sides) = (self.powers.over(motions), sides(self.plane, self.ranges, motions));
        let along = |side: usize, high: &Vec<f64>| {
            let mut sum = vec![0.0; times.len()];
            for (high, spline) in high.iter().zip(&sides[side]) {
                sum.iter_mut().zip(spline).for_each(|(sum, x)| *sum += high * x);
            }
            sum
        };
        let product = |[first, second]: &[Vec<f64>; 2]| {
            let both = along(0, first).into_iter().zip(along(1, second));
            both.zip(&times).map(|((a, b), c)| a * b * c).collect()
        };
        curves.iter().map(product).collect()
    }

    fn law(&self, curves: &[[Vec<f64>; 2]], amplitudes: &[f64], gain: f64, complexity: usize) -> Law {
        let mut params = Vec::new();
        let texts: Vec<String> = curves
            .iter()
            .zip(amplitudes)
            .map(|([first, second], amplitude)| {
                let before =
                    Term { powers: self.powers, factors: Vec::new() }.written(&[*amplitude], &mut params);
                let [x, y] = self.plane;
                format!("{before}*{}*{}", said(x, "", first), said(y, "2", second))
            })
            .collect();
        let count = params.len() + 4;
        for (range, number) in self.ranges.iter().zip(["", "2"]) {
            params.extend(placed(*range, number, PIECES));
        }
        let mut variables = self.variables().to_vec();
        variables.sort_unstable();
        let (text, terms) = (texts.join(" + "), curves.len());
        Law { text, params, variables, gain, alike: false, count, complexity, terms }
    }
}

/// The splines over each variable of a plane.
fn sides(plane: [Variable; 2], ranges: [[f64; 2]; 2], motions: &Motions) -> [Vec<Vec<f64>>; 2] {
    [0, 1].map(|side| {
        let (x, [low, high]) = (&motions[plane[side] as usize], ranges[side]);
        let along = |at: usize| x.iter().map(|x| spline(at, (x - low) / (high - low), PIECES)).collect();
        (0..SIDE).map(along).collect()
    })
}

/// Surfaces over all planes, the one first that does best on blocks that it did not see; of a pair of variables one.
pub fn all(rows: &Rows<'_>, reach: &Reach, watch: &Watch<'_>) -> Vec<Surface> {
    let alike = STIFFNESSES.map(|stiff| [stiff, stiff]);
    let of =
        |(x, y, powers): &(Variable, Variable, Powers)| Surface::of(rows, [*x, *y], *powers, reach, &alike);
    let mut found: Vec<Surface> = watch.each(&PLANES, of).into_iter().flatten().collect();
    found.sort_by(|a, b| a.held.unseen.total_cmp(&b.held.unseen));
    firsts(found, |one, other| one.variables() == other.variables())
}
