//! From zeros, poles and gain to second-order sections, by the pairing that SciPy calls `nearest`.

use nalgebra::Complex;

use super::sos::Section;

/// The roots of a real polynomial: of a complex pair the upper half, then the real ones.
pub(super) struct Roots(Vec<Complex<f64>>);

impl Roots {
    /// Keeps one of each conjugate pair and pads an odd number with a root at zero. The order,
    /// by real then imaginary part, settles which of two equally good roots is taken first.
    pub(super) fn new(all: impl Iterator<Item = Complex<f64>>) -> Self {
        let mut all: Vec<_> = all.collect();
        if all.len() % 2 == 1 {
            all.push(Complex::new(0.0, 0.0));
        }
        let mut kept: Vec<_> = all.into_iter().filter(|root| root.im >= 0.0).collect();
        let key = |root: &Complex<f64>| (is_real(root), root.re, root.im);
        kept.sort_by(|a, b| {
            let ((real_a, re_a, im_a), (real_b, re_b, im_b)) = (key(a), key(b));
            real_a.cmp(&real_b).then(re_a.total_cmp(&re_b)).then(im_a.total_cmp(&im_b))
        });
        Self(kept)
    }

    /// Removes the allowed root with the least cost.
    fn take(
        &mut self,
        cost: impl Fn(&Complex<f64>) -> f64,
        allowed: impl Fn(&Complex<f64>) -> bool,
    ) -> Option<Complex<f64>> {
        let candidates = self.0.iter().enumerate().filter(|(_, root)| allowed(root));
        let best = candidates.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)))?.0;
        Some(self.0.remove(best))
    }

    /// Removes the root with the least cost, and its partner: its conjugate, or for a real root
    /// the real root with the least cost among the rest. Gives the monic quadratic of the two.
    fn take_quadratic(&mut self, cost: impl Fn(&Complex<f64>) -> f64) -> Option<Quadratic> {
        let first = self.take(&cost, |_| true)?;
        if is_real(&first) {
            let second = self.take(&cost, is_real)?;
            let (sum, product) = (first.re + second.re, first.re * second.re);
            Some(Quadratic { first, coefficients: [1.0, -sum, product] })
        } else {
            let square = first.re * first.re + first.im * first.im;
            Some(Quadratic { first, coefficients: [1.0, -2.0 * first.re, square] })
        }
    }
}

/// `z^2 + c1 z + c2` with the root that was chosen first.
struct Quadratic {
    first: Complex<f64>,
    coefficients: [f64; 3],
}

fn is_real(root: &Complex<f64>) -> bool {
    root.im == 0.0
}

/// The pole closest to the unit circle takes the zero closest to it, then the next pole; the
/// sharpest section comes last and the gain sits in the first, so inner signals stay small.
pub(super) fn sections(mut zeros: Roots, mut poles: Roots, gain: f64) -> Vec<Section> {
    let mut sections = Vec::new();
    while let Some(pole) = poles.take_quadratic(|pole| (1.0 - pole.norm()).abs()) {
        let b = zeros
            .take_quadratic(|zero| (zero - pole.first).norm())
            .map_or([1.0, 0.0, 0.0], |zero| zero.coefficients);
        let [_, a1, a2] = pole.coefficients;
        sections.push(Section { b, a: [a1, a2] });
    }
    sections.reverse();
    if let Some(first) = sections.first_mut() {
        first.b = first.b.map(|b| b * gain);
    }
    sections
}
