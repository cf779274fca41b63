//! Decisions over all that they may be asked about, not only what a capture happens to ask: evidence, fitted values and
//! surveys at random.

use crate::answers::Answers;
use crate::captures::{Chance, RATE_HZ, WAVES, at};
use crate::catalogue::{knob, knob_with, motion, sized};
use knobcore::carry::carrier;
use knobcore::diagnose::{Evidence, State, complete, exact, judge};
use knobcore::effects::{Carrier, Context, Id, Survey};
use knobcore::fit::{glance, sketch};
use knobcore::model::{Model, Role};
use knobcore::param::Param;
use knobcore::predict::torque;
use knobcore::signals::Signals;

/// One of these, at random.
fn one_of<T: Copy>(chance: &mut Chance, all: &[T]) -> T {
    all[(chance.uniform() * all.len() as f64) as usize % all.len()]
}

/// From a tenth to ten times as much, at random.
fn about(chance: &mut Chance, size: f64) -> f64 {
    size * 10.0_f64.powf(2.0 * chance.uniform() - 1.0)
}

fn evidence(chance: &mut Chance, state: &State) -> Evidence {
    let excess = (state.rmse.powi(2) - state.noise_floor.powi(2)).max(0.0);
    let share = one_of(chance, &[0.005, 0.02, 0.3, 0.6, 0.95, 0.97]) * (0.9 + 0.2 * chance.uniform());
    let parameters = one_of(chance, &[1, 1, 2, 3, 7]);
    let gain =
        if excess > 0.0 { state.white_squares * share * excess / state.noise_floor.powi(2) } else { 8.0 };
    let rmse = (state.rmse.powi(2) - share * excess).sqrt();
    Evidence {
        gain: gain + 6.0 * chance.normal(),
        parameters,
        charged: parameters as f64 * one_of(chance, &[1.0, 1.0, 0.5]),
        p_value: one_of(chance, &[1e-3, 2e-3, 8e-3, 0.03, 0.2, 1.0]),
        rmse,
        felt: (1.0 - (rmse / state.rmse).powi(2)) * one_of(chance, &[1.0, 1.0, 2.0]),
        doubt: 0.03 * gain,
        implausible: chance.uniform() < 0.15,
        bent: one_of(chance, &[0, 0, 0, 1, 2]),
    }
}

#[test]
fn what_is_said_of_any_evidence() {
    let mut told = Answers::of("evidence");
    let mut chance = Chance(31);
    for round in 0..300 {
        let rmse = one_of(&mut chance, &[1.005, 1.03, 1.1, 1.5, 4.0]);
        let state = State {
            rmse,
            noise_floor: if round % 50 == 0 { f64::NAN } else { 1.0 },
            white_squares: one_of(&mut chance, &[200.0, 3000.0]),
            law: one_of(&mut chance, &[0.0, 0.0, 0.02, 0.5]),
            complete: false,
            exact: round % 60 == 1,
        };
        let beyond = [0.0, 0.02, 0.2].map(|part| part * chance.uniform());
        let state = State { complete: complete(&state, &beyond), ..state };
        let all: Vec<Evidence> = (0..1 + round % 6).map(|_| evidence(&mut chance, &state)).collect();
        let said = judge(&state, &all).into_iter().map(|one| {
            let others: Vec<String> = one.equivalent.iter().map(ToString::to_string).collect();
            format!("{} {}", one.word.id(), others.join(" ")).trim_end().to_owned()
        });
        told.words(format!("{round} {}", state.complete), said.collect::<Vec<_>>().join(", "));
    }
    let rounding = (0..40).map(|i| 10.0_f64.powf(-0.5 * f64::from(i)));
    told.numbers("exact", rounding.map(|rmse| f64::from(u8::from(exact(rmse, 1.0)))));
    told.done();
}

/// Values of an effect's parameters, within their bounds and on either side of nought where they may be.
fn values(chance: &mut Chance, params: &[Param], typical: &[f64]) -> Vec<f64> {
    let value = |(param, typical): (&Param, &f64)| {
        let size = about(chance, if *typical == 0.0 { param.scale() } else { *typical });
        let way = if param.lower < 0.0 && chance.uniform() < 0.3 { -1.0 } else { 1.0 };
        let none = if chance.uniform() < 0.1 { 0.0 } else { 1.0 };
        (none * way * size).clamp(param.lower, param.upper)
    };
    params.iter().zip(typical).map(value).collect()
}

