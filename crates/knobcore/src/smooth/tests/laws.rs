//! Symmetries that the smoother must keep.

use super::motion::{self, Motion, even};
use crate::smooth::{Noise, Sensors, noise_from_capture, smooth};

const NOISE: Noise = Noise { theta: 1e-5, omega: 5e-3, alpha: 0.41, jerk: 5.0 };

#[test]
fn a_capture_played_backward_is_the_motion_backward() {
    let seen = Motion::of(even(9000), motion::multisine).seen(1, 9.8e-6);
    let forward = smooth(&seen.sensors(), &NOISE).unwrap();
    let turned = |column: &[f64], sign: f64| -> Vec<f64> { column.iter().rev().map(|x| sign * x).collect() };
    let (theta, omega, alpha) =
        (turned(&seen.theta, 1.0), turned(&seen.omega, -1.0), turned(&seen.alpha, 1.0));
    let t = turned(&seen.t, -1.0);
    let backward =
        smooth(&Sensors { t: &t, theta: &theta, omega: Some(&omega), alpha: Some(&alpha) }, &NOISE).unwrap();
    for k in 0..9000 {
        let twin = 8999 - k;
        assert!((forward.omega[k] + backward.omega[twin]).abs() < 1e-3 * forward.omega_sd[k], "row {k}");
        assert!((forward.omega_sd[k] / backward.omega_sd[twin] - 1.0).abs() < 1e-3, "row {k}");
    }
}

#[test]
fn where_zero_angle_lies_does_not_matter() {
    let seen = Motion::of(even(3000), motion::multisine).seen(2, 9.8e-6);
    let here = smooth(&seen.sensors(), &NOISE).unwrap();
    let theta: Vec<f64> = seen.theta.iter().map(|theta| theta + 100.0).collect();
    let there = smooth(&Sensors { theta: &theta, ..seen.sensors() }, &NOISE).unwrap();
    assert!(here.omega.iter().zip(&there.omega).all(|(here, there)| (here - there).abs() < 1e-8));
}

#[test]
fn blocks_leave_no_seam() {
    let seen = Motion::of(even(9000), motion::multisine).seen(3, 9.8e-6);
    let whole = smooth(&seen.sensors(), &NOISE).unwrap();
    let part = smooth(&seen.sensors().rows(2000..7000), &NOISE).unwrap();
    for k in 1000..4000 {
        assert!((whole.omega[2000 + k] - part.omega[k]).abs() < 1e-4 * whole.omega_sd[2000 + k], "row {k}");
    }
}

#[test]
fn an_exact_sensor_is_believed() {
    let truth = Motion::of(even(2000), motion::multisine);
    let motion = smooth(&truth.theta_alone(), &Noise { theta: 0.0, ..NOISE }).unwrap();
    assert!(motion.theta.iter().zip(&truth.theta).all(|(found, truth)| (found - truth).abs() < 1e-10));
}

#[test]
fn without_jerk_the_motion_is_a_parabola() {
    let parabola = Motion::of(even(2000), |t| [1.0 + 2.0 * t - 3.0 * t * t, 2.0 - 6.0 * t, -6.0]);
    let seen = parabola.seen(4, 1e-6);
    let motion = smooth(&seen.sensors(), &Noise { jerk: 0.0, ..NOISE }).unwrap();
    let bend = motion.alpha.iter().map(|alpha| (alpha - motion.alpha[0]).abs()).fold(0.0, f64::max);
    assert!(bend < 1e-3, "{bend}");
    assert!((motion.alpha[1000] + 6.0).abs() < 4.0 * motion.alpha_sd[1000]);
}

/// What was seen with another clock and another unit of the angle, both by powers of two, so that nothing is rounded.
fn in_units(seen: &Motion, time: f64, angle: f64) -> Motion {
    let by = |column: &[f64], factor: f64| column.iter().map(|x| x * factor).collect::<Vec<f64>>();
    Motion {
        t: by(&seen.t, time),
        theta: by(&seen.theta, angle),
        omega: by(&seen.omega, angle / time),
        alpha: by(&seen.alpha, angle / (time * time)),
    }
}

/// How far apart two columns are, as a share of the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let most = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / most
}

#[test]
fn units_of_time_and_angle_are_the_users_affair() {
    let mut seen = Motion::of(even(6000), motion::multisine).seen(3, 9.8e-6);
    // What the search for errors of a sensor decides must not hang on units either.
    seen.omega[3000] -= 5.0;
    seen.alpha[2000] += 800.0;
    seen.theta[4000..4040].iter_mut().for_each(|theta| *theta += 0.1);
    let smoothed = |seen: &Motion| {
        let noise = noise_from_capture(&seen.sensors()).unwrap();
        smooth(&seen.sensors(), &noise).unwrap()
    };
    let plain = smoothed(&seen);
    assert_eq!(plain.strays[1..], [vec![3000], vec![2000]]);
    assert_eq!(plain.strays[0], (4000..4040).collect::<Vec<_>>());
    for (time, angle) in [(16.0, 1.0), (1.0 / 16.0, 1.0), (1.0, 64.0), (1.0, 1.0 / 64.0)] {
        let other = smoothed(&in_units(&seen, time, angle));
        assert_eq!(other.strays, plain.strays, "{time} {angle}");
        for (i, (a, b)) in
            [(&other.theta, &plain.theta), (&other.omega, &plain.omega), (&other.alpha, &plain.alpha)]
                .into_iter()
                .enumerate()
        {
            let b: Vec<f64> = b.iter().map(|x| x * angle / time.powi(i as i32)).collect();
            assert!(apart(a, &b) < 1e-6, "{time} {angle}: {i} by {}", apart(a, &b));
        }
    }
}
