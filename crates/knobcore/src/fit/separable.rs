//! Levenberg-Marquardt over the parameters that are hard, with the linear ones eliminated in every step.
//!
//! Source: Golub & Pereyra 1973 (variable projection), in Kaufman's 1975 form; damping by Nielsen 1999.
//! One pass per trial gives everything: with the products of all derivative columns and the residual, the
//! linear parameters are solved exactly, the cost is that of the solved problem, and the hard columns are
//! projected off the linear ones. An amplitude and its phase count as linear, in polar form.

use super::moments::{Moments, measured_squares};
use super::passes::Passes;
use super::solve::{Normal, independent};
use super::status::Status;
use crate::model::{Model, Role};
use crate::param::Kind;
use crate::predict::Seeds;
use crate::signals::Signals;

/// How far to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// To the optimum.
    Full,
    /// Until what is left to gain would not change which of several models is the better one, or a sum of squares of so
    /// much seems out of reach.
    Within(f64),
    /// A few steps: enough to tell which of many starts lead somewhere.
    Glance,
}

impl Effort {
    /// Trials before giving up.
    fn evaluations(self) -> usize {
        match self {
            Self::Full => 60,
            Self::Within(_) => 35,
            Self::Glance => 6,
        }
    }

    /// A step that gains less than this share of the sum of squares ends the search.
    fn least_gain(self) -> f64 {
        if self == Self::Full { 0.0 } else { 2e-4 }
    }

    /// Whether steps from a sum of squares, of which the next promises so much less, lead to what is too much.
    fn in_vain(self, cost: f64, promised: f64) -> bool {
        matches!(self, Self::Within(most) if cost - FAR * promised > most)
    }
}

/// Times what a step promises of a sum of squares that all the steps after it may take off.
const FAR: f64 = 4.0;
/// Steps after which what they promise is believed.
const BELIEVED: usize = 3;
/// A step that promises less than this share of the mean square error is taken and ends the fit: it moves no
/// parameter by more than a thirtieth of its standard error, and what is left after it is its square.
const PREDICTED: f64 = 1e-3;
/// With a joint, whose error is rough, so does one that promises or gains less than this: a tenth of a standard error.
const ROUGH: f64 = 1e-2;
/// The longest such last step, as a share of each hard parameter.
const UNSEEN: f64 = 1e-2;
/// A step below this share of every hard parameter ends the fit.
const STEP: f64 = 1e-12;
/// Linear parameters are close to their best where they leave at most this many times the least sum of squares.
const CLOSE: f64 = 1.5;
/// A sum of squares below this share of the measured one is rounding: eleven digits of the torque agree.
const EXACT: f64 = 1e-22;
/// A sum of squares above this many times the measured one has no digit left for the measured torque.
const LOST: f64 = 1e12;
/// Most that a positive parameter moves in one step, as a power of e.
const LONGEST: f64 = 1.0;

/// Which parameters move, and how each enters.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The free parameters, as indices into the slots of the model; columns are in this order.
    pub free: Vec<usize>,
    linear: Vec<usize>,
    hard: Vec<usize>,
    /// Columns of amplitude and phase.
    polar: Vec<(usize, usize)>,
}

impl Layout {
    /// Of a model.
    pub fn of(model: &Model) -> Self {
        let slots = model.slots();
        let free: Vec<usize> = model.free().collect();
        let tied_to = |i: usize| slots.iter().any(|slot| slot.role == Role::Tied(i));
        let (mut linear, mut hard, mut polar) = (Vec::new(), Vec::new(), Vec::new());
        for (column, &i) in free.iter().enumerate() {
            match model.kind(&slots[i]) {
                Kind::Linear => linear.push(column),
                Kind::Nonlinear => hard.push(column),
                Kind::PhaseOf(amplitude) => {
                    let amplitude = slots[i].base + amplitude;
                    match free.iter().position(|&f| f == amplitude) {
                        Some(partner) if !tied_to(i) && !tied_to(amplitude) => {
                            polar.push((partner, column));
                            linear.push(column);
                        }
                        _ => hard.push(column),
                    }
                }
            }
        }
        Self { free, linear, hard, polar }
    }

