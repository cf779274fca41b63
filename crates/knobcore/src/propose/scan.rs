//! The scan: every power and every function of the grammar at a few widths and centres, held against the residual; sines at
//! every frequency.

use super::follow::Reach;
use super::grammar::{Factor, Powers, Shape, Term, Variable};
use super::rows::{Rows, multiplied};
use crate::algebra::{dot, products, slices};
use crate::diagnose::Watch;
use crate::fourier::Transform;
use crate::order::descending;
use std::f64::consts::TAU;

/// Frequencies of a scan for a wave over all of a range.
const OVERSAMPLING: f64 = 4.0;
/// Most frequencies over a variable that is not time.
const MOST: usize = 1500;
/// Peaks of a scan that are looked at.
const PEAKS: usize = 3;
/// Slow waves that are looked at whether they are peaks or not, in steps of a scan.
const SLOWEST: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 6.0];
/// Waves a turn that are looked at as whole numbers.
const ORDERS: u32 = 12;
/// Cells of a grid of a variable that is not time: in one the fastest wave turns by 0.14.
const CELLS: usize = 1 << 14;
/// Cells of a grid of times at most.
const LONGEST: usize = 1 << 20;
/// Centres of what acts at a place.
const CENTRES: usize = 15;
/// Exponents that powers set out from: roots as of a grease that thins, and what lies between and beyond lines and squares.
const EXPONENTS: [f64; 4] = [0.3, 0.6, 1.5, 2.5];

/// A law at a place of the scan, and what it would take off.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The law.
    pub term: Term,
    /// What it takes off the sum of squares, about, (N m)^2.
    pub gain: f64,
}

/// The functions of one variable that are tried, of those variables; of a knob that `turns` an angle has whole numbers of
/// waves a turn.
pub fn functions(reach: &Reach, variables: &[Variable], turns: bool) -> Vec<Factor> {
    use Shape::{Bump, Cos, Decay, Peaked, Power, Resonant, Saturating, Sin, Slow, Step};
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
        if of == Theta && turns {
            let whole: Vec<f64> = (1..=ORDERS).map(|n| 1.0 / f64::from(n)).collect();
            put(Sin, &whole, 0);
            put(Cos, &whole, 0);
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
        if of == Speed {
            // Any speed does; one digit of it is enough.
            let size = 10_f64.powf(far.log10().floor());
            let held = (0.5 * far / size).ceil() * size;
            found.extend(EXPONENTS.map(|n| Factor { of, shape: Power, at: [held, n] }));
        }
    }
    found
}

/// Functions at rows.
pub fn values(rows: &Rows<'_>, functions: &[Factor]) -> Vec<Vec<f64>> {
    let of = |Factor { of, shape, at: [w, c] }: &Factor| {
        rows.motions[*of as usize].iter().map(|x| shape.at(*x, *w, *c)).collect()
    };
    functions.iter().map(of).collect()
}

/// Functions with their values at rows.
pub type Tried<'a> = (&'a [Factor], &'a [Vec<f64>]);

/// Each power with each function, and alone; what best of every kind is.
pub fn scan(rows: &Rows<'_>, powers: &[Powers], tried: Tried<'_>, watch: &Watch<'_>) -> Vec<Seen> {
    let mut found: Vec<Seen> = watch
        .each(powers, |powers| {
            let plain = counted(rows, &powers.over(&rows.motions));
            let mut best: Vec<Seen> = Vec::new();
            let alone = Term { powers: *powers, factors: Vec::new() };
            let own = rows.own_square(&plain);
            let gain = taken(dot(&plain, &plain), own, dot(&plain, &rows.residual));
            best.extend(gain.map(|gain| Seen { term: alone.clone(), gain }));
            keep_best(rows, &alone, &plain, tried, &mut best);
            best
        })
        .into_iter()
        .flatten()
        .collect();
    found.sort_by_cached_key(|one| descending(one.gain));
    found
}

/// A law with each function more, of every kind the best.
pub fn widened(rows: &Rows<'_>, term: &Term, tried: Tried<'_>) -> Vec<Seen> {
    let mut best = Vec::new();
    if term.sine().is_none() {
        let plain = counted(rows, &term.columns(&rows.motions).remove(0));
        keep_best(rows, term, &plain, tried, &mut best);
        return best;
    }
    let [sine, cosine] = &term.columns(&rows.motions)[..] else { return best };
    for (factor, values) in tried.0.iter().zip(tried.1).filter(|(factor, _)| !term.says_already(factor)) {
        let times = |column: &Vec<f64>| rows.counted(&multiplied(column, values));
        if let Some((gain, ..)) = rows.explained(&[times(sine), times(cosine)]) {
            let mut wider = term.clone();
            wider.factors.insert(wider.factors.len() - 1, *factor);
            put(&mut best, Seen { term: wider, gain });
        }
    }
    best
}

fn counted(rows: &Rows<'_>, column: &[f64]) -> Vec<f64> {
    multiplied(column, &rows.scale)
}

/// What a column (counted, not off the base) takes off, by its square, what of that is beside the base, and its product with
/// the residual.
fn taken(square: f64, own: f64, along: f64) -> Option<f64> {
    (own > 1e-6 * square && own.is_finite()).then(|| along.powi(2) / own)
}

