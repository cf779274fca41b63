//! Where a model fails: what is put there is said to be there, in its size, and nothing else is.

use super::chance::{NOISE, noisy};
use super::*;
use knobcore::diagnose::{Split, locate};

/// Samples at either end that do not count.
const TRIMMED: usize = 100;

/// The splits of a capture of the knob, without a filter, with a torque more that the model knows nothing of.
fn split(more: impl Fn(&Signals, usize) -> f64) -> (Signals, Vec<Split>) {
    let mut signals = noisy(&knob(), 31);
    signals.filter = None;
    let added: Vec<f64> = (0..signals.len()).map(|at| more(&signals, at)).collect();
    signals.tau_raw.iter_mut().zip(added).for_each(|(tau, more)| *tau += more);
    signals.filter_torque();
    let splits = locate(&[&signals], &knob());
    (signals, splits)
}

fn along<'a>(splits: &'a [Split], axis: &str) -> &'a Split {
    splits.iter().find(|split| split.axis == axis).unwrap()
}

/// What the model leaves of a sample.
fn left(signals: &Signals) -> Vec<f64> {
    let model = predict::torque(&knob(), signals);
    signals.tau.iter().zip(model).map(|(tau, model)| tau - model).collect()
}

fn near(a: f64, b: f64, share: f64) -> bool {
    (a - b).abs() <= share * b.abs()
}

#[test]
fn every_axis_holds_every_sample_and_its_bins_are_in_order() {
    let (signals, splits) = split(|_, _| 0.0);
    let rest = left(&signals);
    let counted = TRIMMED..signals.len() - TRIMMED;
    let squares: f64 = rest[counted.clone()].iter().map(|r| r * r).sum();
    let sum: f64 = rest[counted.clone()].iter().sum();
    let axes = ["position", "velocity", "acceleration", "time", "load", "history", "frequency"];
    assert_eq!(splits.iter().map(|split| split.axis).collect::<Vec<_>>(), axes);
    for split in splits.iter().filter(|split| !["frequency", "history"].contains(&split.axis)) {
        let over = |of: &[f64]| of.iter().zip(&split.count).map(|(x, n)| x * n).sum::<f64>();
        let rms: Vec<f64> = split.rms.iter().map(|x| x * x).collect();
        assert_eq!(split.count.iter().sum::<f64>(), counted.len() as f64, "{}", split.axis);
        assert!(near(over(&split.mean), sum, 1e-6) && near(over(&rms), squares, 1e-9), "{}", split.axis);
        assert!(split.low.iter().zip(&split.high).all(|(low, high)| low < high), "{}", split.axis);
    }
}

#[test]
fn chance_keeps_the_mean_of_a_bin_within_its_band() {
    let (_, splits) = split(|_, _| 0.0);
    for split in splits.iter().filter(|split| split.axis != "frequency") {
        let full: Vec<usize> = (0..split.count.len()).filter(|bin| split.count[*bin] >= 20.0).collect();
        // The band of white noise is known: 1.96 standard deviations of a mean of so many.
        let ratio = |bin: &usize| split.band[*bin] / (1.96 * NOISE / split.count[*bin].sqrt());
        let mean = full.iter().map(ratio).sum::<f64>() / full.len() as f64;
        assert!(near(mean, 1.0, 0.05), "{}: {mean}", split.axis);
        let outside = full.iter().filter(|bin| split.mean[**bin].abs() > split.band[**bin]).count();
        assert!(outside as f64 <= 0.15 * full.len() as f64, "{}: {outside}", split.axis);
        assert!(split.regions.is_empty() && split.part <= 0.02, "{}", split.axis);
    }
    assert!(along(&splits, "frequency").regions.is_empty());
}

#[test]
fn a_step_in_time_is_a_region_of_its_length_and_height() {
    let height = 3.0 * NOISE;
    let (signals, splits) = split(|s, at| if (0.8..1.2).contains(&s.t[at]) { height } else { 0.0 });
    let time = along(&splits, "time");
    let region = &time.regions[0];
    // Bins are a thirtieth of the capture.
    assert!((region.from - 0.8).abs() < 0.07 && (region.to - 1.2).abs() < 0.07, "{region:?}");
    // Those at its ends hold it in part.
    assert!(near(region.mean * (region.to - region.from), 0.4 * height, 0.05), "{region:?}");
    assert!(region.direction == 0 && region.mean < 1.05 * height, "{region:?}");
    assert!(near(time.share, 1.0, 0.1) && near(region.share, 1.0, 0.1), "{time:?}");
    let part = 0.4 * RATE_HZ * height * height / left(&signals).iter().map(|r| r * r).sum::<f64>();
    assert!(near(time.part, part, 0.1), "{} {part}", time.part);
    assert!(time.chance < 0.1 * time.share);
    for axis in ["position", "velocity", "acceleration", "load", "history"] {
        assert!(along(&splits, axis).share < 0.5, "{axis}");
    }
}

