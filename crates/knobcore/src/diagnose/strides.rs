//! Descent in strides: slopes over steps as wide as the error that is left.
//!
//! When the surfaces of a joint meet and part depends on every parameter, and where a knob stops against friction too:
//! pulses that no longer overlap with those measured are dents in the error, and a derivative there is the slope of the
//! dent. The difference between two points is the slope of the ground, if they lie further apart than a dent is wide; as
//! less error is left the strides become shorter (implicit filtering: Gilmore & Kelley 1995, SIAM J. Optim. 5).

use super::thinned::Thinned;
use super::watch::Watch;
use crate::algebra::dot;
use crate::fit::least;
use crate::model::{Model, Role};
use crate::rule::rule;
use crate::scalar::WIDE;
use crate::signals::Signals;

/// Rounds of a search for the best end at most, and of one for a way there.
pub const ROUNDS: usize = 24;
pub const FEW: usize = 10;
/// The share of the sum of squares that a round has to take off to count.
const LITTLE: f64 = 2e-3;
/// How far a stride moves the torque, in times of the error that is left; where one leads nowhere the next is tried.
const STRIDES: [f64; 4] = [1.0, 2.0, 4.0, 0.5];
/// How far off a stride may be, and how often a better one is looked for.
const ABOUT: f64 = 2.5;
const TRIED: usize = 3;
/// The first stride, as a share of a value or of its scale.
const FIRST: f64 = 0.02;
/// The error that is left is at least this share of it, however little noise leaves of it.
const LEAST: f64 = 0.1;
/// Steps that are tried along the same slopes: how much each parameter is held back, and how much further it goes.
const STEPS: [(f64, f64); 8] =
    [(1e-4, 1.0), (1e-3, 1.0), (1e-2, 1.0), (0.1, 1.0), (0.1, 2.0), (1.0, 1.0), (1.0, 3.0), (5.0, 1.0)];

/// A point on the way.
struct Point {
    model: Model,
    residual: Vec<f64>,
    squares: f64,
}

/// A parameter, how wide its stride is, and the slope of the torque over it.
struct Slope {
    slot: usize,
    width: f64,
    column: Vec<f64>,
}

/// The model that so many rounds of strides lead to, where they lead downhill; `floor` is what noise leaves of the sum
/// of squares.
pub fn strides(data: &[&Signals], model: &Model, floor: f64, rounds: usize, watch: &Watch<'_>) -> Model {
    let thinned = Thinned::of(data);
    let at = |models: Vec<Model>| points(data, &thinned, models, watch);
    let Some(mut here) = at(vec![model.clone()]).pop() else { return model.clone() };
    let mut widths = first(model);
    let mut failed = 0;
    for _ in 0..rounds {
        if here.squares <= rule().converged.powi(2) * floor || failed == STRIDES.len() || !watch.wanted() {
            break;
        }
        let left = (here.squares - floor).max(LEAST * LEAST * here.squares) / here.squares;
        let target = STRIDES[failed] * (left * dot(&here.residual, &here.residual)).sqrt();
        let slopes = sloped(&here, &widths, target, &at);
        widths = slopes.iter().map(|slope| (slope.slot, slope.width)).collect();
        let told = slopes.into_iter().filter(|slope| {
            let length = dot(&slope.column, &slope.column);
            length.is_finite() && length > 0.0
        });
        let told: Vec<Slope> = told.collect();
        let tried = at(STEPS.iter().filter_map(|step| stepped(&here, &told, *step)).collect());
        let lower = tried.into_iter().filter(|tried| tried.squares < (1.0 - LITTLE) * here.squares);
        match lower.min_by(|a, b| a.squares.total_cmp(&b.squares)) {
            Some(best) => (here, failed) = (best, 0),
            None => failed += 1,
        }
    }
    here.model
}

/// The free parameters of a model and their first strides.
fn first(model: &Model) -> Vec<(usize, f64)> {
    let free = |at: &usize| model.slots()[*at].role == Role::Free && !model.is_idle(*at);
    let width = |at: usize| {
        let slot = &model.slots()[at];
        (at, FIRST * if slot.value == 0.0 { slot.param.scale() } else { slot.value.abs() })
    };
    (0..model.slots().len()).filter(free).map(width).collect()
}

/// Where models are that differ in their values alone, as many side by side as a register has lanes.
fn points(data: &[&Signals], thinned: &Thinned, models: Vec<Model>, watch: &Watch<'_>) -> Vec<Point> {
    let residuals = |models: &&[Model]| {
        let sets: Vec<Vec<f64>> = models.iter().map(Model::values).collect();
        models.first().map_or_else(Vec::new, |model| thinned.residuals(data, model, &sets))
    };
    let residuals = watch.each(&models.chunks(WIDE).collect::<Vec<_>>(), residuals);
    let point = |(model, (residual, squares))| Point { model, residual, squares };
    models.into_iter().zip(residuals.into_iter().flatten()).map(point).collect()
}

