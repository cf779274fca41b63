//! Which parameters of a model a descent moves, and how each enters.

use crate::model::{Model, Role};
use crate::param::Kind;
use crate::predict::Seeds;

/// Most that a positive parameter moves in one step, as a power of e.
const LONGEST: f64 = 1.0;

/// Which parameters move, and how each enters.
#[derive(Debug, Clone)]
pub struct Layout {
    /// The free parameters, as indices into the slots of the model; columns are in this order.
    pub free: Vec<usize>,
    /// Columns that are solved for in every step, and the others.
    pub linear: Vec<usize>,
    pub hard: Vec<usize>,
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
        keep_together(model, &mut next);
        next
    }

    /// Amplitudes that are zero show no phase: give them the scale `unit`.
    pub fn awake(&self, p: &mut [f64], unit: f64) {
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

/// Gives tied parameters the values of those that they are tied to, and shares of one thing no more than all of it.
pub fn keep_together(model: &Model, p: &mut [f64]) {
    let slots = model.slots();
    for (i, slot) in slots.iter().enumerate() {
        if let Role::Tied(to) = slot.role {
            p[i] = p[to];
        }
        let shares = if slot.base == i { slot.effect.info().shares } else { &[] };
        let is_free = |at: &usize| slots[i + at].role == Role::Free;
        let [free, kept] = [true, false]
            .map(|free| shares.iter().filter(|at| is_free(at) == free).map(|at| p[i + at]).sum::<f64>());
        let most = (1.0 - kept).max(0.0);
        if free > most {
            shares.iter().filter(|at| is_free(at)).for_each(|at| p[i + at] *= most / free);
        }
    }
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

    #[test]
    fn no_more_than_all_of_the_friction_builds_up_and_shares_that_are_held_stay() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Presliding).unwrap();
        model.set("presliding.w2", 0.25).unwrap();
        model.set_role("presliding.w2", Role::Fixed).unwrap();
        let [first, held, third] =
            ["presliding.w1", "presliding.w2", "presliding.w3"].map(|name| model.index(name).unwrap());
        for (set, kept) in [([0.2, 0.3], [0.2, 0.3]), ([0.5, 1.0], [0.25, 0.5])] {
            let mut p = model.values();
            (p[first], p[third]) = (set[0], set[1]);
            keep_together(&model, &mut p);
            assert_eq!([p[first], p[held], p[third]], [kept[0], 0.25, kept[1]]);
        }
    }
}
