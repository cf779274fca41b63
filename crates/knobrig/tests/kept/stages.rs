//! What is kept of each stage that a capture goes through.

use crate::answers::Answers;
use knobcore::diagnose::{
    Candidate, Evidence, State, complete, converge, diagnose, exact, implausible, judge, locate, sets,
};
use knobcore::effects::Id;
use knobcore::fit::{Detents, Fit, fit, refine};
use knobcore::floor::{Floor, noises, unheard};
use knobcore::forward::forward;
use knobcore::model::{Model, Role, Slot};
use knobcore::predict::torque;
use knobcore::prepare::Prepared;
use knobcore::signals::Signals;
use knobcore::stiction::stiction;

/// Which samples count and where the motion is.
pub fn prepared(told: &mut Answers, prepared: &Prepared) {
    let signals = &prepared.signals;
    for (name, column) in [
        ("theta", &signals.theta),
        ("omega", &signals.omega),
        ("alpha", &signals.alpha),
        ("forward", &signals.forward),
        ("omega_sd", &signals.omega_sd),
        ("tau", &signals.tau),
        ("weight", &signals.weight),
    ] {
        told.column(format!("prepared {name}"), column);
    }
    let ends = [&signals.segments, &signals.stuck, &signals.bridges];
    for (name, ranges) in ["segments", "stuck", "bridges"].iter().zip(ends) {
        let ends = ranges.iter().flat_map(|range| [range.start as f64, range.end as f64]);
        told.numbers(format!("prepared {name}"), ends);
    }
    for (name, column) in ["theta", "alpha"].iter().zip(prepared.uncertainty.iter().flatten()) {
        told.column(format!("prepared {name}_sd"), column);
    }
    if let Some(noise) = prepared.noise {
        told.numbers("sensors", [noise.theta, noise.omega, noise.alpha, noise.jerk]);
    }
    if let Some(edge) = prepared.edge {
        let ripple = edge.ripple.map_or([0.0; 3], |ripple| [ripple.per_turn, ripple.hz, ripple.share]);
        let lower = edge.incoherent.map_or([0.0; 3], |one| [one.hz, one.edge_hz, one.times]);
        told.numbers("edge", [[edge.hz, f64::from(u8::from(edge.lost)), 0.0], ripple, lower].concat());
    }
    for (name, rows) in ["theta", "omega", "alpha"].iter().zip(&prepared.strays) {
        told.numbers(format!("strays of {name}"), rows.iter().map(|row| *row as f64));
    }
}

fn line(slot: &Slot) -> String {
    let role = match slot.role {
        Role::Free => String::new(),
        Role::Fixed => " fixed".into(),
        Role::Tied(to) => format!(" as {to}"),
    };
    format!("  {}{role}", slot.name())
}

/// All that a fit says, but for how many steps it took.
pub fn fitted(told: &mut Answers, name: &str, data: &[&Signals], fit: &Fit) {
    let errors = fit.standard_errors();
    told.words(format!("{name}, how it ended"), fit.status.word());
    told.numbers("  errors", [fit.rmse, fit.rmse_heldout, fit.noise_floor, fit.white_squares]);
    if !is_sure(fit) {
        return;
    }
    for (at, slot) in fit.model.slots().iter().enumerate() {
        let error = fit.free.iter().position(|free| *free == at).map(|column| errors[column]);
        told.numbers(line(slot), [slot.value].into_iter().chain(error));
    }
    let correlation = fit.correlation();
    told.column("  correlation", correlation.as_slice());
    for one in &fit.undetermined {
        told.words(format!("  {}", one.name), &one.why);
    }
    if let Some(scan) = &fit.scan {
        told.column("  scan 1/P", &scan.inverse_period);
        told.column("  scan gain", &scan.gain);
    }
    told.column("  bootstrap", &fit.bootstrap(24, 5).concat());
    told.column("  band", &fit.band(data[0]));
    let normals: Vec<f64> = (0..fit.free.len()).map(|i| (i as f64 + 0.5).sin()).collect();
    let drawn = fit.drawn(&normals);
    told.numbers("  drawn", drawn.values());
    let other = Signals { tau: torque(&drawn, data[0]), ..data[0].clone() };
    if let Ok(expected) = fit.expected(&other, 1e-6) {
        told.numbers("  expected", [expected.left].into_iter().chain(expected.standard_errors));
    }
}

