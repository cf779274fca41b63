//! Captures through a slower filter, and of as few samples as that lets through: the views in which a search for a joint
//! takes its first steps.

use crate::filter::{ZeroPhase, cheby2};
use crate::fit::used;
use crate::floor::Floor;
use crate::model::Model;
use crate::noise::Noise;
use crate::prepare::slower;
use crate::rule::rule;
use crate::signals::Signals;

/// Stopband edges at 5 kHz of the filter that the search goes through and of the one in between, Hz.
pub const COARSE_HZ: f64 = 60.0;
pub const MIDDLE_HZ: f64 = 150.0;
/// Samples that are kept per period of the edge, at least. A joint is simulated in steps from one of them to the next.
pub const KEPT: f64 = 36.0;
/// The edge before samples are left out, in times of the one after.
pub const BEFORE: f64 = 2.5;

/// The first samples of captures, so many of each at most: enough to find what is then followed through all of it.
pub fn beginnings(data: &[&Signals], most: usize) -> Vec<Signals> {
    data.iter().map(|signals| beginning(signals, most)).collect()
}

fn beginning(signals: &Signals, most: usize) -> Signals {
    let mut left = most;
    let mut segments = Vec::new();
    for segment in &signals.segments {
        let taken = segment.len().min(left);
        left -= taken;
        if taken >= most / 10 {
            segments.push(segment.start..segment.start + taken);
        }
    }
    if segments.is_empty() {
        return signals.clone();
    }
    let mut weight = vec![0.0; signals.len()];
    for segment in &segments {
        weight[segment.clone()].copy_from_slice(&signals.weight[segment.clone()]);
    }
    Signals { weight, segments, ..signals.clone() }
}

/// Captures through a slower filter; without those that are sampled too slowly for it.
pub fn slowed(data: &[&Signals], edge_hz: f64) -> Vec<Signals> {
    let slow = |signals: &&Signals| {
        let edge = edge_hz * slower(signals.rate_hz);
        let every = (signals.rate_hz / (KEPT * edge)).max(1.0) as usize;
        // Noise that is too fast for the samples that are kept would come back as slow noise.
        let mut kept = thinned(&behind(signals, BEFORE * edge)?, every);
        kept.tau_raw = kept.tau;
        kept.tau = Vec::new();
        // What a slower filter lets through needs no finer steps.
        kept.substeps = if edge_hz > COARSE_HZ { 2 } else { 1 };
        behind(&kept, edge)
    };
    data.iter().filter_map(slow).collect()
}

/// What noise leaves of the sum of squares of the slowed captures, as of [`Floor`].
pub fn floor(data: &[&Signals], edge_hz: f64, slowed: &[&Signals], model: &Model) -> f64 {
    let slow = |signals: &&Signals| behind(signals, edge_hz * slower(signals.rate_hz));
    let whole: Vec<Signals> = data.iter().filter_map(slow).collect();
    let whole: Vec<&Signals> = whole.iter().collect();
    Floor::of(&whole, model).squares * used(slowed) / used(&whole)
}

/// The sum of squares of captures that needs no better end where noise leaves so much of it, on average: so little passes a
/// slow filter that it is more one time and less another. One standard error more is nothing to look for.
pub fn enough(data: &[&Signals], floor: f64) -> f64 {
    let white = Noise::white(1.0);
    let alike = data.iter().map(|signals| white.alike(signals.filter.as_ref())).fold(1.0, f64::max);
    let rows = data.iter().map(|signals| signals.used()).sum::<usize>().max(1) as f64;
    rule().converged.powi(2) * floor * (1.0 + (2.0 * alike / rows).sqrt())
}

/// A capture through a filter with this edge; none where it is sampled too slowly for it.
fn behind(signals: &Signals, edge_hz: f64) -> Option<Signals> {
    let filter = ZeroPhase::new(cheby2(3, 20.0, edge_hz, signals.rate_hz).ok()?);
    let mut slow = Signals { filter: Some(filter), ..signals.clone() };
    slow.filter_torque();
    Some(slow)
}

