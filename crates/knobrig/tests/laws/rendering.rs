//! Rendering is prediction, sample by sample, wherever the knob slides.

use super::*;
use knobrender::{Limits, Renderer, Sensed, State};

pub const OPEN: Limits = Limits { torque: f64::INFINITY, torque_rate: f64::INFINITY, speed: 1000.0 };
/// Samples after a reversal in which friction builds up again.
const AFTER: usize = 60;

fn renderer(model: &Model) -> Renderer {
    Renderer::new(model, RATE_HZ, None, OPEN).unwrap()
}

pub fn sensed(i: usize) -> Sensed {
    let motion = motion(i as f64 / RATE_HZ);
    Sensed { theta: motion.theta, omega: motion.omega, alpha: motion.alpha, hand: None }
}

/// Effects of the knob: those of the sensor stay behind on the rig.
fn felt() -> impl Iterator<Item = Id> {
    Id::BUILT_IN.iter().copied().filter(|id| id.info().place != Place::Sensor)
}

#[test]
fn a_rendered_knob_that_slides_is_the_predicted_knob() {
    let mut noise = Noise::new(11);
    for id in felt() {
        let model = plausible_knob(id, &mut noise);
        let whole = torque(&model);
        let mut knob = renderer(&model);
        let rendered: Vec<f64> = (0..2 * CYCLE).map(|i| knob.step(sensed(i))).collect();
        let steady = |i: &usize| {
            let around = &whole.forward[i - AFTER..=*i];
            around.iter().all(|forward| *forward == around[0])
        };
        let far: Vec<usize> = (CYCLE..2 * CYCLE).filter(steady).collect();
        let scale = rms(far.iter().map(|i| whole.tau[*i]));
        let apart = rms(far.iter().map(|i| rendered[*i] - whole.tau[*i])) / scale;
        assert!(apart < 1e-9, "{}: {apart} of the torque apart", name(id));
    }
}

#[test]
fn a_batch_is_single_steps_to_the_last_bit() {
    let mut noise = Noise::new(12);
    for id in felt() {
        let model = plausible_knob(id, &mut noise);
        let steps: Vec<Sensed> = (0..CYCLE + 3).map(sensed).collect();
        let column = |of: fn(&Sensed) -> f64| steps.iter().map(of).collect::<Vec<f64>>();
        let (theta, omega, alpha) = (column(|s| s.theta), column(|s| s.omega), column(|s| s.alpha));
        let mut one = renderer(&model);
        let single: Vec<f64> = steps.iter().map(|s| one.step(*s)).collect();
        let mut knob = renderer(&model);
        let mut batch = vec![0.0; steps.len()];
        // In two parts of odd lengths, so that the packs fall differently.
        let (first, second) = batch.split_at_mut(1237);
        knob.render([&theta[..1237], &omega[..1237], &alpha[..1237]], None, first);
        knob.render([&theta[1237..], &omega[1237..], &alpha[1237..]], None, second);
        let same = single.iter().zip(&batch).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{}", name(id));
        assert_eq!(one.state(), knob.state(), "{}", name(id));
    }
}

#[test]
fn a_batch_is_single_steps_also_where_a_knob_rests_creeps_and_turns_round() {
    let model = plausible_knob(Id::Coulomb, &mut Noise::new(16));
    let mut noise = Noise::new(17);
    // Stretches at one of a few speeds, zero of either sign among them, some of them long.
    let (mut theta, mut omega) = (vec![0.3], vec![0.0]);
    while theta.len() < 12_000 {
        let speed = [-2.0, -1e-4, -0.0, 0.0, 1e-4, 2.0][(6.0 * noise.uniform()) as usize];
        for _ in 0..[1, 3, 16, 90][(4.0 * noise.uniform()) as usize] {
            theta.push(theta[theta.len() - 1] + speed / RATE_HZ);
            omega.push(speed);
        }
    }
    let alpha = vec![0.0; theta.len()];
    let mut one = renderer(&model);
    let single: Vec<u64> = (0..theta.len())
        .map(|i| one.step(Sensed { theta: theta[i], omega: omega[i], alpha: 0.0, hand: None }).to_bits())
        .collect();
    let mut batch = vec![0.0; theta.len()];
    let mut knob = renderer(&model);
    knob.render([&theta, &omega, &alpha], None, &mut batch);
    assert!(single.iter().zip(&batch).all(|(a, b)| *a == b.to_bits()));
    assert_eq!(one.state(), knob.state());
}

#[test]
fn a_batch_lets_go_at_the_sample_where_single_steps_do() {
    let mut noise = Noise::new(15);
    let model = plausible_knob(Id::Detent, &mut noise);
    let steps: Vec<Sensed> = (0..900).map(sensed).collect();
    for broken in [800, 803] {
        let mut omega: Vec<f64> = steps.iter().map(|s| s.omega).collect();
        omega[broken] = f64::NAN;
        let column = |of: fn(&Sensed) -> f64| steps.iter().map(of).collect::<Vec<f64>>();
        let (theta, alpha) = (column(|s| s.theta), column(|s| s.alpha));
        let mut knob = renderer(&model);
        let mut batch = vec![1.0; steps.len()];
        knob.render([&theta, &omega, &alpha], None, &mut batch);
        let mut one = renderer(&model);
        let single =
            (0..900).map(|i| one.step(Sensed { omega: omega[i], ..steps[i] }).to_bits()).collect::<Vec<_>>();
        assert_eq!(batch.iter().map(|tau| tau.to_bits()).collect::<Vec<_>>(), single);
        assert!(batch[broken..].iter().all(|tau| *tau == 0.0) && batch[broken - 1] != 0.0);
    }
}

