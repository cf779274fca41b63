//! The finest step that a sensor shows.

/// Share of the changes that must be whole multiples of the step before it counts as a resolution.
const MOST: f64 = 0.99;

/// How far from a whole multiple a change may be, in steps.
const TOLERANCE: f64 = 0.1;

/// The quantisation step of `column`, in its own units; zero if it has none that can be seen above the
/// resolution of the numbers themselves.
pub fn quantum(column: &[f64]) -> f64 {
    let finite: Vec<f64> = column.iter().copied().filter(|value| value.is_finite()).collect();
    // What differs by rounding alone is the same: an angle that was moved by whole counts keeps its step.
    let least = 4.0 * rounding(&finite);
    let changes = || finite.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|&change| change > least);
    let (step, all) = changes().fold((f64::INFINITY, 0.0), |(least, all), step| (step.min(least), all + 1.0));
    if !step.is_finite() {
        return 0.0;
    }
    let mut whole = all;
    for change in changes() {
        let steps = change / step;
        if (steps - steps.round()).abs() >= TOLERANCE {
            whole -= 1.0;
            if whole < MOST * all {
                return 0.0;
            }
        }
    }
    step
}

/// The least noise that `column` can have: uniform over a quantisation step (variance step^2 / 12, Widrow
/// and Kollar, "Quantization Noise", Cambridge 2008), or the rounding of the numbers.
pub fn least_noise(column: &[f64]) -> f64 {
    (quantum(column) / 12.0_f64.sqrt()).max(rounding(column)).max(f64::EPSILON.powi(2))
}

fn rounding(column: &[f64]) -> f64 {
    let largest =
        column.iter().filter(|value| value.is_finite()).fold(0.0_f64, |most, value| most.max(value.abs()));
    4.0 * f64::EPSILON * largest
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
    fn a_constant_has_a_least_noise_above_zero() {
        assert!(least_noise(&[0.0; 9]) > 0.0);
    }
}