#[test]
fn what_is_implausible_of_any_values() {
    let mut told = Answers::of("implausible");
    let mut chance = Chance(32);
    let (signals, knob) = (motion(), knob());
    let carrier = carrier(&knob, &signals, 1e-3, 1.0);
    for &id in Id::BUILT_IN {
        let params = id.info().params;
        let typical = sized(id, &carrier);
        for round in 0..24 {
            let reach = about(&mut chance, 1.0);
            let slow = one_of(&mut chance, &[1.0, 1.0, 0.2, 0.05]);
            let t: Vec<f64> = (0..400).map(|i| 5.0 * f64::from(i) / RATE_HZ).collect();
            let theta: Vec<f64> = t.iter().map(|t| reach * at(&WAVES, slow * t)[0]).collect();
            let context = Context {
                errors: typical
                    .iter()
                    .map(|size| (chance.uniform() < 0.8).then(|| about(&mut chance, 0.05 * size.abs())))
                    .collect(),
                torque: vec![if round % 8 < 4 { 1e-9 } else { 1e3 }; 9],
                theta,
                turning: about(&mut chance, 30.0),
                rate_hz: one_of(&mut chance, &[200.0, 1000.0, 5000.0]),
                noise_floor: about(&mut chance, 1e-3),
                period: one_of(&mut chance, &[None, Some(0.05), Some(0.11)]),
                period_error: 1e-5,
                revolution: one_of(&mut chance, &[None, Some(1.0)]),
                friction: [3e-3, if round % 5 == 0 { -1e-3 } else { 2e-3 }],
                clipped: round % 2 == 0,
                first: round % 4 < 2,
                t,
            };
            let own = values(&mut chance, params, &typical);
            let said = id.law().implausible(&own, &context);
            if !said.is_empty() {
                told.words(format!("{} {round}", id.info().id), said.join("; "));
            }
        }
    }
    told.done();
}

/// A survey of some motion, with waves or without.
fn surveyed(chance: &mut Chance, carrier: &Carrier<'_>, round: usize) -> Survey {
    let scaled = |column: &[f64], by: f64| column.iter().map(|x| by * x).collect();
    let [angle, speed, torque] = [(); 3].map(|()| about(chance, 1.0));
    let wave = |chance: &mut Chance| [about(chance, 5e-3), about(chance, 0.05), 3.0 * chance.normal()];
    Survey {
        theta: scaled(&carrier.survey.theta, angle),
        speed: scaled(&carrier.survey.speed, speed),
        torque: scaled(&carrier.survey.torque, torque),
        duration_s: about(chance, 2.0),
        rate_hz: about(chance, 1000.0),
        inertia: about(chance, 1e-4),
        friction: carrier.survey.friction,
        revolution: (!round.is_multiple_of(3)).then_some(1.0),
        waves: (!round.is_multiple_of(2)).then(|| (0..round).map(|_| wave(chance)).collect()),
    }
}

#[test]
fn where_a_search_starts_whatever_was_recorded() {
    let mut told = Answers::of("starts");
    let mut chance = Chance(33);
    let (signals, knob) = (motion(), knob());
    let carrier = carrier(&knob, &signals, 1e-3, 1.0);
    for &id in Id::BUILT_IN {
        for round in 0..6 {
            let starts = id.law().starts(&surveyed(&mut chance, &carrier, round));
            told.numbers(format!("{} {round}", id.info().id), [starts.len() as f64]);
            told.column("  all", &starts.concat());
        }
    }
    told.done();
}

/// A knob with these values of an effect; what is no model is brought back within its bounds by it.
fn at_values(id: Id, values: &[f64]) -> Model {
    let mut model = knob_with(id, values);
    model.settle();
    model
}

#[test]
fn every_effect_at_other_values() {
    let mut told = Answers::of("values");
    let mut chance = Chance(34);
    let (recorded, knob) = (motion(), knob());
    let carrier = carrier(&knob, &recorded, 1e-3, 1.0);
    let mut signals = recorded.clone();
    // It stands still for a while, and starts again.
    for at in 200..240 {
        (signals.omega[at], signals.alpha[at], signals.forward[at]) = (0.0, 0.0, 0.5);
        signals.theta[at] = signals.theta[200];
    }
    for &id in Id::BUILT_IN {
        for round in 0..3 {
            let own = values(&mut chance, id.info().params, &sized(id, &carrier));
            told.column(format!("{} {round}", id.info().id), &torque(&at_values(id, &own), &signals));
        }
    }
    told.done();
}

#[test]
fn every_hidden_effect_after_a_few_steps_from_each_of_its_starts() {
    let mut told = Answers::of("glanced");
    let (signals, bare) = (motion(), knob());
    let carrier = carrier(&bare, &signals, 1e-3, 1.0);
    let mut chance = Chance(35);
    for &id in Id::BUILT_IN {
        let truth = knob_with(id, &sized(id, &carrier));
        let mut noisy =
            |tau: Vec<f64>| -> Vec<f64> { tau.iter().map(|tau| tau + 1e-4 * chance.normal()).collect() };
        let tau = noisy(torque(&truth, &signals));
        let data = Signals { tau: tau.clone(), tau_raw: tau, ..signals.clone() };
        let starts = id.law().starts(&carrier.survey);
        for (i, start) in starts.iter().step_by(1 + starts.len() / 3).enumerate() {
            let model = knob_with(id, start);
            let found = glance(&[&data], &model);
            told.numbers(format!("{} {i}", id.info().id), [found.cost]);
            told.words("  ended", found.status.word());
            let free = model.slots().iter().zip(&found.p).filter(|(slot, _)| slot.role == Role::Free);
            if id.info().place != knobcore::effects::Place::Coupling {
                told.column("  at", &free.map(|(_, p)| *p).collect::<Vec<_>>());
            }
        }
        let found = sketch(&[&data], &truth);
        told.numbers(format!("{} from the truth", id.info().id), [found.cost]);
    }
    told.done();
}
