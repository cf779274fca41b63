//! Laws of a search for what is missing, whatever it is.

mod kept;
pub mod recorded;

use super::screen::{Screen, Start};
use super::watch::Watch;
use super::{diagnose, pairs, sets, worth_adding};
use crate::effects::{Id, Place, Survey};
use crate::fit::{refine, sketch, sketch_within};
use crate::model::{Model, Role};
use crate::rule::rule;
use crate::signals::Signals;
use recorded::{SD, knob, recorded};
use std::sync::Mutex;

const SPRING: (&str, f64) = ("return_spring.k", 2e-3);
const DRAG: (&str, f64) = ("quadratic_drag.d", 5e-4);

fn near(a: f64, b: f64, share: f64) -> bool {
    (a - b).abs() <= share * b.abs()
}

fn all_wanted() -> Watch<'static> {
    Watch::new(&|_| true, 1)
}

#[test]
fn a_survey_is_of_all_samples_that_count_and_of_no_others() {
    let model = knob(&[], &[("inertia.M", -3e-4)]);
    let [mut long, short] = [recorded(&model, "a"), recorded(&model, "bb")];
    // What does not count may be anything; a second capture is shorter and goes elsewhere.
    (long.theta[7], long.omega[7], long.tau_raw[7], long.weight[7]) = (99.0, 99.0, 99.0, 0.0);
    let half = |column: &[f64]| column[..2000].to_vec();
    let short = Signals {
        t: half(&short.t),
        theta: short.theta[..2000].iter().map(|theta| theta - 5.0).collect(),
        omega: half(&short.omega),
        alpha: half(&short.alpha),
        forward: half(&short.forward),
        omega_sd: half(&short.omega_sd),
        tau: half(&short.tau),
        tau_raw: half(&short.tau_raw),
        weight: half(&short.weight),
        segments: vec![0..2000; 1],
        ..short
    };
    let data = [&long, &short];
    let watch = all_wanted();
    let survey = Screen::new(&data, &model, &watch).survey;
    let counted = |of: &dyn Fn(&Signals) -> &Vec<f64>| -> Vec<f64> {
        let each = |one: &&Signals| {
            of(one).iter().zip(&one.weight).filter(|(_, w)| **w > 0.0).map(|(x, _)| *x).collect::<Vec<f64>>()
        };
        data.iter().flat_map(each).collect()
    };
    let columns = [
        (counted(&|s| &s.theta), &survey.theta),
        (counted(&|s| &s.omega).iter().map(|x| x.abs()).collect(), &survey.speed),
        (counted(&|s| &s.tau_raw).iter().map(|x| x.abs()).collect(), &survey.torque),
    ];
    for (values, quantiles) in columns {
        for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let at = Survey::quantile(quantiles, share);
            let below = values.iter().filter(|x| **x <= at).count() as f64 / values.len() as f64;
            assert!((below - share).abs() < 0.01, "{share}: {below}");
        }
        let ends = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of).unwrap());
        assert_eq!([quantiles[0], quantiles[quantiles.len() - 1]], ends);
    }
    assert_eq!((survey.duration_s, survey.rate_hz), (long.t[3999], long.rate_hz));
    assert_eq!((survey.inertia, survey.revolution), (3e-4, Some(1.0)));
}

#[test]
fn starts_are_in_the_order_of_what_they_promise_and_promise_no_more_than_there_is() {
    let truth = knob(&[Id::ReturnSpring, Id::FrictionDrift], &[SPRING, ("friction_drift.rise", 0.5)]);
    let data = [recorded(&truth, "a"), recorded(&truth, "bb")];
    let data = data.each_ref();
    let base = refine(&data, &knob(&[], &[])).unwrap().model;
    let watch = all_wanted();
    let screen = Screen::new(&data, &base, &watch);
    let mut several = 0;
    let promised = |starts: &[Start]| starts.iter().map(|start| start.predicted).collect::<Vec<f64>>();
    for &id in Id::BUILT_IN {
        let starts = screen.starts(id);
        several += usize::from(starts.len() > 1);
        assert!(starts.iter().all(|start| start.model.has(id)), "{id:?}");
        let squares = promised(&starts);
        assert!(squares.is_sorted(), "{id:?}");
        if id.info().place == Place::Load {
            assert!(squares.iter().all(|own| (0.0..1.001 * screen.squares).contains(own)), "{id:?}");
        }
        assert!(screen.at_shaft(id, &starts).is_empty(), "no joint, nothing before it");
        let apart = screen.apart(id, &starts);
        assert!(apart.iter().all(|start| start.model.is_apart(id)), "{id:?}");
        if let (Some(shared), Some(own)) = (squares.first(), apart.first()) {
            assert!(own.predicted <= shared * 1.000_001, "{id:?}: what is free for more runs fits better");
        }
    }
    assert!(several > 5);
}

