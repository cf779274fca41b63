//! The finest step that a sensor shows.

/// Share of the changes that must be whole multiples of the step before it counts as a resolution.
const MOST: f64 = 0.99;

/// How far from a whole multiple a change may be, in steps.
const TOLERANCE: f64 = 0.1;

/// Numbers that are looked at side by side.
const LANES: usize = 8;

/// The quantisation step of `column`, in its own units; zero if it has none that can be seen above the
/// resolution of the numbers themselves.
pub fn quantum(column: &[f64]) -> f64 {
    if column.iter().all(|value| value.is_finite()) {
        return step(column);
    }
    step(&column.iter().copied().filter(|value| value.is_finite()).collect::<Vec<f64>>())
}

/// The same of numbers that are all finite.
fn step(finite: &[f64]) -> f64 {
    let Some((_, late)) = finite.split_first() else { return 0.0 };
    let early = &finite[..late.len()];
    // What differs by rounding alone is the same: an angle that was moved by whole counts keeps its step.
    let least = 4.0 * rounding(finite);
    let change = |early: &f64, late: &f64| (late - early).abs();
    let (mut steps, mut counts) = ([f64::INFINITY; LANES], [0.0; LANES]);
    for (early, late) in early.chunks(LANES).zip(late.chunks(LANES)) {
        for (((early, late), step), count) in early.iter().zip(late).zip(&mut steps).zip(&mut counts) {
            let change = change(early, late);
            *count += if change > least { 1.0 } else { 0.0 };
            *step = if change > least && change < *step { change } else { *step };
        }
    }
    let step = steps.into_iter().fold(f64::INFINITY, f64::min);
    if !step.is_finite() {
        return 0.0;
    }
    let all: f64 = counts.iter().sum();
    let mut whole = all;
    for (early, late) in early.iter().zip(late) {
        let change = change(early, late);
        if change > least && off(change / step) >= TOLERANCE {
            whole -= 1.0;
            if whole < MOST * all {
                return 0.0;
            }
        }
    }
    step
}

/// How far from a whole number a number is, zero or more.
fn off(steps: f64) -> f64 {
    // Beside this there are no fractions; whatever is beyond its half has none that matter.
    const WHOLE: f64 = 1.0 / f64::EPSILON;
    if steps < 0.5 * WHOLE { (steps - ((steps + WHOLE) - WHOLE)).abs() } else { 0.0 }
}

/// The least noise that `column` can have: uniform over a quantisation step (variance step^2 / 12, Widrow
/// and Kollar, "Quantization Noise", Cambridge 2008), or the rounding of the numbers.
pub fn least_noise(column: &[f64]) -> f64 {
    (quantum(column) / 12.0_f64.sqrt()).max(rounding(column)).max(f64::EPSILON.powi(2))
}

fn rounding(column: &[f64]) -> f64 {
    let mut largest = [0.0; LANES];
    for chunk in column.chunks(LANES) {
        for (value, largest) in chunk.iter().zip(&mut largest) {
            let size = value.abs();
            *largest = if size > *largest && size < f64::INFINITY { size } else { *largest };
        }
    }
    4.0 * f64::EPSILON * largest.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoder_counts_have_their_count_as_step() {
        let count = std::f64::consts::TAU / 8192.0;
        let theta: Vec<f64> = (0..5000).map(|k| (f64::from(k) * 0.002).sin()).collect();
        let counted: Vec<f64> = theta.iter().map(|theta| (theta / count).round() * count).collect();
        assert!((quantum(&counted) / count - 1.0).abs() < 1e-9);
        assert!((least_noise(&counted).powi(2) / (count * count / 12.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn an_angle_that_was_moved_by_counts_has_its_step_still() {
        let count = std::f64::consts::TAU / 16_384.0;
        let moved = |k: i32| if k < 1234 { 0.0 } else { 12.0 * count };
        let theta: Vec<f64> =
            (0..3000).map(|k| (f64::from(k) * 0.3).floor() * count + 1.0 - moved(k)).collect();
        assert!((quantum(&theta) / count - 1.0).abs() < 1e-9);
    }

    #[test]
    fn an_unrounded_motion_has_no_step() {
        let theta: Vec<f64> = (0..5000).map(|k| (f64::from(k) * 0.002).sin()).collect();
        assert_eq!(quantum(&theta), 0.0);
        assert!(least_noise(&theta) < 1e-15);
    }

    #[test]
    fn a_column_with_gaps_has_the_step_of_its_readings() {
        let counted = |k: i32| f64::from(3 * k) * 1e-3;
        let gaps: Vec<f64> = (0..500).map(|k| if k % 7 == 3 { f64::NAN } else { counted(k) }).collect();
        assert!((quantum(&gaps) / 3e-3 - 1.0).abs() < 1e-9);
        assert_eq!((quantum(&[]), quantum(&[2.0]), quantum(&[f64::INFINITY, f64::NAN])), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_number_is_as_far_from_a_whole_one_as_it_is_from_the_nearest() {
        for (number, far) in
            [(0.0, 0.0), (0.25, 0.25), (2.75, 0.25), (7.5, 0.5), (1e9 + 0.125, 0.125), (1e300, 0.0)]
        {
            assert_eq!(off(number), far, "{number}");
        }
    }

    #[test]
    fn a_constant_has_a_least_noise_above_zero() {
        assert!(least_noise(&[0.0; 9]) > 0.0);
    }
}
