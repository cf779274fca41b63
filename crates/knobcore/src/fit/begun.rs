//! How a knob is when a capture begins.
//!
//! No log says how far a joint is wound up when it begins, nor how fast: a soft one that turned already rings for tenths of a
//! second if it is followed from nothing. Two numbers for each passage, told by its first torques: least squares from a
//! knob that goes along with the shaft, wound up by what loads it, or from where it stood. Nor does a log say which way
//! the knob went before: friction that builds up may have done so already, one way or the other.

use super::hidden::loads;
use super::moments::Moments;
use super::solve::least_squares;
use crate::chain::Begins;
use crate::effects::Joint;
use crate::model::Model;
use crate::predict::{self, Columns, Seeds};
use crate::rule::rule;
use crate::signals::{Chunk, Signals};
use core::ops::Range;

/// What is looked at after a beginning, s: few joints ring for longer.
const LOOKED_AT_S: f64 = 0.5;
/// Steps to the least squares, and halves of one that fails.
const STEPS: usize = 6;
const HALVES: usize = 4;

/// A capture whose knob begins as its first torques say, by a model that leaves `rms`, N m; None where they do not say
/// better than it has it already, and of a model of which nothing depends on it.
pub fn begun(signals: &Signals, model: &Model, rms: f64) -> Option<Signals> {
    let values = model.values();
    let p = model.of_run(&signals.run, &values);
    let inertia = model.inertia().map_or(0.0, |at| p[at]);
    let wound = model.joint(&p).and_then(|joint| Some((joint, units(&joint, inertia, rms)?)));
    let builds_up = model.builds_up_over().is_some();
    if rms.is_nan() || rms <= 0.0 || wound.is_none() && !builds_up {
        return None;
    }
    // Each number has to pay, of what is left and passes the filter.
    let price = rule().price * rms.powi(2) * 0.5 * signals.rate_hz / signals.passes_hz();
    let mut found = signals.clone();
    for passage in signals.passages() {
        let mut first = First::of(&mut found, model, passage.clone());
        let own = first.signals.follow(passage.start).begins;
        let mut best = (own, first.squares(own));
        if builds_up {
            for bent in [-1.0, 0.0, 1.0].into_iter().filter(|bent| *bent != own.bent) {
                let begins = Begins { bent, ..best.0 };
                best = better(best, (begins, first.squares(begins)), price);
            }
        }
        if let Some((joint, units)) = wound {
            let along = first.along(&joint, (1.0 - joint.share) * inertia, best.0.bent);
            let [from_own, from_along] = [best.0, along].map(|start| first.descended(start, units));
            best = better(best, if from_along.1 < from_own.1 { from_along } else { from_own }, 2.0 * price);
        }
        first.begin(best.0);
    }
    (found.begins != signals.begins).then_some(found)
}

/// The second where it leaves less by more than so much.
fn better(one: (Begins, f64), other: (Begins, f64), price: f64) -> (Begins, f64) {
    if one.1 - other.1 > price { other } else { one }
}

/// By how much and how fast what is left winds a joint up; None where that is no number.
fn units(joint: &Joint<f64>, inertia: f64, rms: f64) -> Option<[f64; 2]> {
    let rings = (joint.stiffness / (joint.share * inertia)).sqrt();
    let units = [rms / joint.stiffness, rms / joint.stiffness * rings];
    units.iter().all(|unit| unit.is_finite() && *unit > 0.0).then_some(units)
}

/// The first rows of a passage, and what a model leaves of them.
struct First<'a> {
    signals: &'a mut Signals,
    model: &'a Model,
    /// Those that are looked at, and those that the filter needs.
    chunk: Chunk,
    columns: Columns,
}

impl<'a> First<'a> {
    fn of(signals: &'a mut Signals, model: &'a Model, passage: Range<usize>) -> Self {
        let halo = signals.filter.as_ref().map_or(0, |filter| filter.sos().settle());
        let rows = |more: usize| {
            passage.start..(passage.start + (LOOKED_AT_S * signals.rate_hz) as usize + more).min(passage.end)
        };
        let chunk = Chunk { whole: rows(halo), core: rows(0) };
        Self { signals, model, chunk, columns: Columns::default() }
    }