    /// The free parameters that are linear, as indices into the slots of the model.
    pub fn linear(&self) -> Vec<usize> {
        self.linear.iter().map(|&column| self.free[column]).collect()
    }

    /// Derivative columns for all free parameters.
    pub fn seeds(&self, model: &Model) -> Seeds {
        Seeds::of(model, &self.free)
    }

    /// All columns, those that are linear first: where columns depend on each other, the hard one is named.
    pub fn linear_first(&self) -> Vec<usize> {
        self.linear.iter().chain(&self.hard).copied().collect()
    }

    /// Whether all free parameters are linear, and none of them an angle.
    pub fn is_linear(&self) -> bool {
        self.hard.is_empty() && self.polar.is_empty()
    }

    /// `p` moved by `step` (a value per column), within the bounds of the hard parameters. Amplitudes and
    /// phases move as the vector that they are, so that a step in them is exact.
    pub fn moved(&self, model: &Model, p: &[f64], step: &[f64]) -> Vec<f64> {
        let slots = model.slots();
        let mut next = p.to_vec();
        for (column, &i) in self.free.iter().enumerate() {
            next[i] += step[column];
        }
        for &column in &self.hard {
            let (i, lower) = (self.free[column], slots[self.free[column]].param.lower);
            // What can only be positive moves by factors: the same step to first order, and never through zero.
            if lower > 0.0 {
                next[i] = p[i] * (step[column] / p[i]).clamp(-LONGEST, LONGEST).exp();
            }
            next[i] = next[i].clamp(lower, slots[i].param.upper);
            // Of a wave that is hardly there the phase may go anywhere.
            if matches!(slots[i].param.kind, Kind::PhaseOf(_)) {
                next[i] = wrap(next[i]);
            }
        }
        for &(amplitude, phase) in &self.polar {
            let (a, s) = (self.free[amplitude], self.free[phase]);
            let (along, across) = (p[a] + step[amplitude], p[a] * step[phase]);
            next[a] = along.hypot(across);
            next[s] = wrap(p[s] + across.atan2(along));
        }
        keep_ties(model, &mut next);
        next
    }

    /// Amplitudes that are zero show no phase: give them the scale `unit`.
    fn awake(&self, p: &mut [f64], unit: f64) {
        for &(amplitude, _) in &self.polar {
            let a = self.free[amplitude];
            if p[a] == 0.0 {
                p[a] = unit;
            }
        }
    }
}

/// An angle within (-pi, pi].
fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

fn keep_ties(model: &Model, p: &mut [f64]) {
    for (i, slot) in model.slots().iter().enumerate() {
        if let Role::Tied(to) = slot.role {
            p[i] = p[to];
        }
    }
}

/// A trial: the pass at `p`, and its linear problem solved.
struct Point {
    p: Vec<f64>,
    moments: Moments,
    /// Step in the linear columns to their optimum at these hard parameters.
    linear_step: Vec<f64>,
    kept: Vec<usize>,
    normal: Option<Normal>,
    cost: f64,
}

/// What the search for the best parameters ended with.
#[derive(Debug, Clone)]
pub struct Found {
    /// All parameters of the model.
    pub p: Vec<f64>,
    /// Sum of squares at `p`, (N m)^2.
    pub cost: f64,
    /// Accepted steps.
    pub iterations: usize,
    /// Passes over the data.
    pub evaluations: usize,
    /// Why it stopped.
    pub status: Status,
}

struct Problem<'a> {
    passes: Passes<'a>,
    model: &'a Model,
    layout: &'a Layout,
    /// Sum of squares of the measured torque.
    total: f64,
    unit: f64,
    evaluations: usize,
}

