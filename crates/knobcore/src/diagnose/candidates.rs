//! Every absent effect, fitted: what would each take off the error?

use super::beside::beside;
use super::candidate::Candidate;
use super::chance::Chance;
use super::coupled::{Ways, coupled};
use super::elsewhere::lead_by_its_own_values;
use super::null::Null;
use super::screen::{Screen, Start};
use super::shown::{detents, may_come, needed};
use super::watch::{Tell, Watch};
use crate::effects::{Id, Place};
use crate::fit::{Found, differ, report, sketch};
use crate::floor::{Floor, noises};
use crate::model::{Model, Role, Slot};
use crate::noise::Noise;
use crate::order::descending;
use crate::rule::rule;
use crate::signals::Signals;

/// Starts of an effect that are followed to their optimum.
const FOLLOWED: usize = 3;

/// Fits each of the `effects` beside a fitted model; best first. None if `tell` no longer wanted it.
///
/// Couplings take by far the longest. They are left for last, and tried only where all others leave something.
pub fn diagnose(data: &[&Signals], model: &Model, effects: &[Id], tell: &Tell<'_>) -> Option<Vec<Candidate>> {
    weigh(data, model, effects, tell, false)
}

/// The same for who looks for what to add to a model whose error chance explains: nothing is said of effects that explain
/// too little of it to be named.
pub fn worth_adding(
    data: &[&Signals],
    model: &Model,
    effects: &[Id],
    tell: &Tell<'_>,
) -> Option<Vec<Candidate>> {
    weigh(data, model, effects, tell, true)
}

fn weigh(
    data: &[&Signals],
    model: &Model,
    effects: &[Id],
    tell: &Tell<'_>,
    worth: bool,
) -> Option<Vec<Candidate>> {
    let watch = Watch::new(tell, effects.len());
    let mut screen = Screen::new(data, model, &watch);
    let noises = noises(data, model);
    let floor = Floor::with(data, &noises);
    screen.explained = worth;
    let white = if floor.white > 0.0 { floor.white } else { screen.squares.max(f64::MIN_POSITIVE) * 1e-12 };
    let noises: Vec<Noise> = noises.into_iter().map(|noise| noise.unwrap_or(Noise::white(white))).collect();
    screen.chance = Some(Chance::of(data, &noises, &screen.thinned));
    let (slow, quick): (Vec<Id>, Vec<Id>) = effects.iter().partition(|id| id.info().place == Place::Coupling);
    let may_come = may_come(model, effects);
    // Beside a coupling each step takes long; what several runs have apart is not looked at in steps.
    let told = |Ways { id, starts, end }| {
        watch.step();
        (candidate(&screen, id, &starts, end, white), starts)
    };
    let mut found: Vec<(Candidate, Vec<Start>)> = if screen.coupled && data.len() == 1 {
        beside(&screen, &quick, floor.squares).into_iter().map(told).collect()
    } else {
        weighed(&screen, &quick, [white, floor.squares])
    };
    lead_by_its_own_values(&screen, &mut found, [white, floor.squares]);
    let best = found.iter().fold(0.0, |best: f64, (candidate, _)| best.max(candidate.gain));
    let paid = found.iter().any(|(candidate, _)| candidate.worth() > 0.0);
    let left = screen.squares - best * white;
    let most = best * white >= rule().enough * (screen.squares - floor.squares);
    // Of a little that is missing, what looks like it alone explains the better part of it; where nothing does,
    // nothing is named in a coupling's place.
    let (excess, rest) = (screen.squares - floor.squares, left - floor.squares);
    let better = excess <= rule().slight * floor.squares || rest <= rule().better * excess || !paid;
    let explained = left <= rule().explained * floor.squares && better || most;
    // Who asks for couplings alone wants to know.
    let asked = quick.is_empty() || left.is_nan() || floor.squares.is_nan() || !explained;
    let rival = if asked { None } else { like_a_joint(&found, &slow) };
    if let Some(rival) = rival {
        // It may be one, which then explains more.
        let joints = coupled(&screen, &slow, false, Some(&rival)).into_iter().map(told);
        found.extend(joints.filter(|(joint, _)| joint.fit.is_some()));
    }
    if asked && !slow.is_empty() {
        let joints: Vec<_> = coupled(&screen, &slow, may_come, None).into_iter().map(told).collect();
        let own = detents().filter(|own| !joints.is_empty() && !model.has(*own));
        let known = found.iter().map(|(one, _)| one).find(|one| Some(one.id) == own).cloned();
        // Who asks for a joint alone gets one without detents rather than none.
        let alone = own.filter(|_| quick.is_empty());
        let rigid = known.or_else(|| Some(fitted(&screen, alone?, [white, floor.squares]).0));
        let mut joints: Vec<_> =
            joints.into_iter().map(|(joint, starts)| (needed(joint, rigid.as_ref()), starts)).collect();
        if alone.is_some() && joints.iter().all(|(joint, _)| joint.fit.is_none()) {
            joints = coupled(&screen, &slow, false, None).into_iter().map(told).collect();
        }
        found.extend(joints);
    }
    found.sort_by_cached_key(|(candidate, _)| candidate.id);
    let named = |one: &Candidate| !screen.explained || one.gain * white >= rule().worth * screen.squares;
    if !found.iter().any(|(one, _)| one.fit.is_some() && named(one)) {
        // What chance does is asked beside what could be named.
        return watch.wanted().then(|| found.into_iter().map(|(candidate, _)| candidate.unnamed()).collect());
    }
    let null = Null::of(
        &screen,
        &noises,
        white,
        found.iter().map(|(candidate, starts)| (candidate.id, &starts[..])),
    );
    if !watch.wanted() {
        return None;
    }
    let mut candidates: Vec<Candidate> = found
        .into_iter()
        .map(|(candidate, _)| Candidate { p_value: null.p_value(candidate.id, candidate.gain), ..candidate })
        .collect();
    candidates.sort_by_cached_key(|one| descending(one.gain));
    Some(candidates)
}