    /// Lets the knob begin so.
    fn begin(&mut self, begins: Begins) {
        let start = self.chunk.whole.start;
        self.signals.begins.retain(|(at, _)| *at != start);
        if begins != Begins::default() {
            self.signals.begins.push((start, begins));
            self.signals.begins.sort_by_key(|(at, _)| *at);
        }
    }

    /// What is left of the rows that count, with a knob that begins so.
    fn left(&mut self, begins: Begins) -> Vec<f64> {
        self.begin(begins);
        let seeds = Seeds::none(self.model);
        let (signals, chunk) = (&*self.signals, &self.chunk);
        predict::measured(self.model, &self.model.values(), &seeds, signals, chunk, &mut self.columns);
        let (torque, _) = self.columns.split();
        let left = |at: usize| {
            let counts = signals.weight[at] > 0.0;
            if counts { signals.tau[at] - torque[at - chunk.whole.start] } else { 0.0 }
        };
        chunk.core.clone().map(left).collect()
    }

    fn squares(&mut self, begins: Begins) -> f64 {
        self.left(begins).iter().map(|left| left * left).sum()
    }

    /// A knob that goes along with the shaft: what it asks for winds the joint up.
    fn along(&self, joint: &Joint<f64>, shafts: f64, bent: f64) -> Begins {
        let (signals, start) = (&*self.signals, self.chunk.whole.start);
        let rigid = loads(self.model);
        let mut columns = Columns::default();
        let (rows, seeds) = (start..start + 1, Seeds::none(&rigid));
        predict::raw(&rigid, &rigid.values(), &seeds, signals, rows, &mut columns);
        let torque = columns.split().0[0] - shafts * signals.alpha[start];
        let ahead = torque / joint.stiffness + 0.5 * joint.gap * torque.signum();
        Begins { ahead, faster: 0.0, bent }
    }

    /// Where least squares lead from there, and what they are.
    fn descended(&mut self, start: Begins, units: [f64; 2]) -> (Begins, f64) {
        let mut here = start;
        let mut left = self.left(here);
        let sum = |left: &[f64]| left.iter().map(|left| left * left).sum::<f64>();
        for _ in 0..STEPS {
            let slopes = [0, 1].map(|which| {
                let by = [0, 1].map(|one| if one == which { units[which] } else { 0.0 });
                let then = self.left(further(here, by));
                left.iter().zip(then).map(|(left, then)| left - then).collect::<Vec<f64>>()
            });
            let mut moments = Moments::empty(2);
            moments.add_columns(&[&slopes[0], &slopes[1], &left]);
            let Some(step) = least_squares(&moments, &[0, 1]) else { break };
            let tried = (0..HALVES).find_map(|halves| {
                let share = 0.5_f64.powi(halves as i32);
                let there = further(here, [0, 1].map(|which| share * step[which] * units[which]));
                let then = self.left(there);
                (sum(&then) < sum(&left)).then_some((there, then))
            });
            let Some((there, then)) = tried else { break };
            let done = sum(&left) - sum(&then) < 1e-3 * sum(&then);
            (here, left) = (there, then);
            if done {
                break;
            }
        }
        (here, sum(&left))
    }
}

fn further(from: Begins, [ahead, faster]: [f64; 2]) -> Begins {
    Begins { ahead: from.ahead + ahead, faster: from.faster + faster, ..from }
}

