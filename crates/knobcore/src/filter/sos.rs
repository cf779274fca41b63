//! A digital filter as a chain of second-order sections, and what can be said of it.

use std::f64::consts::PI;

use nalgebra::Complex;

use crate::error::{Error, Result};

/// One section: `y[n] = b0 x[n] + b1 x[n-1] + b2 x[n-2] - a1 y[n-1] - a2 y[n-2]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator `b0, b1, b2`.
    pub b: [f64; 3],
    /// Denominator `a1, a2`; `a0` is 1.
    pub a: [f64; 2],
}

impl Section {
    /// Steady output for a constant input of one.
    pub fn dc_gain(&self) -> f64 {
        self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1])
    }

    /// The state of SciPy's transposed form in which a constant input of one gives a constant
    /// output from the first sample on: `z1 = y - b0`, `z2 = b2 - a2 y` (`lfilter_zi`).
    pub fn steady_state(&self) -> [f64; 2] {
        let y = self.dc_gain();
        [y - self.b[0], self.b[2] - self.a[1] * y]
    }

    /// Radius of the outer pole.
    fn pole_radius(&self) -> f64 {
        let [a1, a2] = self.a;
        let discriminant = 0.25 * a1 * a1 - a2;
        if discriminant < 0.0 { a2.sqrt() } else { 0.5 * a1.abs() + discriminant.sqrt() }
    }

    /// `|H|^2` at `z`.
    fn power_gain(&self, z: Complex<f64>) -> f64 {
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        let numerator = (z * b0 + b1) * z + b2;
        let denominator = (z + a1) * z + a2;
        numerator.norm_sqr() / denominator.norm_sqr()
    }
}

/// A stable chain of sections at a sampling rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Sos {
    sections: Vec<Section>,
    rate_hz: f64,
}

impl Sos {
    /// A chain at `rate_hz`.
    ///
    /// # Errors
    /// No section, a coefficient that is not finite, or a pole that is not inside the unit circle.
    pub fn new(sections: Vec<Section>, rate_hz: f64) -> Result<Self> {
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(
                "rate_hz",
                format!("a sampling rate of {rate_hz} Hz must be positive and finite"),
            ));
        }
        if sections.is_empty() {
            return Err(Error::invalid("sos", "a filter needs at least one section"));
        }
        for (row, section) in sections.iter().enumerate() {
            if !section.b.iter().chain(&section.a).all(|c| c.is_finite()) {
                return Err(Error::invalid("sos", format!("section {row} is not finite")));
            }
            let radius = section.pole_radius();
            if radius >= 1.0 {
                return Err(Error::invalid(
                    "sos",
                    format!(
                        "section {row} is unstable (pole radius {radius}): \
                         design it with a higher edge or a lower order"
                    ),
                ));
            }
        }
        Ok(Self { sections, rate_hz })
    }

    /// The sections in the order of their application.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Sampling rate \[Hz\].
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// For each section the transposed-form state that starts the chain in the steady state of a
    /// constant input of one; equal to SciPy's `sosfilt_zi`.
    pub fn steady_state(&self) -> Vec<[f64; 2]> {
        let mut input = 1.0;
        let scaled = self.sections.iter().map(|section| {
            let state = section.steady_state().map(|z| z * input);
            input *= section.dc_gain();
            state
        });
        scaled.collect()
    }

    /// `|H(f)|^2` of one pass; the forward-backward filter has this as its (real) gain.
    pub fn power_gain(&self, frequency_hz: f64) -> f64 {
        let z = Complex::from_polar(1.0, 2.0 * PI * frequency_hz / self.rate_hz);
        self.sections.iter().map(|section| section.power_gain(z)).product()
    }

    /// Samples to either side after which the impulse response of the forward-backward filter is
    /// below 1e-16 of its largest value.
    ///
    /// It decays as `r^n` with the largest pole radius `r`; the first factor, found over the
    /// designs of this module, stays below 100 per section.
    pub fn settle(&self) -> usize {
        let radius = self.sections.iter().map(Section::pole_radius).fold(0.0, f64::max);
        let start = 100f64.powi(self.sections.len() as i32);
        // At least one sample of memory; a radius of at most 1 - 1e-16 bounds it from above.
        let decay = -radius.clamp(1e-16, 1.0 - f64::EPSILON).ln();
        2 * self.sections.len() + ((start / 1e-16).ln() / decay).ceil() as usize
    }

    /// Mean of `|H|^4` over 0 to the Nyquist frequency: the factor by which the forward-backward
    /// filter changes the variance of white noise.
    ///
    /// By the trapezoidal rule, which for this periodic function errs only by the correlation of
    /// the impulse response at twice the settling time.
    pub fn mean_power(&self) -> f64 {
        let intervals = self.settle().clamp(64, 1 << 20);
        let step_hz = 0.5 * self.rate_hz / intervals as f64;
        let square = |k: usize| self.power_gain(k as f64 * step_hz).powi(2);
        let inner: f64 = (1..intervals).map(square).sum();
        (inner + 0.5 * (square(0) + square(intervals))) / intervals as f64
    }
}