/// The noise of the torque.
pub fn floor(told: &mut Answers, data: &[&Signals], model: &Model) {
    for noise in noises(data, model) {
        let noise = noise.map_or_else(Vec::new, |one| [vec![one.innovation], one.coefficients].concat());
        told.numbers("noise", noise);
    }
    let floor = Floor::of(data, model);
    told.numbers("floor", [floor.white, floor.squares, floor.rows]);
    told.words("unheard", format!("{:?}", unheard(data, model)));
}

/// Where the error is; returns what is beyond chance along each axis.
pub fn located(told: &mut Answers, data: &[&Signals], model: &Model) -> Vec<f64> {
    let splits = locate(data, model);
    for split in &splits {
        let axis = split.axis;
        told.numbers(format!("along {axis}"), [split.share, split.part, split.chance]);
        for (name, column) in [
            ("borders", &[&split.low[..], &split.high[..]].concat()),
            ("count", &split.count),
            ("mean and rms", &[&split.mean[..], &split.rms[..]].concat()),
            ("band", &split.band),
        ] {
            told.column(format!("  {name}"), column);
        }
        let directions: Vec<f64> = split.direction.iter().map(|way| f64::from(*way)).collect();
        told.column("  direction", &directions);
        for region in split.regions.iter().take(2) {
            let way = f64::from(region.direction);
            told.numbers("  region", [region.from, region.to, way, region.mean, region.share]);
        }
    }
    splits.iter().filter(|split| split.share > split.chance).map(|split| split.part).collect()
}

/// What a knob on a rigid shaft can be searched for beside a model.
pub fn rigid(model: &Model) -> Vec<Id> {
    use knobcore::effects::Place;
    let searched = |id: &Id| {
        let info = id.info();
        info.unsearched.is_none() && info.place != Place::Coupling && model.with(*id).is_ok()
    };
    Id::BUILT_IN.iter().copied().filter(searched).collect()
}

/// By the order of the catalogue: of those that take nothing off rounding decides which is better.
fn sorted(candidates: &[Candidate]) -> Vec<&Candidate> {
    let mut sorted: Vec<&Candidate> = candidates.iter().collect();
    sorted.sort_by_key(|one| one.id);
    sorted
}

/// Whether a fit tells its parameters apart: the values of those that it does not hang on rounding.
fn is_sure(fit: &Fit) -> bool {
    let correlation = fit.correlation();
    let apart = |i: usize, j: usize| i == j || correlation[(i, j)].abs() < 0.995;
    fit.undetermined.is_empty() && (0..fit.free.len()).all(|i| (0..i).all(|j| apart(i, j)))
}

/// The error and the values of a fit that is sure of them.
pub fn sure(told: &mut Answers, what: String, fit: &Fit) {
    if is_sure(fit) {
        let values = [fit.rmse].into_iter().chain(fit.model.values());
        told.numbers(what, values);
    } else {
        told.words(what, "cannot tell its parameters apart");
    }
}

