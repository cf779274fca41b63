//! What holds of every effect of the catalogue.

use super::*;
use knobcore::motion::{Channel, Load};

/// No joint is rigid, and what passes through surfaces that knock is its mean over a sample: the stiffest may differ by
/// this share of the torque, which the samples at a reversal make.
const RIGID: f64 = 2e-2;

/// What an effect asks at one instant.
fn loaded(id: Id, p: &[f64], state: &mut [f64], motion: &Motion<f64>) -> Load<f64> {
    let mut load = Load::none();
    id.law().load(p, state, motion, &mut load);
    load
}

#[test]
fn an_effect_at_its_neutral_values_changes_nothing() {
    for &id in Id::BUILT_IN {
        let (without, with) = if knob().has(id) {
            (torque(&Model::new(&[], Axis::Rotary)), torque(&Model::new(&[id], Axis::Rotary)))
        } else {
            (torque(&knob()), torque(&knob_with(id)))
        };
        let allowed = if is_joint(id) { RIGID * rms(without.tau.iter().copied()) } else { 0.0 };
        let apart = apart(&with, &without);
        assert!(apart <= allowed, "{} changes the torque by {apart} N m", name(id));
    }
}

#[test]
fn every_effect_says_what_it_is_where_it_comes_from_and_what_helps() {
    for &id in Id::BUILT_IN {
        let words = &id.info().words;
        let phrases = [words.causes, words.remedies];
        assert!(phrases.iter().all(|list| !list.is_empty()), "{}", name(id));
        let said = phrases.concat().into_iter().chain([words.name, words.about, words.latex]);
        assert!(said.into_iter().all(|text| !text.trim().is_empty()), "{}", name(id));
        let open = |mark: char| words.latex.matches(mark).count();
        assert_eq!(open('{'), open('}'), "{}: {}", name(id), words.latex);
        let sentence = words.about;
        assert!(
            sentence.starts_with(char::is_uppercase) && sentence.ends_with('.'),
            "{}: {sentence}",
            name(id)
        );
        assert!(words.name != id.info().id && words.name.len() < 60, "{}: {}", name(id), words.name);
    }
}

#[test]
fn names_for_people_tell_the_effects_apart() {
    let mut names: Vec<_> = Id::BUILT_IN.iter().map(|id| id.info().words.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Id::BUILT_IN.len());
}

#[test]
fn what_an_effect_says_of_others_names_some_that_there_are() {
    let known = |parameter: &str| {
        let (effect, own) = parameter.split_once('.').unwrap();
        Id::parse(effect).is_ok_and(|id| id.info().params.iter().any(|param| param.name == own))
    };
    for &id in Id::BUILT_IN {
        let info = id.info();
        let others = info.confused.iter().copied().chain(info.needs);
        assert!(others.into_iter().all(|other| Id::parse(other).is_ok()), "{}", name(id));
        assert!(info.taken_up.is_none_or(|by| by.by.iter().all(|own| known(own))), "{}", name(id));
        assert!(info.slower.is_empty() || info.needs.is_some(), "{} follows no period", name(id));
    }
}

#[test]
fn resistance_static_friction_inertia_and_stick_band_are_never_negative() {
    let mut noise = Noise::new(1);
    for &id in Id::BUILT_IN {
        for _ in 0..5 {
            let p = plausible(id, &mut noise);
            let mut state = vec![0.0; id.law().states()];
            for i in (0..CYCLE).step_by(7) {
                let load = loaded(id, &p, &mut state, &motion(i as f64 / RATE_HZ));
                let least = [load.resist, load.hold].concat().into_iter().chain([
                    load.inertia,
                    load.band,
                    load.friction_scale,
                ]);
                assert!(least.into_iter().all(|x| x >= 0.0), "{}: {load:?}", name(id));
            }
        }
    }
}