impl Problem<'_> {
    fn point(&mut self, mut p: Vec<f64>) -> Point {
        self.layout.awake(&mut p, self.unit);
        self.evaluations += 1;
        let moments = self.passes.moments(&p);
        let gram = |i: usize, j: usize| moments.gram(i, j);
        let kept = independent(gram, &self.layout.linear);
        let normal = Normal::of(gram, &kept);
        let mut linear_step = vec![0.0; moments.k];
        if let Some(normal) = &normal {
            for (&column, value) in kept.iter().zip(normal.solve(|i| moments.slope(kept[i]))) {
                linear_step[column] = value;
            }
        }
        let cost = moments.squares_after(&linear_step);
        // A hidden motion may run away: as bad as can be, and so no step to take.
        let told = cost.is_finite() && moments.squares() <= LOST * self.total;
        let cost = if told { cost.max(0.0) } else { f64::INFINITY };
        Point { p, moments, linear_step, kept, normal, cost }
    }

    fn solved(&self, point: &Point) -> Vec<f64> {
        self.layout.moved(self.model, &point.p, &point.linear_step)
    }

    /// The damped step from `point` in all columns, and the fall of the cost that it promises.
    fn step(&self, point: &Point, damping: f64) -> Option<(Vec<f64>, f64)> {
        let m = &point.moments;
        let normal = point.normal.as_ref()?;
        let slots = self.model.slots();
        let hard: Vec<usize> = {
            let order: Vec<usize> = point.kept.iter().chain(&self.layout.hard).copied().collect();
            independent(|i, j| m.gram(i, j), &order).split_off(point.kept.len())
        };
        // Each hard column written as its part along the linear ones and the rest.
        let along: Vec<Vec<f64>> = hard.iter().map(|&h| normal.solve(|i| m.gram(point.kept[i], h))).collect();
        let project = |column: &dyn Fn(usize) -> f64, h: usize| -> f64 {
            point.kept.iter().zip(&along[h]).map(|(&i, x)| x * column(i)).sum()
        };
        let slope: Vec<f64> =
            (0..hard.len()).map(|h| m.slope(hard[h]) - project(&|i| m.slope(i), h)).collect();
        let inside = |h: usize| {
            let i = self.layout.free[hard[h]];
            let (low, high) = (slots[i].param.lower, slots[i].param.upper);
            !(point.p[i] <= low && slope[h] < 0.0 || point.p[i] >= high && slope[h] > 0.0)
        };
        let active: Vec<usize> = (0..hard.len()).filter(|&h| inside(h)).collect();
        let curvature = |a: usize, b: usize| {
            let (a, b) = (active[a], active[b]);
            let own = m.gram(hard[a], hard[b]) - project(&|i| m.gram(i, hard[b]), a);
            if a == b { own * (1.0 + damping) } else { own }
        };
        let all: Vec<usize> = (0..active.len()).collect();
        let hard_step = Normal::of(curvature, &all)?.solve(|a| slope[active[a]]);
        let mut step = point.linear_step.clone();
        for (a, value) in active.iter().zip(&hard_step) {
            step[hard[*a]] = *value;
            for (&column, x) in point.kept.iter().zip(&along[*a]) {
                step[column] -= x * value;
            }
        }
        let predicted = point.cost - m.squares_after(&step);
        Some((step, predicted))
    }
}

