//! A fit against least squares over the samples themselves; and what tests of its parts start from.

mod kept;

use super::*;
use crate::param::Axis;
use crate::random::Noise;
use crate::signals::Signals;
use nalgebra::DVector;

const RATE_HZ: f64 = 1000.0;

/// A knob with inertia and friction, turned to and fro as far as `reach` (rad) and a bit more, with noise (N m) and a
/// torque more of position and direction.
pub fn turned(reach: f64, noise: f64, more: impl Fn(f64, f64) -> f64) -> Signals {
    let parts = [(reach, 3.1), (0.2 * reach, 7.3), (0.03 * reach, 31.0)];
    let over = |of: &dyn Fn(f64) -> f64| (0..4000).map(|i| of(f64::from(i) / RATE_HZ)).collect::<Vec<f64>>();
    let sum =
        |t: f64, of: &dyn Fn(f64, f64, f64) -> f64| parts.iter().map(|(a, w)| of(*a, *w, t)).sum::<f64>();
    let theta = over(&|t| sum(t, &|a, w, t| a * (w * t).sin()));
    let omega = over(&|t| sum(t, &|a, w, t| a * w * (w * t).cos()));
    let alpha = over(&|t| sum(t, &|a, w, t| -a * w * w * (w * t).sin()));
    let mut random = Noise::new(11);
    let tau: Vec<f64> = (0..theta.len())
        .map(|i| {
            let forth = omega[i].signum();
            let knob = 1e-4 * alpha[i] + 4e-3 * forth + 1e-3 * omega[i];
            knob + more(theta[i], forth) + noise * random.normal()
        })
        .collect();
    Signals {
        rate_hz: RATE_HZ,
        substeps: 1,
        t: over(&|t| t),
        forward: omega.iter().map(|omega| f64::from(u8::from(*omega > 0.0))).collect(),
        omega_sd: vec![0.0; theta.len()],
        weight: vec![1.0; theta.len()],
        segments: vec![0..theta.len(); 1],
        tau_raw: tau.clone(),
        theta,
        omega,
        alpha,
        tau,
        ..Signals::default()
    }
}

/// What a wave of this spatial frequency (1/rad) beside inertia and friction takes off the sum of squares, by least
/// squares over the samples themselves; with the sign of the motion if it is one of friction.
pub fn gain(data: &Signals, k: f64, of_friction: bool) -> f64 {
    let rows = data.len();
    let left = |columns: usize| {
        let x = DMatrix::from_fn(rows, columns, |i, j| {
            let (theta, omega, forth) = (data.theta[i], data.omega[i], data.omega[i] > 0.0);
            let sign = if of_friction && !forth { -1.0 } else { 1.0 };
            match j {
                0 => data.alpha[i],
                1 => f64::from(u8::from(forth)),
                2 => f64::from(u8::from(!forth)),
                3 => omega.max(0.0),
                4 => omega.min(0.0),
                5 => sign * (k * theta).sin(),
                _ => sign * (k * theta).cos(),
            }
        });
        let y = DVector::from_column_slice(&data.tau);
        let slope = x.transpose() * &y;
        let solved = (x.transpose() * &x).cholesky().unwrap().solve(&slope);
        (y - x * solved).norm_squared()
    };
    left(5) - left(7)
}

/// Derivatives of the torque by the parameters of a knob without detents, in their order: inertia, then Coulomb's and
/// viscous friction, each backward and forward.
fn design(data: &Signals) -> DMatrix<f64> {
    DMatrix::from_fn(data.len(), 5, |i, j| {
        let (omega, forth) = (data.omega[i], data.omega[i] > 0.0);
        match j {
            0 => data.alpha[i],
            1 => -f64::from(u8::from(!forth)),
            2 => f64::from(u8::from(forth)),
            3 => omega.min(0.0),
            _ => omega.max(0.0),
        }
    })
}

const SD: f64 = 1e-3;

fn fitted(data: &Signals) -> Fit {
    fit(&[data], &Model::equation_1(Axis::Rotary, false), Detents::AsModel).unwrap()
}