#[test]
fn what_is_there_in_one_direction_is_there_in_that_direction_alone() {
    let height = 3.0 * NOISE;
    let here = |s: &Signals, at: usize| (0.2..0.5).contains(&s.theta[at]) && s.omega[at] < 0.0;
    let (_, splits) = split(|s, at| if here(s, at) { height } else { 0.0 });
    let position = along(&splits, "position");
    let region = &position.regions[0];
    assert_eq!(region.direction, -1);
    assert!((region.from - 0.2).abs() < 0.05 && (region.to - 0.5).abs() < 0.05, "{region:?}");
    assert!(near(region.mean, height, 0.1) && near(region.share, 1.0, 0.15), "{region:?}");
    assert!(position.regions.iter().all(|region| region.direction == -1), "{:?}", position.regions);
}

#[test]
fn a_wave_in_time_is_a_line_at_its_frequency_with_its_power() {
    let size = 2.0 * NOISE;
    let (signals, splits) = split(|s, at| size * (TAU * 200.0 * s.t[at]).sin());
    let frequency = along(&splits, "frequency");
    let region = &frequency.regions[0];
    assert_eq!(frequency.regions.len(), 1, "{:?}", frequency.regions);
    assert!(region.from < 200.0 && 200.0 < region.to && region.to - region.from < 50.0, "{region:?}");
    assert!(near(region.mean, size / 2.0_f64.sqrt(), 0.1) && near(region.share, 1.0, 0.1), "{region:?}");
    assert!(near(frequency.share, 1.0, 0.1), "{}", frequency.share);
    let rms_left = rms(left(&signals)[TRIMMED..signals.len() - TRIMMED].iter().copied());
    assert!(near(frequency.part, 0.5 * size * size / rms_left.powi(2), 0.1), "{}", frequency.part);
    // All bins together hold the error, and each reaches half a step to either side.
    let power: f64 = frequency.mean.iter().map(|x| x * x).sum();
    assert!(near(power.sqrt(), rms_left, 0.05), "{} {rms_left}", power.sqrt());
    let last = frequency.high.len() - 1;
    assert!(near(frequency.low[last] + frequency.high[last], RATE_HZ, 1e-9));
    assert!(frequency.mean.len() == frequency.band.len() && frequency.low[0] == 0.0);
}

#[test]
fn behind_the_filter_noise_has_the_filters_spectrum() {
    let signals = noisy(&knob(), 32);
    let splits = locate(&[&signals], &knob());
    let frequency = along(&splits, "frequency");
    let within = |from: f64, to: f64| -> Vec<usize> {
        (0..frequency.low.len()).filter(|bin| (from..to).contains(&frequency.low[*bin])).collect()
    };
    let level = |of: &[f64], bins: &[usize]| bins.iter().map(|bin| of[*bin].powi(2)).sum::<f64>().sqrt();
    // The band is what one bin of noise stays below in 95 of 100 cases; that of a mean of few windows is wide.
    let (passed, stopped) = (within(50.0, 250.0), within(600.0, 2400.0));
    let ratio = level(&frequency.band, &passed) / level(&frequency.mean, &passed);
    assert!((1.1..2.0).contains(&ratio), "{ratio}");
    assert!(level(&frequency.band, &stopped) < 0.1 * level(&frequency.band, &passed));
    let below = passed.iter().filter(|bin| frequency.mean[**bin] <= frequency.band[**bin]).count();
    assert!(below as f64 >= 0.85 * passed.len() as f64, "{below} of {}", passed.len());
}

#[test]
fn histories_are_cut_ever_finer_towards_the_turn() {
    let (signals, splits) = split(|_, _| 0.0);
    let history = along(&splits, "history");
    let ends = signals
        .theta
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], theta| [low.min(*theta), high.max(*theta)]);
    let cells = history.low.len() / 2;
    assert!(
        history.direction[..cells].iter().all(|d| *d == 1) && history.direction[cells..] == vec![-1; cells]
    );
    assert_eq!(history.low[0], 0.0);
    assert!(near(history.high[cells - 1], ends[1] - ends[0], 0.01));
    let ratio = history.high[1] / history.high[0];
    assert!(ratio > 1.1);
    for bin in 1..cells {
        assert!(near(history.high[bin] / history.low[bin], ratio, 1e-6), "bin {bin}");
    }
}
