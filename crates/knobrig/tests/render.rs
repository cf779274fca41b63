//! What a rendered knob feels like, on an emulated handle in somebody's hand.

use knobcore::model::Model;
use knobcore::model_file;
use knobcore::random::Noise;
use knobrender::{Device, Fault, Limits, Renderer, Sensed, check_stability};
use knobrig::emulate::Handle;
use std::f64::consts::TAU;

const OPEN: Limits = Limits { torque: f64::INFINITY, torque_rate: f64::INFINITY, speed: 1000.0 };
/// One count of the paper's encoder, rad.
const COUNT: f64 = 9.8e-6;
const RATE: f64 = 5000.0;

fn device(inertia: f64, delay: usize) -> Device {
    Device {
        inertia,
        damping: 1e-4,
        delay,
        torque_limit: f64::INFINITY,
        torque_rate_limit: f64::INFINITY,
        encoder_step: COUNT,
        held: false,
    }
}

fn knob(n: usize) -> Model {
    let path = format!("{}/../../python/knobcam/model/knobs/knob{n}.toml", env!("CARGO_MANIFEST_DIR"));
    model_file::parse(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn value(model: &Model, name: &str) -> f64 {
    model.index(name).map_or(0.0, |at| model.slots()[at].value)
}

/// Where its detents hold the knob.
fn groove(model: &Model) -> f64 {
    let [a, p, s] = ["detent.A", "detent.P", "detent.S"].map(|name| value(model, name));
    let falling = if a < 0.0 { 0.5 * TAU } else { 0.0 };
    p * (falling - s)
}

/// A knob that is rendered on a handle, which a hand pushes.
struct Rendered {
    knob: Renderer,
    handle: Handle,
    measured: bool,
    hand: f64,
}

impl Rendered {
    fn new(model: &Model, device: Device, rate: f64, measured: bool) -> Self {
        Self::of(Renderer::new(model, rate, Some(device), OPEN).unwrap(), model, device, rate, measured)
    }

    fn of(knob: Renderer, model: &Model, device: Device, rate: f64, measured: bool) -> Self {
        let handle = Handle::new(device, 1.0 / rate, groove(model));
        Self { knob, handle, measured, hand: 0.0 }
    }

    /// The hand's torque goes to `hand` during the sample; returns its work.
    fn push(&mut self, hand: f64) -> f64 {
        let sensed = self.handle.sensed(self.measured.then_some(self.hand));
        let tau = self.knob.step(sensed);
        let work = self.handle.push(-tau, [self.hand, hand]);
        self.hand = hand;
        work
    }
}

#[test]
fn a_renderer_says_at_which_rate_it_has_to_be_called() {
    let knob = Renderer::new(&knob(1), 4000.0, None, OPEN).unwrap();
    assert!((knob.rate_hz() - 4000.0).abs() < 1e-6);
}

#[test]
fn a_stuck_knob_does_not_creep_by_one_count_in_38_seconds() {
    for n in 1..=5 {
        let model = knob(n);
        let holds = value(&model, "karnopp.D_pos");
        for (inertia, delay) in [(2e-5, 1), (5e-5, 0), (5e-5, 1), (3e-4, 1)] {
            for measured in [false, true] {
                let mut knob = Rendered::new(&model, device(inertia, delay), RATE, measured);
                // Five periods of the push a block: its mean position is where the knob stands.
                let mut blocks = (0..190).map(|block| {
                    let stand = |i: usize| {
                        let t = (1000 * block + i) as f64 / RATE;
                        knob.push(holds * (0.2 + 0.5 * (TAU * 25.0 * t).sin()));
                        knob.handle.motion()[0]
                    };
                    (0..1000).map(stand).sum::<f64>() / 1000.0
                });
                let settled = blocks.by_ref().nth(4).unwrap();
                let drift = blocks.last().unwrap() - settled;
                assert!(
                    drift.abs() < COUNT,
                    "knob {n}, {inertia} kg m^2, delay {delay}, measured {measured}: {drift}"
                );
            }
        }
    }
}

/// Torque of a hand that pushes ever harder, at the moment when the knob breaks away, N m.
fn breakaway(model: &Model, sign: f64, rate: f64, measured: bool) -> f64 {
    let mut knob = Rendered::new(model, device(5e-5, 0), rate, measured);
    let mut hand = 0.0;
    while !knob.knob.state().contact.slipping && hand < 1.0 {
        hand += 0.02 / rate;
        knob.push(sign * hand);
    }
    hand
}

/// Torque along a slow steady motion, N m.
fn sliding(model: &Model, omega: f64, rate: f64) -> f64 {
    let mut knob = Renderer::new(model, rate, None, OPEN).unwrap();
    let mut tau = 0.0;
    for i in 0..(0.5 * rate) as usize {
        tau = knob.step(Sensed { theta: omega * i as f64 / rate, omega, alpha: 0.0, hand: None });
    }
    tau
}

#[test]
fn breakaway_and_sliding_torque_are_those_of_the_model_at_any_rate() {
    for n in [1, 2] {
        let mut model = knob(n);
        model.set("karnopp.D_neg", 0.8 * value(&model, "karnopp.D_pos")).unwrap();
        for (sign, way) in [(1.0, "pos"), (-1.0, "neg")] {
            let of = |name: &str| value(&model, &format!("{name}{way}"));
            for measured in [false, true] {
                let found = [1e4, 5000.0, 2500.0].map(|rate| breakaway(&model, sign, rate, measured));
                for tau in found {
                    assert!(
                        (tau / of("karnopp.D_") - 1.0).abs() < 0.01,
                        "knob {n} {way} {measured}: {found:?}"
                    );
                    assert!((tau / found[1] - 1.0).abs() < 0.02, "knob {n} {way} {measured}: {found:?}");
                }
            }
            for rate in [1e4, 5000.0, 2500.0] {
                let omega = 2.0 * sign;
                let expected = sign * of("coulomb.") + of("viscous.") * omega;
                assert!((sliding(&model, omega, rate) / expected - 1.0).abs() < 0.01);
            }
        }
    }
}

/// A hand that follows a multisine through its own spring and damper for 30 s: the least that its work has come to.
fn least_work(model: &Model, device: Device, seed: u64) -> f64 {
    let mut noise = Noise::new(seed);
    let tones: Vec<[f64; 2]> = (0..12).map(|k| [0.3 * 1.5_f64.powi(k), TAU * noise.uniform()]).collect();
    let mut knob = Rendered::new(model, device, RATE, false);
    let start = knob.handle.motion()[0];
    let (mut work, mut least) = (0.0_f64, 0.0_f64);
    for i in 0..150_000 {
        let t = f64::from(i) / RATE;
        let at: f64 = tones.iter().map(|[f, phase]| 0.3 / f * (TAU * f * t + phase).sin()).sum();
        let speed: f64 = tones.iter().map(|[f, phase]| 0.3 * TAU * (TAU * f * t + phase).cos()).sum();
        let [theta, omega, _] = knob.handle.motion();
        work += knob.push(0.5 * (start + at - theta) + 0.005 * (speed - omega));
        least = least.min(work);
    }
    assert_eq!(knob.knob.fault(), None);
    least
}

/// How far the knob still swings 3 s after a kick, rad.
fn swing(model: &Model, device: Device) -> f64 {
    let mut knob = Rendered::new(model, device, RATE, false);
    knob.handle.kick(8.0);
    let places: Vec<f64> = (0..20_000)
        .map(|_| {
            knob.push(0.0);
            knob.handle.motion()[0]
        })
        .collect();
    let (low, high) =
        places[15_000..].iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low
}

#[test]
fn no_shipped_knob_gives_out_energy_or_rings_under_delays_up_to_ten_samples() {
    for n in 1..=5 {
        let model = knob(n);
        for delay in 0..=10 {
            let least = least_work(&model, device(5e-5, delay), 7);
            assert!(least > -1e-6, "knob {n}, delay {delay}: {least} J");
            let swing = swing(&model, device(5e-5, delay));
            assert!(swing < COUNT, "knob {n}, delay {delay}: {swing} rad");
        }
    }
}

#[test]
fn what_is_said_to_be_stable_comes_to_rest_and_what_is_said_to_ring_rings() {
    let mut loud = 0;
    for delay in [0, 2, 10] {
        for (n, factor) in [(3, 1.0), (4, 1.0), (5, 1.0), (5, 0.3), (4, 30.0), (4, 300.0), (3, 1e4)] {
            let mut model = knob(n);
            model.set("detent.A", factor * value(&model, "detent.A")).unwrap();
            for friction in ["coulomb.neg", "coulomb.pos", "karnopp.D_neg", "karnopp.D_pos"] {
                model.set(friction, 0.0).unwrap();
            }
            let device = device(5e-5, delay);
            let said = check_stability(&model, device, RATE).unwrap();
            let forced = Renderer::forced(&model, RATE, Some(device), OPEN).unwrap();
            let mut knob = Rendered::of(forced, &model, device, RATE, false);
            knob.handle.kick(0.1);
            let mut energy = 0.0;
            for _ in 0..25_000 {
                knob.push(0.0);
                energy = knob.handle.energy();
            }
            let rings = knob.knob.fault().is_some() || energy > 0.5 * 5e-5 * 0.1 * 0.1;
            let margin = said.sliding_margin;
            assert!(
                margin.abs() < 0.02 || rings == (margin < 0.0),
                "knob {n} times {factor}, delay {delay}: {margin}"
            );
            loud += usize::from(rings);
        }
    }
    assert!(loud > 3, "some of them do ring");
}

#[test]
fn what_cannot_be_true_lets_go_until_a_reset() {
    let still = Sensed { theta: 0.3, omega: 5.0, alpha: 0.0, hand: None };
    for (broken, fault) in [
        (Sensed { theta: f64::NAN, ..still }, Fault::NotFinite),
        (Sensed { omega: f64::INFINITY, ..still }, Fault::NotFinite),
        (Sensed { alpha: f64::NEG_INFINITY, ..still }, Fault::NotFinite),
        (Sensed { hand: Some(f64::NAN), ..still }, Fault::NotFinite),
        (Sensed { theta: 3.0, ..still }, Fault::Jump),
        (Sensed { omega: -1e4, ..still }, Fault::Jump),
        (Sensed { theta: 1e300, ..still }, Fault::Jump),
    ] {
        let mut knob = Renderer::new(&knob(4), RATE, None, OPEN).unwrap();
        assert!(knob.step(still) > 0.0);
        assert_eq!(knob.step(broken), 0.0, "{broken:?}");
        assert_eq!(knob.step(still), 0.0, "{broken:?} is not forgotten");
        assert_eq!(knob.fault(), Some(fault), "{broken:?}");
        knob.reset();
        assert!(knob.step(still) > 0.0 && knob.fault().is_none());
    }
}

#[test]
fn torque_never_exceeds_its_limit_nor_changes_faster_than_it_may() {
    let limits = Limits { torque: 0.03, torque_rate: 5.0, speed: 1000.0 };
    let mut knob = Renderer::new(&knob(5), RATE, None, limits).unwrap();
    let (mut before, mut most) = (None, 0.0_f64);
    for i in 0..20_000 {
        let (sin, cos) = (7.0 * f64::from(i) / RATE).sin_cos();
        let tau = knob.step(Sensed { theta: sin, omega: 7.0 * cos, alpha: -49.0 * sin, hand: None });
        let change = before.map_or(0.0, |before: f64| (tau - before).abs());
        assert!(tau.abs() <= 0.03 && change <= 5.0 / RATE * (1.0 + 1e-12), "{tau} after {before:?}");
        (before, most) = (Some(tau), most.max(tau.abs()));
    }
    assert_eq!(most, 0.03);

    // A device that can do no more is a limit too.
    let device = Device { torque_limit: 0.02, torque_rate_limit: 3.0, held: true, ..device(5e-5, 0) };
    let mut knob = Renderer::new(&self::knob(5), RATE, Some(device), limits).unwrap();
    let mut before = 0.0_f64;
    for i in 0..5000 {
        let (sin, cos) = (7.0 * f64::from(i) / RATE).sin_cos();
        let tau = knob.step(Sensed { theta: sin, omega: 7.0 * cos, alpha: -49.0 * sin, hand: None });
        assert!(
            tau.abs() <= 0.02 && (i == 0 || (tau - before).abs() <= 3.0 / RATE * (1.0 + 1e-12)),
            "{tau} {before}"
        );
        before = tau;
    }
}

#[test]
fn periods_that_were_missed_are_no_jump_and_a_stuck_knob_stays_where_it_stuck() {
    let limits = Limits { speed: 20.0, ..OPEN };
    let turning = |i: u32| Sensed { theta: 10.0 * f64::from(i) / RATE, omega: 10.0, alpha: 0.0, hand: None };
    let after_a_gap = |told: bool| {
        let mut knob = Renderer::new(&knob(4), RATE, None, limits).unwrap();
        knob.step(turning(0));
        if told {
            knob.missed(50);
        }
        knob.step(turning(51));
        (knob.fault(), knob.state().samples)
    };
    assert_eq!(after_a_gap(false).0, Some(Fault::Jump));
    assert_eq!(after_a_gap(true), (None, 52));

    let model = knob(1);
    let holds = value(&model, "karnopp.D_pos");
    let mut knob = Rendered::new(&model, device(5e-5, 2), RATE, false);
    let mut stand = |i: usize| {
        knob.push(0.5 * holds);
        if i.is_multiple_of(10) {
            // A period goes by in which the motor is told its last torque again.
            let tau = -knob.knob.state().tau;
            knob.handle.push(tau, [knob.hand; 2]);
            knob.knob.missed(1);
        }
        knob.handle.motion()[0]
    };
    let places: Vec<f64> = (0..20_000).map(&mut stand).collect();
    assert!((places[19_999] - places[2_000]).abs() < COUNT);
    assert!(!knob.knob.state().contact.slipping && knob.knob.fault().is_none());
}
