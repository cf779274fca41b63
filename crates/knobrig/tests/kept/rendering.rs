//! Knobs as they are rendered on all kinds of devices, along motions that stick, turn, miss periods and fail; and what is
//! said of each before it moves.

use crate::answers::Answers;
use crate::captures::{Chance, WAVES, at};
use crate::catalogue::knob;
use knobcore::effects::Id;
use knobcore::model::Model;
use knobcore::param::Axis;
use knobrender::{Device, Limits, Nature, Renderer, Sensed, check_passive, check_stability};

const OPEN: Limits = Limits { torque: f64::INFINITY, torque_rate: f64::INFINITY, speed: 100.0 };
const PLAIN: Device = Device {
    inertia: 5e-5,
    damping: 1e-4,
    delay: 1,
    torque_limit: f64::INFINITY,
    torque_rate_limit: f64::INFINITY,
    encoder_step: 0.0,
    held: false,
};

/// Devices that differ in one thing each.
fn devices() -> Vec<(&'static str, Option<Device>)> {
    vec![
        ("none", None),
        ("plain", Some(PLAIN)),
        ("late", Some(Device { delay: 5, ..PLAIN })),
        ("counted", Some(Device { encoder_step: 2e-4, ..PLAIN })),
        ("light", Some(Device { inertia: 4e-6, ..PLAIN })),
        ("heavy", Some(Device { inertia: 2e-3, damping: 0.02, ..PLAIN })),
        ("held", Some(Device { held: true, delay: 2, encoder_step: 1e-5, ..PLAIN })),
        ("weak", Some(Device { torque_limit: 0.02, torque_rate_limit: 20.0, ..PLAIN })),
    ]
}

/// The base knob with these effects and values more.
fn with(effects: &[Id], values: &[(&str, f64)]) -> Model {
    let mut model = effects
        .iter()
        .fold(knob(), |model, id| if model.has(*id) { model } else { model.with(*id).unwrap() });
    values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
    model
}

/// Knobs that go other ways through a step: without detents, with static friction, feeding, remembering, behind a joint,
/// with what acts before it.
fn knobs() -> Vec<(&'static str, Model)> {
    let joint =
        [("compliance.k", 2.0), ("compliance.d", 2e-3), ("compliance.share", 0.6), ("return_spring.k", 0.05)];
    let soft = with(&[Id::Compliance, Id::ReturnSpring], &joint);
    vec![
        ("plain", knob()),
        ("smooth", with(&[], &[("detent.A", 0.0), ("viscous.neg", 0.02), ("viscous.pos", 0.001)])),
        ("sticks", with(&[Id::Karnopp], &[("karnopp.D_neg", 0.05), ("karnopp.D_pos", 0.07)])),
        ("rises", with(&[Id::Stribeck], &[("stribeck.rise", 0.8), ("stribeck.vs", 0.3)])),
        ("feeds", with(&[], &[("viscous.neg", -6e-3), ("viscous.pos", -4e-3), ("inertia.M", 8e-4)])),
        ("loads", with(&[Id::LoadFriction], &[("load_friction.mu", 0.3), ("load_friction.s_alpha", 0.8)])),
        (
            "slips",
            with(
                &[Id::Presliding],
                &[("presliding.s", 0.05), ("presliding.w1", 0.4), ("presliding.w3", 0.3)],
            ),
        ),
        ("drifts", with(&[Id::FrictionDrift], &[("friction_drift.rise", 0.7), ("friction_drift.tau", 0.2)])),
        ("at the shaft", soft.with_at_shaft(Id::ReturnSpring).unwrap()),
        ("behind a joint", soft),
        (
            "behind play",
            with(
                &[Id::Backlash],
                &[
                    ("backlash.gap", 0.05),
                    ("backlash.k", 20.0),
                    ("backlash.d", 0.02),
                    ("backlash.share", 0.5),
                ],
            ),
        ),
    ]
}

/// A hand that turns, stops, turns back by little, and measures its torque now and then.
fn sensed(i: usize, rate_hz: f64, chance: &mut Chance) -> Sensed {
    let t = i as f64 / rate_hz;
    let [theta, omega, alpha] = at(&WAVES, t);
    let rests = (i / 70) % 3 == 2;
    let creeps = 4e-4 * (0.3 * i as f64).sin();
    let hand = (i % 5 < 2).then_some(0.03 * (9.0 * t).sin() + 1e-3 * chance.normal());
    if rests {
        let stands = at(&WAVES, (i / 70 * 70) as f64 / rate_hz)[0];
        return Sensed { theta: stands + creeps, omega: 0.02 * (0.3 * i as f64).cos(), alpha: 0.0, hand };
    }
    Sensed { theta, omega, alpha, hand }
}

#[test]
fn knobs_on_devices() {
    let mut told = Answers::of("devices");
    for (name, model) in knobs() {
        let nature = Nature::of(&model, &model.values(), 30.0);
        let sizes = [nature.inertia, nature.surge, nature.hold, nature.stiffness, nature.damping];
        told.numbers(name, sizes.into_iter().chain([f64::from(u8::from(nature.dissipates))]));
        for (on, device) in devices() {
            for rate_hz in [1000.0, 5000.0] {
                let mut knob = Renderer::forced(&model, rate_hz, device, OPEN).unwrap();
                let mut chance = Chance(71);
                let taus: Vec<f64> = (0..420)
                    .map(|i| {
                        if i == 300 {
                            knob.missed(3);
                        }
                        knob.step(sensed(i, rate_hz, &mut chance))
                    })
                    .collect();
                told.column(format!("  {on} at {rate_hz}"), &taus);
                let state = knob.state();
                let contact =
                    [state.contact.strain, f64::from(u8::from(state.contact.slipping)), state.contact.rest];
                told.numbers(
                    "    state",
                    [state.between, state.alpha, state.tau, state.tank].into_iter().chain(contact),
                );
                if let Some(fault) = knob.fault() {
                    told.words("    fault", fault.name());
                }
            }
        }
    }
    told.done();
}

