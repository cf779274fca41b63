//! One trial of a descent: the pass at a set of parameters, what it leaves, and the steps that it promises something of.

use super::layout::Layout;
use super::moments::{Moments, residuals};
use super::passes::Passes;
use super::solve::{Normal, independent};
use crate::algebra::dot;
use crate::model::Model;
use crate::scalar::WIDE;
use crate::signals::Signals;

/// A sum of squares above this many times the measured one has no digit left for the measured torque.
const LOST: f64 = 1e12;

/// A trial: the pass at `p`, and its linear problem solved.
pub struct Point {
    pub p: Vec<f64>,
    pub moments: Moments,
    /// Step in the linear columns to their optimum at these hard parameters.
    linear_step: Vec<f64>,
    kept: Vec<usize>,
    normal: Option<Normal>,
    /// Sum of squares with the linear parameters at their best, (N m)^2.
    pub cost: f64,
}

/// What is to be solved.
pub struct Problem<'a> {
    pub data: &'a [&'a Signals],
    pub passes: Passes<'a>,
    pub model: &'a Model,
    pub layout: &'a Layout,
    /// Sum of squares of the measured torque.
    pub total: f64,
    /// The scale of an amplitude that shows no phase yet.
    pub unit: f64,
    /// Passes that were made.
    pub evaluations: usize,
}

/// How much steps are held back (Nielsen 1999).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// What is added to the curvature, as a share of it.
    pub damping: f64,
    /// How much more the next step is held back if this one fails.
    pub growth: f64,
}

impl Default for Held {
    fn default() -> Self {
        Self { damping: 0.0, growth: Self::GROWTH }
    }
}

impl Held {
    /// The growth after a step that did not fail.
    pub const GROWTH: f64 = 2.0;

    /// A step failed.
    pub fn back(&mut self) {
        self.damping = self.damping.max(1e-3) * self.growth;
        self.growth *= 2.0;
    }

    /// One did not, and the next is held back by so much of it.
    pub fn let_go(&mut self, share: f64) {
        self.damping *= share;
        if self.damping < 1e-9 {
            self.damping = 0.0;
        }
        self.growth = Self::GROWTH;
    }
}

impl Problem<'_> {
    /// The trial at `p`.
    pub fn point(&mut self, mut p: Vec<f64>) -> Point {
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

    /// The parameters of a trial, those that are linear at their best.
    pub fn solved(&self, point: &Point) -> Vec<f64> {
        self.layout.moved(self.model, &point.p, &point.linear_step)
    }

    /// The damped step from `point` in all columns, and the fall of the cost that it promises.
    pub fn step(&self, point: &Point, damping: f64) -> Option<(Vec<f64>, f64)> {
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

    /// The first trial that is lower of at most so many, each held back more than the one before, and what its step
    /// promised, where that is more than `least`; as if they were tried one after the other. None where none is.
    pub fn fan(&mut self, here: &Point, held: &mut Held, most: usize, least: f64) -> Option<(Point, f64)> {
        let (mut next, mut steps) = (*held, Vec::new());
        while steps.len() < most.min(WIDE)
            && let Some((step, predicted)) = self.step(here, next.damping)
            && predicted > least
        {
            steps.push((next, self.layout.moved(self.model, &here.p, &step), predicted));
            next.back();
        }
        let costs = self.costs(steps.iter().map(|(_, p, _)| p.clone()).collect());
        let lower = costs.iter().position(|cost| *cost < here.cost);
        self.evaluations += lower.unwrap_or(steps.len());
        let Some(lower) = lower else {
            *held = next;
            return None;
        };
        let (own, p, predicted) = steps.swap_remove(lower);
        *held = own;
        Some((self.point(p), predicted))
    }

    /// Sums of squares at several sets of parameters.
    fn costs(&self, sets: Vec<Vec<f64>>) -> Vec<f64> {
        let mut costs = vec![0.0; sets.len()];
        residuals(self.data, self.model, &sets, |evaluated| {
            costs.iter_mut().zip(evaluated.columns).for_each(|(cost, part)| *cost += dot(part, part));
        });
        costs
    }
}

#[cfg(test)]
mod tests {
    use super::super::moments::measured_squares;
    use super::super::tests::turned;
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;
    use crate::predict;
    use crate::random::Noise;

    #[test]
    fn steps_that_are_tried_at_once_lead_where_one_after_the_other_does() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        let values = [("inertia.M", 1e-4), ("coulomb.neg", 4e-3), ("coulomb.pos", 4e-3)];
        let joint = [("gap", 0.02), ("k", 20.0), ("d", 0.02), ("share", 0.6)];
        values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
        joint.iter().for_each(|(name, value)| model.set(&format!("backlash.{name}"), *value).unwrap());
        let mut signals = turned(0.3, 0.0, |_, _| 0.0);
        signals.tau = predict::torque_raw(&model, &signals);
        let data = [&signals];
        let (layout, total) = (Layout::of(&model), measured_squares(&data));
        let passes = Passes::of(&data, &model, &layout.free, true);
        let (model, layout) = (&model, &layout);
        let mut problem = Problem { data: &data, passes, model, layout, total, unit: 1.0, evaluations: 0 };
        let bottom = problem.point(model.values());
        let mut held = Held::default();
        assert!(problem.fan(&bottom, &mut held, 8, 1e-12 * total).is_none() && held == Held::default());
        let mut failed = 0;
        let mut noise = Noise::new(3);
        for _ in 0..12 {
            let mut p = model.values();
            layout.free.iter().for_each(|at| p[*at] *= noise.normal().exp());
            p[model.index("backlash.share").unwrap()] = 0.6;
            let mut off = problem.point(p);
            let costs = problem.costs(vec![off.p.clone(), bottom.p.clone()]);
            assert!((costs[0] / off.cost - 1.0).abs() < 1e-9 && costs[1] < 1e-20 * total, "{costs:?}");
            // One after the other, from where all but the best of them fail.
            let start = Held { damping: 1e-6, growth: 2.0 };
            let ladder: Vec<Held> = std::iter::successors(Some(start), |held| {
                let mut next = *held;
                next.back();
                Some(next)
            })
            .take(WIDE)
            .collect();
            let ends: Vec<Point> = ladder
                .iter()
                .map(|held| {
                    problem.point(layout.moved(model, &off.p, &problem.step(&off, held.damping).unwrap().0))
                })
                .collect();
            off.cost = (1.0 + 1e-9) * ends.iter().map(|end| end.cost).fold(f64::INFINITY, f64::min);
            let tried = ends.iter().position(|end| end.cost < off.cost).unwrap();
            let (mut held, before) = (start, problem.evaluations);
            let (there, _) = problem.fan(&off, &mut held, WIDE, f64::NEG_INFINITY).unwrap();
            assert_eq!((held, there.p, there.cost), (ladder[tried], ends[tried].p.clone(), ends[tried].cost));
            assert_eq!(problem.evaluations - before, tried + 1);
            failed += tried;
            // With less room than that there is none, and the next is held back as after all of them.
            let mut short = start;
            assert!(
                tried == 0
                    || problem.fan(&off, &mut short, tried, f64::NEG_INFINITY).is_none()
                        && short == ladder[tried]
            );
        }
        assert!(failed > 0);
    }
}
