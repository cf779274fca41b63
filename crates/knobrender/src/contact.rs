//! Dry friction that holds without drift: an anchor where the knob stuck, a spring to it, and two limits.
//!
//! Karnopp's friction (1985; Equation 2 of the haptic-camera paper) has no memory of where the knob stuck, so
//! that a torque which only just holds lets it creep. Here friction is elastoplastic (Hayward & Armstrong 2000,
//! "A new computational model of friction applied to haptic rendering"; Kikuuwe, Takesue, Sano, Mochiyama &
//! Fujimoto 2006): within its limits it is a spring to the anchor and returns all that it took; at a limit the
//! anchor follows. The limit is the static friction D while the knob sticks and the sliding friction from then on,
//! until it comes to rest again.
//!
//! The damper that a sampled spring needs acts within the same limits, so that friction never exceeds them. It
//! does not stretch the spring: a knob that slides feels its sliding friction and nothing else.

use super::device::Tuning;

/// Where the knob stands between sticking and sliding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contact {
    /// Stretch of the spring as a share of the limit on its side: -1 to 1.
    pub strain: f64,
    /// Whether it has broken away and not yet come to rest.
    pub slipping: bool,
    /// Torque of the weak spring that holds beside a measured hand, N m.
    pub rest: f64,
}

/// What friction may answer at most, N m: magnitudes backward and forward.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    /// While the knob slides.
    pub slide: [f64; 2],
    /// While it sticks.
    pub hold: [f64; 2],
}

/// How the handle has moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moved {
    /// Since the sample before, rad.
    pub by: f64,
    /// Speed, rad/s.
    pub omega: f64,
    /// Speed below which a knob may come to rest, rad/s.
    pub band: f64,
}

/// A knob comes to rest when its spring has let go of half of the sliding friction.
const RELAXED: f64 = 0.5;

impl Contact {
    /// A knob that is first seen moving slides already.
    pub(super) fn first(omega: f64, band: f64) -> Self {
        if omega.abs() > band {
            return Self { strain: omega.signum(), slipping: true, rest: 0.0 };
        }
        Self::default()
    }

    /// The direction in which it slides on and on, so that friction is the sliding friction of that direction:
    /// 1, -1, or 0 where that has to be looked into.
    pub(super) fn slides(&self, by: f64, omega: f64) -> f64 {
        let on = self.slipping && self.strain.abs() == 1.0;
        if on && self.strain * omega > 0.0 && self.strain * by >= 0.0 { self.strain } else { 0.0 }
    }

    /// Friction, N m, and the share of its limit. `other` is the torque that friction would have to answer to
    /// keep the knob still, if that is known.
    pub(super) fn answer(
        &mut self,
        tuning: &Tuning,
        budget: &Budget,
        moved: Moved,
        other: Option<f64>,
    ) -> (f64, f64) {
        let hold = [budget.hold[0].max(budget.slide[0]), budget.hold[1].max(budget.slide[1])];
        let limits = if self.slipping { budget.slide } else { hold };
        let mut pull = self.strain * side(self.strain, limits) + tuning.stiffness * moved.by;
        let mut asked = pull + tuning.damping * moved.omega;
        if let (Some(other), false) = (other, self.slipping) {
            self.rest = (self.rest + tuning.weak * moved.by).clamp(-hold[0], hold[1]);
            pull = other + self.rest;
            asked = pull + tuning.damping * moved.omega;
        }
        self.strain = share(pull, limits);
        if !self.slipping && (asked < -hold[0] || asked > hold[1]) {
            *self = Self { strain: asked.signum(), slipping: true, rest: 0.0 };
        } else if self.slipping
            && moved.omega.abs() <= moved.band
            && asked.abs() <= RELAXED * side(asked, budget.slide)
        {
            *self = Self { strain: share(pull, hold), slipping: false, rest: 0.0 };
        }
        let limits = if self.slipping { budget.slide } else { hold };
        let friction = asked.max(-limits[0]).min(limits[1]);
        (friction, share(friction, limits))
    }
}

