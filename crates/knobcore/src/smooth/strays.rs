//! Readings that are none: without them there is no sign of an impact.
//!
//! A wild reading of a single sensor throws the motion off all around it, as an impact does. But an impact goes on:
//! whatever reading of it is left out, the others still tell of it. Where the usual jerk explains all the others of
//! the surroundings, the motion was smooth and the reading wrong. A brief pulse of acceleration may leave next to
//! nothing in the other sensors; so they must be good enough to have noticed.
//!
//! Of a sensor that is off for some time no reading alone is too many: there all that it says is left out at once,
//! and those are none that what the others then say is far from.

use super::impacts::{beyond_chance, spread, sums};
use super::lifts::{Lifts, WINDOW};
use super::rts::{Motion, smooth_rows};
use super::sensors::Sensors;
use super::state::Model;
use crate::spans::spans;
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

/// Windows between two places that may be the ends of one time for which a sensor was off.
const OFF: usize = 48;

/// Standard deviations from what the others say, beyond which a reading of a sensor that was off is left out.
const APART: f64 = 4.0;

/// Readings of such a sensor at least: a lively motion rounds off fewer of an impact.
const FEWEST: usize = 5;

/// The same of a velocity between an angle and an acceleration: what it leaps by would show in both.
const BETWEEN_BOTH: usize = 2;

/// Places beyond which a motion is full of impacts.
const PLACES: usize = 100;