/// The slopes of the torque over strides that move it by about `target`; empty ones where nobody waits any longer.
fn sloped(
    here: &Point,
    widths: &[(usize, f64)],
    target: f64,
    at: &impl Fn(Vec<Model>) -> Vec<Point>,
) -> Vec<Slope> {
    let slope = |(slot, width): &(usize, f64)| Slope { slot: *slot, width: *width, column: Vec::new() };
    let mut slopes: Vec<Slope> = widths.iter().map(slope).collect();
    let mut open: Vec<usize> = (0..slopes.len()).collect();
    for _ in 0..TRIED {
        let moved = open.iter().map(|i| moved(&here.model, slopes[*i].slot, slopes[*i].width));
        let (models, by): (Vec<Model>, Vec<f64>) = moved.unzip();
        let mut off = Vec::new();
        for ((i, there), by) in open.into_iter().zip(at(models)).zip(by) {
            let slope = &mut slopes[i];
            slope.column = here.residual.iter().zip(&there.residual).map(|(a, b)| (a - b) / by).collect();
            let far = by.abs() * dot(&slope.column, &slope.column).sqrt() / target;
            if !(ABOUT.recip()..ABOUT).contains(&far) {
                slope.width *= if far.is_finite() { far.clamp(0.05, 20.0).recip() } else { 0.1 };
                off.push(i);
            }
        }
        open = off;
    }
    slopes
}

/// A model with one parameter moved by about `width`, within its bounds, and by how much it was.
fn moved(model: &Model, slot: usize, width: f64) -> (Model, f64) {
    let mut p = model.values();
    let (param, before) = (model.slots()[slot].param, p[slot]);
    let up = (before + width).min(param.upper);
    p[slot] = if up - before > 0.5 * width { up } else { (before - width).max(param.lower) };
    let by = p[slot] - before;
    let mut moved = model.clone();
    moved.set_values(&p);
    (moved, by)
}