#[test]
fn a_joint_begins_with_an_inertia_that_a_knob_can_have_however_it_bent_the_one_that_is_seen() {
    let watch = all_wanted();
    for inertia in [2e-4, -2e-4] {
        let model = knob(&[], &[("inertia.M", inertia)]);
        let data = recorded(&model, "a");
        let data = [&data];
        let starts = Screen::new(&data, &model, &watch).starts(Id::Compliance);
        let value = |model: &Model| model.values()[model.inertia().unwrap()];
        let mut seen: Vec<f64> = starts.iter().map(|start| value(&start.model)).collect();
        seen.sort_by(f64::total_cmp);
        seen.dedup();
        let expected = if inertia > 0.0 { vec![2e-4] } else { vec![2e-4, 6e-4] };
        assert!(seen.len() == expected.len(), "{seen:?}");
        assert!(seen.iter().zip(expected).all(|(a, b)| near(*a, b, 1e-9)), "{seen:?}");
    }
}

#[test]
fn of_a_pool_the_set_is_told_that_explains_most_for_its_parameters() {
    let truth = knob(&[Id::ReturnSpring, Id::QuadraticDrag], &[SPRING, DRAG]);
    let data = recorded(&truth, "a");
    let data = [&data];
    let base = refine(&data, &knob(&[], &[])).unwrap().model;
    let pool: Vec<(Id, Model)> = [Id::ReturnSpring, Id::Offset, Id::QuadraticDrag]
        .into_iter()
        .map(|id| {
            let model = base.with(id).unwrap();
            let found = sketch(&data, &model);
            let mut model = model;
            model.set_values(&found.p);
            (id, model)
        })
        .collect();
    let told = |most: usize| sets(&data, &base, &pool, most, &|_| true).unwrap();
    let best = told(3);
    assert_eq!(best[0].effects, [Id::ReturnSpring, Id::QuadraticDrag], "an offset is not worth its price");
    assert!(near(best[0].fit.rmse, best[0].fit.noise_floor, 0.06));
    assert_eq!(best[1].effects, [Id::ReturnSpring, Id::Offset, Id::QuadraticDrag], "the next best has it");
    assert!(told(1).iter().all(|set| set.effects.len() == 1));
    let alone = told(1)[0].fit.rmse;
    assert!(best[0].fit.rmse < 0.95 * alone && told(2)[0].effects == best[0].effects);
}

#[test]
fn who_waits_is_told_how_far_it_is_and_may_end_it() {
    let data = recorded(&knob(&[Id::ReturnSpring], &[SPRING]), "a");
    let data = [&data];
    let base = refine(&data, &knob(&[], &[])).unwrap().model;
    let effects = [Id::ReturnSpring, Id::QuadraticDrag, Id::FrictionDrift, Id::Compliance];
    let told = Mutex::new(Vec::new());
    let tell = |share: f64| {
        told.lock().unwrap().push(share);
        true
    };
    diagnose(&data, &base, &effects, &tell).unwrap();
    pairs(&data, &base, &effects[..2], &tell).unwrap();
    let told = told.into_inner().unwrap();
    assert!(told.iter().all(|share| (0.0..=1.0).contains(share)), "{told:?}");
    assert_eq!(told[0], 0.0);
    let unwanted = |_: f64| false;
    assert!(diagnose(&data, &base, &effects, &unwanted).is_none());
    assert!(pairs(&data, &base, &effects, &unwanted).is_none());
    assert!(sets(&data, &base, &[(Id::Offset, base.with(Id::Offset).unwrap())], 1, &unwanted).is_none());
}

