//! Low-pass designs: analog prototype, bilinear transform with a pre-warped edge, sections.
//!
//! Every step rounds as SciPy's does, because a narrow filter magnifies the last bit of its
//! coefficients: at an edge of 0.002 of the Nyquist frequency one bit moves the DC gain by 1e-11.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::pairing::{Roots, sections};
use super::sos::Sos;
use crate::effects::short;
use crate::error::{Error, Result};

/// Digits of a frequency in a message: that of a log's clock has a dozen.
const DIGITS: usize = 4;

/// Highest order that the designs give; beyond it the stop band of any practical filter is below
/// the rounding of a double.
const MAX_ORDER: usize = 12;

/// Chebyshev type II low-pass: flat in the pass band, at least `stopband_db` of attenuation from
/// `edge_hz` on (Oppenheim & Schafer, *Discrete-Time Signal Processing*, 2010, appendix B.3).
///
/// The poles are the inverses of the type I poles, `p = -1 / sinh(mu + i theta)`, with
/// `mu = asinh(sqrt(10^(dB/10) - 1)) / order`; the zeros lie at `i / sin(theta)`.
///
/// # Errors
/// Order outside of 1..=12, an attenuation that is not positive and finite, or an edge that is not
/// between zero and the Nyquist frequency.
pub fn cheby2(order: usize, stopband_db: f64, edge_hz: f64, rate_hz: f64) -> Result<Sos> {
    let warped = warped_edge("edge_hz", order, edge_hz, rate_hz)?;
    if !(stopband_db.is_finite() && stopband_db > 0.0) {
        return Err(Error::invalid(
            "stopband_db",
            format!("{stopband_db} dB must be a positive attenuation, for example 20"),
        ));
    }
    let ripple = 1.0 / (10f64.powf(0.1 * stopband_db) - 1.0).sqrt();
    let mu = (1.0 / ripple).asinh() / order as f64;
    let poles = angles(order)
        .map(|theta| {
            let sinh = Complex::new(mu.sinh() * theta.cos(), mu.cosh() * theta.sin());
            divide(Complex::new(-1.0, 0.0), sinh)
        })
        .collect();
    let zeros = angles(order)
        .filter(|&theta| theta != 0.0)
        .map(|theta| Complex::new(0.0, 1.0 / theta.sin()))
        .collect();
    Sos::new(digital_sections(zeros, poles, warped), rate_hz)
}

/// Chebyshev type I low-pass: `ripple_db` of ripple up to `edge_hz`, steeper beyond it (Oppenheim &
/// Schafer, appendix B.2). The poles are `-sinh(mu + i theta)`, with
/// `mu = asinh(1 / sqrt(10^(dB/10) - 1)) / order`; at even orders the gain at rest is that of a trough.
///
/// # Errors
/// As [`cheby2`].
pub fn cheby1(order: usize, ripple_db: f64, edge_hz: f64, rate_hz: f64) -> Result<Sos> {
    let warped = warped_edge("edge_hz", order, edge_hz, rate_hz)?;
    if !(ripple_db.is_finite() && ripple_db > 0.0) {
        return Err(Error::invalid(
            "ripple_db",
            format!("{ripple_db} dB must be a positive ripple, for example 0.05"),
        ));
    }
    let ripple = (10f64.powf(0.1 * ripple_db) - 1.0).sqrt();
    let mu = (1.0 / ripple).asinh() / order as f64;
    let poles =
        angles(order).map(|theta| Complex::new(-mu.sinh() * theta.cos(), -mu.cosh() * theta.sin())).collect();
    let mut sections = digital_sections(Vec::new(), poles, warped);
    if order.is_multiple_of(2)
        && let Some(first) = sections.first_mut()
    {
        first.b = first.b.map(|b| b / (1.0 + ripple * ripple).sqrt());
    }
    Sos::new(sections, rate_hz)
}

/// Butterworth low-pass: maximally flat, half the power at `cutoff_hz` (S. Butterworth, 1930).
/// The poles lie on the unit circle, `p = -exp(i theta)`; there are no finite zeros.
///
/// # Errors
/// Order outside of 1..=12, or a cutoff that is not between zero and the Nyquist frequency.
pub fn butter(order: usize, cutoff_hz: f64, rate_hz: f64) -> Result<Sos> {
    let warped = warped_edge("cutoff_hz", order, cutoff_hz, rate_hz)?;
    let poles = angles(order).map(|theta| -Complex::new(theta.cos(), theta.sin())).collect();
    Sos::new(digital_sections(Vec::new(), poles, warped), rate_hz)
}

/// Angles of the prototype's poles from the negative real axis, `pi m / (2 order)` with
/// `m = -order + 1, -order + 3, ..., order - 1`: symmetric, so roots come in exact pairs.
fn angles(order: usize) -> impl Iterator<Item = f64> {
    let order = order as i32;
    (1 - order..order).step_by(2).map(move |m| PI * f64::from(m) / f64::from(2 * order))
}

