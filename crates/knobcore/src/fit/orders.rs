//! Orders of a ripple: whole numbers of waves per revolution, chosen one after the other by what they explain.
//!
//! Forward selection by least squares (Miller 1990): after each choice all others are judged beside it, so that the
//! skirts of a strong wave are not taken for waves. All it needs are the products of the columns with e^(i n theta).

use super::layout::Layout;
use super::moments::evaluate;
use super::scan::{range, scan};
use crate::effects::{Id, Wave};
use crate::fourier::Transform;
use crate::model::{Model, Role};
use crate::order::{descending, nth};
use crate::param::Axis;
use crate::predict::Seeds;
use crate::signals::Signals;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::{LN_2, TAU};

/// Highest order that is looked for: on any motion, and on one that is slow enough for its waves to pass the torque's
/// filter. A harmonic drive makes two waves per turn of its motor, up to 400 of its joint.
const HIGHEST: [usize; 2] = [100, 400];
/// Orders around one by whose median it is judged, so that noise that is louder at some makes none.
const AROUND: usize = 100;
/// Places of a revolution that are told apart: half of one is 0.08 rad of the highest order.
const PLACES: usize = 1 << 14;
/// Most waves of one ripple.
pub const MOST: usize = 9;
/// Revolutions that a motion must cover for neighbouring orders to be told apart: over so many two of them are alike
/// by sin(pi x)/(pi x), here 0.37. A motor that was turned about once covers less of it where its log is cut.
const TURNS: f64 = 0.7;
/// Chance of an order where there is none.
const CHANCE: f64 = 1e-3;
/// Samples that are looked at; of more, every second or third.
const ENOUGH: usize = 60_000;
/// The strongest wave of a linear axis may be one of so many per pitch.
const PER_PITCH: [usize; 5] = [6, 4, 3, 2, 1];
/// A detent is a whole order up to this share of what neighbouring orders differ by within the motion.
const WHOLE: f64 = 0.25;
/// A column of which less than this share is its own is one of the others.
const OWN: f64 = 1e-8;

/// Amplitude, period over 2 pi and phase of the waves beside `model`, strongest first; none on a motion that covers
/// too little to tell orders apart.
pub fn waves(data: &[&Signals], model: &Model) -> Vec<[f64; 3]> {
    let linear = Layout::of(model).linear();
    let Some(pitch) = pitch(data, model, &linear) else { return Vec::new() };
    let mut products = Products::of(data, model, &linear, pitch);
    for column in 0..linear.len() {
        products.sweep(column);
    }
    let mut waves = Vec::new();
    while let Some((order, [sin, cos])) = products.best().filter(|_| waves.len() <= MOST) {
        products.sweep(products.sine(order));
        products.sweep(products.sine(order) + 1);
        waves.push([sin.hypot(cos), pitch / order as f64, cos.atan2(sin)]);
    }
    waves
}

/// What a ripple may stand beside: the model; where its detents are a whole order themselves, the model without them
/// too (fixed, and silent), and with detents looked for anew beside that order. Along an axis detents are ripple.
pub fn beside(data: &[&Signals], model: &Model) -> Vec<Model> {
    let Some(period) = model.period().map(|at| model.slots()[at].value) else { return vec![model.clone()] };
    let mut bare = model.clone();
    let own: Vec<String> =
        model.slots().iter().filter(|slot| slot.effect == Id::Detent).map(|slot| slot.name()).collect();
    for name in own {
        // They are its own names; the amplitude is what is silent at nought.
        let _ = bare.set_role(&name, Role::Fixed);
    }
    let _ = bare.set("detent.A", 0.0);
    if model.axis == Axis::Linear {
        return vec![bare];
    }
    let order = (1.0 / period).round();
    let turns = range(data) / TAU;
    if (order - 1.0 / period).abs() * turns >= WHOLE || turns < TURNS {
        return vec![model.clone()];
    }
    let moved = elsewhere(data, model, order);
    [Some(model.clone()), Some(bare), moved].into_iter().flatten().collect()
}

