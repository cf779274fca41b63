//! Every effect as it is: its row, its torque and derivatives along a motion, pushed and rendered.

use crate::answers::Answers;
use crate::captures::{RATE_HZ, WAVES, at, base, recorded};
use knobcore::carry::carrier;
use knobcore::chain::{Hand, push};
use knobcore::effects::{Carrier, Id, Place};
use knobcore::filter::{ZeroPhase, butter, cheby1, cheby2};
use knobcore::model::{Model, Role};
use knobcore::model_file;
use knobcore::param::Axis;
use knobcore::predict::{Columns, Seeds, raw, torque};
use knobcore::rule::rule;
use knobcore::signals::{Chunk, Signals};
use knobrender::{Device, Limits, Renderer, Sensed, check_passive, check_stability};
use knobrig::emulate::Handle;

const LIMITS: Limits = Limits { torque: 0.2, torque_rate: 200.0, speed: 100.0 };
const DEVICE: Device = Device {
    inertia: 5e-5,
    damping: 1e-4,
    delay: 1,
    torque_limit: 0.3,
    torque_rate_limit: 500.0,
    encoder_step: 1e-5,
    held: false,
};

pub fn knob() -> Model {
    let mut model = Model::equation_1(Axis::Rotary, true);
    for (name, value) in [
        ("inertia.M", 1.5e-4),
        ("coulomb.neg", 0.02),
        ("coulomb.pos", 0.025),
        ("viscous.neg", 1e-3),
        ("viscous.pos", 1.5e-3),
        ("detent.A", 0.02),
        ("detent.P", 0.11),
        ("detent.S", 0.4),
    ] {
        model.set(name, value).unwrap();
    }
    model
}

pub fn motion() -> Signals {
    recorded(600, &WAVES, 0.0, 21, |_, motion| base(motion)).smooth("a").signals
}

/// A size of the effect's parameters that is no number of the crates: within their bounds, and like no neutral one.
pub fn sized(id: Id, carrier: &Carrier<'_>) -> Vec<f64> {
    let typical = id.law().typical(carrier);
    let params = id.info().params.iter().zip(typical).enumerate();
    let size = |(i, (param, typical)): (usize, (&knobcore::param::Param, f64))| {
        let own = if typical == 0.0 { 0.01 * (i as f64 + 1.0) } else { typical * (1.0 + 0.03 * i as f64) };
        own.clamp(param.lower, param.upper)
    };
    params.map(size).collect()
}

pub fn knob_with(id: Id, values: &[f64]) -> Model {
    let knob = knob();
    if knob.has(id) {
        return knob;
    }
    let mut model = knob.with(id).unwrap();
    let own: Vec<(String, bool)> = model
        .slots()
        .iter()
        .filter(|slot| slot.effect == id)
        .map(|slot| (slot.name(), matches!(slot.role, Role::Tied(_))))
        .collect();
    for ((name, tied), value) in own.iter().zip(values) {
        if !tied {
            model.set(name, *value).unwrap();
        }
    }
    model
}

#[test]
fn every_row_of_the_catalogue() {
    let mut told = Answers::of("catalogue");
    for id in Id::BUILT_IN {
        let info = id.info();
        told.words(info.id, format!("{} {} {:?} {:?}", info.place.text(), info.law, info.over, info.touches));
        let said = (info.confused, info.needs, info.makes_nonlinear, info.describes, info.unsearched);
        told.words("  said", format!("{said:?}"));
        let more = (info.clips, info.every_run, info.scan, info.slower, info.is_map(), info.is_friction());
        told.words("  more", format!("{more:?} {} {} {}", info.stores(), info.presses, info.shapes_friction));
        for param in info.params.iter().take(6) {
            let unit = param.unit.text(Axis::Rotary);
            told.words(format!("  {}", param.name), format!("{unit}, {:?}, {:?}", param.kind, param.usual));
            let bounds = [param.lower, param.upper, param.neutral, param.plausible[0], param.plausible[1]];
            told.numbers("    bounds", bounds.into_iter().chain([param.scale()]));
        }
    }
    told.numbers("thresholds", rule().values());
    told.done();
}

#[test]
fn every_effect_along_a_motion() {
    let mut told = Answers::of("effects");
    let (signals, knob) = (motion(), knob());
    let carrier = carrier(&knob, &signals, 1e-3, 1.0);
    for &id in Id::BUILT_IN {
        let name = id.info().id;
        let values = sized(id, &carrier);
        told.numbers(format!("{name} typical"), values.iter().copied());
        for (i, start) in id.law().starts(&carrier.survey).into_iter().enumerate().take(4) {
            told.numbers(format!("{name} start {i}"), start);
        }
        let model = knob_with(id, &values);
        let roles: Vec<String> = model.slots().iter().map(|slot| format!("{:?}", slot.role)).collect();
        told.words(format!("{name} roles"), roles.join(" "));
        let free: Vec<usize> = (0..model.slots().len())
            .filter(|at| model.slots()[*at].effect == id && !matches!(model.slots()[*at].role, Role::Tied(_)))
            .collect();
        let whole = 0..signals.len();
        let chunk = Chunk { whole: whole.clone(), core: whole };
        let mut columns = Columns::default();
        raw(&model, &model.values(), &Seeds::of(&model, &free), &signals, chunk.whole.clone(), &mut columns);
        for (i, column) in columns.into_all().iter().enumerate().take(6) {
            told.column(format!("{name} torque and derivatives {i}"), column);
        }
        told.column(format!("{name} measured"), &torque(&model, &signals));
        told.words(format!("{name} file"), model_file::write(&model).lines().last().unwrap_or_default());
    }
    told.done();
}

