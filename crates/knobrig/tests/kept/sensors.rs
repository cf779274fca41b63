//! What the smoother makes of whatever saw a motion: each set of sensors, at even and uneven times, in counts and stairs,
//! with gaps, blows and wild readings.

use crate::answers::Answers;
use crate::captures::{Chance, RATE_HZ, WAVES, at};
use knobcore::smooth::{Noise, Sensors, noise_from_capture, smooth};

const COUNT: usize = 800;

/// What sensors saw, and when.
#[derive(Clone)]
struct Seen {
    t: Vec<f64>,
    columns: [Option<Vec<f64>>; 3],
}

/// Which sensors are there.
const ALL: [bool; 3] = [true; 3];
const ANGLE: [bool; 3] = [true, false, false];

/// A motion at these times, as sensors with this much of the usual noise see it.
fn seen(t: Vec<f64>, there: [bool; 3], noisy: [f64; 3], seed: u64) -> Seen {
    let mut chance = Chance(seed);
    let columns = [0, 1, 2].map(|i| {
        let sd = noisy[i] * [2e-5, 2e-3, 0.5][i];
        let column = t.iter().map(|t| at(&WAVES, *t)[i] + sd * chance.normal()).collect();
        there[i].then_some(column)
    });
    Seen { t, columns }
}

fn even(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64 / RATE_HZ).collect()
}

fn uneven(seed: u64) -> Vec<f64> {
    let mut chance = Chance(seed);
    (0..COUNT).map(|i| (i as f64 + 0.8 * chance.uniform()) / RATE_HZ).collect()
}

impl Seen {
    /// With something done to one of the columns.
    fn with(mut self, which: usize, mut change: impl FnMut(&mut [f64])) -> Self {
        self.columns[which].iter_mut().for_each(|column| change(column));
        self
    }

    fn told(&self, told: &mut Answers, name: &str, known: Option<Noise>) {
        let [theta, omega, alpha] = self.columns.each_ref().map(Option::as_deref);
        let sensors = Sensors { t: &self.t, theta: theta.unwrap_or_default(), omega, alpha };
        let noise = match known.map_or_else(|| noise_from_capture(&sensors), Ok) {
            Ok(noise) => noise,
            Err(why) => return told.words(name, why.to_string()),
        };
        told.numbers(name, [noise.theta, noise.omega, noise.alpha, noise.jerk]);
        let found = match smooth(&sensors, &noise) {
            Ok(found) => found,
            Err(why) => return told.words("  refused", why.to_string()),
        };
        for (what, column) in [
            ("theta", &found.theta),
            ("omega", &found.omega),
            ("alpha", &found.alpha),
            ("theta_sd", &found.theta_sd),
            ("omega_sd", &found.omega_sd),
            ("alpha_sd", &found.alpha_sd),
        ] {
            told.column(format!("  {what}"), column);
        }
        for (what, rows) in ["theta", "omega", "alpha"].iter().zip(&found.strays) {
            if !rows.is_empty() {
                told.numbers(format!("  strays of {what}"), rows.iter().map(|row| *row as f64));
            }
        }
    }
}

#[test]
fn whatever_sensors_are_there() {
    let mut told = Answers::of("sensors");
    for (name, there) in [
        ("all", ALL),
        ("angle", ANGLE),
        ("angle and speed", [true, true, false]),
        ("angle and acceleration", [true, false, true]),
    ] {
        seen(even(COUNT), there, [1.0; 3], 41).told(&mut told, name, None);
        seen(uneven(42), there, [5.0, 0.2, 3.0], 43).told(&mut told, &format!("{name}, uneven"), None);
    }
    // Lost rows, of one sensor and of all; and rows that did not come at all.
    let gaps = seen(even(COUNT), ALL, [1.0; 3], 44).with(1, |omega| omega[300..420].fill(f64::NAN));
    let gaps = gaps.with(2, |alpha| alpha[380..500].fill(f64::NAN));
    gaps.told(&mut told, "lost", None);
    let mut late = even(COUNT);
    late.iter_mut().skip(500).for_each(|t| *t += 0.05);
    seen(late, [true, true, false], [1.0; 3], 45).told(&mut told, "late", None);
    let third = seen(even(COUNT), ALL, [1.0; 3], 46).with(0, |theta| {
        (0..theta.len()).filter(|at| at % 3 > 0).for_each(|at| theta[at] = f64::NAN);
    });
    third.told(&mut told, "every third", None);
    let short = |count: usize| seen(even(count), ALL, [1.0; 3], 47);
    [3, 4, 9, 17, 40]
        .into_iter()
        .for_each(|count| short(count).told(&mut told, &format!("{count} rows"), None));
    short(2).told(&mut told, "2 rows", None);
    let exact = Noise { theta: 0.0, omega: f64::INFINITY, alpha: 0.1, jerk: 500.0 };
    seen(even(COUNT), ALL, [0.0; 3], 48).told(&mut told, "exact", Some(exact));
    let calm = Noise { theta: 1e-3, omega: 0.1, alpha: f64::INFINITY, jerk: 1e-6 };
    seen(even(5000), ALL, [1.0; 3], 49).told(&mut told, "calm", Some(calm));
    told.done();
}