/// The best parameters that a descent from `start` reaches.
pub fn descend(data: &[&Signals], model: &Model, layout: &Layout, start: &[f64], effort: Effort) -> Found {
    let total = measured_squares(data);
    let rows: f64 = data.iter().map(|s| s.used() as f64).sum();
    let unit = (total / rows.max(1.0)).sqrt().max(f64::MIN_POSITIVE);
    let passes = Passes::of(data, model, &layout.free, !layout.hard.is_empty());
    let mut problem = Problem { passes, model, layout, total, unit, evaluations: 0 };
    let mut start = start.to_vec();
    keep_ties(model, &mut start);
    let mut here = problem.point(start);
    let mut iterations = 0;
    let ended = |problem: &Problem<'_>, here: &Point, iterations, status| Found {
        p: problem.solved(here),
        cost: here.cost,
        iterations,
        evaluations: problem.evaluations,
        status,
    };
    if here.cost.is_infinite() {
        return ended(&problem, &here, 0, Status::Stalled);
    }
    if layout.free.is_empty() {
        return ended(&problem, &here, 0, Status::Fixed);
    }
    if layout.hard.is_empty() {
        return ended(&problem, &here, 1, Status::Linear);
    }
    // The hard columns depend on the linear parameters, which have just been found: unless the start was close,
    // look again.
    if here.moments.squares() > CLOSE * here.cost {
        here = problem.point(problem.solved(&here));
    }
    let (mut damping, mut growth) = (0.0_f64, 2.0);
    let least_gain = effort.least_gain().max(if model.is_coupled() { ROUGH / rows } else { 0.0 });
    loop {
        if here.cost <= EXACT * total {
            return ended(&problem, &here, iterations, Status::Exact);
        }
        if problem.evaluations >= effort.evaluations() {
            return ended(&problem, &here, iterations, Status::Limit);
        }
        let Some((step, predicted)) = problem.step(&here, damping) else {
            return ended(&problem, &here, iterations, Status::Converged);
        };
        if iterations >= BELIEVED && effort.in_vain(here.cost, predicted) {
            return ended(&problem, &here, iterations, Status::Limit);
        }
        let small =
            layout.hard.iter().all(|&h| step[h].abs() <= STEP * here.p[layout.free[h]].abs().max(STEP));
        if predicted <= (PREDICTED / rows).max(least_gain) * here.cost || small {
            if damping > 1e8 {
                return ended(&problem, &here, iterations, Status::Stalled);
            }
            // A parameter that hardly matters may take a long step for a small predicted gain: not unseen.
            let short = layout.hard.iter().all(|&h| step[h].abs() <= UNSEEN * here.p[layout.free[h]].abs());
            let found = ended(&problem, &here, iterations, Status::Converged);
            let p = layout.moved(model, &here.p, &step);
            return if short { Found { p, iterations: iterations + 1, ..found } } else { found };
        }
        let there = problem.point(layout.moved(model, &here.p, &step));
        let gain = (here.cost - there.cost) / predicted;
        if there.cost < here.cost {
            let fell = 1.0 - there.cost / here.cost;
            here = there;
            iterations += 1;
            if fell < least_gain {
                return ended(&problem, &here, iterations, Status::Converged);
            }
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            if damping < 1e-9 {
                damping = 0.0;
            }
            growth = 2.0;
        } else {
            damping = damping.max(1e-3) * growth;
            growth *= 2.0;
            if damping > 1e12 {
                return ended(&problem, &here, iterations, Status::Stalled);
            }
        }
    }
}

/// What a search found, if it is better than where a descent from the model's own values ends: behind a joint a scan may end
/// far from where a model that is given already is.
pub fn at_least_own(found: Option<Found>, data: &[&Signals], model: &Model, layout: &Layout) -> Found {
    let own = descend(data, model, layout, &model.values(), Effort::Full);
    found.filter(|found| found.cost < own.cost).unwrap_or(own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    #[test]
    fn a_phase_that_is_no_polar_one_stays_within_a_turn_however_long_the_step() {
        let model = Model::equation_1(Axis::Rotary, true).with(Id::Compliance).unwrap();
        let layout = Layout::of(&model);
        let phase = model.index("detent.S").unwrap();
        let column = layout.free.iter().position(|&i| i == phase).unwrap();
        assert!(layout.hard.contains(&column));
        for long in [0.5, 7.0, -1e17] {
            let mut step = vec![0.0; layout.free.len()];
            step[column] = long;
            let moved = layout.moved(&model, &model.values(), &step)[phase];
            assert!(moved.abs() <= std::f64::consts::PI, "{moved}");
            let all_round = (moved - model.values()[phase] - long).rem_euclid(std::f64::consts::TAU);
            assert!(long.abs() > 1e3 || all_round.min(std::f64::consts::TAU - all_round) < 1e-9, "{long}");
        }
    }
}