#[test]
fn every_effect_pushed_by_a_hand() {
    let mut told = Answers::of("pushed");
    let (signals, knob) = (motion(), knob());
    let carrier = carrier(&knob, &signals, 1e-3, 1.0);
    let reference: Vec<f64> = (0..300).map(|i| at(&WAVES[..2], f64::from(i) / RATE_HZ)[0]).collect();
    for &id in Id::BUILT_IN {
        let model = knob_with(id, &sized(id, &carrier));
        let name = id.info().id;
        match push(&model, &reference, 1.0 / RATE_HZ, Hand { stiffness: 2.0, damping: 5e-3 }) {
            Ok(pushed) => {
                told.column(format!("{name} theta"), &pushed.theta);
                told.column(format!("{name} omega"), &pushed.omega);
                told.column(format!("{name} alpha"), &pushed.alpha);
                told.column(format!("{name} tau"), &pushed.tau);
            }
            Err(why) => told.words(name, why.to_string()),
        }
    }
    told.done();
}

#[test]
fn every_effect_rendered() {
    let mut told = Answers::of("rendered");
    let (signals, knob) = (motion(), knob());
    let carrier = carrier(&knob, &signals, 1e-3, 1.0);
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place != Place::Sensor) {
        let model = knob_with(id, &sized(id, &carrier));
        let name = id.info().id;
        let passive = check_passive(&model, Some(DEVICE), RATE_HZ)
            .map_or_else(|why| why.to_string(), |()| "passive".into());
        told.words(name, passive);
        let found = check_stability(&model, DEVICE, RATE_HZ).unwrap();
        let sizes =
            [found.delay_s, found.stiffness, found.damping, found.inertia_ratio, found.allowed_stiffness];
        let margins = [found.passive_stiffness, found.passivity_margin, found.anchor_stiffness];
        told.numbers(
            "  stability",
            sizes.into_iter().chain(margins).chain([found.sliding_margin, found.sticking_margin]),
        );
        for (how, device) in
            [("", None), (" on a device", Some(DEVICE)), (" on a rig", Some(Device { held: true, ..DEVICE }))]
        {
            let mut knob = Renderer::forced(&model, RATE_HZ, device, LIMITS).unwrap();
            let taus: Vec<f64> = (0..400)
                .map(|i| {
                    let [theta, omega, alpha] = at(&WAVES, f64::from(i) / RATE_HZ);
                    // Now and then the hand lets go of a knob that stands.
                    let still = (i / 40) % 4 == 3;
                    let hand = (i % 3 > 0).then_some(0.01 * (f64::from(i) * 0.05).sin());
                    let (omega, alpha) = if still { (0.0, 0.0) } else { (omega, alpha) };
                    knob.step(Sensed { theta: if still { 0.3 } else { theta }, omega, alpha, hand })
                })
                .collect();
            told.column(format!("  torque{how}"), &taus);
            let state = knob.state();
            told.numbers("    tank", [state.tank, state.knob[0], state.knob[1], state.alpha, state.between]);
        }
        let mut knob = Renderer::forced(&model, RATE_HZ, Some(DEVICE), LIMITS).unwrap();
        let mut handle = Handle::new(DEVICE, 1.0 / RATE_HZ, 0.05);
        let (mut felt, mut hand) = (Vec::new(), 0.0);
        for i in 0..500 {
            let tau = knob.step(handle.sensed((i % 2 > 0).then_some(hand)));
            let next = 0.06 * (f64::from(i) * 0.02).sin();
            handle.push(-tau, [hand, next]);
            hand = next;
            felt.push(handle.motion()[0]);
        }
        told.column("  in a hand", &felt);
    }
    told.done();
}

#[test]
fn filters() {
    let mut told = Answers::of("filters");
    let signal: Vec<f64> = (0..700).map(|i| (f64::from(i * i) * 1e-4).sin() + f64::from(i % 7)).collect();
    for (name, design) in [
        ("cheby2", cheby2(3, 20.0, 90.0, RATE_HZ)),
        ("cheby2 of 6", cheby2(6, 40.0, 200.0, RATE_HZ)),
        ("cheby1", cheby1(8, 0.05, 100.0, RATE_HZ)),
        ("butter", butter(5, 60.0, RATE_HZ)),
    ] {
        let sos = design.unwrap();
        let sections = sos.sections().iter().flat_map(|section| section.b.into_iter().chain(section.a));
        told.numbers(name, sections.collect::<Vec<f64>>());
        told.numbers("  steady", sos.steady_state().concat());
        let gains = (1..9).map(|i| sos.power_gain(f64::from(i) * 50.0));
        told.numbers("  gains", gains.chain([sos.mean_power(), sos.settle() as f64]));
        let filter = ZeroPhase::new(sos);
        for count in [1, 3, 5] {
            let mut columns = vec![signal.clone(); count];
            columns.iter_mut().enumerate().for_each(|(i, column)| column[50 * i] += 3.0);
            let mut each: Vec<&mut [f64]> = columns.iter_mut().map(Vec::as_mut_slice).collect();
            filter.filter_channels(&mut each).unwrap();
            columns.iter().for_each(|column| told.column(format!("  {count} at once"), column));
        }
        told.numbers("  padding", [filter.padding() as f64]);
    }
    told.done();
}