/// Where a step along slopes leads: how much parameters are held back in it, and how much further it then goes.
fn stepped(here: &Point, slopes: &[Slope], (held, further): (f64, f64)) -> Option<Model> {
    let gram = |i: usize, j: usize| dot(&slopes[i].column, &slopes[j].column);
    let step = least(slopes.len(), gram, |i| dot(&slopes[i].column, &here.residual), held)?;
    let mut p = here.model.values();
    for (slope, change) in slopes.iter().zip(step) {
        let param = here.model.slots()[slope.slot].param;
        p[slope.slot] = (p[slope.slot] + further * change).clamp(param.lower, param.upper);
    }
    let mut model = here.model.clone();
    model.set_values(&p);
    Some(model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::fit::refine;
    use crate::floor::Floor;
    use crate::param::Axis;
    use crate::predict;

    fn knob(values: &[(&str, f64)]) -> Model {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        let base = [("inertia.M", 1e-4), ("coulomb.neg", 4e-3), ("coulomb.pos", 5e-3)];
        let joint = [("backlash.gap", 4e-3), ("backlash.k", 100.0), ("backlash.d", 0.05)];
        for (name, value) in base.iter().chain(&joint).chain(values) {
            model.set(name, *value).unwrap();
        }
        model
    }

    /// To and fro, faster and faster, with noise of 0.4 mN m.
    fn turned(model: &Model) -> Signals {
        let rate_hz = 2000.0;
        let over = |f: &dyn Fn(f64) -> f64| (0..6000).map(|i| f(f64::from(i) / rate_hz)).collect::<Vec<_>>();
        let (phase, speed) = (|t: f64| 6.0 * t + 2.0 * t * t, |t: f64| 6.0 + 4.0 * t);
        let mut signals = Signals {
            rate_hz,
            substeps: 4,
            t: over(&|t| t),
            theta: over(&|t| phase(t).sin()),
            omega: over(&|t| phase(t).cos() * speed(t)),
            alpha: over(&|t| 4.0 * phase(t).cos() - phase(t).sin() * speed(t).powi(2)),
            forward: over(&|t| f64::from(u8::from(phase(t).cos() > 0.0))),
            segments: vec![0..6000; 1],
            weight: vec![1.0; 6000],
            ..Signals::default()
        };
        let noise = |i: usize| 8e-4 * ((i as f64 * 12.9898).sin() * 43_758.545).rem_euclid(1.0) - 4e-4;
        let tau = predict::torque_raw(model, &signals);
        signals.tau_raw = tau.iter().enumerate().map(|(i, tau)| tau + noise(i)).collect();
        signals.tau = signals.tau_raw.clone();
        signals
    }

    #[test]
    fn strides_lead_to_a_joint_that_a_descent_by_derivatives_ends_beside() {
        let signals = turned(&knob(&[]));
        let data = [&signals];
        for gap in [2.7e-3, 3e-3, 3.2e-3] {
            for (k, d) in [(40.0, 0.02), (60.0, 0.03)] {
                let contact = [("backlash.gap", gap), ("backlash.k", k), ("backlash.d", d)];
                let start = knob(&[&contact[..], &[("coulomb.neg", 3.8e-3)]].concat());
                let watch = Watch::new(&|_| true, 1);
                let floor = Floor::of(&data, &start).squares;
                let led = refine(&data, &strides(&data, &start, floor, ROUNDS, &watch)).unwrap();
                let alone = refine(&data, &start).unwrap();
                assert!(led.rmse < 0.9 * alone.rmse, "{gap} {k}: {} {}", led.rmse, alone.rmse);
            }
        }
    }

    #[test]
    fn a_parameter_at_its_bound_is_moved_away_from_it() {
        let model = knob(&[("backlash.share", 1.0)]);
        let slot = model.index("backlash.share").unwrap();
        let (there, by) = moved(&model, slot, 0.1);
        assert!((by + 0.1).abs() < 1e-12 && (there.values()[slot] - 0.9).abs() < 1e-12);
    }

    /// A knob without a joint, whose torque is in proportion to all that it has.
    fn rigid(values: &[(&str, f64)]) -> Model {
        let loads: Vec<Id> = knob(values).effects().filter(|id| *id != Id::Backlash).collect();
        knob(values).only(&loads).unwrap()
    }

    /// The points of models, against these signals.
    fn at(signals: &Signals, models: Vec<Model>) -> Vec<Point> {
        let data = [signals];
        points(&data, &Thinned::of(&data), models, &Watch::new(&|_| true, 1))
    }

    #[test]
    fn a_stride_moves_the_torque_as_far_as_it_is_aimed_however_wide_it_was_before() {
        let truth = rigid(&[]);
        let signals = turned(&truth);
        let at = |models: Vec<Model>| at(&signals, models);
        let here = at(vec![rigid(&[("coulomb.pos", 6e-3)])]).remove(0);
        let slot = truth.index("coulomb.pos").unwrap();
        let target = 0.5 * here.squares.sqrt();
        let exact: f64 = here.squares.sqrt() / 1e-3;
        for width in [1e-5, 1e-4, 1e-3, 5e-3] {
            let slope = sloped(&here, &[(slot, width)], target, &at).remove(0);
            let far = slope.width * dot(&slope.column, &slope.column).sqrt() / target;
            assert!((ABOUT.recip()..=ABOUT).contains(&far), "{width}: {far}");
            // What brakes one way alone is a torque in proportion.
            let steep = dot(&slope.column, &slope.column).sqrt();
            assert!((steep / exact - 1.0).abs() < 0.1, "{width}: {steep} {exact}");
        }
        assert_eq!(first(&here.model).iter().find(|(at, _)| *at == slot), Some(&(slot, FIRST * 6e-3)));
    }

    #[test]
    fn a_step_along_slopes_ends_where_the_squares_are_least_and_one_that_is_held_back_before() {
        let signals = turned(&rigid(&[]));
        let all = |models: Vec<Model>| at(&signals, models);
        let at = |model: Model| all(vec![model]).remove(0);
        let here = at(rigid(&[("coulomb.pos", 6e-3), ("inertia.M", 8e-5)]));
        let names = ["coulomb.pos", "inertia.M"];
        let slots = names.map(|name| here.model.index(name).unwrap());
        let widths: Vec<(usize, f64)> = slots.into_iter().zip([1e-4, 2e-6]).collect();
        let slopes = sloped(&here, &widths, 0.1 * here.squares.sqrt(), &all);
        let led = |step| at(stepped(&here, &slopes, step).unwrap());
        let (whole, held, twice) = (led((1e-6, 1.0)), led((1.0, 1.0)), led((1.0, 2.0)));
        assert!(whole.squares < held.squares && held.squares < here.squares);
        for slot in slots {
            let way = |to: &Point| to.model.values()[slot] - here.model.values()[slot];
            assert!((way(&twice) / way(&held) - 2.0).abs() < 1e-9 && way(&held) * way(&whole) > 0.0);
            assert!(way(&held).abs() < way(&whole).abs());
        }
        let least = at(rigid(&[])).squares;
        assert!(whole.squares < 1.001 * least && here.squares > 5.0 * least, "{} {least}", whole.squares);
    }
}
