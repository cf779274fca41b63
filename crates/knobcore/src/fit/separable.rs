//! Levenberg-Marquardt over the parameters that are hard, with the linear ones eliminated in every step.
//!
//! Source: Golub & Pereyra 1973 (variable projection), in Kaufman's 1975 form; damping by Nielsen 1999.
//! One pass per trial gives everything: with the products of all derivative columns and the residual, the
//! linear parameters are solved exactly, the cost is that of the solved problem, and the hard columns are
//! projected off the linear ones. An amplitude and its phase count as linear, in polar form.
//!
//! Behind a joint the error is rough, and nearly every second step fails. There a pass without derivatives over several
//! sets of parameters takes a quarter of one with: after a step that failed those to try next are tried at once.

use super::layout::{Layout, keep_together};
use super::moments::{measured_squares, used};
use super::passes::Passes;
use super::status::Status;
use super::trial::{Held, Point, Problem};
use crate::chain;
use crate::model::Model;
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

    /// What a step from a sum of squares has to promise, or those after it lead to what is too much.
    fn in_vain_below(self, cost: f64) -> f64 {
        if let Self::Within(most) = self { (cost - most) / FAR } else { 0.0 }
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
/// Steps that are damped more than this go nowhere.
const FIXED: f64 = 1e12;

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

/// The best parameters that a descent from `start` reaches.
pub fn descend(data: &[&Signals], model: &Model, layout: &Layout, start: &[f64], effort: Effort) -> Found {
    let total = measured_squares(data);
    let rows = used(data);
    let unit = (total / rows.max(1.0)).sqrt().max(f64::MIN_POSITIVE);
    let passes = Passes::of(data, model, &layout.free, !layout.hard.is_empty());
    let mut problem = Problem { data, passes, model, layout, total, unit, evaluations: 0 };
    let mut start = start.to_vec();
    keep_together(model, &mut start);
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
    let (mut held, mut fanned) = (Held::default(), false);
    let least_gain = effort.least_gain().max(if model.is_coupled() { ROUGH / rows } else { 0.0 });
    loop {
        if here.cost <= EXACT * total {
            return ended(&problem, &here, iterations, Status::Exact);
        }
        if held.damping > FIXED {
            return ended(&problem, &here, iterations, Status::Stalled);
        }
        if problem.evaluations >= effort.evaluations() {
            return ended(&problem, &here, iterations, Status::Limit);
        }
        let Some((step, predicted)) = problem.step(&here, held.damping) else {
            return ended(&problem, &here, iterations, Status::Converged);
        };
        let vain = if iterations >= BELIEVED { effort.in_vain_below(here.cost) } else { 0.0 };
        if predicted < vain {
            return ended(&problem, &here, iterations, Status::Limit);
        }
        let small =
            layout.hard.iter().all(|&h| step[h].abs() <= STEP * here.p[layout.free[h]].abs().max(STEP));
        let least = (PREDICTED / rows).max(least_gain) * here.cost;
        if predicted <= least || small {
            if held.damping > 1e8 {
                return ended(&problem, &here, iterations, Status::Stalled);
            }
            // A parameter that hardly matters may take a long step for a small predicted gain: not unseen.
            let short = layout.hard.iter().all(|&h| step[h].abs() <= UNSEEN * here.p[layout.free[h]].abs());
            let found = ended(&problem, &here, iterations, Status::Converged);
            let p = layout.moved(model, &here.p, &step);
            return if short { Found { p, iterations: iterations + 1, ..found } } else { found };
        }
        let (there, predicted) = if fanned {
            let most = effort.evaluations() - problem.evaluations;
            match problem.fan(&here, &mut held, most, least.max(vain)) {
                Some(best) => best,
                None => continue,
            }
        } else {
            (problem.point(layout.moved(model, &here.p, &step)), predicted)
        };
        let gain = (here.cost - there.cost) / predicted;
        if there.cost < here.cost {
            let fell = 1.0 - there.cost / here.cost;
            here = there;
            iterations += 1;
            if fell < least_gain {
                return ended(&problem, &here, iterations, Status::Converged);
            }
            // Where a step needed damping the next one may.
            fanned = fanned && held.growth > Held::GROWTH;
            held.let_go((1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0));
        } else {
            held.back();
            fanned = chain::go_together(model);
        }
    }
}

/// What a search found, if it is better than where a descent from the model's own values ends: behind a joint a scan may end
/// far from where a model that is given already is.
pub fn at_least_own(found: Option<Found>, data: &[&Signals], model: &Model, layout: &Layout) -> Found {
    let own = descend(data, model, layout, &model.values(), Effort::Full);
    found.filter(|found| found.cost < own.cost).unwrap_or(own)
}
