//! Captures at the edge of what a capture can be.

use super::motion::{self, Motion, even};
use crate::smooth::{Noise, Sensors, noise_from_capture, smooth};

/// Largest |a - b| in the largest |b|, leaving out what lies within `edge` samples of an end.
fn worst(a: &[f64], b: &[f64], edge: usize) -> f64 {
    let inside = edge..b.len() - edge;
    let difference =
        a[inside.clone()].iter().zip(&b[inside]).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    difference / b.iter().fold(0.0_f64, |most, b| most.max(b.abs()))
}

#[test]
fn exact_motion_passes_unharmed() {
    for at in [motion::chirp, motion::multisine] {
        let truth = Motion::of(even(10_000), at);
        for (seen, edge) in [(truth.sensors(), 0), (truth.theta_alone(), 50)] {
            let motion = smooth(&seen, &noise_from_capture(&seen).unwrap()).unwrap();
            assert!(worst(&motion.theta, &truth.theta, 0) < 1e-10);
            assert!(worst(&motion.omega, &truth.omega, edge) < 1e-8);
            assert!(worst(&motion.alpha, &truth.alpha, edge) < 1e-6);
        }
    }
}

#[test]
fn exact_motion_with_lost_samples_and_late_angles_passes_unharmed() {
    let truth = Motion::of(even(10_000), motion::chirp);
    let mut seen = Motion::of(even(10_000), motion::chirp);
    seen.theta[..40].fill(f64::NAN);
    for k in (100..9900).step_by(97) {
        seen.theta[k] = f64::NAN;
    }
    for (seen, edge) in [(seen.sensors(), 0), (seen.theta_alone(), 100)] {
        let motion = smooth(&seen, &noise_from_capture(&seen).unwrap()).unwrap();
        assert!(worst(&motion.omega, &truth.omega, edge) < 1e-7);
    }
}

#[test]
fn a_knob_at_rest_is_at_rest() {
    for angle in [0.0, 1.5, -300.0] {
        let t = even(3000);
        let theta = vec![angle; t.len()];
        let still = vec![0.0; t.len()];
        for rates in [None, Some(&still[..])] {
            let seen = Sensors { t: &t, theta: &theta, omega: rates, alpha: rates };
            let motion = smooth(&seen, &noise_from_capture(&seen).unwrap()).unwrap();
            assert!(motion.theta.iter().all(|theta| (theta - angle).abs() < 1e-12));
            assert!(motion.omega.iter().all(|omega| omega.abs() < 1e-9));
            assert!(motion.omega_sd.iter().all(|sd| sd.is_finite()));
        }
    }
}

#[test]
fn three_samples_are_enough_and_two_are_not() {
    let (t, theta) = ([0.0, 0.1, 0.3], [0.0, 0.1, 0.3]);
    let seen = Sensors { t: &t, theta: &theta, omega: None, alpha: None };
    let motion = smooth(&seen, &noise_from_capture(&seen).unwrap()).unwrap();
    assert!(motion.omega.iter().all(|omega| (omega - 1.0).abs() < 1e-3));

    let theta = [0.0, f64::NAN, 0.3];
    let seen = Sensors { theta: &theta, ..seen };
    assert!(noise_from_capture(&seen).unwrap_err().to_string().contains("2 finite samples"));
}

#[test]
fn a_sensor_without_one_finite_sample_is_an_absent_sensor() {
    let truth = Motion::of(even(3000), motion::multisine).seen(1, 1e-5);
    let dead = vec![f64::NAN; 3000];
    let seen = Sensors { omega: Some(&dead), alpha: Some(&dead), ..truth.sensors() };
    assert_eq!(noise_from_capture(&seen).unwrap(), noise_from_capture(&truth.theta_alone()).unwrap());
}

#[test]
fn faults_are_named_with_their_row() {
    let (t, theta) = ([0.0, 0.1, 0.1, 0.2], [0.0; 4]);
    let noise = Noise { theta: 1e-5, omega: f64::INFINITY, alpha: f64::INFINITY, jerk: 1.0 };
    let seen = Sensors { t: &t, theta: &theta, omega: None, alpha: None };
    assert!(smooth(&seen, &noise).unwrap_err().to_string().contains("row 2"));

    let t = [0.0, 0.1, 0.2, 0.3];
    let short = Sensors { t: &t, omega: Some(&theta[..3]), ..seen };
    assert!(smooth(&short, &noise).unwrap_err().to_string().contains("omega: has 3 samples where t has 4"));

    let seen = Sensors { t: &t, ..seen };
    for (wrong, name) in [
        (Noise { jerk: f64::NAN, ..noise }, "noise.jerk"),
        (Noise { jerk: f64::INFINITY, ..noise }, "noise.jerk"),
        (Noise { theta: -1e-5, ..noise }, "noise.theta"),
        (Noise { theta: f64::INFINITY, ..noise }, "noise.theta"),
        (Noise { omega: -1.0, ..noise }, "noise.omega"),
        (Noise { alpha: f64::NAN, ..noise }, "noise.alpha"),
    ] {
        assert!(smooth(&seen, &wrong).unwrap_err().to_string().contains(name), "{wrong:?}");
    }
}

#[test]
fn a_gap_of_a_minute_harms_neither_side() {
    let t: Vec<f64> = (0..6000).map(|k| f64::from(k) * 2e-4 + if k < 3000 { 0.0 } else { 60.0 }).collect();
    let truth = Motion::of(t, motion::multisine);
    let seen = truth.seen(9, 9.8e-6);
    let motion = smooth(&seen.sensors(), &noise_from_capture(&seen.sensors()).unwrap()).unwrap();
    let calibration = motion::rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
    assert!((0.8..1.25).contains(&calibration), "{calibration}");
    assert!(motion.omega_sd.iter().all(|sd| *sd < 5e-3));
}