/// Every candidate, and what is said of it.
pub fn diagnosed(
    told: &mut Answers,
    data: &[&Signals],
    before: &Fit,
    beyond: &[f64],
    effects: &[Id],
) -> Vec<Candidate> {
    let candidates = diagnose(data, &before.model, effects, &|_| true).unwrap();
    let squares: f64 =
        data.iter().flat_map(|one| one.tau.iter().zip(&one.weight)).map(|(x, w)| x * x * w).sum();
    let used: f64 = data.iter().map(|one| one.used() as f64).sum();
    let exact = exact(before.rmse, (squares / used).sqrt());
    let (rmse, noise_floor, white_squares) = (before.rmse, before.noise_floor, before.white_squares);
    let state = State { rmse, noise_floor, white_squares, law: 0.0, complete: false, exact };
    let state = State { complete: complete(&state, beyond), ..state };
    let mut all = Vec::new();
    let order: Vec<&str> =
        candidates.iter().filter(|one| one.gain > 1.0).map(|one| one.id.info().id).collect();
    told.words("candidates", order.join(" "));
    for one in sorted(&candidates) {
        told.about(format!("candidate {}", one.id.info().id), one.gain);
        told.numbers("  parameters", [one.parameters as f64]);
        told.about("  its chance", one.p_value);
        if !one.note.is_empty() {
            told.words("  note", &one.note);
        }
        if let Some(fit) = &one.fit {
            sure(told, "  its values".into(), fit);
            let said = implausible(data, fit, one.id, false, true);
            said.iter().for_each(|why| told.words("  implausible", why));
        }
    }
    for one in &candidates {
        let rmse = one.fit.as_ref().map_or(before.rmse, |fit| fit.rmse);
        let cannot_be = |fit: &Fit| !implausible(data, fit, one.id, false, true).is_empty();
        all.push(Evidence {
            gain: one.gain,
            parameters: one.parameters,
            charged: one.parameters as f64,
            p_value: one.p_value,
            rmse,
            felt: 1.0 - (rmse / before.rmse).powi(2),
            doubt: 0.0,
            implausible: one.fit.as_ref().is_some_and(cannot_be),
            bent: 0,
        });
    }
    let judged = judge(&state, &all);
    told.words("complete", format!("{} {}", state.complete, state.exact));
    for one in sorted(&candidates) {
        let Some(at) = candidates.iter().position(|other| other.id == one.id) else { continue };
        let others: Vec<&str> = judged[at].equivalent.iter().map(|at| candidates[*at].id.info().id).collect();
        told.words(one.id.info().id, format!("{} {}", judged[at].word.id(), others.join(" ")));
    }
    candidates
}

/// The best sets of up to three of the likeliest candidates.
pub fn together(told: &mut Answers, data: &[&Signals], model: &Model, candidates: &[Candidate]) {
    let fitted = candidates.iter().filter_map(|one| Some((one.id, one.fit.as_ref()?.model.clone())));
    let pool: Vec<(Id, Model)> = fitted.take(5).collect();
    let found = sets(data, model, &pool, 3, &|_| true).unwrap();
    for set in found.iter().filter(|set| is_sure(&set.fit)).take(2) {
        let names: Vec<&str> = set.effects.iter().map(|id| id.info().id).collect();
        sure(told, format!("set {}", names.join(" ")), &set.fit);
    }
}

/// The whole way of captures through a model that lacks something: preparation, fit, where it fails, what is missing, and
/// the best candidate added.
pub fn all(
    told: &mut Answers,
    captures: &[&Prepared],
    base: &Model,
    detents: Detents,
    effects: Option<&[Id]>,
) {
    captures.iter().for_each(|one| prepared(told, one));
    let data: Vec<&Signals> = captures.iter().map(|one| &one.signals).collect();
    let before = fit(&data, base, detents).unwrap();
    fitted(told, "fit", &data, &before);
    floor(told, &data, &before.model);
    let beyond = located(told, &data, &before.model);
    let searched = effects.map_or_else(|| rigid(&before.model), <[Id]>::to_vec);
    let candidates = diagnosed(told, &data, &before, &beyond, &searched);
    together(told, &data, &before.model, &candidates);
    if let Some(best) = candidates.first().and_then(|one| one.fit.as_ref()) {
        let after = converge(&data, &best.model).unwrap();
        fitted(told, "with the best", &data, &after);
        sure(told, "refined".into(), &refine(&data, &best.model).unwrap());
        for split in locate(&data, &after.model) {
            told.numbers(format!("then along {}", split.axis), [split.share, split.part, split.chance]);
        }
    }
    let found = stiction(&data, &before.model);
    let estimates = [found.d_neg, found.d_pos, found.dv].into_iter().flatten();
    let numbers = estimates.flat_map(|one| [one.value, one.ci95[0], one.ci95[1]]);
    told.numbers("stiction", numbers.chain(found.breakaways.map(|n| n as f64)));
    match forward(&before.model, data[0], Some(0.1)) {
        Ok(along) => {
            told.column("forward", &along.theta);
            told.numbers("  starts", along.starts.iter().take(8).map(|at| *at as f64));
        }
        Err(why) => told.words("forward", why.to_string().split(" is ").next().unwrap_or_default()),
    }
}
