//! Where the knob stands still, and where its direction is not certain.

use super::motion::Moving;
use std::ops::Range;

/// A knob stands still when its speed stays below this many standard deviations of it for this long.
const STILL_SD: f64 = 4.0;
/// See [`STILL_SD`].
const STILL_S: f64 = 0.02;
/// Below this many standard deviations the sign of the velocity is not certain: a reversal may lie a sample
/// earlier or later than it seems. A step of dry friction that is a sample off looks like an effect of its own
/// once the filter has smeared it, so what it reaches does not count.
const UNSURE_SD: f64 = 3.0;
/// As long as this share of the samples stays.
const MOSTLY_SURE: f64 = 0.75;
/// Samples that are looked at together.
const MANY: usize = 64;

/// Stretches in which the knob stands still.
pub(super) fn standing_still(moving: &Moving, segments: &[Range<usize>], rate_hz: f64) -> Vec<Range<usize>> {
    slower_than(STILL_SD, (STILL_S * rate_hz) as usize, moving, segments)
}

/// Weights without what unsure directions reach through the filter; None where that would take away more than
/// it saves: with a velocity so coarse, the expected friction is the better bet.
pub(super) fn without_unsure(
    weight: &[f64],
    moving: &Moving,
    segments: &[Range<usize>],
    reach: usize,
) -> Option<Vec<f64>> {
    let unsure = slower_than(UNSURE_SD, 0, moving, segments);
    if unsure.is_empty() {
        return None;
    }
    let mut sure = weight.to_vec();
    for run in unsure {
        sure[run.start.saturating_sub(reach)..(run.end + reach).min(weight.len())].fill(0.0);
    }
    (sure.iter().sum::<f64>() >= MOSTLY_SURE * weight.iter().sum::<f64>()).then_some(sure)
}

/// Stretches within the segments in which the speed stays below so many of its standard deviations for more
/// than `least` samples; a speed that is known exactly is below nothing but zero.
fn slower_than(
    deviations: f64,
    least: usize,
    moving: &Moving,
    segments: &[Range<usize>],
) -> Vec<Range<usize>> {
    let slow = |at: usize| moving.omega[at].abs() <= deviations * moving.omega_sd[at];
    let mut found = Vec::new();
    for segment in segments {
        let mut at = segment.start;
        while at < segment.end {
            // A knob mostly moves; that is told of many samples side by side.
            let many = at..(at + MANY).min(segment.end);
            let speeds = moving.omega[many.clone()].iter().zip(&moving.omega_sd[many.clone()]);
            if !speeds.fold(false, |any, (omega, sd)| any | (omega.abs() <= deviations * sd)) {
                at = many.end;
                continue;
            }
            let start = at;
            while at < segment.end && slow(at) {
                at += 1;
            }
            if at - start > least {
                found.push(start..at);
            }
            at += 1;
        }
    }
    found
}
