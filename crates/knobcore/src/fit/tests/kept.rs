//! Kept answers of the stages of a fit: the scan, what it decides, and descents that are stopped on their way.

use super::super::layout::Layout;
use super::super::orders;
use super::super::parts::Parts;
use super::super::runs::{differ, runs, settled};
use super::super::separable::{Effort, descend};
use super::super::serial::serial;
use super::super::undetermined::silent;
use super::super::*;
use super::{SD, turned};
use crate::model::Run;
use crate::param::Axis;
use crate::random;
use crate::signals::Signals;
use crate::tests::answers::Answers;

/// A part of the capture of a knob that is turned so far, with a torque more, and a few samples that do not count.
fn part(reach: f64, rows: std::ops::Range<usize>, more: impl Fn(f64, f64) -> f64) -> Signals {
    let all = turned(reach, SD, more);
    let n = rows.len();
    let cut = |column: &[f64]| column[rows.clone()].to_vec();
    let mut weight = vec![1.0; n];
    weight[n / 3..n / 3 + 9].fill(0.0);
    Signals {
        t: cut(&all.t),
        theta: cut(&all.theta),
        omega: cut(&all.omega),
        alpha: cut(&all.alpha),
        forward: cut(&all.forward),
        omega_sd: cut(&all.omega_sd),
        tau: cut(&all.tau),
        tau_raw: cut(&all.tau_raw),
        segments: vec![0..n; 1],
        weight,
        ..all
    }
}

fn at_values(model: &Model, values: &[(&str, f64)]) -> Model {
    let mut model = model.clone();
    values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
    model
}

fn scanned_over(told: &mut Answers, name: &str, data: &[&Signals], model: &Model) {
    for wave in [Wave::Torque, Wave::Friction] {
        let Some((scan, step)) = scan::scan(data, model, &model.values(), &Layout::of(model).linear(), wave)
        else {
            return told.words(name, "no motion");
        };
        told.numbers(format!("{name} {wave:?}"), [scan.gain.len() as f64, scan.without, scan.background()]);
        told.column("  1/P", &scan.inverse_period);
        told.column("  gain", &scan.gain);
        told.numbers("  step", step);
        for peak in scan.peaks().iter().take(4) {
            told.numbers("  peak", [peak.period, peak.gain, peak.amplitude, peak.phase]);
        }
    }
    told.numbers(format!("{name} range"), [scan::range(data)]);
    if let Some(([first, last], between)) = band(data) {
        told.numbers("  band", [first, last, between]);
    }
    told.column("  orders", &orders::waves(data, model).concat());
}

#[test]
fn what_a_scan_sees() {
    let mut told = Answers::of("scans");
    let wave = |x: f64| 5e-3 * (x / 0.06 + 0.3).sin() + 2e-3 * (x / 0.021).sin();
    let base = Model::equation_1(Axis::Rotary, false);
    for reach in [0.05, 0.9, 7.0] {
        let data = part(reach, 0..2500, |x, forth| wave(x) + 1e-3 * forth * (x / 0.04).cos());
        scanned_over(&mut told, &format!("{reach}"), &[&data], &base);
    }
    let orders = |x: f64| 4e-3 * (12.0 * x).sin() + 2e-3 * (24.0 * x + 1.0).cos() + 1e-3 * (7.0 * x).sin();
    let [one, two] = [part(4.0, 0..2000, |x, _| orders(x)), part(1.5, 500..1600, |x, _| orders(x))];
    scanned_over(&mut told, "two", &[&one, &two], &base);
    let detents = Model::equation_1(Axis::Rotary, true);
    let detents = at_values(&detents, &[("detent.A", 4e-3), ("detent.P", 1.0 / 12.0), ("detent.S", 0.1)]);
    for beside in orders::beside(&[&one, &two], &detents) {
        told.numbers("beside", beside.values());
    }
    let slide = Signals {
        axis: Axis::Linear,
        ..part(0.9, 0..2000, |x, _| 4e-3 * (60.0 * x).sin() + 2e-3 * (20.0 * x).sin())
    };
    scanned_over(&mut told, "slide", &[&slide], &Model::equation_1(Axis::Linear, false));
    let detents =
        at_values(&Model::equation_1(Axis::Linear, true), &[("detent.A", 4e-3), ("detent.P", 1.0 / 60.0)]);
    orders::beside(&[&slide], &detents).iter().for_each(|beside| told.numbers("beside", beside.values()));
    let still = Signals { theta: vec![0.2; 2000], ..slide };
    scanned_over(&mut told, "still", &[&still], &Model::equation_1(Axis::Linear, false));
    told.done();
}