#[test]
fn a_load_touches_no_channel_that_it_does_not_name() {
    let mut noise = Noise::new(5);
    let channels = |load: Load<f64>| {
        let [back, forth] = load.resist;
        let held = load.hold[0] + load.hold[1] + load.band;
        [
            load.drive,
            load.inertia,
            back,
            forth,
            load.friction_scale,
            load.hysteresis,
            load.normal_load,
            load.position_load,
            load.mu,
            load.position_share,
            load.inertia_share,
            held,
        ]
    };
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Load) {
        let (touched, mut moved) = (Channel::among(id.info().touches), [false; Channel::ALL.len()]);
        for _ in 0..5 {
            let p = plausible(id, &mut noise);
            let mut state = vec![0.0; id.law().states()];
            for i in (0..CYCLE).step_by(3) {
                let load = channels(loaded(id, &p, &mut state, &motion(i as f64 / RATE_HZ)));
                let silent = channels(Load::none());
                (0..load.len()).for_each(|c| moved[c] |= load[c] != silent[c]);
            }
        }
        assert_eq!(touched, moved, "{}", name(id));
    }
}

#[test]
fn a_load_that_says_it_is_steady_is_the_same_in_every_motion_and_no_other_is() {
    let mut noise = Noise::new(8);
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Load) {
        let mut steady = true;
        for _ in 0..5 {
            let p = plausible(id, &mut noise);
            let mut state = vec![0.0; id.law().states()];
            let mut at = |i: usize| format!("{:?}", loaded(id, &p, &mut state, &motion(i as f64 / RATE_HZ)));
            let first = at(0);
            steady &= (3..CYCLE).step_by(3).all(|i| at(i) == first);
        }
        assert_eq!(id.info().steady, steady, "{}", name(id));
    }
}

#[test]
fn sample_by_sample_is_what_whole_stretches_are_to_the_last_bit() {
    let mut noise = Noise::new(2);
    // A joint needs the motion before and after; a sensor is no part of a load.
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Load) {
        let model = plausible_knob(id, &mut noise);
        let whole = torque(&model);
        let p = model.values();
        let mut state = vec![0.0; model.states()];
        for (i, expected) in whole.tau.iter().enumerate() {
            let motion = whole.motion(i);
            let tau = model.load(&p, &mut state, &motion).sliding(&motion);
            assert_eq!(tau.to_bits(), expected.to_bits(), "{} at {i}: {tau} {expected}", name(id));
        }
    }
}

#[test]
fn no_effect_gives_energy_over_a_closed_cycle() {
    let mut noise = Noise::new(3);
    // A sensor moves no knob. What only changes another effect gives or takes energy beside that one alone.
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place != Place::Sensor) {
        let alone = id.info().needs.is_none() && !is_joint(id);
        let p = plausible(id, &mut noise);
        let model = if alone { Model::new(&[id], Axis::Rotary) } else { knob_with(id) };
        let torque = torque(&at(model, id, &p));
        let power = || torque.tau.iter().zip(&torque.omega).skip(CYCLE).map(|(tau, omega)| tau * omega);
        let (work, scale): (f64, f64) = (power().sum(), power().map(f64::abs).sum());
        assert!(work >= -1e-3 * scale, "{} gives {} of what it moves", name(id), -work / scale);
    }
}

#[test]
fn only_what_remembers_keeps_anything_from_sample_to_sample() {
    let still = signals(|_| 0.0);
    for &id in Id::BUILT_IN {
        let model = knob_with(id);
        let p: Vec<f64> =
            model.slots().iter().filter(|slot| slot.effect == id).map(|slot| slot.value).collect();
        let kept = id.law().kept(&p, &vec![None; p.len()], still.motion_columns(0..CYCLE));
        assert!(id.law().remembers() || id.law().states() == 0 && kept.is_empty(), "{}", name(id));
        let states: usize = model.effects().map(|id| id.law().states()).sum();
        assert_eq!(model.states(), states, "{}", name(id));
    }
}

#[test]
fn every_place_of_the_chain_has_a_word_of_its_own() {
    let words = [Place::Coupling, Place::Load, Place::Sensor].map(Place::text);
    for (i, word) in words.iter().enumerate() {
        assert!(!word.is_empty() && !words[..i].contains(word), "{words:?}");
    }
}
