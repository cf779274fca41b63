//! Motions with impacts: a knob that sticks and slips, an end stop, a hand that lets go.

use super::motion::{self, Motion, even, rms};
use crate::smooth::lifts::Lifts;
use crate::smooth::rts::smooth_rows;
use crate::smooth::state::Model;
use crate::smooth::{Noise, Smoothed, noise_from_capture, smooth};

const FINE: f64 = 9.8e-6;
const SAMPLES: u32 = 20_000;

/// Theta, omega and alpha from pieces of constant jerk: (start, alpha there, jerk), or a stop: (start, 0, 0)
/// with `None`. Starts are on samples; theta and omega go on from piece to piece.
fn pieces(all: &[(f64, Option<(f64, f64)>)]) -> Motion {
    let mut starts: Vec<(f64, [f64; 4])> = Vec::new();
    for &(start, driven) in all {
        let [theta, omega, _] = starts.last().map_or([0.0; 3], |(before, piece)| at(piece, start - before));
        starts.push((
            start,
            driven.map_or([theta, 0.0, 0.0, 0.0], |(alpha, jerk)| [theta, omega, alpha, jerk]),
        ));
    }
    Motion::of(even(SAMPLES), |t| {
        let here = starts.partition_point(|(start, _)| *start <= t + 1e-9) - 1;
        at(&starts[here].1, t - starts[here].0)
    })
}

fn at([theta, omega, alpha, jerk]: &[f64; 4], t: f64) -> [f64; 3] {
    [
        theta + t * (omega + t * (alpha / 2.0 + t * jerk / 6.0)),
        omega + t * (alpha + t * jerk / 2.0),
        alpha + t * jerk,
    ]
}

/// A knob that sticks for 0.3 s and slips for 10 ms, ten times; starts of the slips.
fn stick_slip() -> (Motion, Vec<f64>) {
    let slips: Vec<f64> = (1..11).map(|i| 0.3 * f64::from(i)).collect();
    let slide = |&slip: &f64| [(slip, Some((-1400.0, 2.8e5))), (slip + 0.01, None)];
    let all: Vec<_> = std::iter::once((0.0, None)).chain(slips.iter().flat_map(slide)).collect();
    (pieces(&all), slips)
}

/// A knob at 10 rad/s meets a stop that throws it back within 2 ms.
fn end_stop() -> Motion {
    pieces(&[
        (0.0, Some((0.0, 10.0))),
        (1.0, Some((5.0, 0.0))),
        (2.0, Some((-9000.0, 0.0))),
        (2.002, Some((-1.0, 0.0))),
    ])
}

/// A hand at 80 rad/s^2 lets go, and friction slows the knob down.
fn hand_release() -> Motion {
    pieces(&[(0.0, Some((0.0, 80.0))), (1.0, Some((-12.0, 2.0)))])
}

fn smoothed(seen: &Motion) -> Smoothed {
    smooth(&seen.sensors(), &noise_from_capture(&seen.sensors()).unwrap()).unwrap()
}