#[test]
fn whether_there_are_detents() {
    let mut told = Answers::of("detents_found");
    let base = Model::equation_1(Axis::Rotary, false);
    for reach in [0.05, 0.4, 3.0] {
        for period in [0.002, 0.02, 0.1, 0.3, 1.2] {
            for size in [1e-4, 2.5e-4, 5e-4, 3e-3] {
                let data = part(reach, 0..900, |x, _| size * (x / period + 0.5).sin());
                let fit = fit(&[&data], &base, Detents::Find).unwrap();
                let found = fit.model.period().map(|at| fit.model.values()[at]);
                told.numbers(format!("{reach} {period} {size}"), found.into_iter().chain([fit.rmse]));
            }
        }
        // What looks like detents, and is none.
        for (name, more) in [("cubic", 1.0), ("spring", 0.0)] {
            let data = part(reach, 0..900, |x, _| 4e-3 * (x / reach + more * (x / reach).powi(3)));
            let fit = fit(&[&data], &base, Detents::Find).unwrap();
            told.words(format!("{reach} {name}"), format!("{}", fit.model.has(Id::Detent)));
        }
    }
    told.done();
}

#[test]
fn descents_that_are_stopped_on_their_way() {
    let mut told = Answers::of("descents");
    let base = Model::equation_1(Axis::Rotary, true);
    let data = part(0.9, 0..1500, |x, forth| {
        5e-3 * (x / 0.11 + 0.5).sin() + 3e-3 * forth * (-x * x).exp() + 2e-3 * x
    });
    let data = [&data];
    for (id, values) in [
        (Id::Stribeck, vec![("stribeck.rise", 0.3), ("stribeck.vs", 0.2)]),
        (
            Id::EndStop,
            vec![
                ("end_stop.k_hi", 0.05),
                ("end_stop.hi", 0.5),
                ("end_stop.k_lo", 0.05),
                ("end_stop.lo", -0.5),
            ],
        ),
        (Id::Presliding, vec![("presliding.s", 0.1), ("presliding.w1", 0.3)]),
        (Id::FrictionDrift, vec![("friction_drift.rise", 0.1), ("friction_drift.tau", 0.4)]),
        (Id::TorqueLag, vec![("torque_lag.lag", 2e-3)]),
        (Id::Saturation, vec![("saturation.limit", 0.012)]),
        (Id::LoadFriction, vec![("load_friction.mu", 0.1)]),
    ] {
        let model = base.with(id).unwrap();
        let known: Vec<(&str, f64)> =
            values.into_iter().filter(|(name, _)| model.index(name).is_ok()).collect();
        for (period, phase) in [(0.11, 0.4), (0.108, -2.0), (0.16, 3.0)] {
            let start = [("detent.A", 2e-3), ("detent.P", period), ("detent.S", phase)];
            let model = at_values(&model, &[&known[..], &start].concat());
            for (called, effort) in [("Glance", Effort::Glance), ("Sketch", Effort::Within(f64::INFINITY))] {
                let found = descend(&data, &model, &Layout::of(&model), &model.values(), effort);
                let steps = if effort == Effort::Glance { found.iterations as f64 } else { 0.0 };
                told.numbers(format!("{} {period} {called}", id.info().id), [found.cost, steps]);
            }
        }
    }
    let held = |name: &str, model: &Model| {
        let mut held = model.clone();
        held.set_role(name, Role::Fixed).unwrap();
        held
    };
    let detents = at_values(&base, &[("detent.A", 4e-3), ("detent.P", 0.11), ("detent.S", 0.4)]);
    for name in ["detent.A", "detent.P", "detent.S", "inertia.M"] {
        let found = descend(
            &data,
            &held(name, &detents),
            &Layout::of(&held(name, &detents)),
            &detents.values(),
            Effort::Full,
        );
        told.numbers(format!("without {name}"), [found.cost].into_iter().chain(found.p));
        told.words("  ended", found.status.word());
        let fit = fit(&data, &held(name, &detents), Detents::AsModel).unwrap();
        told.numbers("  fitted", [fit.rmse, fit.rmse_heldout, fit.noise_floor]);
        told.words("  ended", fit.status.word());
    }
    let straight = fit(&data, &Model::equation_1(Axis::Rotary, false), Detents::AsModel).unwrap();
    told.numbers("straight", [straight.iterations as f64, straight.evaluations as f64]);
    let spring =
        fit(&data, &Model::equation_1(Axis::Rotary, false).with(Id::ReturnSpring).unwrap(), Detents::AsModel)
            .unwrap();
    told.numbers("spring", [spring.iterations as f64, spring.rmse]);
    // A linear model looked at beside a scan takes its passes too.
    let none = part(0.9, 0..900, |_, _| 0.0);
    let found = fit(&[&none], &Model::equation_1(Axis::Rotary, false), Detents::Find).unwrap();
    told.numbers("none", [found.iterations as f64, found.evaluations as f64]);
    told.done();
}