/// The model with its detents where a scan beside a wave of this order finds the strongest that are none.
fn elsewhere(data: &[&Signals], model: &Model, order: f64) -> Option<Model> {
    let others: Vec<Id> = model.effects().filter(|id| *id != Id::Detent).collect();
    let mut with = model.only(&others).ok()?.with(Id::Cogging).ok()?;
    with.set("cogging.n1", order).ok()?;
    with.set("cogging.a1", model.slots()[model.index("detent.A").ok()?].value).ok()?;
    with.settle();
    let linear = Layout::of(&with).linear();
    let (scan, _) = scan(data, &with, &with.values(), &linear, Wave::Torque)?;
    let peak = scan.peaks().into_iter().next()?;
    let mut moved = model.clone();
    for (name, value) in [("detent.P", peak.period), ("detent.A", peak.amplitude), ("detent.S", peak.phase)] {
        moved.set(name, value).ok()?;
    }
    Some(moved)
}

/// Revolution or pitch over 2 pi, if the motion covers one.
fn pitch(data: &[&Signals], model: &Model, linear: &[usize]) -> Option<f64> {
    let turns = range(data) / TAU;
    match model.axis {
        Axis::Rotary => (turns >= TURNS).then_some(1.0),
        Axis::Linear => {
            let (scan, _) = scan(data, model, &model.values(), linear, Wave::Torque)?;
            let strongest = scan.peaks().first()?.period;
            let times = PER_PITCH.into_iter().map(|times| times as f64 * strongest);
            times.into_iter().find(|pitch| turns >= TURNS * pitch)
        }
    }
}

/// The highest order whose waves pass the torque's filter at half of the speeds.
fn highest(data: &[&Signals], pitch: f64) -> usize {
    let of = |signals: &&Signals| {
        let pairs = signals.omega.iter().zip(&signals.weight);
        let mut speeds: Vec<f64> = pairs.filter(|(_, w)| **w > 0.0).map(|(omega, _)| omega.abs()).collect();
        let at = speeds.len() / 2;
        let middle = nth(&mut speeds, at).unwrap_or(0.0);
        TAU * signals.passes_hz() * pitch / middle
    };
    let [usual, most] = HIGHEST;
    (data.iter().map(of).fold(f64::INFINITY, f64::min) as usize).clamp(usual, most)
}

/// Products of columns, sine and cosine of every order, and the residual, with each other.
struct Products {
    linear: usize,
    highest: usize,
    gram: DMatrix<f64>,
    slope: DVector<f64>,
    /// Squared length of each column before anything was swept out.
    length: DVector<f64>,
}

impl Products {
    fn of(data: &[&Signals], model: &Model, linear: &[usize], pitch: f64) -> Self {
        let k = linear.len();
        let highest = highest(data, pitch);
        let stride = 1 + data.iter().map(|signals| signals.used()).sum::<usize>() / ENOUGH;
        // Sums by place of each column, the residual and the weights.
        let mut sums = vec![vec![0.0; PLACES]; k + 2];
        let mut plain = DMatrix::zeros(k + 1, k + 1);
        evaluate(data, model, &model.values(), &Seeds::of(model, linear), |evaluated| {
            let core = evaluated.rows.clone();
            let theta = &evaluated.signals.theta[core.clone()];
            let weight = &evaluated.signals.weight[core];
            for row in (0..theta.len()).step_by(stride).filter(|row| weight[*row] > 0.0) {
                let place = (theta[row] / (TAU * pitch)).rem_euclid(1.0) * PLACES as f64;
                let place = place.round() as usize % PLACES;
                sums[k + 1][place] += weight[row];
                for (sums, column) in sums.iter_mut().zip(evaluated.columns) {
                    sums[place] += column[row];
                }
                for (i, a) in evaluated.columns.iter().enumerate() {
                    for (j, b) in evaluated.columns.iter().enumerate() {
                        plain[(i, j)] += a[row] * b[row];
                    }
                }
            }
        });
        let mut spectra: Vec<Vec<Complex64>> = sums.iter().map(|sums| spectrum(sums, 2 * highest)).collect();
        let weights = spectra.pop().unwrap_or_default();
        // sin a sin b, cos a cos b and sin a cos b by the sum and the difference of the orders.
        let product = |(i, m): (usize, usize), (j, n): (usize, usize)| {
            let (sum, apart) = (weights[m + n], weights[m.abs_diff(n)]);
            match (i, j) {
                (0, 0) => 0.5 * (apart.re - sum.re),
                (1, 1) => 0.5 * (apart.re + sum.re),
                (0, 1) => 0.5 * (sum.im + if m >= n { apart.im } else { -apart.im }),
                _ => 0.5 * (sum.im + if n >= m { apart.im } else { -apart.im }),
            }
        };
        let part = |column: usize| ((column - k) % 2, 1 + (column - k) / 2);
        let with = |i: usize, column: usize| {
            let (side, order) = part(column);
            if side == 0 { spectra[i][order].im } else { spectra[i][order].re }
        };
        let side = k + 2 * highest;
        let gram = DMatrix::from_fn(side, side, |i, j| match (i < k, j < k) {
            (true, true) => plain[(i, j)],
            (true, false) => with(i, j),
            (false, true) => with(j, i),
            (false, false) => product(part(i), part(j)),
        });
        let slope = DVector::from_fn(side, |i, _| if i < k { plain[(i, k)] } else { with(k, i) });
        Self { linear: k, highest, length: gram.diagonal(), gram, slope }
    }