/// The limit on the side of `x`.
fn side(x: f64, [back, forth]: [f64; 2]) -> f64 {
    if x < 0.0 { back } else { forth }
}

/// `x` as a share of the limit on its side, -1 to 1; without a limit, its sign.
fn share(x: f64, limits: [f64; 2]) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    (x / side(x, limits)).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::nature::Nature;
    use super::*;
    use knobcore::param::Axis;

    const BUDGET: Budget = Budget { slide: [0.01, 0.02], hold: [0.03, 0.05] };

    fn tuning() -> Tuning {
        let nature =
            Nature { inertia: 0.0, surge: 0.0, hold: 0.02, stiffness: 0.0, damping: 0.0, dissipates: true };
        Tuning { damping: 0.0, ..Tuning::faithful(Axis::Rotary, &nature, 2e-4) }
    }

    fn moved(by: f64, omega: f64) -> Moved {
        Moved { by, omega, band: 0.1 }
    }

    #[test]
    fn a_knob_holds_by_its_static_friction_and_slides_by_the_other_until_it_is_slow_and_relaxed() {
        let tuning = tuning();
        let angle = |torque: f64| torque / tuning.stiffness;
        for (sign, hold, slide) in [(1.0, 0.05, 0.02), (-1.0, 0.03, 0.01)] {
            let mut contact = Contact::default();
            let mut step = |by: f64, omega: f64| {
                contact.answer(&tuning, &BUDGET, moved(sign * angle(by), sign * omega), None)
            };
            // Up to its static friction it is a spring, and gives back what it took.
            let (friction, strain) = step(0.9 * hold, 1.0);
            assert!((friction - sign * 0.9 * hold).abs() < 1e-12 && (strain - sign * 0.9).abs() < 1e-12);
            assert!((step(-0.4 * hold, -1.0).0 - sign * 0.5 * hold).abs() < 1e-12);
            // Beyond it slides, with no more than its sliding friction.
            assert_eq!(step(0.6 * hold, 1.0), (sign * slide, sign));
            assert_eq!(step(angle(1.0), 1.0), (sign * slide, sign));
            // Let go by more than half of that it rests if it is slow, and not before.
            let (friction, _) = step(-0.7 * slide, 1.0);
            assert!((friction - sign * 0.3 * slide).abs() < 1e-12);
            assert!((step(0.0, 1.0).0 - sign * 0.3 * slide).abs() < 1e-12);
            assert!(contact.slipping, "it is too fast to rest");
            contact.answer(&tuning, &BUDGET, moved(sign * angle(0.4 * slide), 0.0), None);
            assert!(contact.slipping, "it is strained too much to rest");
            contact.answer(&tuning, &BUDGET, moved(sign * angle(-0.4 * slide), 0.1), None);
            assert!(!contact.slipping);
            // At rest static friction holds it, as far as it was strained.
            let (friction, _) = contact.answer(&tuning, &BUDGET, moved(sign * angle(0.5 * hold), 0.0), None);
            assert!((friction - sign * (0.3 * slide + 0.5 * hold)).abs() < 1e-12 && !contact.slipping);
        }
    }

    #[test]
    fn it_slides_on_only_the_way_that_it_is_strained() {
        let mut contact = Contact::first(-2.0, 0.1);
        assert_eq!((contact.slipping, contact.strain), (true, -1.0));
        assert_eq!(
            [(-1e-6, -1.0), (0.0, -1.0), (1e-6, -1.0), (-1e-6, 0.0), (-1e-6, 1.0)]
                .map(|(by, w)| contact.slides(by, w)),
            [-1.0, -1.0, 0.0, 0.0, 0.0]
        );
        contact.strain = -0.9;
        assert_eq!(contact.slides(-1e-6, -1.0), 0.0);
        assert_eq!(Contact::first(0.1, 0.1), Contact::default());
    }
}
