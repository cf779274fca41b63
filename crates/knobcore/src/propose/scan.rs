//! The scan: every power and every function of the grammar at a few widths and centres, held against the residual; sines at
//! every frequency.

use super::follow::Reach;
use super::grammar::{Factor, Powers, Shape, Term, Variable};
use super::rows::Rows;
use crate::diagnose::Watch;
use crate::fit::dot;
use std::f64::consts::TAU;

/// Frequencies of a scan for a wave over all of a range.
const OVERSAMPLING: f64 = 4.0;
/// Most frequencies over a variable that is not time.
const MOST: usize = 1500;
/// Peaks of a scan that are looked at.
const PEAKS: usize = 3;
/// Centres of what acts at a place.
const CENTRES: usize = 15;

/// A law at a place of the scan, and what it would take off.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The law.
    pub term: Term,
    /// What it takes off the sum of squares, about, (N m)^2.
    pub gain: f64,
}

/// The functions of one variable that are tried, of those variables.
pub fn functions(reach: &Reach, variables: &[Variable]) -> Vec<Factor> {
    use Shape::{Bump, Decay, Peaked, Resonant, Saturating, Slow, Step};
    use Variable::{Alpha, Omega, Since, Speed, Theta, Time};
    let mut found = Vec::new();
    for &of in variables {
        let ([low, _], span, far) = (reach.ranges[of as usize], reach.span(of), reach.far(of));
        let mut put = |shape, widths: &[f64], centres: usize| {
            for width in widths {
                for k in 0..centres.max(1) {
                    let centre = low + span * (k as f64 + 0.5) / centres.max(1) as f64;
                    found.push(Factor { of, shape, at: [*width, if centres > 0 { centre } else { 0.0 }] });
                }
            }
        };
        let of_span = |shares: &[f64]| shares.iter().map(|share| share * span).collect::<Vec<_>>();
        let of_far = |shares: &[f64]| shares.iter().map(|share| share * far).collect::<Vec<_>>();
        if matches!(of, Theta | Speed | Time) {
            put(Bump, &of_span(&[0.03, 0.08, 0.2]), CENTRES);
            put(Step, &of_span(&[0.02, 0.1]), CENTRES);
        }
        if matches!(of, Speed | Theta) {
            put(Resonant, &of_span(&[0.05, 0.15]), CENTRES);
        }
        match of {
            Time => put(Decay, &of_span(&[0.05, 0.15, 0.4, 1.0, -0.5]), 0),
            Since => put(Decay, &of_span(&[0.01, 0.03, 0.1, 0.3]), 0),
            Speed => put(Decay, &of_far(&[0.03, 0.1, 0.3, -0.5]), 0),
            Theta => put(Decay, &of_span(&[0.2, -0.2, 0.6, -0.6]), 0),
            _ => {}
        }
        if matches!(of, Omega | Theta | Alpha) {
            put(Saturating, &of_far(&[0.05, 0.15, 0.4]), 0);
            put(Slow, &of_far(&[0.05, 0.2, 0.6]), 0);
            put(Peaked, &of_far(&[0.03, 0.08, 0.2, 0.5]), 0);
        }
        if of == Since {
            put(Saturating, &of_far(&[0.02, 0.08, 0.3]), 0);
        }
    }
    found
}

