//! What is rendered never feeds a hand, or says by which term it would.

use knobcore::effects::Id;
use knobcore::model::Model;
use knobcore::model_file;
use knobcore::param::Axis;
use knobrender::{Device, Fault, Limits, Renderer, TANK_J, check_passive, check_stability};
use knobrig::emulate::Handle;

const RATE: f64 = 5000.0;
const LIMITS: Limits = Limits { torque: 0.5, torque_rate: 2000.0, speed: 100.0 };

fn device(delay: usize) -> Device {
    Device {
        inertia: 5e-5,
        damping: 1e-4,
        delay,
        torque_limit: 0.5,
        torque_rate_limit: 2000.0,
        encoder_step: 9.8e-6,
        held: false,
    }
}

fn knob(n: usize) -> Model {
    let path = format!("{}/../../python/knobcam/model/knobs/knob{n}.toml", env!("CARGO_MANIFEST_DIR"));
    model_file::parse(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Knob 4 with one more effect.
fn with(id: Id, values: &[(&str, f64)]) -> Model {
    let mut model = knob(4);
    if !model.has(id) {
        model = model.with(id).unwrap();
    }
    values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
    model
}

fn refused(model: &Model, device: Option<Device>) -> String {
    check_passive(model, device, RATE).unwrap_err().to_string()
}

#[test]
fn the_knobs_of_the_paper_are_rendered_at_any_delay_that_they_were_measured_with() {
    for n in 1..=5 {
        assert_eq!(check_passive(&knob(n), None, RATE), Ok(()), "knob {n}");
        for delay in 0..=10 {
            assert_eq!(check_passive(&knob(n), Some(device(delay)), RATE), Ok(()), "knob {n}, {delay}");
        }
    }
}

#[test]
fn a_term_that_feeds_the_hand_is_named() {
    for (id, name, value) in [
        (Id::ReturnSpring, "return_spring.k", -5.0),
        (Id::ReturnSpring, "return_spring.k", -0.01),
        (Id::Inertia, "inertia.M", -5e-5),
        (Id::Coulomb, "coulomb.neg", -0.002),
        (Id::Coulomb, "coulomb.pos", -0.002),
        (Id::Viscous, "viscous.neg", -5e-4),
        (Id::Viscous, "viscous.pos", -5e-4),
        (Id::PositionPolynomial, "position_polynomial.p1", -1.0),
        (Id::PositionPolynomial, "position_polynomial.p2", 0.1),
        (Id::PositionPolynomial, "position_polynomial.p3", -0.1),
        (Id::QuadraticDrag, "quadratic_drag.d", -1e-2),
    ] {
        let said = refused(&with(id, &[(name, value)]), None);
        assert!(said.starts_with(&format!("{name}: is {value} ")), "{said}");
        assert!(said.len() <= 120, "a NAK has room for it: {said}");
    }
}

#[test]
fn what_dry_friction_outweighs_over_the_range_is_rendered() {
    for (pos, passes) in [(-1e-4, true), (-2.1e-4, true), (-2.3e-4, false)] {
        // 0.0011 N m of dry friction at 5 rad/s.
        let model = with(Id::Viscous, &[("viscous.pos", pos)]);
        assert_eq!(check_passive(&model, None, RATE).is_ok(), passes, "{pos}");
    }
}

#[test]
fn a_model_says_itself_how_far_and_how_fast_it_is_turned() {
    // 0.0011 N m of dry friction: at 5 rad/s it is not enough, at 4 rad/s it is.
    let mut slow = with(Id::Viscous, &[("viscous.pos", -2.3e-4)]);
    assert!(check_passive(&slow, None, RATE).is_err());
    slow.reach = Some([1.0, 4.0]);
    assert_eq!(check_passive(&slow, None, RATE), Ok(()));
    // Over a turn the spring brings it back, over two the cubic wins.
    let cubic = [("position_polynomial.p1", 0.01), ("position_polynomial.p3", -1e-4)];
    let mut far = with(Id::PositionPolynomial, &cubic);
    assert_eq!(check_passive(&far, None, RATE), Ok(()));
    far.reach = Some([20.0, 5.0]);
    assert!(refused(&far, None).contains("pushes the handle away, out of its range"));
    let back = model_file::parse(&model_file::write(&far)).unwrap();
    assert_eq!(back.reach, far.reach);
    assert!(check_passive(&back, None, RATE).is_err());
}

#[test]
fn a_spring_that_is_too_stiff_for_the_delay_is_named_on_that_device_alone() {
    let stiff = with(Id::ReturnSpring, &[("return_spring.k", 200.0)]);
    assert_eq!(check_passive(&stiff, None, RATE), Ok(()));
    assert!(!check_stability(&stiff, device(10), RATE).unwrap().is_stable());
    let said = refused(&stiff, Some(device(10)));
    assert!(said.starts_with("return_spring.k: is 200 N m/rad: rings"), "{said}");
    // Ten samples, and half a one until its torque has acted.
    assert!(said.contains("acts 2.1 ms late"), "{said}");
    assert!(Renderer::new(&stiff, RATE, Some(device(10)), LIMITS).is_err());
    assert_eq!(check_passive(&stiff, Some(Device { held: true, ..device(10) }), RATE), Ok(()));
}

#[test]
fn springs_stops_and_unbalance_that_come_back_are_rendered() {
    for (id, values) in [
        (Id::ReturnSpring, &[("return_spring.k", 0.05), ("return_spring.theta0", 1.0)][..]),
        (Id::Unbalance, &[("unbalance.a", 0.02), ("unbalance.phi", 2.0)]),
        (Id::PositionPolynomial, &[("position_polynomial.p1", -0.01), ("position_polynomial.p3", 0.01)]),
    ] {
        assert_eq!(check_passive(&with(id, values), None, RATE), Ok(()), "{values:?}");
    }
}

#[test]
fn a_model_that_is_forced_gives_out_what_its_tank_holds_and_then_lets_go() {
    let pushing = with(Id::ReturnSpring, &[("return_spring.k", -5.0)]);
    assert!(Renderer::new(&pushing, RATE, None, LIMITS).is_err());
    let mut knob = Renderer::forced(&pushing, RATE, Some(device(0)), LIMITS).unwrap();
    let mut handle = Handle::new(device(0), 1.0 / RATE, 0.01);
    let (mut most, mut last) = (0.0_f64, 1.0);
    for _ in 0..5000 {
        last = knob.step(handle.sensed(None));
        handle.push(-last, [0.0; 2]);
        most = most.max(handle.energy());
    }
    assert_eq!((knob.fault(), last), (Some(Fault::Energy), 0.0));
    // One sample's worth more at the most: the tank is looked at before a torque is given, not after.
    assert!(most <= TANK_J + 0.5 * 100.0 / RATE, "{most}");
    knob.reset();
    assert!(knob.fault().is_none() && knob.state().tank == TANK_J);
}

#[test]
fn the_tank_of_a_passive_model_lasts() {
    let spring = with(Id::ReturnSpring, &[("return_spring.k", 0.05)]);
    let mut knob = Renderer::forced(&spring, RATE, Some(device(0)), LIMITS).unwrap();
    let mut handle = Handle::new(device(0), 1.0 / RATE, 0.0);
    for i in 0..50_000 {
        let tau = knob.step(handle.sensed(None));
        let hand = 0.04 * (2e-3 * f64::from(i)).sin();
        handle.push(-tau, [hand, hand]);
    }
    assert_eq!(knob.fault(), None);
}

#[test]
fn a_motor_that_follows_a_dent_late_is_ended_before_it_feeds_the_hand() {
    let mut deep = with(Id::Detent, &[("detent.A", -0.84), ("detent.P", 0.104)]);
    deep.set("detent.S", 0.0).unwrap();
    let slow = Limits { torque: 0.68, torque_rate: 47.0, speed: 1000.0 };
    let device = Device { torque_limit: 1.0, ..device(0) };
    let mut knob = Renderer::new(&deep, RATE, Some(device), slow).unwrap();
    let held = knob.state().tank;
    // Twice the amplitude times P from the top of a dent to its ground, and 0.1 J.
    assert!((held - TANK_J - 2.0 * 0.84 * 0.104).abs() < 1e-3, "{held}");
    let mut handle = Handle::new(device, 1.0 / RATE, 0.01);
    let (mut most, mut last) = (0.0_f64, 1.0);
    for _ in 0..20_000 {
        last = knob.step(handle.sensed(None));
        handle.push(-last, [0.0; 2]);
        most = most.max(handle.energy());
    }
    assert!(most <= held + 0.68 * 100.0 / RATE, "{most}");
    assert_eq!((knob.fault(), last), (Some(Fault::Energy), 0.0));
}

#[test]
fn the_torque_starts_from_zero_also_in_a_dent() {
    let slow = Limits { torque_rate: 5.0, ..LIMITS };
    let mut knob = Renderer::new(&knob(5), RATE, None, slow).unwrap();
    let still = knobrender::Sensed { theta: 0.1, omega: 0.0, alpha: 0.0, hand: None };
    let first = knob.step(still).abs();
    assert!(first > 0.0 && first <= 5.0 / RATE * (1.0 + 1e-12), "{first}");
}

#[test]
fn a_linear_axis_has_a_range_of_its_own() {
    let mut model = Model::equation_1(Axis::Linear, false);
    model.set("coulomb.pos", 1.0).unwrap();
    model.set("viscous.pos", -0.9).unwrap();
    assert_eq!(check_passive(&model, None, RATE), Ok(()));
    model.set("viscous.pos", -1.1).unwrap();
    assert!(refused(&model, None).contains("N s/m"), "{}", refused(&model, None));
}

/// Knob 4 with friction of this size both ways.
fn rubbed(mut model: Model, friction: f64) -> Model {
    for name in ["coulomb.neg", "coulomb.pos", "karnopp.D_neg", "karnopp.D_pos"] {
        model.set(name, friction).unwrap();
    }
    model
}

#[test]
fn what_pushes_away_is_rendered_where_friction_takes_its_work_over_the_outer_half() {
    // The spring gives 3/8 of its stiffness times the range squared from halfway to the end.
    let limit = |friction: f64| {
        let passes = |k: f64| {
            let model =
                rubbed(with(Id::ReturnSpring, &[("return_spring.k", -k), ("detent.A", 0.0)]), friction);
            check_passive(&model, None, RATE).is_ok()
        };
        let (mut low, mut high) = (0.0, 10.0 * friction);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if passes(middle) { low = middle } else { high = middle }
        }
        low
    };
    let [one, two] = [0.01, 0.02].map(limit);
    let expected = 4.0 / 3.0 * 0.01 / std::f64::consts::TAU;
    assert!(one > expected && one < 1.15 * expected, "{one} {expected}");
    assert!((two / one - 2.0).abs() < 0.01, "{one} {two}");
}

#[test]
fn a_dent_at_the_end_of_the_range_is_no_push_where_the_deepest_place_is_before_it() {
    // Its lowest places are at 5.34 rad to either side, and a dent at the very end leads outward.
    let dented = |depth: f64| {
        with(
            Id::PositionPolynomial,
            &[
                ("position_polynomial.p1", -1.0),
                ("position_polynomial.p3", 1.0 / 28.5),
                ("detent.A", depth),
                ("detent.P", 0.1),
                ("detent.S", 0.25 * std::f64::consts::TAU),
            ],
        )
    };
    for depth in [4.0, -4.0] {
        assert_eq!(check_passive(&dented(depth), None, RATE), Ok(()), "{depth}");
    }
}

#[test]
fn a_tank_holds_what_a_spring_holds_at_the_end_of_the_range() {
    let mut spring = Model::new(&[Id::Inertia, Id::Coulomb, Id::ReturnSpring], Axis::Rotary);
    for (name, value) in
        [("inertia.M", 5e-5), ("coulomb.neg", 1e-3), ("coulomb.pos", 1e-3), ("return_spring.k", 0.3)]
    {
        spring.set(name, value).unwrap();
    }
    let held = Renderer::new(&spring, RATE, Some(device(0)), LIMITS).unwrap().state().tank - TANK_J;
    let expected = 0.5 * 0.3 * std::f64::consts::TAU.powi(2);
    assert!((held / expected - 1.0).abs() < 1e-9, "{held} {expected}");
}

/// Knob 4 without detents, on a spring on which it swings so many times in 0.4 s; its friction, N m, and what that gains
/// or loses with the speed, N m s/rad.
fn swinging(times: f64, friction: f64, viscous: f64) -> Model {
    let w = std::f64::consts::TAU * 2.5 * times;
    let mut model = knob(4).with(Id::Compliance).unwrap();
    for (name, value) in [
        ("compliance.k", 0.7 * 4.9e-5 * w * w),
        ("compliance.d", 1e-6),
        ("compliance.share", 0.7),
        ("detent.A", 0.0),
        ("viscous.neg", viscous),
        ("viscous.pos", viscous),
    ] {
        model.set(name, value).unwrap();
    }
    rubbed(model, friction)
}

#[test]
fn a_mass_on_a_spring_gives_back_what_it_took_and_is_rendered() {
    for friction in [0.0, 1e-4, 1e-3] {
        for times in [0.6, 0.9, 1.0, 1.1, 1.5, 2.0, 2.5, 3.0, 4.5, 6.0, 10.0, 14.0] {
            let model = swinging(times, friction, 0.0);
            assert_eq!(check_passive(&model, None, RATE), Ok(()), "{times} {friction}");
        }
    }
}

#[test]
fn what_falls_short_of_friction_beyond_the_range_feeds_the_hand_where_a_spring_swings_that_fast() {
    let told = |times: f64| check_passive(&swinging(times, 2e-3, -3.9e-4), None, RATE).err();
    let said: Vec<String> = [0.8, 0.9, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0]
        .into_iter()
        .filter_map(told)
        .map(|why| why.to_string())
        .collect();
    assert!(said.len() >= 5, "{said:?}");
    assert!(said.iter().all(|why| why.contains("feeds the hand by")), "{said:?}");
    assert!(said.iter().filter(|why| why.starts_with("viscous.")).count() > said.len() / 2, "{said:?}");
    // Where a mass hardly swings friction is enough.
    assert_eq!(check_passive(&swinging(60.0, 3e-3, -3.9e-4), None, RATE), Ok(()));
    // What only a fast hand brings to swing is found too.
    assert!(check_passive(&swinging(4.0, 3e-3, -3.9e-4), None, RATE).is_err());
}

#[test]
fn a_knob_is_asked_from_the_place_where_its_spring_holds_nothing() {
    for rest in [-2.5, 0.0, 2.5] {
        let mut model = swinging(1.5, 1e-4, 0.0).with(Id::ReturnSpring).unwrap();
        model.set("return_spring.k", 5e-3).unwrap();
        model.set("return_spring.theta0", rest).unwrap();
        assert_eq!(check_passive(&model, None, RATE), Ok(()), "{rest}");
    }
}

#[test]
fn a_term_that_is_no_number_where_the_knob_goes_is_named() {
    let model = with(Id::PositionPolynomial, &[("position_polynomial.p3", 1e308)]);
    let said = refused(&model, None);
    assert!(said.starts_with("position_polynomial.p3: ") && said.contains("gives "), "{said}");
}