#[test]
fn of_white_noise_the_uncertainty_is_that_of_the_textbook() {
    let data = turned(0.9, SD, |_, _| 0.0);
    let found = fitted(&data);
    let x = design(&data);
    let exact = (x.transpose() * &x).try_inverse().unwrap() * (SD * SD);
    let (errors, correlation, band) = (found.standard_errors(), found.correlation(), found.band(&data));
    assert_eq!(found.free.len(), 5);
    for (i, error) in errors.iter().enumerate() {
        assert!((error / exact[(i, i)].sqrt() - 1.0).abs() < 0.06, "{i}: {error}");
        for j in 0..5 {
            let right = exact[(i, j)] / (exact[(i, i)] * exact[(j, j)]).sqrt();
            assert!((correlation[(i, j)] - right).abs() < 0.05, "{i} {j}: {}", correlation[(i, j)]);
        }
    }
    for at in (0..data.len()).step_by(97) {
        let row = x.row(at);
        let right = Z95 * (row * &exact * row.transpose())[(0, 0)].sqrt();
        assert!((band[at] / right - 1.0).abs() < 0.06, "{at}: {} {right}", band[at]);
    }
}

#[test]
fn refits_of_blocks_scatter_as_the_uncertainty_says_about_what_was_found() {
    let data = turned(0.9, SD, |_, _| 0.0);
    let found = fitted(&data);
    let refits = found.bootstrap(1000, 3);
    for ((refits, error), at) in refits.iter().zip(found.standard_errors()).zip(&found.free) {
        let n = refits.len() as f64;
        let mean = refits.iter().sum::<f64>() / n;
        let sd = (refits.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt();
        assert_eq!(refits.len(), 1000);
        assert!((mean - found.model.values()[*at]).abs() < 0.15 * error, "{at}: {mean}");
        assert!((sd / error - 1.0).abs() < 0.2, "{at}: {sd} {error}");
    }
    assert_ne!(refits, found.bootstrap(1000, 4));
    assert!(found.bootstrap(13, 3).iter().all(|refits| refits.len() == 13));
}

#[test]
fn what_a_fit_did_not_see_it_explains_almost_as_well() {
    let data = turned(0.9, SD, |_, _| 0.0);
    let found = fitted(&data);
    // Of p parameters and n samples the error unseen is larger by p / n, about.
    let more = found.rmse_heldout / found.rmse - 1.0;
    assert!((0.0..4.0 * 5.0 / data.len() as f64).contains(&more), "{more}");
    assert!((found.rmse / SD - 1.0).abs() < 0.05 && (found.noise_floor / SD - 1.0).abs() < 0.05);
    assert!((found.white_squares / data.len() as f64 - 1.0).abs() < 0.02, "{}", found.white_squares);
}

#[test]
fn what_a_motion_says_nothing_about_is_named_with_the_reason() {
    let mut data = turned(0.9, SD, |_, _| 0.0);
    for (at, weight) in data.weight.iter_mut().enumerate() {
        *weight = f64::from(u8::from(data.omega[at] > 0.0));
    }
    let names = |found: &Fit| found.undetermined.iter().map(|one| one.name.clone()).collect::<Vec<_>>();
    let forth = fitted(&data);
    assert_eq!(names(&forth), ["coulomb.neg", "viscous.neg"]);
    assert!(
        forth.undetermined.iter().all(|one| one.why.starts_with("nothing in this capture depends on it"))
    );
    // At one speed friction is friction.
    data.omega.fill(2.0);
    data.forward.fill(1.0);
    let steady = fitted(&data);
    let one =
        steady.undetermined.iter().find(|one| one.why.starts_with("this capture cannot tell it")).unwrap();
    let pair = ["coulomb.pos", "viscous.pos"];
    let other = pair.iter().find(|name| **name != one.name).unwrap();
    assert!(pair.contains(&one.name.as_str()) && one.why.contains(other), "{one:?}");
    assert!(!one.why.contains("inertia"), "{one:?}");
}

#[test]
fn detents_are_found_where_they_are_and_nowhere_else() {
    let bare = Model::equation_1(Axis::Rotary, false);
    let search = |more: &dyn Fn(f64) -> f64| {
        let data = turned(0.9, SD, |theta, _| more(theta));
        fit(&[&data], &bare, Detents::Find).unwrap()
    };
    let found = search(&|theta| 5e-3 * (theta / 0.11 + 0.4).sin());
    let value = |name: &str| found.model.values()[found.model.index(name).unwrap()];
    assert!((value("detent.P") / 0.11 - 1.0).abs() < 1e-3 && (value("detent.A") / 5e-3 - 1.0).abs() < 0.05);
    assert!((found.rmse / SD - 1.0).abs() < 0.05);
    let none: [(&str, &dyn Fn(f64) -> f64); 5] = [
        ("nothing", &|_| 0.0),
        ("detents that chance explains", &|theta| 5e-5 * (theta / 0.11).sin()),
        ("a spring", &|theta| 5e-3 * theta),
        ("a cubic", &|theta| 5e-3 * (theta - 1.2 * theta.powi(3))),
        ("less than a wave", &|theta| 5e-3 * (theta / 1.1).cos()),
    ];
    for (what, more) in none {
        let found = search(more);
        assert!(!found.model.has(Id::Detent), "{what}");
        assert!(found.scan.is_some());
    }
}

/// A motion's torque with noise of a memory: of each sample `memory` of the one before.
fn remembering(memory: f64, seed: u64) -> Signals {
    let mut data = turned(0.9, 0.0, |_, _| 0.0);
    let mut random = Noise::new(seed);
    let mut noise = SD / (1.0 - memory * memory).sqrt() * random.normal();
    for tau in &mut data.tau {
        *tau += noise;
        noise = memory * noise + SD * random.normal();
    }
    data.tau_raw = data.tau.clone();
    data
}

#[test]
fn of_noise_with_a_memory_the_uncertainty_is_that_of_the_sandwich() {
    const MEMORY: f64 = 0.8;
    const SEEDS: u64 = 16;
    let x = design(&remembering(MEMORY, 0));
    // The covariance of the noise times the design: each row takes its neighbours by powers of the memory.
    let mut later = x.clone();
    let mut earlier = x.clone();
    for i in 1..x.nrows() {
        let before = later.row(i - 1) * MEMORY;
        later.row_mut(i).zip_apply(&before, |a, b| *a += b);
        let at = x.nrows() - 1 - i;
        let after = earlier.row(at + 1) * MEMORY;
        earlier.row_mut(at).zip_apply(&after, |a, b| *a += b);
    }
    let spread = (later + earlier - &x) * (SD * SD / (1.0 - MEMORY * MEMORY));
    let bread = (x.transpose() * &x).try_inverse().unwrap();
    let exact = &bread * (x.transpose() * spread) * &bread;
    // The memory itself is known from 4000 samples to 0.01, and an error by that much changes an error bar by 5 %.
    let fits: Vec<Fit> = (0..SEEDS).map(|seed| fitted(&remembering(MEMORY, 100 + seed))).collect();
    let mean = |of: &dyn Fn(&Fit) -> f64| fits.iter().map(of).sum::<f64>() / SEEDS as f64;
    for i in 0..5 {
        for j in 0..=i {
            let (found, scale) =
                (mean(&|fit| fit.covariance[(i, j)]), (exact[(i, i)] * exact[(j, j)]).sqrt());
            assert!((found - exact[(i, j)]).abs() < 0.08 * scale, "{i} {j}: {found} {}", exact[(i, j)]);
        }
    }
}

#[test]
fn a_model_that_is_linear_is_solved_at_once() {
    let found = fitted(&turned(0.9, SD, |_, _| 0.0));
    assert_eq!((found.status, found.iterations), (Status::Linear, 1));
}

#[test]
fn only_what_an_undetermined_parameter_hangs_on_is_named_in_any_unit() {
    let mut data = turned(0.9, SD, |_, _| 0.0);
    data.omega = data.alpha.iter().map(|alpha| 2.0 + 1e-6 * alpha).collect();
    data.forward.fill(1.0);
    let steady = fitted(&data);
    let one = steady.undetermined.iter().find(|one| one.why.contains("cannot tell it")).unwrap();
    assert!(!one.why.contains("inertia"), "{one:?}");
}

#[test]
fn a_torque_of_many_times_the_size_has_parameters_of_many_times_the_size() {
    let search = |unit: f64| {
        let mut data = turned(0.9, SD, |theta, _| 5e-3 * (theta / 0.11 + 0.4).sin());
        data.tau.iter_mut().for_each(|tau| *tau *= unit);
        data.tau_raw = data.tau.clone();
        fit(&[&data], &Model::equation_1(Axis::Rotary, false), Detents::Find).unwrap()
    };
    let one = search(1.0);
    assert!(one.model.has(Id::Detent));
    for unit in [1.0 / 1024.0, 256.0] {
        let other = search(unit);
        let linear = |at: usize| one.model.slots()[at].param.kind == crate::param::Kind::Linear;
        for (at, (a, b)) in one.model.values().iter().zip(other.model.values()).enumerate() {
            let right = if linear(at) { unit * a } else { *a };
            assert!((b - right).abs() < 1e-6 * right.abs(), "{unit}: {at}: {b} {right}");
        }
        for (a, b) in one.standard_errors().iter().zip(other.standard_errors()) {
            assert!((b / a - 1.0).abs() < 1e-5 || (b / a / unit - 1.0).abs() < 1e-5, "{unit}: {a} {b}");
        }
        assert!((other.rmse / one.rmse / unit - 1.0).abs() < 1e-9);
        assert!((other.noise_floor / one.noise_floor / unit - 1.0).abs() < 1e-9);
    }
}

#[test]
fn small_detents_beyond_chance_are_found_and_those_beside_a_larger_error_are_not() {
    let bare = Model::equation_1(Axis::Rotary, false);
    let has = |size: f64, other: f64| {
        let data = turned(0.9, SD, |theta, _| size * (theta / 0.11).sin() + other * (theta / 0.013).cos());
        fit(&[&data], &bare, Detents::Find).unwrap().model.has(Id::Detent)
    };
    // A percent of the noise's own variance, and several times what chance does.
    assert!(has(2e-4, 0.0));
    assert!(!has(2e-5, 0.0));
}

#[test]
fn of_a_smooth_torque_and_detents_within_it_the_detents_are_found() {
    let bare = Model::equation_1(Axis::Rotary, false);
    let off = |torque: &dyn Fn(f64) -> f64, period: f64| {
        let data = turned(0.9, SD, |theta, _| torque(theta));
        let model = fit(&[&data], &bare, Detents::Find).unwrap().model;
        (model.values()[model.period().unwrap()] / period - 1.0).abs()
    };
    let detents = |theta: f64| (theta / 0.05 + 0.4).sin();
    assert!(off(&|theta| 0.02 * (theta / 0.45).sin() + 5e-3 * detents(theta), 0.05) < 0.02);
    assert!(off(&|theta| 0.02 * theta + 1e-3 * detents(theta), 0.05) < 0.02);
    assert!(off(&|theta| 0.02 * (theta / 0.45).sin(), 0.45) < 0.05);
}

#[test]
fn detents_that_take_nothing_off_are_not_there() {
    let data = turned(0.9, SD, |theta, _| 5e-3 * (theta / 0.11 + 0.4).sin());
    let bare = Model::equation_1(Axis::Rotary, false);
    let (bare, without, scan) = scan_beside(&[&data], &bare).unwrap();
    let full = bare.with(Id::Detent).unwrap();
    let loudest = loudest(&[&data]);
    let data = [&data];
    let judge = Judge {
        data: &data,
        bare: &bare,
        without: &without,
        scan: &scan,
        loudest: &loudest,
        floor: OnceCell::new(),
    };
    let mut start = full.values();
    start[..without.p.len()].copy_from_slice(&without.p);
    let with = best_from_scan(&data, &full, &Layout::of(&full), &start, &scan).unwrap().unwrap();
    assert!(judge.promising() && judge.are_there(&full, &with).unwrap());
    let nothing = Found { cost: without.cost * (1.0 - 1e-6), ..with };
    assert!(!judge.are_there(&full, &nothing).unwrap());
}

#[test]
fn what_never_moves_or_never_changes_is_refused() {
    let model = Model::equation_1(Axis::Rotary, false);
    let said = |data: &Signals| fit(&[data], &model, Detents::AsModel).map(|_| ()).unwrap_err().to_string();
    let moving = turned(0.9, SD, |_, _| 0.0);
    let still = Signals { theta: vec![0.3; moving.len()], ..moving.clone() };
    assert!(said(&still).contains("never moves"), "{}", said(&still));
    let flat = Signals { tau_raw: vec![0.3; moving.len()], ..moving.clone() };
    assert!(said(&flat).contains("same in every sample"), "{}", said(&flat));
    // One capture that says something is enough.
    assert!(fit(&[&still, &moving], &model, Detents::AsModel).is_ok());
    let linear = Signals { axis: Axis::Linear, ..moving };
    assert!(said(&linear).contains("another kind of axis"));
}

#[test]
fn what_is_missing_widens_the_errors_of_all_parameters_and_leaves_them_a_covariance() {
    let data = turned(0.9, SD, |theta, _| 4e-3 * (theta / 0.3).sin());
    let found = fitted(&data);
    let bare = Model::equation_1(Axis::Rotary, false);
    let plain = report(&[&data], &bare, sketch(&[&data], &bare)).unwrap();
    assert!(found.rmse > 2.0 * found.noise_floor);
    for i in 0..5 {
        for j in 0..5 {
            let [one, other] = [found.covariance[(i, j)], found.covariance[(j, i)]];
            let scale = (found.covariance[(i, i)] * found.covariance[(j, j)]).sqrt();
            assert!((one - other).abs() < 1e-9 * scale && one.abs() < 1.000_001 * scale, "{i} {j}");
        }
    }
    let pairs = found.standard_errors().into_iter().zip(plain.standard_errors());
    let wider: Vec<f64> = pairs.map(|(whole, plain)| whole / plain).collect();
    assert!(wider.iter().all(|times| *times >= 1.0) && wider.iter().any(|times| *times > 1.1), "{wider:?}");
}

#[test]
fn of_few_samples_the_errors_are_larger_by_those_that_the_parameters_took() {
    let mut data = turned(0.9, SD, |_, _| 0.0);
    data.weight = (0..data.len()).map(|at| f64::from(u8::from(at % 100 == 7))).collect();
    let found = fitted(&data);
    let x = design(&data);
    let counted: Vec<usize> = (0..data.len()).filter(|at| data.weight[*at] > 0.0).collect();
    let x = DMatrix::from_fn(counted.len(), 5, |i, j| x[(counted[i], j)]);
    let variance = found.rmse.powi(2) * 40.0 / (40.0 - 5.0);
    let exact = (x.transpose() * &x).try_inverse().unwrap() * variance;
    for (i, error) in found.standard_errors().iter().enumerate() {
        assert!((error / exact[(i, i)].sqrt() - 1.0).abs() < 1e-3, "{i}: {error} {}", exact[(i, i)].sqrt());
    }
}

#[test]
fn more_samples_are_asked_for_than_twice_the_parameters_and_ten() {
    let model = Model::equation_1(Axis::Rotary, false);
    let of = |samples: usize| {
        let mut data = turned(0.9, SD, |_, _| 0.0);
        let every = data.len() / samples;
        data.weight =
            (0..data.len()).map(|at| f64::from(u8::from(at % every == 0 && at < samples * every))).collect();
        fit(&[&data], &model, Detents::AsModel)
    };
    let said = of(20).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("has 20 samples that count, too few to fit 5 parameters"), "{said}");
    assert!(of(21).is_ok());
}

#[test]
fn waves_that_do_not_return_within_a_turn_are_detents_of_a_slide_and_of_no_knob() {
    let data = turned(4.0, SD, |theta, _| 5e-3 * theta.sin());
    let slide = Signals { axis: Axis::Linear, ..data.clone() };
    for (data, axis) in [(data, Axis::Rotary), (slide, Axis::Linear)] {
        let found = fit(&[&data], &Model::equation_1(axis, false), Detents::Find).unwrap();
        assert_eq!(found.model.has(Id::Detent), axis == Axis::Linear);
    }
}