/// Readings by sensor and row, beside which the `motion`, with the usual jerk throughout, is out of line; None where it
/// is nowhere.
pub fn strays(sensors: &Sensors<'_>, model: &Model, motion: &Motion) -> Option<[Vec<usize>; 3]> {
    let all = sums(sensors, model, motion);
    let spreads = all.each_ref().map(|sums| spread(sums));
    let out_of_line = beyond_chance(&all, &spreads);
    let places = spans(0..out_of_line.len(), BETWEEN, |i| out_of_line[i]);
    if places.is_empty() {
        return None;
    }
    let mut found: [Vec<usize>; 3] = Default::default();
    let mut known = 0;
    for (k, place) in places.iter().enumerate().filter(|_| places.len() <= PLACES) {
        if place.start < known {
            continue;
        }
        let next = places.get(k + 1).filter(|next| next.start <= place.end + OFF);
        let both = next.map(|next| place.start..next.end);
        let one = || at(sensors, model, &spreads, place).or_else(|| off(sensors, model, &spreads, place));
        let wild = one().map(|wild| (wild, place.end));
        let two = || both.and_then(|both| Some((off(sensors, model, &spreads, &both)?, both.end)));
        if let Some((wild, end)) = wild.or_else(two) {
            wild.into_iter().for_each(|(sensor, row)| found[sensor].push(row));
            known = end;
        }
    }
    Some(found)
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

/// The readings of the one sensor without which a place, some windows, is in line, and that would not have escaped the
/// others if they were right; None where it is no sensor's fault, or may be that of either of two.
fn off(
    sensors: &Sensors<'_>,
    model: &Model,
    spreads: &[f64; 3],
    place: &Range<usize>,
) -> Option<Vec<(usize, usize)>> {
    let around = place.start.saturating_sub(2) * WINDOW..((place.end + 2) * WINDOW).min(sensors.len());
    let rows = around.start.saturating_sub(AROUND)..(around.end + AROUND).min(sensors.len());
    let here = around.start - rows.start..around.end - rows.start;
    let local = sensors.rows(rows.clone());
    let there = [Some(local.theta), local.omega, local.alpha];
    let speaks = |i: usize| there[i].is_some() && model.variance[i].is_finite();
    let mut found = None;
    for i in (0..3).filter(|&i| speaks(i) && (0..3).any(|other| other != i && speaks(other))) {
        let fewest = if i == 1 && speaks(0) && speaks(2) { BETWEEN_BOTH } else { FEWEST };
        let mut without = there[i]?.to_vec();
        without[here.clone()].fill(f64::NAN);
        let mut seen = local;
        match i {
            0 => seen.theta = &without,
            1 => seen.omega = Some(&without),
            _ => seen.alpha = Some(&without),
        }
        let motion = smooth_rows(&seen, model, &Lifts::default());
        let windows = here.start / WINDOW..here.end.div_ceil(WINDOW);
        if beyond_chance(&sums(&seen, model, &motion), spreads)[windows].contains(&true) {
            continue;
        }
        let noise = spreads[i] * model.variance[i] / model.scale[i].powi(2);
        let errors: Vec<(usize, f64)> = here
            .clone()
            .map(|row| (row, there[i].map_or(f64::NAN, |all| all[row] - motion.values[i][row])))
            .filter(|(_, error)| error.is_finite())
            .collect();
        let Some(times) = abrupt(&errors, FAR * (2.0 * noise).sqrt()) else { continue };
        let apart = |(row, error): &&(usize, f64)| {
            error.powi(2) > APART * APART * (noise + motion.sds[i][*row].powi(2))
        };
        let wild: Vec<(usize, f64)> = errors[times].iter().filter(apart).copied().collect();
        // Before and after it a sensor that is off is right.
        let within = here.start + WINDOW..here.end - WINDOW;
        let whole = wild.iter().all(|(row, _)| within.contains(row));
        if wild.len() < fewest || !whole || !noticed(model, i, wild.iter().map(|(_, error)| *error)) {
            continue;
        }
        if found.replace((i, wild)).is_some() {
            return None;
        }
    }
    let (i, wild) = found?;
    Some(wild.into_iter().map(|(row, _)| (i, rows.start + row)).collect())
}

/// From the first to the last leap, farther than `far`, of errors by row; None where the most of them came about little
/// by little, as where it is the motion that is known too badly.
fn abrupt(errors: &[(usize, f64)], far: f64) -> Option<Range<usize>> {
    let leap = |k: &usize| (errors[*k].1 - errors[k - 1].1).abs();
    let first = (1..errors.len()).find(|k| leap(k) > far)?;
    let last = (1..errors.len()).rev().find(|k| leap(k) > far)?;
    let most = errors[first..last].iter().fold(0.0_f64, |most, (_, error)| most.max(error.abs()));
    let farthest = (first..=last).map(|k| leap(&k)).fold(0.0, f64::max);
    // Beside a bend of the motion that was rounded off all readings are off, to either side.
    let sound = [errors[first - 1].1, errors[last].1].iter().all(|error| error.abs() < 0.3 * most);
    (farthest > 0.5 * most && last > first && sound).then_some(first..last)
}

/// Whether errors of a sensor in these rows, if they were none, would have shown in the others: an angle's in the
/// velocity that it takes, a rate's in what it adds up to.
fn noticed(model: &Model, sensor: usize, errors: impl Iterator<Item = f64>) -> bool {
    let sd = |i: usize| model.variance[i].sqrt() / model.scale[i];
    let (mut most, mut sum, mut rows) = (0.0_f64, 0.0_f64, 0.0_f64);
    for error in errors {
        sum += error * model.scale[1];
        rows += 1.0;
        most = most.max(if sensor == 0 { error.abs() } else { sum.abs() });
    }
    let (speed, turned) = (sd(1) * model.scale[1], sd(2) * model.scale[1].powi(2));
    match sensor {
        0 => most > NOTICED * (speed * rows.sqrt()).min(turned * rows.powf(1.5)),
        1 => most > NOTICED * sd(0),
        _ => most > NOTICED * sd(1).min(sd(0) / (model.scale[1] * rows)),
    }
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

#[cfg(test)]
mod tests {
    use super::super::sensors::Noise;
    use super::*;
    use crate::random;

    const STEP: f64 = 2e-4;

    /// A turn to and fro at these noise levels of angle and velocity, and the model of who knows them.
    fn turned(theta_sd: f64, omega_sd: f64, jerk: f64) -> ([Vec<f64>; 3], Model) {
        let mut noise = random::Noise::new(2);
        let over = |f: &dyn Fn(f64) -> f64| (0..400).map(|k| f(STEP * f64::from(k))).collect::<Vec<f64>>();
        let w = 20.0_f64;
        let mut columns = [over(&|t| t), over(&|t| 0.5 * (w * t).sin()), over(&|t| 0.5 * w * (w * t).cos())];
        for (column, sd) in columns.iter_mut().skip(1).zip([theta_sd, omega_sd]) {
            column.iter_mut().for_each(|x| *x += sd * noise.normal());
        }
        let noise = Noise { theta: theta_sd, omega: omega_sd, alpha: f64::INFINITY, jerk };
        (columns, Model::new(&noise, STEP))
    }

    fn of([t, theta, omega]: &[Vec<f64>; 3]) -> Sensors<'_> {
        Sensors { t, theta, omega: Some(omega), alpha: None }
    }

    #[test]
    fn a_wild_reading_is_named_where_the_others_would_have_noticed() {
        // With so lively a motion each angle is nearly what it says itself: a wild one draws the motion after it.
        for (column, jerk, sd, other_sd) in [(1, 1e7, 1e-4, 1.0), (2, 1e5, 1e-2, 1e-7), (2, 1e5, 1e-2, 1e-2)]
        {
            let (theta_sd, omega_sd) = if column == 1 { (sd, other_sd) } else { (other_sd, sd) };
            let (mut columns, model) = turned(theta_sd, omega_sd, jerk);
            let named = |columns: &[Vec<f64>; 3]| {
                let motion = smooth_rows(&of(columns), &model, &Lifts::default());
                let free = 1.0 - (motion.sds[column - 1][200] / sd).powi(2);
                (farthest(&of(columns), &model, &[1.0; 3], &motion, 100..300), free)
            };
            assert_eq!(named(&columns).0, None, "{column} {jerk}");
            let (_, free) = named(&columns);
            // As far as 20 standard deviations of what the others say of it.
            columns[column][200] += 20.0 * sd / free.sqrt();
            let (found, free) = named(&columns);
            // What a coarse angle does not tell a velocity may have been.
            let seen = if other_sd == 1e-2 { None } else { Some((column - 1, 200)) };
            assert_eq!(found, seen, "{column} {jerk} {free}");
        }
    }

    #[test]
    fn a_sensor_is_off_where_five_of_its_readings_are_and_not_where_four_are() {
        for (rows, is_off) in [(4, false), (5, true), (9, true)] {
            let (mut columns, model) = turned(1e-6, 1e-2, 1e3);
            columns[2][203..203 + rows].fill(0.0);
            let found = off(&of(&columns), &model, &[1.0; 3], &(25..27));
            let expected: Vec<(usize, usize)> = (203..203 + rows).map(|row| (1, row)).collect();
            assert_eq!(found, is_off.then_some(expected), "{rows}");
        }
    }

    #[test]
    fn several_wild_readings_at_one_place_are_named_together_and_an_impact_is_not() {
        let (mut columns, model) = turned(1e-6, 1e-2, 1e3);
        let place = 25..26;
        let wild = [201, 203, 205, 207];
        wild.iter().for_each(|row| columns[2][*row] += 3.0);
        let mut found = at(&of(&columns), &model, &[1.0; 3], &place).unwrap();
        found.sort_unstable();
        assert_eq!(found, wild.map(|row| (1, row)));
        // From then on it turns faster: all that comes after says so.
        let (mut columns, model) = turned(1e-6, 1e-2, 1e3);
        columns[2][202..].iter_mut().for_each(|omega| *omega += 3.0);
        for (row, theta) in columns[1].iter_mut().enumerate().skip(202) {
            *theta += 3.0 * STEP * (row - 202) as f64;
        }
        assert_eq!(at(&of(&columns), &model, &[1.0; 3], &place), None);
    }
}