/// Every so many samples of a capture's segments.
fn thinned(signals: &Signals, every: usize) -> Signals {
    let rows: Vec<Vec<usize>> =
        signals.segments.iter().map(|segment| segment.clone().step_by(every).collect()).collect();
    let mut from = 0;
    let segment = |rows: &Vec<usize>| {
        from += rows.len();
        from - rows.len()..from
    };
    let segments = rows.iter().map(segment).collect();
    let rows = rows.concat();
    let begins =
        signals.begins.iter().filter_map(|(at, begins)| Some((rows.binary_search(at).ok()?, *begins)));
    let kept = |column: &Vec<f64>| rows.iter().filter_map(|row| column.get(*row).copied()).collect();
    Signals {
        run: signals.run.clone(),
        axis: signals.axis,
        rate_hz: signals.rate_hz / every as f64,
        t: kept(&signals.t),
        theta: kept(&signals.theta),
        omega: kept(&signals.omega),
        alpha: kept(&signals.alpha),
        forward: kept(&signals.forward),
        omega_sd: kept(&signals.omega_sd),
        tau: kept(&signals.tau),
        tau_raw: kept(&signals.tau_raw),
        weight: kept(&signals.weight),
        segments,
        // What is left out of the motion is told by weights; the noise is not read here.
        stuck: Vec::new(),
        bridges: Vec::new(),
        knocks: Vec::new(),
        filter: None,
        substeps: 1,
        begins: begins.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::Axis;
    use crate::predict;
    use crate::random::Noise;

    const RATE_HZ: f64 = 5000.0;

    /// A wheel turned to and fro in two stretches, its torque measured with white noise of this standard deviation, N m.
    fn measured(sd: f64) -> (Signals, Model) {
        drawn(sd, 3)
    }

    /// The same with noise that is drawn from a seed.
    fn drawn(sd: f64, seed: u64) -> (Signals, Model) {
        let mut model = Model::equation_1(Axis::Rotary, false);
        model.set("inertia.M", 1e-4).unwrap();
        let over =
            |f: &dyn Fn(f64) -> f64| (0..20_000).map(|i| f(f64::from(i) / RATE_HZ)).collect::<Vec<f64>>();
        let w = 30.0_f64;
        let mut signals = Signals {
            rate_hz: RATE_HZ,
            t: over(&|t| t),
            theta: over(&|t| (w * t).sin()),
            omega: over(&|t| w * (w * t).cos()),
            alpha: over(&|t| -w * w * (w * t).sin()),
            forward: over(&|t| f64::from(u8::from((w * t).cos() > 0.0))),
            weight: vec![1.0; 20_000],
            segments: vec![10..9_000, 9_100..20_000],
            ..Signals::default()
        };
        let mut noise = Noise::new(seed);
        signals.tau_raw =
            predict::torque_raw(&model, &signals).iter().map(|tau| tau + sd * noise.normal()).collect();
        signals.tau = signals.tau_raw.clone();
        (signals, model)
    }

    #[test]
    fn a_slowed_capture_is_half_as_long_and_says_of_a_slow_torque_what_the_whole_does() {
        let (signals, model) = measured(0.0);
        let slow = &slowed(&[&signals], COARSE_HZ)[0];
        assert_eq!(slow.segments, [0..4495, 4495..9945]);
        assert_eq!((slow.t[0], slow.t[4495]), (10.0 / RATE_HZ, 9_100.0 / RATE_HZ));
        let there = predict::torque(&model, slow);
        let inner = |at: &usize| slow.segments.iter().any(|s| s.start + 200 < *at && *at < s.end - 200);
        let off =
            (0..slow.len()).filter(inner).map(|at| (there[at] - slow.tau[at]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3 * 0.09, "{off}");
    }

    #[test]
    fn noise_leaves_of_a_slowed_capture_what_its_floor_says() {
        let (signals, model) = measured(1e-3);
        let slow = slowed(&[&signals], COARSE_HZ);
        let slow: Vec<&Signals> = slow.iter().collect();
        let there = predict::torque(&model, slow[0]);
        let left: f64 = there.iter().zip(&slow[0].tau).map(|(there, tau)| (there - tau).powi(2)).sum();
        let expected = floor(&[&signals], COARSE_HZ, &slow, &model);
        assert!((0.75..1.33).contains(&(left / expected)), "{left} {expected}");
    }

    #[test]
    fn of_captures_of_nothing_but_noise_half_or_so_need_no_better_end() {
        let below = |seed: u64| {
            let (signals, model) = drawn(1e-3, seed);
            let slow = slowed(&[&signals], COARSE_HZ);
            let slow: Vec<&Signals> = slow.iter().collect();
            let floor = floor(&[&signals], COARSE_HZ, &slow, &model);
            let there = predict::torque(&model, slow[0]);
            let left: f64 = there.iter().zip(&slow[0].tau).map(|(there, tau)| (there - tau).powi(2)).sum();
            assert!(enough(&slow, floor) < 1.2 * floor);
            left <= enough(&slow, floor)
        };
        // The ends of segments, where the filter has less to go by, leave a tenth more.
        let few = (0..40).filter(|seed| below(*seed)).count();
        assert!((12..=30).contains(&few), "{few}");
        let (signals, _) = drawn(1e-3, 3);
        assert!(enough(&[&signals], f64::NAN).is_nan());
    }

    #[test]
    fn of_many_samples_the_beginnings_of_segments_are_looked_at() {
        let (signals, _) = measured(0.0);
        let few = &beginnings(&[&signals], 9_500)[0];
        assert_eq!(few.segments, vec![10..9_000; 1]);
        assert_eq!(few.used(), 8_990);
        assert_eq!(beginnings(&[&signals], 12_000)[0].segments, [10..9_000, 9_100..12_110]);
    }
}
