//! Kept answers of what a search for missing effects goes by on its way: its end hides most of what goes wrong there, for
//! a descent from a worse start mostly ends at the same place, later.

use super::super::beside::beside;
use super::super::chance::Chance;
use super::super::chosen;
use super::super::coupled::coupled;
use super::super::in_place::in_place;
use super::super::null::Null;
use super::super::screen::{Screen, Start};
use super::super::slower::{COARSE_HZ, MIDDLE_HZ, beginnings, floor, slowed};
use super::super::strides::{ROUNDS, strides};
use super::super::thinned::Thinned;
use super::super::{implausible, locate};
use super::all_wanted;
use super::recorded::{SD, knob, recorded};
use crate::effects::{Id, Place};
use crate::filter::{ZeroPhase, cheby2};
use crate::fit::refine;
use crate::floor::Floor;
use crate::model::{Model, Role};
use crate::noise::Noise;
use crate::signals::Signals;
use crate::tests::answers::Answers;

const JOINT: [(&str, f64); 3] = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
const DETENTS: [(&str, f64); 3] = [("detent.A", 0.02), ("detent.P", 1.0 / 12.0), ("detent.S", 0.4)];

/// A part of a capture of a knob, behind a filter if one is named, with a gap and samples that do not count.
fn part(model: &Model, run: &str, rows: std::ops::Range<usize>, edge_hz: Option<f64>) -> Signals {
    let all = recorded(model, run);
    let n = rows.len();
    let cut = |column: &[f64]| column[rows.clone()].to_vec();
    let mut weight = vec![1.0; n];
    weight[n / 2 - 20..n / 2].fill(0.0);
    weight[60..70].fill(0.0);
    let filter = edge_hz.map(|edge_hz| ZeroPhase::new(cheby2(3, 20.0, edge_hz, all.rate_hz).unwrap()));
    let mut signals = Signals {
        t: cut(&all.t),
        theta: cut(&all.theta),
        omega: cut(&all.omega),
        alpha: cut(&all.alpha),
        forward: cut(&all.forward),
        omega_sd: vec![0.02; n],
        tau: cut(&all.tau),
        tau_raw: cut(&all.tau_raw),
        segments: vec![0..n / 2 - 20, n / 2..n],
        weight,
        filter,
        ..all
    };
    signals.filter_torque();
    signals
}

fn promised(told: &mut Answers, name: &str, starts: &[Start]) {
    let first = starts.iter().take(5).map(|start| start.predicted);
    told.numbers(name, [starts.len() as f64].into_iter().chain(first));
}

/// What is taken up by the base model, or by detents: of its columns rounding alone is left.
const TAKEN_UP: [Id; 2] = [Id::Offset, Id::DetentHarmonics];

/// What every effect promises beside a model, shared and apart, behind a joint and before it, and what chance gives it.
fn screened(told: &mut Answers, name: &str, data: &[&Signals], model: &Model, noises: &[Noise]) {
    let watch = all_wanted();
    let mut screen = Screen::new(data, model, &watch);
    screen.chance = Some(Chance::of(data, noises, &screen.thinned));
    told.numbers(name, [screen.squares, f64::from(u8::from(screen.coupled))]);
    let mut all: Vec<(Id, Vec<Start>)> = Vec::new();
    for &id in Id::BUILT_IN.iter().filter(|id| !TAKEN_UP.contains(id)) {
        let starts = screen.starts(id);
        let what = format!("{name} {}", id.info().id);
        promised(told, &what, &starts);
        if let Some(best) = starts.first().filter(|_| id.info().scan.is_some()) {
            // Behind a joint its fifth digit is the instruction set's.
            let behind = model.is_coupled();
            let short = |x: f64| if behind { format!("{x:.3e}").parse().unwrap_or(x) } else { x };
            told.numbers("  best", best.model.values().into_iter().map(short));
        }
        for (how, more) in
            [("apart", screen.apart(id, &starts)), ("at the shaft", screen.at_shaft(id, &starts))]
        {
            if !more.is_empty() {
                promised(told, &format!("  {how}"), &more);
            }
        }
        all.push((id, starts));
    }
    let null = Null::of(&screen, noises, SD * SD, all.iter().map(|(id, starts)| (*id, &starts[..])));
    for (id, starts) in &all {
        let what = format!("{name} {} by chance", id.info().id);
        [1.0, 3.0, 8.0, 14.0, 25.0, 60.0].iter().for_each(|gain| told.about(&what, null.p_value(*id, *gain)));
        if let Some(start) = starts.first().filter(|_| id.info().place != Place::Coupling) {
            told.column("  signature", &start.by_chance.concat());
        }
        if let Some(chance) = screen.chance.as_ref().filter(|_| chosen::scanned(*id)) {
            let mut gains = chosen::gains(&screen, chance, SD * SD, *id, 99);
            gains.sort_by(f64::total_cmp);
            told.numbers("  luckiest", [10, 50, 90].iter().filter_map(|at| gains.get(*at).copied()));
        }
    }
}