#[test]
fn a_state_that_is_put_back_goes_on_as_before() {
    let mut noise = Noise::new(13);
    for id in felt() {
        let model = plausible_knob(id, &mut noise);
        let mut knob = renderer(&model);
        for i in 0..1500 {
            knob.step(sensed(i));
        }
        let state: State = knob.state().clone();
        let once: Vec<u64> = (1500..2500).map(|i| knob.step(sensed(i)).to_bits()).collect();
        let mut other = renderer(&model);
        other.set_state(state).unwrap();
        let again: Vec<u64> = (1500..2500).map(|i| other.step(sensed(i)).to_bits()).collect();
        assert_eq!(once, again, "{}", name(id));
        other.reset();
        assert_eq!(other.state(), renderer(&model).state(), "{}", name(id));
    }
}

#[test]
fn no_rendered_effect_gives_energy_over_a_closed_cycle() {
    let mut noise = Noise::new(14);
    for id in felt() {
        let mut knob = renderer(&plausible_knob(id, &mut noise));
        for i in 0..CYCLE {
            knob.step(sensed(i));
        }
        let power: Vec<f64> = (CYCLE..2 * CYCLE).map(|i| knob.step(sensed(i)) * sensed(i).omega).collect();
        let (work, scale): (f64, f64) = (power.iter().sum(), power.iter().map(|p| p.abs()).sum());
        assert!(work >= -1e-3 * scale, "{} gives {} of what it moves", name(id), -work / scale);
    }
}

#[test]
fn a_knob_that_turns_back_lets_go_of_its_friction_evenly_before_it_resists_the_other_way() {
    let mut model = Model::new(&[Id::Inertia, Id::Coulomb], Axis::Rotary);
    for (name, value) in [("inertia.M", 1.5e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.03)] {
        model.set(name, value).unwrap();
    }
    let mut knob = renderer(&model);
    let (forth, back) = (1.0, 0.05);
    let felt: Vec<f64> = (0..400)
        .map(|i| {
            let t = f64::from(i) / RATE_HZ;
            let turned = t.min(0.02);
            let omega = if t < 0.02 { forth } else { -back };
            knob.step(Sensed { theta: forth * turned - back * (t - turned), omega, alpha: 0.0, hand: None })
        })
        .collect();
    assert!((felt[99] - 0.03).abs() < 1e-9 && (felt[399] + 0.02).abs() < 1e-3, "{} {}", felt[99], felt[399]);
    // Between both friction is a spring, which turns back by as much in each sample.
    let spring: Vec<f64> = felt.windows(2).skip(101).map(|two| two[0] - two[1]).collect();
    let whole: Vec<f64> = spring.into_iter().take_while(|fall| *fall > 1e-6).collect();
    let most = whole.iter().copied().fold(0.0, f64::max);
    assert!(whole.len() > 5 && whole.iter().sum::<f64>() > 0.04, "{whole:?}");
    assert!(whole[..whole.len() - 1].iter().all(|fall| *fall > 0.9 * most), "{whole:?}");
}

#[test]
fn a_knob_that_a_spring_of_its_friction_strains_breaks_away_where_one_without_does() {
    let breakaway = |effects: &[Id], sign: f64| {
        let mut model =
            Model::new(&[&[Id::Inertia, Id::Coulomb, Id::Karnopp], effects].concat(), Axis::Rotary);
        for (name, value) in [
            ("inertia.M", 1.5e-4),
            ("coulomb.neg", 0.02),
            ("coulomb.pos", 0.02),
            ("karnopp.D_neg", 0.05),
            ("karnopp.D_pos", 0.04),
            ("karnopp.dv", 0.5),
            ("presliding.s", 2e-3),
            ("presliding.w1", 0.8),
        ] {
            if model.index(name).is_ok() {
                model.set(name, value).unwrap();
            }
        }
        let mut knob = renderer(&model);
        let omega = sign * 0.02;
        let felt = (0..4000).map(|i| {
            knob.step(Sensed { theta: omega * f64::from(i) / RATE_HZ, omega, alpha: 0.0, hand: None }).abs()
        });
        felt.fold(0.0, f64::max)
    };
    for (sign, most) in [(1.0, 0.04), (-1.0, 0.05)] {
        let (plain, strained) = (breakaway(&[], sign), breakaway(&[Id::Presliding], sign));
        assert!((plain / most - 1.0).abs() < 0.01, "{sign}: {plain}");
        assert!((strained / most - 1.0).abs() < 0.05, "{sign}: {strained}");
    }
}