#[cfg(test)]
mod tests {
    use super::super::tests::turned;
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    /// A knob that is swung behind a joint, and its torque where it begins so far and so fast behind the shaft.
    fn swung(joint: Id, begins: [f64; 2]) -> (Signals, Model) {
        let mut model = Model::equation_1(Axis::Rotary, false).with(joint).unwrap();
        for (name, value) in [("inertia.M", 1e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.02)] {
            model.set(name, value).unwrap();
        }
        let id = joint.info().id;
        for (name, value) in [("k", 20.0), ("d", 2e-3), ("share", 0.7), ("gap", 0.02)] {
            if joint == Id::Backlash || name != "gap" {
                model.set(&format!("{id}.{name}"), value).unwrap();
            }
        }
        let mut swing = turned(1.0, 0.0, |_, _| 0.0);
        for at in 0..swing.len() {
            let (sin, cos) = (5.0 * swing.t[at]).sin_cos();
            (swing.theta[at], swing.omega[at], swing.alpha[at]) = (sin, 5.0 * cos, -25.0 * sin);
        }
        let [ahead, faster] = begins;
        swing.begins = vec![(0, Begins { ahead, faster, bent: 0.0 })];
        swing.tau = predict::torque(&model, &swing);
        swing.begins.clear();
        (swing, model)
    }

    #[test]
    fn where_a_soft_shaft_is_wound_up_to_and_how_fast_is_told_by_its_first_torques() {
        for begins in [[1e-3, 0.0], [-4e-4, 0.3], [2e-3, -0.1]] {
            let (swing, model) = swung(Id::Compliance, begins);
            let found = begun(&swing, &model, 1e-4).unwrap();
            let [(0, Begins { ahead, faster, .. })] = found.begins[..] else { panic!("{:?}", found.begins) };
            assert!(
                (ahead - begins[0]).abs() < 1e-7 && (faster - begins[1]).abs() < 1e-4,
                "{ahead} {faster}"
            );
            // What says nothing new says nothing.
            assert!(begun(&found, &model, 1e-4).is_none());
        }
    }

    #[test]
    fn a_knob_that_leans_on_a_side_of_its_play_is_found_there() {
        let (swing, model) = swung(Id::Backlash, [0.011, 0.0]);
        let found = begun(&swing, &model, 1e-4).unwrap();
        let left = |signals: &Signals| -> f64 {
            let torque = predict::torque(&model, signals);
            torque.iter().zip(&signals.tau).map(|(is, tau)| (is - tau).powi(2)).sum()
        };
        assert!(left(&found) < 1e-4 * left(&swing), "{} of {}", left(&found), left(&swing));
    }

    #[test]
    fn a_knob_that_begins_with_its_shaft_is_left_there_and_so_is_one_without_a_joint() {
        let (swing, model) = swung(Id::Compliance, [0.0; 2]);
        assert!(begun(&swing, &model, 1e-4).is_none());
        // Less than noise would tell is nothing.
        let (swing, model) = swung(Id::Compliance, [1e-6, 0.0]);
        assert!(begun(&swing, &model, 1e-3).is_none());
        assert!(begun(&swing, &loads(&model), 1e-4).is_none());
    }

    #[test]
    fn which_way_friction_has_built_up_is_told_by_the_first_torques_and_else_nothing_is_said() {
        let cases = [-1.0, 0.0, 1.0].into_iter().flat_map(|bent| [(bent, false), (bent, true)]);
        for (bent, behind) in cases {
            let (mut swing, joined) = swung(Id::Compliance, [0.0; 2]);
            let bare = if behind { joined } else { loads(&joined) };
            let mut model = bare.with(Id::Presliding).unwrap();
            for (name, value) in [("s", 0.2), ("w1", 0.5), ("w2", 0.4)] {
                model.set(&format!("presliding.{name}"), value).unwrap();
            }
            swing.begins = vec![(0, Begins { bent, ..Begins::default() })];
            swing.tau = predict::torque(&model, &swing);
            swing.begins.clear();
            let found = begun(&swing, &model, 1e-3);
            let told = found.as_ref().map(|found| found.begins[0].1.bent);
            assert_eq!(told, Some(bent).filter(|bent| *bent != 0.0));
            // It is over once the knob has turned as far.
            if let Some(found) = found {
                let torques = [&swing, &found].map(|signals| predict::torque(&model, signals));
                let apart = |at: usize| (torques[0][at] - torques[1][at]).abs();
                let most = |rows: std::ops::Range<usize>| rows.map(apart).fold(0.0, f64::max);
                let (first, last) = (most(0..100), most(2 * swing.len() / 3..swing.len()));
                assert!(first > 1e-2 && last < 1e-6, "{first} {last}");
            }
        }
    }
}