#[test]
fn what_effects_promise_beside_a_bare_knob() {
    let mut told = Answers::of("bare");
    let truth = knob(&[Id::Detent, Id::ReturnSpring], &[&DETENTS[..], &[("return_spring.k", 4e-3)]].concat());
    let data = part(&truth, "a", 100..1500, Some(90.0));
    let base = refine(&[&data], &knob(&[], &[])).unwrap().model;
    let coloured = Noise { coefficients: vec![-0.6], innovation: 0.64 * SD * SD };
    screened(&mut told, "bare", &[&data], &base, &[coloured]);
    told.done();
}

#[test]
fn what_effects_promise_beside_detents_that_are_an_order() {
    let mut told = Answers::of("detents");
    let more = [("second_detent.A", 8e-3), ("second_detent.P", 0.21), ("second_detent.S", 1.0)];
    let truth = knob(&[Id::Detent, Id::SecondDetent], &[&DETENTS[..], &more].concat());
    let all = recorded(&truth, "a");
    // Through more than a revolution.
    let wide = Signals {
        theta: all.theta.iter().map(|x| 6.0 * x).collect(),
        omega: all.omega.iter().map(|x| 6.0 * x).collect(),
        alpha: all.alpha.iter().map(|x| 6.0 * x).collect(),
        ..all
    };
    let tau: Vec<f64> = crate::predict::torque_raw(&truth, &wide);
    let wide = Signals { tau: tau.clone(), tau_raw: tau, ..wide };
    let base = refine(&[&wide], &knob(&[Id::Detent], &DETENTS)).unwrap().model;
    screened(&mut told, "detents", &[&wide], &base, &[Noise::white(SD * SD)]);
    told.done();
}

#[test]
fn what_effects_promise_beside_what_two_runs_have_apart() {
    let mut told = Answers::of("apart");
    let truth = |zero: f64| {
        knob(
            &[Id::Offset, Id::Stribeck],
            &[("offset.tau0", zero), ("stribeck.rise", 0.5), ("stribeck.vs", 0.5)],
        )
    };
    let one = part(&truth(2e-3), "a", 0..1300, None);
    let other = part(&truth(-1e-3), "bb", 900..2000, Some(150.0));
    let data = [&one, &other];
    let base =
        refine(&data, &knob(&[Id::Stribeck], &[("stribeck.rise", 0.4), ("stribeck.vs", 0.4)])).unwrap().model;
    screened(&mut told, "apart", &data, &base, &[Noise::white(SD * SD), Noise::white(4.0 * SD * SD)]);
    told.done();
}

/// A knob behind a joint, and the model of it without the spring that it has.
fn joined() -> (Signals, Model) {
    let truth =
        knob(&[Id::Compliance, Id::ReturnSpring], &[&JOINT[..], &[("return_spring.k", 0.1)]].concat());
    let data = part(&truth, "a", 0..1200, None);
    let base = refine(&[&data], &knob(&[Id::Compliance], &JOINT)).unwrap().model;
    (data, base)
}

#[test]
fn what_effects_promise_beside_a_joint() {
    let mut told = Answers::of("joint");
    let (data, base) = joined();
    screened(&mut told, "joint", &[&data], &base, &[Noise::white(SD * SD)]);
    let watch = all_wanted();
    let data = [&data];
    let screen = Screen::new(&data, &base, &watch);
    let floor = SD * SD * data[0].used() as f64;
    for way in beside(&screen, &[Id::ReturnSpring, Id::Stribeck], floor) {
        let end = way.end.map_or(f64::NAN, |(_, found)| found.cost);
        told.numbers(format!("beside {}", way.id.info().id), [way.starts.len() as f64, end]);
    }
    let other = in_place(&data, &base, Id::Backlash, &|_| true);
    // A play beside a spring ends by the instruction set, but well below the joint alone.
    let alone = refine(&data, &base).unwrap().rmse;
    let ends = if other.is_some_and(|fit| fit.rmse < 0.6 * alone) { "well below it" } else { "above" };
    told.words("in its place", ends);
    told.done();
}