#[test]
fn what_a_candidate_takes_off_is_in_variances_of_the_noise_and_has_its_chance() {
    let data = recorded(&knob(&[Id::ReturnSpring], &[SPRING]), "a");
    let data = [&data];
    let before = refine(&data, &knob(&[], &[])).unwrap();
    let named = diagnose(&data, &before.model, &[Id::QuadraticDrag, Id::ReturnSpring], &|_| true).unwrap();
    let [spring, drag] = &named[..] else { panic!("two were asked for") };
    assert_eq!((spring.id, drag.id), (Id::ReturnSpring, Id::QuadraticDrag), "best first");
    let fit = spring.fit.as_ref().unwrap();
    let squares = 4000.0 * (before.rmse.powi(2) - fit.rmse.powi(2));
    let white = fit.noise_floor.powi(2);
    assert!(near(spring.gain, squares / white, 0.05), "{} {}", spring.gain, squares / white);
    assert_eq!(spring.p_value, 1e-3, "of 999 captures none has as much");
    assert!(drag.p_value > spring.p_value && drag.gain < 0.1 * spring.gain, "{} {}", drag.p_value, drag.gain);
    let free = |model: &Model| model.slots().iter().filter(|slot| slot.role == Role::Free).count();
    assert_eq!(spring.parameters, free(&fit.model) - free(&before.model));
    assert!(
        spring.note.is_empty() && near(fit.model.values()[fit.model.index(SPRING.0).unwrap()], SPRING.1, 0.1)
    );
}

#[test]
fn beside_a_joint_what_is_missing_is_found_and_what_explains_too_little_is_not_followed() {
    let joint = [("compliance.k", 3.0), ("compliance.d", 5e-3), ("compliance.share", 0.7)];
    let base = knob(&[Id::Compliance], &joint);
    let mut truth = base.with(Id::ReturnSpring).unwrap();
    truth.set("return_spring.k", 0.02).unwrap();
    let data = recorded(&truth, "a");
    let data = [&data];
    let before = refine(&data, &base).unwrap();
    let effects = [Id::QuadraticDrag, Id::Stribeck, Id::ReturnSpring];
    let named = diagnose(&data, &before.model, &effects, &|_| true).unwrap();
    let (best, others) = (&named[0], &named[1..]);
    let fit = best.fit.as_ref().unwrap();
    assert!(best.id == Id::ReturnSpring && best.p_value == 1e-3 && others.len() == 2);
    assert!(fit.rmse < 1.1 * fit.noise_floor && before.rmse > 2.0 * fit.rmse, "{}", fit.rmse);
    assert!(near(fit.model.values()[fit.model.index("return_spring.k").unwrap()], 0.02, 0.05));
    for other in others {
        assert!(other.fit.is_none() && other.note.contains("explains too little"), "{:?}", other.id);
        assert!(other.gain == 0.0 && other.p_value == 1.0 && other.parameters > 0, "{:?}", other.id);
    }
}

#[test]
fn waves_behind_a_joint_are_those_of_the_detents_that_are_there_and_not_of_ones_twice_as_wide() {
    let joint = [("compliance.k", 0.5), ("compliance.d", 4e-4), ("compliance.share", 0.65)];
    let detents = [("detent.A", 5e-3), ("detent.P", 0.06), ("detent.S", 1.0)];
    let base = knob(&[Id::Compliance, Id::Detent], &[joint, detents].concat());
    let mut truth = base.with(Id::DetentHarmonics).unwrap();
    for (name, value) in [("A2", 4e-3), ("S2", 0.5), ("A3", 2e-3), ("S3", -1.0), ("A4", 6e-4)] {
        truth.set(&format!("detent_harmonics.{name}"), value).unwrap();
    }
    let signals = recorded(&truth, "a");
    let data = [&signals];
    let before = refine(&data, &base).unwrap();
    let found = diagnose(&data, &before.model, &[Id::DetentHarmonics, Id::SecondDetent], &|_| true).unwrap();
    let fit = found.iter().find(|one| one.id == Id::DetentHarmonics).unwrap().fit.as_ref().unwrap();
    let period = fit.model.values()[fit.model.index("detent.P").unwrap()];
    assert!(fit.rmse < 1.05 * fit.noise_floor && near(period, 0.06, 0.02), "{period} {}", fit.rmse);
}