/// The model with what explains most, where that looks like one of these joints.
fn like_a_joint(found: &[(Candidate, Vec<Start>)], joints: &[Id]) -> Option<Model> {
    let (best, _) = found.iter().max_by(|(a, _), (b, _)| a.worth().total_cmp(&b.worth()))?;
    let alike = |id: &Id| id.info().confused.contains(&best.id.info().id);
    Some(best.fit.as_ref().filter(|_| joints.iter().any(alike))?.model.clone())
}

/// Fits effects beside the screen's model. `noise` is the variance of its white part, and what it leaves of the sum of
/// squares.
fn weighed(screen: &Screen<'_>, effects: &[Id], noise: [f64; 2]) -> Vec<(Candidate, Vec<Start>)> {
    screen.watch.each(effects, |id| {
        let result = fitted(screen, *id, noise);
        screen.watch.step();
        result
    })
}

/// An effect fitted beside the screen's model, and the starts that it had.
fn fitted(screen: &Screen<'_>, id: Id, [white, floor]: [f64; 2]) -> (Candidate, Vec<Start>) {
    let mut starts = screen.starts(id);
    let apart = screen.apart(id, &starts);
    let mut before = screen.at_shaft(id, &starts);
    // Of what loads the shaft the first step tells nearly all.
    before
        .retain(|start| screen.squares - start.predicted >= rule().worth_at_shaft * (screen.squares - floor));
    // Which of both it loads is told by less than the floor is known to: both are followed.
    let ends = [&before, &starts].into_iter().filter_map(|starts| followed(screen, id, starts));
    let shared = ends.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    // Each run's own parameters have their price like any others, and have to differ beyond chance.
    let priced =
        |(model, found): &(Model, Found)| found.cost + rule().price * white * added(screen, model) as f64;
    let own = followed(screen, id, &apart)
        .filter(|own| shared.as_ref().is_none_or(|shared| priced(own) < priced(shared)))
        .filter(|(model, found)| report(screen.data, model, found.clone()).is_ok_and(|fit| differ(&fit, id)));
    let end = own.or(shared);
    starts.extend(apart);
    (candidate(screen, id, &starts, end, white), starts)
}

/// Where the best of some starts leads to.
fn followed(screen: &Screen<'_>, id: Id, starts: &[Start]) -> Option<(Model, Found)> {
    let best_predicted = screen.squares - starts.first()?.predicted;
    // Beside a coupling each step takes long.
    let most = if screen.coupled { 1 } else { FOLLOWED };
    let least =
        if screen.coupled || screen.explained { rule().worth_following * screen.squares } else { 0.0 };
    // The starts of what changes the detents are of other periods: which is right the first step cannot tell.
    let rival = if id.info().needs.is_some() { 0.3 * rule().rival_start } else { rule().rival_start };
    let worth = |start: &&Start| {
        let predicted = screen.squares - start.predicted;
        predicted >= least && (screen.has_own(id, start) || predicted >= rival * best_predicted)
    };
    let ends = starts.iter().take(most).filter(worth).take_while(|_| screen.watch.wanted());
    let ends = ends.map(|start| (start.model.clone(), sketch(screen.data, &start.model)));
    ends.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))
}

/// Free parameters that a model with an effect has more: the effect's own, those of runs, and what came with it.
fn added(screen: &Screen<'_>, model: &Model) -> usize {
    let more = |slot: &&Slot| screen.model.index(&slot.name()).is_err();
    model.slots().iter().filter(more).filter(|slot| slot.role == Role::Free).count()
}