#[test]
fn what_a_joint_is_searched_through() {
    let mut told = Answers::of("joints");
    let joint = knob(&[Id::Compliance], &JOINT);
    let data = part(&joint, "a", 0..3000, Some(200.0));
    let data = [&data];
    let base = knob(&[], &[]);
    for most in [400, 1400, 1600, 9000] {
        let few = beginnings(&data, most);
        told.numbers(
            format!("the first {most}"),
            few[0].segments.iter().flat_map(|one| [one.start as f64, one.end as f64]),
        );
        told.column("  weight", &few[0].weight);
    }
    for edge_hz in [20.0, COARSE_HZ, MIDDLE_HZ] {
        let slow = slowed(&data, edge_hz);
        let slow: Vec<&Signals> = slow.iter().collect();
        let one = slow[0];
        told.numbers(
            format!("through {edge_hz}"),
            [one.rate_hz, one.len() as f64, one.substeps as f64, floor(&data, edge_hz, &slow, &base)],
        );
        for column in [&one.t, &one.theta, &one.omega, &one.alpha, &one.forward, &one.tau, &one.weight] {
            told.column("  column", column);
        }
        told.numbers("  segments", one.segments.iter().flat_map(|one| [one.start as f64, one.end as f64]));
    }
    let thinned = Thinned::of(&data);
    let free: Vec<usize> =
        (0..base.slots().len()).filter(|at| base.slots()[*at].role == Role::Free).collect();
    let (columns, residual, squares) = thinned.columns(&data, &base, &free);
    told.numbers("thinned", [thinned.rows() as f64, squares]);
    told.column("  columns", &columns.concat());
    told.column("  residual", &residual);
    let watch = all_wanted();
    let off = knob(
        &[Id::Compliance],
        &[("compliance.k", 0.24), ("compliance.d", 1.5e-3), ("compliance.share", 0.6), ("inertia.M", 1.2e-4)],
    );
    told.numbers("in strides", strides(&data, &off, Floor::of(&data, &off).squares, ROUNDS, &watch).values());
    let short = part(&joint, "a", 0..1000, None);
    let short = [&short];
    for way in coupled(&Screen::new(&short, &base, &watch), &[Id::Backlash, Id::Compliance], false, None) {
        promised(&mut told, way.id.info().id, &way.starts);
        if let Some((model, found)) = &way.end {
            told.numbers("  end", [found.cost].into_iter().chain(model.values()));
        }
    }
    told.done();
}

#[test]
fn where_errors_lie_and_what_is_implausible() {
    let mut told = Answers::of("located");
    let truth = knob(&[Id::Detent, Id::ReturnSpring], &[&DETENTS[..], &[("return_spring.k", 4e-3)]].concat());
    let mut data = part(&truth, "a", 0..3900, Some(150.0));
    // A line of the mains, and its third harmonic.
    let hum: Vec<f64> = data.t.iter().map(|t| 2e-3 * (314.0 * t).sin() + 1e-3 * (942.0 * t).sin()).collect();
    data.tau_raw.iter_mut().zip(&hum).for_each(|(tau, hum)| *tau += hum);
    data.filter_torque();
    let data = [&data];
    for (name, base) in [("bare", knob(&[], &[])), ("detents", knob(&[Id::Detent], &DETENTS))] {
        let fit = refine(&data, &base).unwrap();
        for split in locate(&data, &fit.model) {
            told.numbers(
                format!("{name} {}", split.axis),
                [split.share, split.part, split.chance, split.regions.len() as f64],
            );
            for column in [&split.low, &split.high, &split.count, &split.mean, &split.rms, &split.band] {
                told.column("  column", column);
            }
            for region in split.regions.iter().take(3) {
                let way = f64::from(region.direction);
                told.numbers("  region", [region.from, region.to, way, region.mean, region.share]);
            }
        }
        for id in [Id::DetentHarmonics, Id::SecondDetent, Id::Cogging, Id::PositionFriction, Id::Presliding] {
            let Ok(with) = fit.model.with(id) else { continue };
            let Ok(end) = refine(&data, &with) else { continue };
            implausible(&data, &end, id, false, false).iter().for_each(|why| told.words(id.info().id, why));
        }
    }
    told.done();
}