#[test]
fn how_sure_a_fit_is_whatever_is_left() {
    let mut told = Answers::of("sureness");
    let base = Model::equation_1(Axis::Rotary, false);
    let mut noise = random::Noise::new(21);
    let mut colour = 0.0;
    let coloured: Vec<f64> = (0..4000)
        .map(|_| {
            colour = 0.8 * colour + 6e-4 * noise.normal();
            colour
        })
        .collect();
    for (name, more, gap) in [("nothing", 0.0, false), ("much", 6e-3, false), ("in parts", 6e-3, true)] {
        let mut data = part(0.9, 0..3000, |x, _| more * (4.0 * x).sin());
        data.tau.iter_mut().zip(&coloured).for_each(|(tau, own)| *tau += own);
        data.tau_raw = data.tau.clone();
        if gap {
            data.segments = vec![0..700, 900..3000];
            data.weight[700..900].fill(0.0);
        }
        let data = [&data];
        let fit = fit(&data, &base, Detents::AsModel).unwrap();
        told.numbers(name, [fit.rmse, fit.rmse_heldout, fit.noise_floor, fit.white_squares]);
        told.numbers("  errors", fit.standard_errors());
        told.column("  correlation", fit.correlation().as_slice());
        told.column("  bootstrap", &fit.bootstrap(40, 9).concat());
        told.numbers("  blocks", [fit.blocks.len() as f64, fit.blocks[3].squares(), fit.blocks[3].rows]);
        let residual: Vec<f64> = crate::predict::torque(&fit.model, data[0])
            .iter()
            .zip(&data[0].tau)
            .map(|(a, b)| b - a)
            .collect();
        let found = serial(&[&residual[..1000], &residual[1000..]]);
        told.numbers("  serial", [found.innovation].into_iter().chain(found.coefficients));
        let layout = Layout::of(&fit.model);
        let mut parts = Parts::of(&data, layout.free.len());
        evaluate(&data, &fit.model, &fit.model.values(), &layout.seeds(&fit.model), |evaluated| {
            parts.add(evaluated)
        });
        told.numbers("  by parts", parts.variances(&[0, 1, 2, 3, 4]));
    }
    told.done();
}

#[test]
fn what_several_runs_have_apart() {
    let mut told = Answers::of("runs");
    let base = Model::equation_1(Axis::Rotary, false).with(Id::Offset).unwrap();
    let run = |name: &str, zero: f64, rows: std::ops::Range<usize>| Signals {
        run: Run { name: name.into(), fingerprint: name.into() },
        ..part(0.9, rows, |x, _| zero + 1e-3 * x)
    };
    for by in [0.0, 4e-5, 2e-4, 2e-3] {
        let data = [run("a", by, 0..1200), run("b", -by, 1000..2400), run("c", 0.3 * by, 2300..3400)];
        let data = data.each_ref();
        let fit = fit(&data, &base, Detents::AsModel).unwrap();
        let apart = fit.model.is_apart(Id::Offset);
        told.numbers(
            format!("{by}"),
            [
                fit.rmse,
                fit.rmse_heldout,
                f64::from(u8::from(apart)),
                f64::from(u8::from(differ(&fit, Id::Offset))),
            ],
        );
        told.numbers("  at", fit.model.values());
        told.numbers("  errors", fit.standard_errors());
        if let Some(model) = base.apart(Id::Offset, &runs(&data)) {
            let settled =
                settled(&data, refine(&data, &model).unwrap(), |model| refine(&data, model)).unwrap();
            told.numbers("  settled", settled.model.values());
        }
    }
    // What nothing tells of: a knob that goes one way alone, and detents of no size.
    let mut one_way = part(0.9, 0..1500, |_, _| 0.0);
    one_way
        .weight
        .iter_mut()
        .zip(&one_way.omega)
        .for_each(|(weight, omega)| *weight *= f64::from(u8::from(*omega > 0.0)));
    let detents = Model::equation_1(Axis::Rotary, true).with(Id::ReturnSpring).unwrap();
    told.words("silent", silent(&[&one_way], &detents).join(" "));
    let fit = fit(&[&one_way], &Model::equation_1(Axis::Rotary, false), Detents::AsModel).unwrap();
    fit.undetermined.iter().for_each(|one| told.words(&one.name, &one.why));
    told.about("about", 0.5);
    told.done();
}