#[test]
fn what_went_before_is_taken_up_and_forgotten() {
    let mut told = Answers::of("taken_up");
    let limits = Limits { torque: 0.08, torque_rate: 300.0, speed: 60.0 };
    for (name, model) in knobs() {
        let made = || Renderer::new(&model, 2000.0, Some(PLAIN), limits);
        let mut knob = match made() {
            Ok(knob) => knob,
            Err(why) => {
                told.words(name, why.to_string());
                Renderer::forced(&model, 2000.0, Some(PLAIN), limits).unwrap()
            }
        };
        let mut chance = Chance(72);
        let mut run = |knob: &mut Renderer, rows: std::ops::Range<usize>| -> Vec<f64> {
            rows.map(|i| knob.step(sensed(i, 2000.0, &mut chance))).collect()
        };
        told.column(format!("{name} first"), &run(&mut knob, 0..150));
        let state = knob.state().clone();
        let mut other = knob.clone();
        other.reset();
        other.set_state(state).unwrap();
        told.column("  taken up", &run(&mut other, 150..260));
        // So many periods that a knob behind a joint is lost; then what no handle does.
        for periods in [1, 40, 400] {
            other.missed(periods);
            told.column(format!("  after {periods}"), &run(&mut other, 260..300));
        }
        told.column(
            "  leaps",
            &[500, 501, 502].map(|i| {
                let there = sensed(i, 2000.0, &mut Chance(73));
                other.step(Sensed { theta: there.theta + 3.0 * f64::from(u8::from(i > 500)), ..there })
            }),
        );
        told.words("  fault", other.fault().map_or("none", |fault| fault.name()));
        other.reset();
        told.column("  again", &run(&mut other, 0..90));
        let columns = [0, 1, 2].map(|which| {
            (0..300)
                .map(|i| {
                    let Sensed { theta, omega, alpha, .. } = sensed(i, 2000.0, &mut Chance(74));
                    [theta, omega, alpha][which]
                })
                .collect::<Vec<f64>>()
        });
        let mut out = vec![0.0; 300];
        Renderer::forced(&model, 2000.0, None, OPEN).unwrap().render(
            columns.each_ref().map(Vec::as_slice),
            None,
            &mut out,
        );
        told.column("  at once", &out);
    }
    told.done();
}

#[test]
fn whether_a_knob_is_passive_and_stable_whatever_it_is() {
    let mut told = Answers::of("trusted");
    let mut chance = Chance(75);
    for (name, model) in knobs() {
        for round in 0..5 {
            let mut other = model.clone();
            let mut values = other.values();
            // One parameter is another: turned round, or much larger.
            let which = (chance.uniform() * values.len() as f64) as usize % values.len();
            values[which] *= [1.0, -1.0, -0.1, 8.0, 300.0][round];
            let changed = other.slots()[which].name();
            other.set_values(&values);
            let device = devices()[1 + round % 5].1.unwrap();
            let said = |device: Option<Device>| {
                check_passive(&other, device, 2000.0)
                    .map_or_else(|why| why.to_string(), |()| "passive".into())
            };
            told.words(format!("{name}, {changed} {round}"), said(None));
            told.words("  on a device", said(Some(device)));
            let found = check_stability(&other, device, 2000.0).unwrap();
            told.numbers("  margins", [found.passivity_margin, found.sliding_margin, found.sticking_margin]);
            told.numbers(
                "  stiffness",
                [found.stiffness, found.allowed_stiffness, found.passive_stiffness, found.anchor_stiffness],
            );
        }
    }
    let mut slide = Model::equation_1(Axis::Linear, false);
    slide.set("coulomb.neg", 1.0).unwrap();
    for pull in [0.0, 3.0, -0.5, -8.0] {
        let mut pulled = slide.with(Id::ReturnSpring).unwrap();
        pulled.set("return_spring.k", pull).unwrap();
        let said =
            check_passive(&pulled, None, 1000.0).map_or_else(|why| why.to_string(), |()| "passive".into());
        told.words(format!("slide {pull}"), said);
    }
    for broken in [
        Device { inertia: 0.0, ..PLAIN },
        Device { damping: -1e-9, ..PLAIN },
        Device { damping: 0.0, encoder_step: f64::INFINITY, ..PLAIN },
        Device { torque_limit: 0.0, ..PLAIN },
        Device { torque_rate_limit: f64::NAN, ..PLAIN },
        Device { delay: 1000, ..PLAIN },
        Device { delay: 1001, ..PLAIN },
    ] {
        told.words("device", broken.checked().map_or_else(|why| why.to_string(), |_| "right".into()));
    }
    for (rate_hz, torque, speed) in [
        (9.0, 1.0, 1.0),
        (10.0, 1.0, 1.0),
        (1e6, 1.0, 1.0),
        (2e6, 1.0, 1.0),
        (1e3, 0.0, 1.0),
        (1e3, 1.0, 0.0),
    ] {
        let limits = Limits { torque, speed, ..OPEN };
        let made = Renderer::forced(&knob(), rate_hz, None, limits);
        told.words("renderer", made.map_or_else(|why| why.to_string(), |_| "made".into()));
    }
    told.done();
}