/// The edge on the analog axis of a unit-rate bilinear transform, `4 tan(pi edge / rate)`, so that
/// the digital filter has its edge exactly there.
fn warped_edge(name: &str, order: usize, edge_hz: f64, rate_hz: f64) -> Result<f64> {
    if !(1..=MAX_ORDER).contains(&order) {
        return Err(Error::invalid("order", format!("{order} must be 1 to {MAX_ORDER}")));
    }
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Error::invalid(
            "rate_hz",
            format!("a sampling rate of {rate_hz} Hz must be positive and finite"),
        ));
    }
    let nyquist_hz = 0.5 * rate_hz;
    if !(edge_hz.is_finite() && edge_hz > 0.0 && edge_hz < nyquist_hz) {
        let [edge, nyquist, rate] = [edge_hz, nyquist_hz, rate_hz].map(|hz| short(hz, DIGITS));
        return Err(Error::invalid(
            name,
            format!(
                "{edge} Hz must lie above 0 and below the Nyquist frequency {nyquist} Hz \
                 (half of {rate} Hz); lower the edge or sample faster"
            ),
        ));
    }
    let fraction = edge_hz / nyquist_hz;
    Ok(4.0 * (PI * fraction / 2.0).tan())
}

/// Scale the prototype to the edge, map it by `z = (4 + s) / (4 - s)`, and split it into sections.
/// Zeros at infinity arrive at the Nyquist frequency, `z = -1`.
fn digital_sections(zeros: Vec<Complex<f64>>, poles: Vec<Complex<f64>>, warped: f64) -> Vec<super::Section> {
    let four = Complex::new(4.0, 0.0);
    let degree = poles.len() - zeros.len();
    let product = |roots: &[Complex<f64>], from: Complex<f64>, scale: f64| {
        roots.iter().map(|root| from - root * scale).product::<Complex<f64>>()
    };
    let zero = Complex::new(0.0, 0.0);
    let prototype_gain = divide(product(&poles, zero, 1.0), product(&zeros, zero, 1.0)).re;
    let analog_gain = prototype_gain * warped.powi(degree as i32);
    let ratio = divide(product(&zeros, four, warped), product(&poles, four, warped));
    let gain = analog_gain * ratio.re;

    let bilinear = |root: &Complex<f64>| divide(four + root * warped, four - root * warped);
    let nyquist = std::iter::repeat_n(Complex::new(-1.0, 0.0), degree);
    let zeros = Roots::new(zeros.iter().map(bilinear).chain(nyquist));
    let poles = Roots::new(poles.iter().map(bilinear));
    sections(zeros, poles, gain)
}

/// Complex division without overflow, and without the rounding that squaring the divisor brings
/// (R. L. Smith, *Algorithm 116*, 1962).
fn divide(a: Complex<f64>, b: Complex<f64>) -> Complex<f64> {
    if b.re.abs() >= b.im.abs() {
        let ratio = b.im / b.re;
        let scale = 1.0 / (b.re + b.im * ratio);
        Complex::new((a.re + a.im * ratio) * scale, (a.im - a.re * ratio) * scale)
    } else {
        let ratio = b.re / b.im;
        let scale = 1.0 / (b.re * ratio + b.im);
        Complex::new((a.re * ratio + a.im) * scale, (a.im * ratio - a.re) * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_the_edge_the_nyquist_frequency_and_the_way_out() {
        for edge_hz in [500.0, 600.0, 0.0, -3.0, f64::NAN, f64::INFINITY] {
            let message = cheby2(3, 20.0, edge_hz, 1000.0).unwrap_err().to_string();
            assert!(message.contains(&format!("{edge_hz} Hz")), "{message}");
            assert!(message.contains("Nyquist frequency 500 Hz"), "{message}");
            assert!(message.contains("lower the edge"), "{message}");
        }
        let message = cheby2(3, 20.0, 100.5, 199.8994476).unwrap_err().to_string();
        assert!(message.contains("Nyquist frequency 99.95 Hz (half of 199.9 Hz)"), "{message}");
    }

    #[test]
    fn orders_outside_of_1_to_12_are_refused() {
        assert!(butter(0, 100.0, 1000.0).unwrap_err().to_string().contains("order: 0"));
        assert!(butter(13, 100.0, 1000.0).is_err());
    }

    #[test]
    fn a_stop_band_without_attenuation_is_refused() {
        for db in [0.0, -20.0, f64::NAN, f64::INFINITY] {
            assert!(cheby2(3, db, 100.0, 1000.0).is_err());
        }
    }

    #[test]
    fn a_constant_passes_every_design_unchanged() {
        for order in 1..=12 {
            for filter in [butter(order, 90.0, 1e3), cheby2(order, 20.0, 90.0, 1e3)] {
                assert!((filter.unwrap().power_gain(0.0) - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_power_at_the_edge_is_half_for_butterworth_and_the_stop_band_for_chebyshev() {
        for order in 1..=12 {
            let half = butter(order, 90.0, 1e3).unwrap().power_gain(90.0);
            assert!((half - 0.5).abs() < 1e-9);
            let stop = cheby2(order, 20.0, 90.0, 1e3).unwrap().power_gain(90.0);
            assert!((stop - 0.01).abs() < 1e-9);
        }
    }
}