    /// The column of the sine of an order; its cosine is the next.
    fn sine(&self, order: usize) -> usize {
        self.linear + 2 * (order - 1)
    }

    /// Projects a column off all others (a step of Gauss's elimination); what is a combination of those before it is
    /// left alone.
    fn sweep(&mut self, column: usize) {
        let own = self.gram[(column, column)];
        if own <= OWN * self.length[column] {
            return;
        }
        let row = self.gram.column(column).clone_owned();
        self.slope.axpy(-self.slope[column] / own, &row, 1.0);
        self.gram.ger(-1.0 / own, &row, &row, 1.0);
    }

    /// The order that explains most, if chance does not: its sine and cosine, N m.
    ///
    /// The gains of orders that are not there are exponential; the median over those around tells their scale.
    fn best(&self) -> Option<(usize, [f64; 2])> {
        let gains: Vec<(f64, usize, [f64; 2])> = (1..=self.highest)
            .filter_map(|order| {
                let at = self.sine(order);
                let block = self.gram.fixed_view::<2, 2>(at, at).clone_owned();
                let slope = self.slope.fixed_rows::<2>(at).clone_owned();
                let own = |i: usize| block[(i, i)] > OWN * self.length[at + i];
                let wave = block.try_inverse().filter(|_| own(0) && own(1))? * slope;
                Some((wave.dot(&slope), order, [wave[0], wave[1]]))
            })
            .collect();
        let likely = (gains.len() as f64 / CHANCE).ln();
        let stands_out = |at: usize| {
            let from = at.saturating_sub(AROUND / 2).min(gains.len().saturating_sub(AROUND));
            let mut around: Vec<f64> = gains[from..].iter().take(AROUND).map(|(gain, ..)| *gain).collect();
            let middle = around.len() / 2;
            let median = *around.select_nth_unstable_by(middle, f64::total_cmp).1;
            gains[at].0 > median / LN_2 * likely
        };
        let mut by_gain: Vec<usize> = (0..gains.len()).collect();
        by_gain.sort_by_cached_key(|at| descending(gains[*at].0));
        let (_, order, wave) = by_gain.into_iter().find(|at| stands_out(*at)).map(|at| gains[at])?;
        Some((order, wave))
    }
}

