//! Symmetries that the smoother must keep.

use super::motion::{self, Motion, even};
use crate::smooth::{Noise, Sensors, smooth};

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