#[test]
fn an_effect_that_is_asked_for_alone_is_fitted_beside_a_joint_however_little_it_explains() {
    let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
    let truth = knob(&[Id::Compliance], &joint);
    let signals = recorded(&truth, "fifth");
    let data = [&signals];
    let base = refine(&data, &truth).unwrap();
    let found = diagnose(&data, &base.model, &[Id::ReturnSpring], &|_| true).unwrap();
    let fit = found[0].fit.as_ref().unwrap();
    assert!(found[0].p_value > 0.05 && (fit.rmse / base.rmse - 1.0).abs() < 0.01);
}

#[test]
fn of_an_error_that_chance_explains_what_promises_too_little_is_not_fitted_for_who_looks_for_what_to_add() {
    let effects = [Id::QuadraticDrag, Id::Stribeck, Id::ReturnSpring];
    // What a spring takes off the squared error: nothing, and more than the least that is named.
    for (k, fitted) in [(0.0, false), (1.8e-4, true)] {
        let data = recorded(&knob(&[Id::ReturnSpring], &[("return_spring.k", k)]), "a");
        let data = [&data];
        let base = refine(&data, &knob(&[], &[])).unwrap();
        assert!(base.rmse < rule().at_floor * base.noise_floor, "{}", base.rmse / base.noise_floor);
        let found = worth_adding(&data, &base.model, &effects, &|_| true).unwrap();
        let all = diagnose(&data, &base.model, &effects, &|_| true).unwrap();
        assert!(all.iter().all(|one| one.fit.is_some()));
        assert!(!found.iter().any(|one| one.fit.is_some() && one.id != Id::ReturnSpring));
        let [spring, same] =
            [&found, &all].map(|of| of.iter().find(|one| one.id == Id::ReturnSpring).unwrap());
        assert_eq!(spring.fit.is_some(), fitted, "{k}: {}", same.gain);
        if fitted {
            assert_eq!((spring.gain, spring.p_value), (same.gain, same.p_value));
        } else {
            assert!(spring.p_value == 1.0 && spring.note.contains("explains too little"));
        }
    }
}

#[test]
fn what_is_said_to_load_the_shaft_does_so_wherever_a_joint_comes_in() {
    let model = knob(&[Id::ReturnSpring], &[SPRING]);
    let data = recorded(&model, "a");
    let data = [&data];
    let watch = all_wanted();
    for shaft in [vec![], vec![Id::ReturnSpring]] {
        let there = !shaft.is_empty();
        let screen = Screen::new(&data, &model, &watch).with_shaft(shaft);
        let starts = screen.starts(Id::Compliance);
        assert!(!starts.is_empty());
        assert!(starts.iter().all(|start| start.model.at_shaft(Id::ReturnSpring) == there));
        assert!(!screen.starts(Id::QuadraticDrag)[0].model.at_shaft(Id::ReturnSpring));
    }
}

#[test]
fn a_rival_that_comes_nowhere_near_is_given_up_and_one_that_does_is_not() {
    let joint = [("compliance.k", 0.3), ("compliance.d", 2e-3), ("compliance.share", 0.7)];
    let truth =
        knob(&[Id::Compliance, Id::ReturnSpring], &[&joint[..], &[("return_spring.k", 0.1)]].concat());
    let signals = recorded(&truth, "a");
    let data = [&signals];
    let near = [("compliance.k", 0.4), ("compliance.d", 3e-3), ("compliance.share", 0.6)];
    let followed = |rival: Id, within: f64| {
        let found = sketch_within(&data, &knob(&[Id::Compliance, rival], &near), within);
        ((found.cost / signals.used() as f64).sqrt(), found.evaluations)
    };
    let right = followed(Id::ReturnSpring, 2.0 * SD);
    assert_eq!(right, followed(Id::ReturnSpring, f64::INFINITY));
    assert!(right.0 < 1.1 * SD, "{right:?}");
    for wrong in [Id::PositionFriction, Id::Presliding] {
        let (given_up, whole) = (followed(wrong, 2.0 * SD), followed(wrong, f64::INFINITY));
        assert!(whole.0 > 2.0 * SD && given_up.0 > 2.0 * SD, "{wrong:?} {given_up:?} {whole:?}");
        assert!(3 * given_up.1 < 2 * whole.1, "{wrong:?} {given_up:?} {whole:?}");
    }
}
