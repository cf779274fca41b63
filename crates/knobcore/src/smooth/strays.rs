//! Readings that are none: without them there is no sign of an impact.
//!
//! A wild reading of a single sensor throws the motion off all around it, as an impact does. But an impact goes on:
//! whatever reading of it is left out, the others still tell of it. Where the usual jerk explains all the others of
//! the surroundings, the motion was smooth and the reading wrong. A brief pulse of acceleration may leave next to
//! nothing in the other sensors; so they must be good enough to have noticed.

use super::impacts::{beyond_chance, spread, sums};
use super::lifts::{Lifts, WINDOW};
use super::rts::{Motion, smooth_rows};
use super::sensors::Sensors;
use super::state::Model;
use std::ops::Range;

/// Standard deviations from what the others predict, beyond which a reading can be none.
const FAR: f64 = 8.0;

/// Standard deviations by which such a change of motion would have shown in the next slower quantity.
const NOTICED: f64 = 10.0;

/// Readings that are left out at one place where other sensors tell what there was, and where none does.
const MOST: [usize; 2] = [8, 1];

/// Readings of the angle that have to be left in a place for each that is left out, where no other sensor tells: with
/// all of its readings gone, any place is in line.
const REST: usize = 4;

/// Readings after which an impact is known as one: nearly all of its squares are left, this share at least.
const TRIED: usize = 3;
const LEFT: f64 = 0.7;

/// Readings to either side that a wild one leaps away from.
const BESIDE: usize = 3;

/// Samples to either side of a place that are smoothed with it.
const AROUND: usize = 16 * WINDOW;

/// Windows between those of one place.
const BETWEEN: usize = 4;

/// Places beyond which a motion is full of impacts.
const PLACES: usize = 100;

/// Readings by sensor and row, beside which the `motion`, with the usual jerk throughout, is out of line; None where it
/// is nowhere.
pub fn strays(sensors: &Sensors<'_>, model: &Model, motion: &Motion) -> Option<[Vec<usize>; 3]> {
    let all = sums(sensors, model, motion);
    let spreads = all.each_ref().map(|sums| spread(sums));
    let places = places(&beyond_chance(&all, &spreads));
    if places.is_empty() {
        return None;
    }
    let mut found: [Vec<usize>; 3] = Default::default();
    for place in places.iter().filter(|_| places.len() <= PLACES) {
        for (sensor, row) in at(sensors, model, &spreads, place).unwrap_or_default() {
            found[sensor].push(row);
        }
    }
    Some(found)
}

/// Runs of windows that are out of line, with few between them.
fn places(out_of_line: &[bool]) -> Vec<Range<usize>> {
    let mut places: Vec<Range<usize>> = Vec::new();
    for i in (0..out_of_line.len()).filter(|&i| out_of_line[i]) {
        match places.last_mut().filter(|last| i <= last.end + BETWEEN) {
            Some(last) => last.end = i + 1,
            None => places.push(i..i + 1),
        }
    }
    places
}

/// The readings without which a place, some windows, is in line.
fn at(
    sensors: &Sensors<'_>,
    model: &Model,
    spreads: &[f64; 3],
    place: &Range<usize>,
) -> Option<Vec<(usize, usize)>> {
    let here = place.start * WINDOW..(place.end * WINDOW).min(sensors.len());
    // From the first row of a window, so that windows are the same.
    let rows = here.start.saturating_sub(AROUND)..(here.end + AROUND).min(sensors.len());
    let local = sensors.rows(rows.clone());
    let there = [Some(local.theta), local.omega, local.alpha];
    let mut columns = there.map(|column| column.map(<[f64]>::to_vec));
    let others = (1..3).any(|i| there[i].is_some() && model.variance[i].is_finite());
    let mut left_out = Vec::new();
    let mut first = f64::INFINITY;
    for _ in 0..=MOST[usize::from(!others)] {
        let seen = Sensors {
            t: local.t,
            theta: columns[0].as_deref().unwrap_or(local.theta),
            omega: columns[1].as_deref(),
            alpha: columns[2].as_deref(),
        };
        let motion = smooth_rows(&seen, model, &Lifts::default());
        let all = sums(&seen, model, &motion);
        let inside = here.start - rows.start..here.end - rows.start;
        let windows = (here.start - rows.start) / WINDOW..(here.end - rows.start).div_ceil(WINDOW);
        if !beyond_chance(&all, spreads)[windows.clone()].contains(&true) {
            let rest = seen.theta[inside].iter().filter(|theta| theta.is_finite()).count();
            let leaps = |&(i, row): &(usize, usize)| {
                let seen = columns[i].as_deref().unwrap_or_default();
                let noise = (spreads[i] * model.variance[i]).sqrt() / model.scale[i];
                there[i].is_some_and(|all| leaps(all[row - rows.start], seen, row - rows.start, FAR * noise))
            };
            let wild = left_out.iter().all(leaps) && (others || rest >= REST * left_out.len());
            return wild.then_some(left_out);
        }
        let squares: f64 = all
            .iter()
            .filter(|sums| !sums.is_empty())
            .flat_map(|sums| &sums[windows.clone()])
            .map(|sum| sum.0)
            .sum();
        if left_out.is_empty() {
            first = squares;
        } else if left_out.len() >= TRIED && squares > LEFT * first {
            return None;
        }
        let (sensor, row) = farthest(&seen, model, spreads, &motion, inside)?;
        if let Some(reading) = columns[sensor].as_mut().and_then(|column| column.get_mut(row)) {
            *reading = f64::NAN;
        }
        left_out.push((sensor, rows.start + row));
    }
    None
}

/// Whether a reading is beyond all those of its sensor beside it that are left, by `far` and by more than they differ:
/// where a force sets in or ends they lie on the one side as it does, or on the other.
fn leaps(reading: f64, seen: &[f64], row: usize, far: f64) -> bool {
    let finite = |value: &&f64| value.is_finite();
    let before = seen[..row].iter().rev().filter(finite).take(BESIDE);
    let beside = before.chain(seen[row + 1..].iter().filter(finite).take(BESIDE));
    let (low, high) =
        beside.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    (reading - high).max(low - reading) > far.max(high - low)
}

/// The reading that is farthest from what all the others predict, if that is far, and they would have noticed.
fn farthest(
    sensors: &Sensors<'_>,
    model: &Model,
    spreads: &[f64; 3],
    motion: &Motion,
    rows: Range<usize>,
) -> Option<(usize, usize)> {
    let mut best = None;
    let mut most = FAR;
    for row in rows {
        let readings = sensors.row(row);
        for i in (0..3).filter(|&i| readings[i].is_finite() && model.variance[i].is_finite()) {
            let noise = model.variance[i] / model.scale[i].powi(2);
            // The error of predicting it from the others, see `jerk`.
            let free = (1.0 - motion.sds[i][row].powi(2) / noise).max(f64::EPSILON);
            let error = (readings[i] - motion.values[i][row]).abs() / free;
            let far = error * (free / (noise * spreads[i])).sqrt();
            let noticed = i == 0 || error * model.scale[1] > NOTICED * motion.sds[i - 1][row];
            if far > most && noticed {
                (best, most) = (Some((i, row)), far);
            }
        }
    }
    best
}
