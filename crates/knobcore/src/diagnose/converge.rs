//! A model followed to its best from near it, whether its error is smooth or rough.

use super::coupled::{self, squares};
use super::ends::on;
use super::slower::{self, BEFORE, COARSE_HZ, MIDDLE_HZ, slowed};
use super::strides::{ROUNDS, strides};
use super::unseen;
use super::watch::Watch;
use crate::error::Result;
use crate::fit::{Fit, glance, refine, settled, sketch};
use crate::floor::Floor;
use crate::model::Model;
use crate::rule::rule;
use crate::signals::Signals;

/// Rounds through slower filters and in strides at most, and the share of the error that one has to take off for another.
const AGAIN: usize = 3;
const LITTLE: f64 = 0.02;

/// Fits a model from values near its best. The error of one with a coupling is rough at its finest: it is descended
/// through slower filters and in strides too, as long as more than noise is left.
///
/// # Errors
/// As of [`crate::fit::fit`].
pub fn converge(data: &[&Signals], model: &Model) -> Result<Fit> {
    let best = if model.is_coupled() { descended(data, model)? } else { refine(data, model)? };
    settled(data, best, |model| refine(data, model))
}

fn descended(data: &[&Signals], model: &Model) -> Result<Fit> {
    let floor = Floor::of(data, model).squares;
    // Without surfaces that meet and part there are no dents to be led out of.
    let knocks = model.joint(&model.values()).is_some_and(|joint| !joint.welded);
    // What a search has followed is near its end: a descent before the strides and one after them were one too many.
    let mut ended = near(squares(data, model), floor);
    let mut best = if ended { strode(data, model, floor)? } else { refine(data, model)? };
    for _ in 0..AGAIN {
        let before = best.rmse;
        if before <= rule().converged * best.noise_floor {
            break;
        }
        if knocks && let Some(other) = slowly(data, &best.model) {
            best = lower(best, refine(data, &other));
            ended = false;
        }
        if !ended && near(best.rmse.powi(2), best.noise_floor.powi(2)) {
            let led = strode(data, &best.model, Floor::of(data, &best.model).squares);
            best = lower(best, led);
        }
        ended = true;
        if best.rmse > (1.0 - LITTLE) * before {
            break;
        }
    }
    Ok(best)
}

/// Whether strides may lead from such a sum of squares to what noise leaves.
fn near(squares: f64, floor: f64) -> bool {
    (rule().converged.powi(2)..rule().hopeless.powi(2)).contains(&(squares / floor))
}

fn lower(best: Fit, led: Result<Fit>) -> Fit {
    led.ok().filter(|led| led.rmse < best.rmse).unwrap_or(best)
}

fn strode(data: &[&Signals], model: &Model, floor: f64) -> Result<Fit> {
    refine(data, &strides(data, model, floor, ROUNDS, &Watch::new(&|_| true, 1)))
}

/// Where slower filters lead a model with a joint, if it is lower there. An effect that came in beside a joint bent it
/// before, and left it among dents that the finest filter has and a slower one has not.
fn slowly(data: &[&Signals], model: &Model) -> Option<Model> {
    let [coarse, middle] = [COARSE_HZ, MIDDLE_HZ].map(|edge| slowed(data, edge));
    if coarse.len() < data.len() {
        return None;
    }
    let [coarse, middle]: [Vec<&Signals>; 2] = [&coarse, &middle].map(|view| view.iter().collect());
    let watch = Watch::new(&|_| true, 1);
    let end = on(model, |model| sketch(&coarse, model));
    let floor = slower::floor(data, COARSE_HZ, &coarse, model);
    let (end, _) = coupled::strode(&coarse, end, floor, f64::INFINITY, &watch);
    let (end, _) = unseen::lower(&middle, &end, [COARSE_HZ, MIDDLE_HZ], sketch);
    let (end, found) = unseen::lower(data, &end, [MIDDLE_HZ, BEFORE * MIDDLE_HZ], glance);
    (found.cost < squares(data, model)).then_some(end)
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::effects::Id;

    #[test]
    fn what_comes_in_beside_a_gap_is_led_out_of_the_dents_that_the_gap_was_bent_into_without_it() {
        let values = |gap, k, spring| {
            let joint =
                [("backlash.gap", gap), ("backlash.k", k), ("backlash.d", 0.06), ("backlash.share", 0.7)];
            knob(&[Id::Backlash, Id::ReturnSpring], &[&joint[..], &[("return_spring.k", spring)]].concat())
        };
        let signals = recorded(&values(8e-3, 90.0, 0.02), "a");
        let data = [&signals];
        for gap in [5e-3, 6e-3, 1.2e-2] {
            let start = values(gap, 200.0, 0.0);
            let end = |fit: Result<Fit>| fit.map(|fit| fit.rmse / fit.noise_floor).unwrap();
            let (steps, led) = (end(refine(&data, &start)), end(converge(&data, &start)));
            assert!(steps > 2.0 && led < 1.5, "{gap}: {steps} {led}");
        }
        let near = knob(&[Id::Backlash], &[("backlash.gap", 8e-3), ("backlash.k", 90.0)]);
        assert!(slowly(&data, &near).is_none_or(|led| squares(&data, &led) < squares(&data, &near)));
    }
}