#[test]
fn angles_in_counts_and_stairs() {
    let mut told = Answers::of("counts");
    for (there, what) in [(ANGLE, "angle"), ([true, true, false], "angle and speed")] {
        for step in [1e-4, 2e-3, 2e-2, 0.2] {
            let counted = |theta: &mut [f64]| theta.iter_mut().for_each(|x| *x = (*x / step).round() * step);
            let capture = seen(even(1500), there, [0.1; 3], 51).with(0, counted);
            capture.told(&mut told, &format!("{what} in steps of {step}"), None);
        }
    }
    // A knob that hardly moves, and one that rests.
    for slow in [0.02, 0.1] {
        let t: Vec<f64> = even(1500).iter().map(|t| slow * t).collect();
        let capture = Seen { t: even(1500), ..seen(t, ANGLE, [0.0; 3], 52) };
        let counted = |theta: &mut [f64]| theta.iter_mut().for_each(|x| *x = (*x / 1e-3).round() * 1e-3);
        capture.with(0, counted).told(&mut told, &format!("{slow} times as fast"), None);
    }
    let rests = |theta: &mut [f64]| (400..900).for_each(|at| theta[at] = theta[400]);
    seen(even(1500), ANGLE, [0.0; 3], 53).with(0, rests).told(&mut told, "rests", None);
    told.done();
}

#[test]
fn blows_and_wild_readings() {
    let mut told = Answers::of("blows");
    for there in [ALL, [true, true, false], ANGLE] {
        let sensors = there.iter().filter(|is| **is).count();
        let name = |what: &str| format!("{sensors} sensors, {what}");
        let capture = |seed: u64| seen(even(COUNT), there, [1.0; 3], seed);
        // From some row on it turns faster by this much, all at once or over some rows.
        for (by, over) in [(0.3, 1), (3.0, 1), (3.0, 12), (30.0, 3)] {
            let speed = |at: usize| by * (at.saturating_sub(400) as f64 / f64::from(over)).min(1.0);
            let way: Vec<f64> = (0..COUNT)
                .scan(0.0, |way, at| {
                    *way += speed(at) / RATE_HZ;
                    Some(*way)
                })
                .collect();
            let blown = capture(61)
                .with(0, |theta| theta.iter_mut().zip(&way).for_each(|(x, by)| *x += by))
                .with(1, |omega| omega.iter_mut().enumerate().for_each(|(at, x)| *x += speed(at)))
                .with(2, |alpha| {
                    (401..=400 + over as usize).for_each(|at| alpha[at] += by * RATE_HZ / f64::from(over))
                });
            blown.told(&mut told, &name(&format!("a blow of {by} over {over}")), None);
        }
        for which in 0..sensors {
            let size = [2e-5, 2e-3, 0.5][which];
            for (times, rows) in
                [(8.0, 300..301), (60.0, 300..301), (1e3, 300..303), (1e3, 300..309), (200.0, 2..3)]
            {
                let wild =
                    |column: &mut [f64]| column[rows.clone()].iter_mut().for_each(|x| *x += times * size);
                let said = format!("{times} of {which} at {} to {}", rows.start, rows.end);
                capture(62).with(which, wild).told(&mut told, &name(&said), None);
            }
            let scattered = |column: &mut [f64]| {
                [250, 251, 255, 520, 700].iter().for_each(|at| column[*at] -= 500.0 * size)
            };
            capture(63).with(which, scattered).told(&mut told, &name(&format!("scattered of {which}")), None);
            // For a while a sensor says nothing, or the same.
            let off = |column: &mut [f64]| column[400..440].fill(0.0);
            capture(64).with(which, off).told(&mut told, &name(&format!("{which} is off")), None);
        }
    }
    told.done();
}