/// Each power with each function, and alone; what best of every kind is.
pub fn scan(rows: &Rows<'_>, functions: &[Factor], watch: &Watch<'_>) -> Vec<Seen> {
    let shapes: Vec<Vec<f64>> = functions
        .iter()
        .map(|Factor { of, shape, at: [w, c] }| {
            rows.motions[*of as usize].iter().map(|x| shape.at(*x, *w, *c)).collect()
        })
        .collect();
    let mut found: Vec<Seen> = watch
        .each(Powers::ALL, |powers| {
            let plain = counted(rows, &powers.over(&rows.motions));
            let mut best: Vec<Seen> = Vec::new();
            let alone = Term { powers: *powers, factors: Vec::new() };
            best.extend(taken(rows, &plain).map(|gain| Seen { term: alone.clone(), gain }));
            keep_best(rows, &alone, &plain, functions, &shapes, &mut best);
            best
        })
        .into_iter()
        .flatten()
        .collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// A law with each function more, of every kind the best.
pub fn widened(rows: &Rows<'_>, term: &Term, functions: &[Factor]) -> Vec<Seen> {
    let mut best = Vec::new();
    if term.sine().is_none() {
        let plain = counted(rows, &term.columns(&rows.motions).remove(0));
        let shapes: Vec<Vec<f64>> = functions
            .iter()
            .map(|Factor { of, shape, at: [w, c] }| {
                rows.motions[*of as usize].iter().map(|x| shape.at(*x, *w, *c)).collect()
            })
            .collect();
        keep_best(rows, term, &plain, functions, &shapes, &mut best);
        return best;
    }
    let [sine, cosine] = &term.columns(&rows.motions)[..] else { return best };
    for factor in functions {
        let Factor { of, shape, at: [w, c] } = factor;
        let x = &rows.motions[*of as usize];
        let times = |column: &Vec<f64>| {
            let product = column.iter().zip(x).map(|(own, x)| own * shape.at(*x, *w, *c)).collect();
            rows.counted(product)
        };
        if let Some((gain, ..)) = rows.explained(&[times(sine), times(cosine)]) {
            let mut wider = term.clone();
            wider.factors.insert(wider.factors.len() - 1, *factor);
            put(&mut best, Seen { term: wider, gain });
        }
    }
    best
}

fn counted(rows: &Rows<'_>, column: &[f64]) -> Vec<f64> {
    column.iter().zip(&rows.scale).map(|(x, scale)| x * scale).collect()
}

/// What a column (counted, not off the base) takes off.
fn taken(rows: &Rows<'_>, column: &[f64]) -> Option<f64> {
    let (square, own) = (dot(column, column), rows.own_square(column));
    (own > 1e-6 * square && own.is_finite()).then(|| dot(column, &rows.residual).powi(2) / own)
}

fn keep_best(
    rows: &Rows<'_>,
    term: &Term,
    plain: &[f64],
    functions: &[Factor],
    shapes: &[Vec<f64>],
    best: &mut Vec<Seen>,
) {
    let mut product = vec![0.0; plain.len()];
    for (factor, shape) in functions.iter().zip(shapes) {
        product.iter_mut().zip(plain).zip(shape).for_each(|((x, a), b)| *x = a * b);
        if let Some(gain) = taken(rows, &product) {
            let mut factors = term.factors.clone();
            factors.push(*factor);
            put(best, Seen { term: Term { powers: term.powers, factors }, gain });
        }
    }
}

/// Keeps the best of each kind: powers, and of the last function variable and shape.
fn put(best: &mut Vec<Seen>, one: Seen) {
    let kinds = |term: &Term| -> Vec<(Variable, Shape)> {
        term.factors.iter().map(|factor| (factor.of, factor.shape)).collect()
    };
    match best
        .iter_mut()
        .find(|other| other.term.powers == one.term.powers && kinds(&other.term) == kinds(&one.term))
    {
        Some(other) if other.gain < one.gain => *other = one,
        Some(_) => {}
        None => best.push(one),
    }
}

/// Sines over a variable times each of some laws without one, at the frequencies that stand out.
pub fn sines(rows: &Rows<'_>, terms: &[Term], of: Variable, reach: &Reach, fastest: f64) -> Vec<Seen> {
    let x = &rows.motions[of as usize];
    let span = reach.span(of);
    let step = TAU / span / OVERSAMPLING;
    let count = ((fastest / step) as usize).min(if of == Variable::Time { usize::MAX } else { MOST });
    let weights: Vec<Vec<f64>> =
        terms.iter().map(|term| counted(rows, &term.columns(&rows.motions).remove(0))).collect();
    let squares: Vec<f64> = weights.iter().map(|column| dot(column, column)).collect();
    let loaded: Vec<Vec<f64>> = weights
        .iter()
        .map(|column| column.iter().zip(&rows.residual).map(|(w, r)| w * r).collect())
        .collect();
    // Phasors of all rows, turned on by one frequency after the other.
    let (mut re, mut im) = (vec![1.0; x.len()], vec![0.0; x.len()]);
    let (cos, sin): (Vec<f64>, Vec<f64>) = x.iter().map(|x| ((x * step).cos(), (x * step).sin())).unzip();
    let mut gains = vec![vec![0.0; count + 1]; terms.len()];
    for k in 1..=count {
        for (((re, im), c), s) in re.iter_mut().zip(&mut im).zip(&cos).zip(&sin) {
            (*re, *im) = (*re * c - *im * s, *re * s + *im * c);
        }
        for ((gains, loaded), square) in gains.iter_mut().zip(&loaded).zip(&squares) {
            gains[k] = (dot(loaded, &re).powi(2) + dot(loaded, &im).powi(2)) / (0.5 * square);
        }
    }
    let mut found = Vec::new();
    for (gains, term) in gains.iter().zip(terms) {
        let mut peaks: Vec<usize> = (1..count)
            .filter(|&k| gains[k] >= gains[k - 1] && gains[k] > gains[k + 1] && gains[k].is_finite())
            .collect();
        peaks.sort_by(|a, b| gains[*b].total_cmp(&gains[*a]));
        // The slowest waves are no peak: over less than one the parameters of the model take most of them.
        peaks.truncate(PEAKS);
        peaks.extend([1, 2, 4].into_iter().filter(|k| *k <= count));
        for k in peaks {
            let mut factors = term.factors.clone();
            factors.push(Factor { of, shape: Shape::Sine, at: [1.0 / (step * k as f64), 0.0] });
            found.push(Seen { term: Term { powers: term.powers, factors }, gain: gains[k] });
        }
    }
    found
}