/// Root mean square of the error of omega, in units of its standard deviation, over `rows`.
fn calibration(motion: &Smoothed, truth: &Motion, rows: impl Iterator<Item = usize>) -> f64 {
    let squares: Vec<f64> =
        rows.map(|k| ((motion.omega[k] - truth.omega[k]) / motion.omega_sd[k]).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Rows within `reach` s of one of the `times`.
fn near(times: &[f64], reach: f64) -> impl Iterator<Item = usize> {
    let times = times.to_vec();
    (0..SAMPLES as usize).filter(move |&k| times.iter().any(|time| (k as f64 * 2e-4 - time).abs() < reach))
}

#[test]
fn a_stuck_knob_does_not_creep_before_it_slips() {
    let (truth, slips) = stick_slip();
    for seed in [1, 2, 3] {
        let motion = smoothed(&truth.seen(seed, FINE));
        let stuck = |k: &usize| {
            let t = *k as f64 * 2e-4;
            slips.iter().all(|slip| t < slip - 0.003 || t > slip + 0.013)
        };
        let creep: Vec<f64> = (0..SAMPLES as usize).filter(stuck).map(|k| motion.omega[k]).collect();
        let mut sds: Vec<f64> = (0..SAMPLES as usize).filter(stuck).map(|k| motion.omega_sd[k]).collect();
        let usual = *sds.select_nth_unstable_by(creep.len() / 2, f64::total_cmp).1;
        let creep = rms(&creep, &vec![0.0; creep.len()], |_| usual);
        assert!(creep < 3.0, "{creep}");
    }
}

#[test]
fn velocity_is_honest_within_5_ms_of_an_impact() {
    let (slipping, slips) = stick_slip();
    let cases = [
        ("stick-slip", slipping, slips),
        ("end stop", end_stop(), vec![2.0]),
        ("hand release", hand_release(), vec![1.0]),
    ];
    for (name, truth, impacts) in cases {
        for seed in [1, 2, 3] {
            let motion = smoothed(&truth.seen(seed, FINE));
            let honest = calibration(&motion, &truth, near(&impacts, 0.005));
            assert!(honest < 3.0, "{name}: {honest}");
            let everywhere = calibration(&motion, &truth, 0..SAMPLES as usize);
            assert!(everywhere < 1.5, "{name}: {everywhere}");
        }
    }
}

#[test]
fn the_peak_velocity_of_a_slip_is_kept() {
    let (truth, _) = stick_slip();
    let peak = |omega: &[f64]| omega.iter().fold(0.0_f64, |most, omega| most.max(omega.abs()));
    let motion = smoothed(&truth.seen(4, FINE));
    assert!((peak(&motion.omega) / peak(&truth.omega) - 1.0).abs() < 0.01);
}

#[test]
fn a_smooth_motion_is_untouched_bit_for_bit() {
    let motions = [
        Motion::of(even(SAMPLES), motion::multisine),
        Motion::of(even(SAMPLES), motion::chirp),
        Motion::of(even(SAMPLES), motion::fast_turns),
        motion::slow_hand(SAMPLES, 5),
    ];
    for truth in motions {
        for seed in 1..6 {
            let seen = truth.seen(seed, FINE);
            for sensors in [seen.sensors(), seen.theta_alone()] {
                let noise = noise_from_capture(&sensors).unwrap();
                let plain = smooth_rows(&sensors, &Model::new(&noise, sensors.step()), &Lifts::default());
                let motion = smooth(&sensors, &noise).unwrap();
                assert_eq!(motion.theta, plain.values[0]);
                assert_eq!(motion.omega, plain.values[1]);
                assert_eq!(motion.omega_sd, plain.sds[1]);
            }
        }
    }
}

#[test]
fn coloured_noise_of_the_angle_does_not_explode() {
    let truth = Motion::of(even(SAMPLES), motion::multisine);
    let mut seen = truth.seen(6, FINE);
    let mut normal = crate::random::Noise::new(8);
    let (mut slow, mut loops) = (0.0, 0.0);
    for theta in &mut seen.theta {
        // A phase-locked loop passes the noise of its detector below 100 Hz.
        slow += 0.12 * (1e-4 * normal.normal() - slow);
        loops += 0.12 * (slow - loops);
        *theta += loops;
    }
    let motion = smoothed(&seen);
    let plain = Model::new(&motion.noise, seen.sensors().step());
    let plain = smooth_rows(&seen.sensors(), &plain, &Lifts::default());
    let error = rms(&motion.omega, &truth.omega, |_| 1.0);
    assert!(error < 1.5 * rms(&plain.values[1], &truth.omega, |_| 1.0), "{error}");
}

#[test]
fn jerk_that_is_far_too_low_is_raised_where_the_motion_asks() {
    let truth = Motion::of(even(SAMPLES), motion::fast_turns);
    let seen = truth.seen(9, FINE);
    let noise = Noise { jerk: 1.0, ..noise_from_capture(&seen.sensors()).unwrap() };
    let motion = smooth(&seen.sensors(), &noise).unwrap();
    let honest = rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
    assert!(honest < 3.0, "{honest}");
}

#[test]
fn a_wild_reading_of_one_sensor_is_named_and_an_impact_is_not() {
    for seed in [1, 2, 3] {
        let mut seen = Motion::of(even(SAMPLES), motion::multisine).seen(seed, FINE);
        assert!(smoothed(&seen).strays.iter().all(Vec::is_empty));
        seen.omega[9_000] -= 5.0;
        seen.alpha[5_000] += 800.0;
        assert_eq!(smoothed(&seen).strays, [vec![], vec![9_000], vec![5_000]]);
        for truth in [stick_slip().0, end_stop(), hand_release()] {
            let seen = truth.seen(seed, FINE);
            let strays = smoothed(&seen).strays;
            assert!(strays.iter().all(Vec::is_empty), "seed {seed}: {strays:?}");
            let alone = seen.theta_alone();
            let motion = smooth(&alone, &noise_from_capture(&alone).unwrap()).unwrap();
            assert!(motion.strays.iter().all(Vec::is_empty));
        }
    }
}

#[test]
fn a_few_velocities_in_a_row_are_left_out_where_angle_and_acceleration_both_tell() {
    let mut seen = Motion::of(even(SAMPLES), motion::multisine).seen(5, FINE);
    let runs: [(usize, &[f64]); 4] = [
        (4_260, &[12.3, 5.9, -7.2, -5.9]),
        (9_320, &[-14.2, -12.9, -11.7, -19.4]),
        (7_000, &[8.0, 9.0]),
        (2_000, &[-4.0, 5.0, 5.0]),
    ];
    let mut rows = Vec::new();
    for (first, off) in runs {
        rows.extend(first..first + off.len());
        seen.omega[first..].iter_mut().zip(off).for_each(|(omega, off)| *omega += off);
    }
    rows.sort_unstable();
    let [theta, mut omega, alpha] = smoothed(&seen).strays;
    omega.sort_unstable();
    assert_eq!((theta, omega, alpha), (vec![], rows, vec![]));
}

#[test]
fn a_sensor_that_is_off_for_some_ms_is_left_out_and_the_motion_stays_what_it_was() {
    let truth = Motion::of(even(SAMPLES), motion::multisine);
    for (sensor, off) in [(0, 0.1), (1, 2.0), (2, 300.0)] {
        let mut seen = truth.seen(4, FINE);
        let sound = smoothed(&seen);
        let rows: Vec<usize> = (9_000..9_040).collect();
        let column = [&mut seen.theta, &mut seen.omega, &mut seen.alpha];
        column.into_iter().nth(sensor).unwrap()[9_000..9_040].iter_mut().for_each(|value| *value += off);
        let motion = smoothed(&seen);
        assert_eq!(motion.strays[sensor], rows);
        // What is left out is up to the caller: he smooths without it.
        for row in rows {
            match sensor {
                0 => seen.theta[row] = f64::NAN,
                1 => seen.omega[row] = f64::NAN,
                _ => seen.alpha[row] = f64::NAN,
            }
        }
        let without = smoothed(&seen);
        let moved = rms(&without.alpha[8_800..9_300], &sound.alpha[8_800..9_300], |_| 1.0);
        assert!(without.strays.iter().all(Vec::is_empty) && moved < 0.2, "{moved}");
    }
}
