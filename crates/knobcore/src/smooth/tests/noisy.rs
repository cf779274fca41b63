//! What noise leaves of the motion, and whether the smoother knows it.

use super::motion::{self, Motion, even, rms};
use crate::smooth::{Smoothed, noise_from_capture, smooth};

const FINE: f64 = 9.8e-6;

fn smoothed(seen: &crate::smooth::Sensors<'_>) -> Smoothed {
    smooth(seen, &noise_from_capture(seen).unwrap()).unwrap()
}

fn motions() -> Vec<(&'static str, Motion)> {
    vec![
        ("multisine", Motion::of(even(20_000), motion::multisine)),
        ("chirp", Motion::of(even(20_000), motion::chirp)),
        ("fast turns", Motion::of(even(20_000), motion::fast_turns)),
        ("slow hand", motion::slow_hand(20_000, 5)),
    ]
}

#[test]
fn velocity_error_falls_twentyfold_and_its_sd_is_honest() {
    for (name, truth) in motions() {
        let runs = [1, 2, 3].map(|seed| {
            let motion = smoothed(&truth.seen(seed, FINE).sensors());
            let calibration = rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
            (rms(&motion.omega, &truth.omega, |_| 1.0), calibration)
        });
        let worst = runs.iter().fold(0.0_f64, |most, run| most.max(run.0));
        let calibration = runs.iter().map(|run| run.1).sum::<f64>() / 3.0;
        assert!(worst < 2.4e-4, "{name}: {worst}");
        assert!((0.8..1.25).contains(&calibration), "{name}: {calibration}");
    }
}

#[test]
fn theta_alone_yields_velocity_with_an_sd_that_is_not_too_small() {
    for (name, truth) in motions() {
        let motion = smoothed(&truth.seen(7, FINE).theta_alone());
        let error = rms(&motion.omega, &truth.omega, |_| 1.0);
        let calibration = rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
        assert!(error < 8e-4, "{name}: {error}");
        assert!((0.6..1.25).contains(&calibration), "{name}: {calibration}");
        assert!(motion.noise.omega.is_infinite() && motion.noise.alpha.is_infinite());
    }
}

#[test]
fn noise_levels_are_found_from_the_capture() {
    for (name, truth) in motions() {
        let noise = noise_from_capture(&truth.seen(11, FINE).sensors()).unwrap();
        let levels = [
            (noise.theta, motion::THETA_NOISE.hypot(FINE / 12.0_f64.sqrt())),
            (noise.omega, motion::OMEGA_NOISE),
            (noise.alpha, motion::ALPHA_NOISE),
        ];
        for (found, truth) in levels {
            assert!((found / truth - 1.0).abs() < 0.08, "{name}: {found} for {truth}");
        }
    }
}

#[test]
fn uneven_times_lost_samples_and_a_gap_stay_honest_and_the_gap_shows() {
    let t = (0..12_000_i32)
        .filter(|k| !(6000..6100).contains(k))
        .map(|k| (f64::from(k) + 0.3 * f64::from(k * 37 % 11) / 11.0) * 2e-4)
        .collect();
    let truth = Motion::of(t, motion::multisine);
    let mut seen = truth.seen(2, FINE);
    for k in 0..seen.t.len() {
        if k % 7 == 3 {
            seen.omega[k] = f64::NAN;
        }
        if k % 50 < 5 {
            seen.theta[k] = f64::NAN;
        }
    }
    seen.alpha[3000..3400].fill(f64::NAN);
    for column in [&mut seen.theta, &mut seen.omega, &mut seen.alpha] {
        column[8000..8100].fill(f64::NAN);
    }
    let motion = smoothed(&seen.sensors());
    let calibration = rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
    assert!((0.8..1.25).contains(&calibration), "{calibration}");
    assert!(rms(&motion.omega, &truth.omega, |_| 1.0) < 3.5e-4);
    assert!(motion.theta_sd[8050] > 2.0 * motion.theta_sd[7000]);
}

#[test]
fn counts_of_a_slow_encoder_do_not_become_jolts() {
    let count = std::f64::consts::TAU / 8192.0;
    for dither in [0.0, 0.1, 0.3] {
        let wave = std::f64::consts::TAU * 0.7;
        let truth = Motion::of(even(20_000), |t| {
            let (sin, cos) = (wave * t).sin_cos();
            [0.19 * (t - 0.5 * cos / wave), 0.19 * (1.0 + 0.5 * sin), 0.095 * wave * cos]
        });
        let mut seen = Motion::of(even(20_000), |_| [0.0; 3]);
        let mut normal = crate::random::Noise::new(4);
        for (seen, theta) in seen.theta.iter_mut().zip(&truth.theta) {
            *seen = (theta / count + dither * normal.normal()).round() * count;
        }
        let motion = smoothed(&seen.theta_alone());
        let inside = 500..19_500;
        let error = rms(&motion.omega[inside.clone()], &truth.omega[inside], |_| 1.0);
        let worth = rms(&motion.omega, &truth.omega, |k| motion.omega_sd[k]);
        assert!(error < 4e-4, "dither {dither}: {error}");
        assert!(worth < 1.25, "dither {dither}: {worth}");
    }
}

#[test]
fn counts_that_stay_for_a_few_samples_are_not_followed() {
    // At two to eight samples a count neighbours are off alike, and would be believed to predict one another.
    for counts in [2048.0, 4096.0, 16_384.0] {
        for seed in [1006, 1007, 1008] {
            let truth = motion::slow_hand(20_000, seed);
            let count = std::f64::consts::TAU / counts;
            let theta = truth.theta.iter().map(|theta| (theta / count).floor() * count).collect();
            let seen = Motion { theta, ..truth.seen(seed, count) };
            let motion = smoothed(&seen.theta_alone());
            let error =
                rms(&motion.alpha, &truth.alpha, |_| 1.0) / rms(&truth.alpha, &[0.0; 20_000], |_| 1.0);
            assert!(error < 0.3, "{counts} counts, seed {seed}: {error}");
        }
    }
}