/// Sums over places times e^(i n theta), for n from nought to `highest`.
fn spectrum(sums: &[f64], highest: usize) -> Vec<Complex64> {
    let transform = Transform::of(sums.len());
    let mut pairs = transform.rows(1);
    sums.iter().enumerate().for_each(|(at, x)| pairs[at % 2][at / 2] = *x);
    let [re, im] = transform.forward(1, &mut pairs, 0..highest + 1);
    re.into_iter().zip(im).map(|(re, im)| Complex64::new(re, -im)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::tests::turned;

    #[test]
    fn the_waves_of_a_ripple_are_found_strongest_first_and_no_others() {
        let put = [(40, 3e-3, 2.0), (3, 2e-3, -1.0), (7, 1e-3, 0.4)];
        let ripple = |theta: f64| -> f64 {
            put.iter().map(|(order, size, phase)| size * (f64::from(*order) * theta + phase).sin()).sum()
        };
        let data = turned(4.0, 5e-4, |theta, _| ripple(theta));
        let found = waves(&[&data], &Model::equation_1(Axis::Rotary, false));
        assert_eq!(found.len(), put.len(), "{found:?}");
        for ([size, period, phase], (order, own, at)) in found.iter().zip(put) {
            assert!((period * f64::from(order) - 1.0).abs() < 1e-9, "{found:?}");
            assert!((size / own - 1.0).abs() < 0.1 && (phase - at).abs() < 0.1, "{found:?}");
        }
    }

    #[test]
    fn a_slow_motion_shows_the_waves_of_a_gear_and_noise_shows_none() {
        let gear = |theta: f64| 2e-3 * (202.0 * theta + 0.5).sin() + 1e-3 * (101.0 * theta).sin();
        let found =
            waves(&[&turned(4.0, 5e-4, |theta, _| gear(theta))], &Model::equation_1(Axis::Rotary, false));
        let orders: Vec<f64> = found.iter().map(|[_, period, _]| (1.0 / period).round()).collect();
        assert_eq!(orders, [202.0, 101.0], "{found:?}");
        assert!((found[0][0] / 2e-3 - 1.0).abs() < 0.1 && (found[0][2] - 0.5).abs() < 0.1);
        let model = Model::equation_1(Axis::Rotary, false);
        assert!(waves(&[&turned(4.0, 5e-4, |_, _| 0.0)], &model).is_empty());
    }

    #[test]
    fn within_less_than_a_turn_no_orders_are_told_apart() {
        let data = turned(1.0, 1e-4, |theta, _| 3e-3 * (7.0 * theta).sin());
        assert!(waves(&[&data], &Model::equation_1(Axis::Rotary, false)).is_empty());
    }

    #[test]
    fn beside_detents_that_are_an_order_stand_those_that_are_none() {
        let data =
            turned(4.0, 1e-4, |theta, _| 4e-3 * (12.0 * theta).sin() + 2e-3 * (17.4 * theta + 0.3).sin());
        let mut model = Model::equation_1(Axis::Rotary, true);
        for (name, value) in [("detent.A", 4e-3), ("detent.P", 1.0 / 12.0), ("detent.S", 0.0)] {
            model.set(name, value).unwrap();
        }
        let value = |model: &Model, name: &str| model.values()[model.index(name).unwrap()];
        let [same, bare, moved] = &beside(&[&data], &model)[..] else { panic!("three") };
        assert_eq!(same.values(), model.values());
        assert_eq!(value(bare, "detent.A"), 0.0);
        assert!(bare.slots().iter().all(|slot| slot.effect != Id::Detent || slot.role == Role::Fixed));
        assert!((value(moved, "detent.P") * 17.4 - 1.0).abs() < 2e-3, "{}", value(moved, "detent.P"));
        assert!((value(moved, "detent.A") / 2e-3 - 1.0).abs() < 0.1);
        model.set("detent.P", 1.0 / 12.4).unwrap();
        assert_eq!(beside(&[&data], &model).len(), 1);
    }

    #[test]
    fn along_an_axis_the_strongest_wave_may_be_one_of_six_per_pitch() {
        let wave = |x: f64| 4e-3 * (60.0 * x).sin() + 2e-3 * (10.0 * x + 0.5).sin();
        let data = turned(0.9, 1e-4, |x, _| wave(x));
        let found = waves(&[&data], &Model::equation_1(Axis::Linear, false));
        let periods: Vec<f64> = found.iter().map(|[_, period, _]| (1.0 / period).round()).collect();
        assert_eq!(periods, [60.0, 10.0], "{found:?}");
    }
}
