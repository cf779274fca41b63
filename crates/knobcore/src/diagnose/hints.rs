//! What speaks for each absent effect to first order, a number each: too little to name one, but a lot of captures adds
//! it up.

use super::screen::Screen;
use super::watch::Watch;
use crate::effects::{Id, Place};
use crate::floor::{Floor, noises};
use crate::model::Model;
use crate::signals::Signals;

/// Starts of an effect that are looked at, of all of them: more say nearly the same, and take as much longer.
const MOST: usize = 2;

/// How much a capture speaks for an effect, in standard deviations of what noise alone would give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hint {
    /// An effect that draws the torque in one direction alone: how far the residual leans that way, with its sign. By
    /// chance it is as often negative as positive, so that a lot of captures adds up what is in all of them.
    Lean(f64),
    /// One that draws in several directions: the root of what all of them take off.
    Gain(f64),
}

impl Hint {
    /// Of what the directions of each start have of the residual: the mean over the starts, of which none is right.
    fn of(starts: &[Vec<f64>]) -> Option<Self> {
        let count = starts.len() as f64;
        match starts.iter().map(Vec::len).max()? {
            0 => None,
            1 => Some(Self::Lean(starts.iter().flatten().sum::<f64>() / count)),
            _ => Some(Self::Gain((starts.iter().flatten().map(|z| z * z).sum::<f64>() / count).sqrt())),
        }
    }
}

/// What a capture says for these effects beside a fitted model; nothing of couplings, which a first step does not tell,
/// nor of those whose whole torque the model takes up.
pub fn hints(data: &[&Signals], model: &Model, effects: &[Id]) -> Vec<(Id, Hint)> {
    let watch = Watch::new(&|_| true, effects.len());
    let screen = Screen::new(data, model, &watch);
    let white = Floor::with(data, &noises(data, model)).white;
    if white.is_nan() || white <= 0.0 {
        return Vec::new();
    }
    let scale = white.sqrt().recip();
    let hint = |id: &Id| {
        let mut starts = screen.leans(*id, MOST);
        starts.iter_mut().flatten().for_each(|z| *z *= scale);
        Some((*id, Hint::of(&starts)?))
    };
    let ids: Vec<Id> = effects.iter().copied().filter(|id| id.info().place != Place::Coupling).collect();
    watch.each(&ids, hint).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::fit::refine;

    fn told(truth: &[(&str, f64)], effects: &[Id]) -> Vec<(Id, Hint)> {
        let known = |name: &str| *Id::BUILT_IN.iter().find(|id| name.starts_with(id.info().id)).unwrap();
        let mut own: Vec<Id> = truth.iter().map(|(name, _)| known(name)).collect();
        own.dedup();
        let signals = recorded(&knob(&own, truth), "a");
        let base = refine(&[&signals], &knob(&[], &[])).unwrap().model;
        hints(&[&signals], &base, effects)
    }

    #[test]
    fn the_mean_over_the_starts_has_a_sign_where_each_has_one_direction() {
        assert_eq!(Hint::of(&[vec![1.0], vec![], vec![-4.0]]), Some(Hint::Lean(-1.0)));
        assert_eq!(Hint::of(&[vec![3.0, 4.0], vec![5.0]]), Some(Hint::Gain(5.0)));
        assert_eq!((Hint::of(&[]), Hint::of(&[vec![], vec![]])), (None, None));
    }

    #[test]
    fn a_capture_leans_towards_what_it_has_in_its_direction_and_a_coupling_has_no_hint() {
        let drag = |d: f64| {
            let found = told(&[("quadratic_drag.d", d)], &[Id::QuadraticDrag, Id::Compliance]);
            let [(Id::QuadraticDrag, Hint::Lean(lean))] = found[..] else { panic!("{found:?}") };
            lean
        };
        let (none, some, less) = (drag(0.0), drag(3e-4), drag(-3e-4));
        assert!(none.abs() < 4.0 && some - none > 10.0 && less - none < -10.0, "{none} {some} {less}");
        // It is in proportion to the size, beside what noise does.
        assert!(((drag(6e-4) - none) / (some - none) - 2.0).abs() < 0.1);
    }

    #[test]
    fn a_wave_is_seen_whatever_its_phase_is() {
        for phi in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0] {
            let gain = |a: f64| {
                let found = told(&[("unbalance.a", a), ("unbalance.phi", phi)], &[Id::Unbalance]);
                let [(Id::Unbalance, Hint::Gain(gain))] = found[..] else { panic!("{found:?}") };
                gain
            };
            assert!(gain(0.0) < 4.0 && gain(1e-3) > 8.0, "{phi}: {} {}", gain(0.0), gain(1e-3));
        }
    }

    #[test]
    fn what_draws_in_several_directions_gains_whatever_its_signs_are() {
        let gain = |k: f64| {
            let found = told(&[("return_spring.k", k)], &[Id::PositionPolynomial]);
            let [(Id::PositionPolynomial, Hint::Gain(gain))] = found[..] else { panic!("{found:?}") };
            gain
        };
        assert!(gain(0.0) < 5.0 && gain(0.01) > 10.0 && gain(-0.01) > 10.0);
    }
}