fn keep_best(
    rows: &Rows<'_>,
    term: &Term,
    plain: &[f64],
    (functions, values): Tried<'_>,
    best: &mut Vec<Seen>,
) {
    // The products of a product with others are those of one factor with the others' products.
    let beside = rows.base.iter().chain([&rows.residual]).map(|column| multiplied(column, plain));
    let beside: Vec<Vec<f64>> = beside.collect();
    let along = products(&slices(&beside), &slices(values));
    let mut product = vec![0.0; plain.len()];
    let new = |(_, factor): &(usize, &Factor)| !term.says_already(factor);
    for (at, factor) in functions.iter().enumerate().filter(new) {
        product.iter_mut().zip(plain).zip(&values[at]).for_each(|((x, a), b)| *x = a * b);
        let (square, along) = (dot(&product, &product), along.column(at));
        let within = along.rows(0, rows.base.len()).norm_squared();
        if let Some(gain) = taken(square, square - within, along[rows.base.len()]) {
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

/// Sines over a variable times each of some laws without one, at the frequencies that stand out and the slowest.
pub fn sines(rows: &Rows<'_>, terms: &[Term], of: Variable, reach: &Reach) -> Vec<Seen> {
    let weights: Vec<Vec<f64>> =
        terms.iter().map(|term| counted(rows, &term.columns(&rows.motions).remove(0))).collect();
    let loaded: Vec<Vec<f64>> = weights.iter().map(|column| multiplied(column, &rows.residual)).collect();
    let (step, powers) = spectra(rows, &loaded, of, reach);
    let slow = SLOWEST.map(|k| [f64::sin, f64::cos].map(|wave| over(rows, of, |x| wave(x * step * k))));
    let mut found = Vec::new();
    for ((powers, weight), term) in powers.iter().zip(&weights).zip(terms) {
        let mut peaks: Vec<usize> = (1..powers.len().saturating_sub(1))
            .filter(|&k| powers[k] >= powers[k - 1] && powers[k] > powers[k + 1] && powers[k].is_finite())
            .collect();
        peaks.sort_by_cached_key(|at| descending(powers[*at]));
        peaks.truncate(PEAKS);
        let half = 0.5 * dot(weight, weight);
        let sine = |k: f64| {
            let mut factors = term.factors.clone();
            factors.push(Factor { of, shape: Shape::Sine, at: [1.0 / (step * k), 0.0] });
            Term { powers: term.powers, factors }
        };
        found.extend(peaks.iter().map(|&k| Seen { term: sine(k as f64), gain: powers[k] / half }));
        // The slowest waves are no peak: the parameters of the model take most of them, and of none the half.
        for (k, waves) in SLOWEST.iter().zip(&slow) {
            if let Some(gain) = explained(rows, weight, waves) {
                put(&mut found, Seen { term: sine(*k), gain });
            }
        }
    }
    found
}

/// Waves of a whole number a turn, times each of some laws without one.
pub fn turning(rows: &Rows<'_>, terms: &[Term]) -> Vec<Seen> {
    let wave = |order: u32, wave: fn(f64) -> f64| over(rows, Variable::Theta, |x| wave(f64::from(order) * x));
    let waves: Vec<_> =
        (1..=ORDERS).map(|order| (order, [f64::sin, f64::cos].map(|of| wave(order, of)))).collect();
    let mut found = Vec::new();
    for term in terms {
        let weight = counted(rows, &term.columns(&rows.motions).remove(0));
        for (order, waves) in &waves {
            let mut factors = term.factors.clone();
            let at = [1.0 / f64::from(*order), 0.0];
            factors.push(Factor { of: Variable::Theta, shape: Shape::Turning, at });
            if let Some(gain) = explained(rows, &weight, waves) {
                put(&mut found, Seen { term: Term { powers: term.powers, factors }, gain });
            }
        }
    }
    found
}

fn over(rows: &Rows<'_>, of: Variable, wave: impl Fn(f64) -> f64) -> Vec<f64> {
    rows.motions[of as usize].iter().map(|x| wave(*x)).collect()
}

/// What sine and cosine times a column that is counted take off.
fn explained(rows: &Rows<'_>, weight: &[f64], waves: &[Vec<f64>; 2]) -> Option<f64> {
    let columns = waves.each_ref().map(|wave| rows.beside(multiplied(weight, wave)));
    Some(rows.explained(&columns)?.0)
}

/// The step of frequency, and the squared product of each column with waves over a variable at each, by a Fourier transform:
/// over time rows lie on a grid, over another variable in one so fine that it does not matter where in a cell.
fn spectra(rows: &Rows<'_>, loaded: &[Vec<f64>], of: Variable, reach: &Reach) -> (f64, Vec<Vec<f64>>) {
    let x = &rows.motions[of as usize];
    let timed = of == Variable::Time;
    let [low, high] = reach.ranges[of as usize];
    let (low, apart, cells) = if timed {
        let apart =
            x.windows(2).map(|pair| pair[1] - pair[0]).filter(|dt| *dt > 0.0).fold(f64::INFINITY, f64::min);
        let last = x.iter().copied().fold(0.0, f64::max);
        (0.0, apart, ((last / apart).round() as usize + 1).min(LONGEST))
    } else {
        (low, (high - low).max(f64::MIN_POSITIVE) / (CELLS - 1) as f64, CELLS)
    };
    let transform = Transform::of((OVERSAMPLING as usize * cells).next_power_of_two());
    let mut places = transform.rows(1);
    let length = 2 * places[0].len();
    let bins = if timed { length / 2 } else { MOST };
    let powers = loaded
        .iter()
        .map(|column| {
            places.iter_mut().for_each(|half| half.fill(0.0));
            for (loaded, x) in column.iter().zip(x) {
                let at = ((x - low) / apart).round() as usize;
                if let Some(place) = places[at % 2].get_mut(at / 2) {
                    *place += loaded;
                }
            }
            let [re, im] = transform.forward(1, &mut places, 0..bins);
            re.iter().zip(&im).map(|(re, im)| re * re + im * im).collect()
        })
        .collect();
    (TAU / (apart * length as f64), powers)
}