fn candidate(
    screen: &Screen<'_>,
    id: Id,
    starts: &[Start],
    end: Option<(Model, Found)>,
    white: f64,
) -> Candidate {
    let ended = end.as_ref().map(|(model, _)| model);
    let parameters =
        ended.or(starts.first().map(|start| &start.model)).map_or(0, |model| added(screen, model));
    let failed = |note: String| Candidate { id, fit: None, gain: 0.0, parameters, p_value: 1.0, note };
    let Some((model, found)) = end else {
        return failed("does not go with this model, or explains too little of it to be followed".into());
    };
    if let Id::User(user) = id
        && let Some(why) = user.failure()
    {
        return failed(format!("it {why}"));
    }
    let gain = (screen.squares - found.cost) / white;
    match report(screen.data, &model, found) {
        Ok(fit) => Candidate { id, fit: Some(fit), gain, parameters, p_value: 1.0, note: String::new() },
        Err(why) => failed(why.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{SD, knob, recorded};
    use super::*;
    use crate::fit::{refine, runs};
    use crate::predict;

    #[test]
    fn a_richer_model_has_as_many_parameters_more_as_it_has() {
        let data = [recorded(&knob(&[], &[]), "a"), recorded(&knob(&[], &[]), "bb")];
        let data = data.each_ref();
        let named = runs(&data);
        let watch = Watch::new(&|_| true, 1);
        let of_runs = |id: &Id| id.info().params.iter().any(|param| param.of_a_run);
        let own: Vec<Id> = Id::BUILT_IN.iter().copied().filter(of_runs).collect();
        let bare = knob(&[], &[]);
        let apart = own.iter().filter_map(|id| bare.with(*id).ok()?.apart(*id, &named));
        let bases: Vec<Model> = std::iter::once(bare.clone()).chain(apart).collect();
        assert!(bases.len() > 1);
        for base in &bases {
            let screen = Screen::new(&data, base, &watch);
            for &id in Id::BUILT_IN {
                let Ok(with) = base.with(id) else { continue };
                assert_eq!(added(&screen, &with), with.free().count() - base.free().count(), "{id:?}");
                if let Some(apart) = with.apart(id, &named) {
                    assert_eq!(
                        added(&screen, &apart),
                        apart.free().count() - base.free().count(),
                        "{id:?} apart"
                    );
                }
            }
        }
    }

    #[test]
    fn what_loads_the_shaft_before_a_joint_is_found_there_and_what_loads_the_knob_behind_it() {
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let base = knob(&[Id::Compliance], &joint);
        for at_shaft in [false, true] {
            let mut truth = base.with(Id::ReturnSpring).unwrap();
            truth.set("return_spring.k", 0.1).unwrap();
            let truth = if at_shaft { truth.with_at_shaft(Id::ReturnSpring).unwrap() } else { truth };
            let data = recorded(&truth, "a");
            let data = [&data];
            // Beside the joint as it is: one that was fitted without the spring is bent to all shapes.
            let watch = Watch::new(&|_| true, 1);
            let screen = Screen::new(&data, &base, &watch);
            let noise = [SD * SD, SD * SD * data[0].used() as f64];
            let model = fitted(&screen, Id::ReturnSpring, noise).0.fit.unwrap().model;
            assert_eq!(model.at_shaft(Id::ReturnSpring), at_shaft);
            assert!((model.values()[model.index("return_spring.k").unwrap()] - 0.1).abs() < 0.003);
        }
    }

    #[test]
    fn the_harmonics_of_few_detents_are_looked_for_over_the_detents_that_were_found_too() {
        let theta = recorded(&knob(&[], &[]), "a").theta;
        let ends = [f64::min, f64::max].map(|of| theta.iter().copied().reduce(of).unwrap());
        let period = (ends[1] - ends[0]) / (2.3 * std::f64::consts::TAU);
        let detents = [
            ("detent.A", 0.0218),
            ("detent.P", period),
            ("detent.S", 0.51),
            ("detent_harmonics.A2", 0.014),
            ("detent_harmonics.S2", 1.4),
            ("detent_harmonics.A3", 0.003),
            ("detent_harmonics.S3", 0.4),
        ];
        let data = recorded(&knob(&[Id::Detent, Id::DetentHarmonics], &detents), "a");
        let data = [&data];
        let base = refine(&data, &knob(&[Id::Detent], &detents[..3])).unwrap().model;
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &base, &watch);
        let noise = [SD * SD, SD * SD * data[0].used() as f64];
        let model = fitted(&screen, Id::DetentHarmonics, noise).0.fit.unwrap().model;
        let found = model.values()[model.period().unwrap()];
        assert!((found / period - 1.0).abs() < 0.01, "{found} {period}");
    }

    #[test]
    fn of_two_stops_each_is_found_however_far_the_other_is_pressed() {
        let theta = recorded(&knob(&[], &[]), "a").theta;
        let [low, high] = [f64::min, f64::max].map(|of| theta.iter().copied().reduce(of).unwrap());
        let range = high - low;
        for [lower, upper] in [[0.3, 0.03], [0.03, 0.3]] {
            let ends = [low + lower * range, high - upper * range];
            let stops = [("end_stop.k_lo", 0.05), ("end_stop.lo", ends[0])];
            let truth =
                knob(&[Id::EndStop], &[stops, [("end_stop.k_hi", 0.05), ("end_stop.hi", ends[1])]].concat());
            let data = recorded(&truth, "a");
            let data = [&data];
            let base = refine(&data, &knob(&[], &[])).unwrap().model;
            let watch = Watch::new(&|_| true, 1);
            let screen = Screen::new(&data, &base, &watch);
            let noise = [SD * SD, SD * SD * data[0].used() as f64];
            let model = fitted(&screen, Id::EndStop, noise).0.fit.unwrap().model;
            for (name, end) in ["end_stop.lo", "end_stop.hi"].into_iter().zip(ends) {
                let found = model.values()[model.index(name).unwrap()];
                assert!((found - end).abs() < 0.01 * range, "{name}: {found} {end}");
            }
        }
    }

    #[test]
    fn along_the_hidden_knobs_motion_its_loads_alone_leave_the_same_error() {
        let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
        let model = knob(&[Id::Compliance], &joint);
        let mut truth = model.with(Id::ReturnSpring).unwrap();
        truth.set("return_spring.k", 0.1).unwrap();
        let signals = recorded(&truth, "a");
        let data = [&signals];
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &model, &watch);
        let hidden = screen.seen_by(Id::ReturnSpring, &truth)[0];
        let loads: Vec<Id> = model.effects().filter(|id| *id != Id::Compliance).collect();
        let loads = predict::torque(&model.only(&loads).unwrap(), hidden);
        let joined = predict::torque(&model, &signals);
        for at in 0..signals.len() {
            let [rigid, whole] = [hidden.tau[at] - loads[at], signals.tau[at] - joined[at]];
            assert!((rigid - whole).abs() < 1e-12, "{at}: {rigid} {whole}");
            assert_eq!(hidden.forward[at] > 0.5, hidden.omega[at] > 0.0);
        }
        let lag = signals.theta.iter().zip(&hidden.theta).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(lag > 0.01, "the knob goes another way: {lag}");
        let at_shaft = truth.with_at_shaft(Id::ReturnSpring).unwrap();
        assert_eq!(screen.seen_by(Id::ReturnSpring, &at_shaft)[0].theta, signals.theta);
    }

    /// What is named beside a knob that has none of these.
    fn named(truth: &[(&str, f64)], effects: &[Id]) -> Vec<Candidate> {
        let known = |name: &str| *Id::BUILT_IN.iter().find(|id| name.starts_with(id.info().id)).unwrap();
        let mut own: Vec<Id> = truth.iter().map(|(name, _)| known(name)).collect();
        own.dedup();
        let signals = recorded(&knob(&own, truth), "fifth");
        let base = refine(&[&signals], &knob(&[], &[])).unwrap().model;
        diagnose(&[&signals], &base, effects, &|_| true).unwrap()
    }

    #[test]
    fn friction_that_builds_up_over_most_of_the_way_is_found_though_none_is_left_without_it() {
        let truth = [("presliding.s", 1.0), ("presliding.w1", 0.5), ("presliding.w2", 0.5)];
        let found = &named(&truth, &[Id::Presliding])[0];
        let fit = found.fit.as_ref().unwrap();
        assert!(fit.rmse < 1.05 * SD, "{}", fit.rmse / SD);
    }

    #[test]
    fn a_joint_is_looked_for_where_nothing_else_explains_what_is_left_and_nowhere_else() {
        const TRIED: [Id; 2] = [Id::QuadraticDrag, Id::Compliance];
        let looked = |truth: &[(&str, f64)]| {
            let found = named(truth, &TRIED);
            found.iter().any(|one| one.id == Id::Compliance)
        };
        assert_eq!(named(&[("compliance.k", 0.3), ("compliance.d", 2e-3)], &TRIED)[0].id, Id::Compliance);
        // Nothing is missing, or drag alone.
        assert!(!looked(&[]) && !looked(&[("quadratic_drag.d", 5e-4)]));
        // Of much that is missing drag leaves a little, but more than noise would be; of little the better part.
        assert!(looked(&[("quadratic_drag.d", 3e-4), ("unbalance.a", 1.5e-3)]));
        assert!(looked(&[("quadratic_drag.d", 1.6e-4), ("unbalance.a", 4e-4)]));
        // Of more it leaves no more than that, and not the better part of it.
        assert!(!looked(&[("quadratic_drag.d", 4e-4), ("unbalance.a", 3e-4)]));
    }
}
