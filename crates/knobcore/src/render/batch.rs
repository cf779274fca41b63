//! A whole motion at once: the same numbers as single steps, eight samples at a time where the knob just slides.
#![expect(clippy::needless_range_loop, reason = "a count known to the compiler becomes vector instructions")]

use super::sliding::{Sliding, sliding};
use super::step::{Renderer, Sensed};
use crate::motion::Motion;
use crate::scalar::{LANES, Pack, Scalar};

/// Columns of a motion: angle, speed, acceleration, and the torque of the hand where it is measured.
#[derive(Clone, Copy)]
struct Columns<'a> {
    motion: [&'a [f64]; 3],
    hand: Option<&'a [f64]>,
}

impl Renderer {
    /// The torque along a motion, N m, as single steps would give it, to the last bit; a hand torque that is
    /// NaN is one that is not known. Rows beyond the shortest column are left as they are.
    pub fn render(&mut self, motion: [&[f64]; 3], hand: Option<&[f64]>, out: &mut [f64]) {
        let columns = Columns { motion, hand };
        pulp::Arch::new().dispatch(Rendering { renderer: self, columns, out });
    }

    /// Whether single steps would only add up what eight samples ask for: nothing is filtered or remembered.
    fn is_plain(&self) -> bool {
        let tuning = &self.tuning;
        let fast = self.limits.torque_rate == f64::INFINITY;
        self.state.fault.is_none() && tuning.freshness == 1.0 && tuning.count == 0.0 && fast
    }

    /// Whether the knob just slides on through these eight samples.
    #[inline(always)]
    fn glides(&self, columns: &Columns<'_>, at: usize) -> bool {
        let [theta, omega, alpha] = columns.motion.map(|column| Pack::load(column, at));
        let way = self.state.contact.slides(0.0, self.state.contact.strain);
        if way == 0.0 || self.state.samples == 0 {
            return false;
        }
        let mut before = [self.state.before[0]; LANES];
        before[1..].copy_from_slice(&theta.0[..LANES - 1]);
        let most = self.limits.speed * self.dt;
        let hand = columns.hand.map_or(Pack::of(0.0), |hand| Pack::load(hand, at));
        let mut on = true;
        for i in 0..LANES {
            let by = theta.0[i] - before[i];
            // What is not finite fails one of these; a hand that is NaN is not known.
            on &= way * by >= 0.0 && by.abs() <= most;
            on &= way * omega.0[i] > 0.0 && omega.0[i].abs() <= self.limits.speed;
            on &= alpha.0[i].abs() < f64::INFINITY && hand.0[i].abs() != f64::INFINITY;
        }
        on
    }

    /// What eight samples ask for if the knob slides in all of them; none for a model that remembers.
    #[inline(always)]
    fn ahead(&self, columns: &Columns<'_>, at: usize) -> Option<Sliding<Pack>> {
        if self.hidden.is_some() || !self.state.memory.is_empty() || self.own || self.tuning.rush_s != 0.0 {
            return None;
        }
        let clock = Pack(std::array::from_fn(|i| self.clock(self.state.samples + i as u64)));
        let speed = Pack::load(columns.motion[1], at);
        let there = Pack::load(columns.motion[0], at) + speed * Pack::of(self.tuning.ahead_s);
        let motion = Motion::exact(clock, there, speed, Pack::of(0.0));
        let spare: Option<&mut [Pack]> = if self.guarded { Some(&mut []) } else { None };
        Some(sliding(&self.model, &self.packs, &mut [], spare, &motion))
    }

    /// Eight samples through which the knob slides, all at once; false if a torque is not finite.
    #[inline(always)]
    fn glide(&mut self, columns: &Columns<'_>, at: usize, asked: Sliding<Pack>, out: &mut [f64]) -> bool {
        let [theta, omega, alpha] = columns.motion.map(|column| Pack::load(column, at));
        let [inertia, damping] = self.tuning.own.map(Pack::of);
        let tau = asked.torque + (asked.inertia + inertia) * alpha + damping * omega;
        let limit = self.limits.torque;
        let mut finite = true;
        let mut cut = tau;
        for i in 0..LANES {
            finite &= tau.0[i].is_finite();
            cut.0[i] = tau.0[i].max(-limit).min(limit);
        }
        if finite {
            cut.store(out, at);
            let last = LANES - 1;
            let state = &mut self.state;
            state.samples += LANES as u64;
            (state.before, state.between) = ([theta.0[last], omega.0[last]], theta.0[last]);
            (state.alpha, state.tau) = (alpha.0[last], cut.0[last]);
        }
        finite
    }
}

/// A rendering as a value, so that its body is compiled for the machine's instruction set.
struct Rendering<'a> {
    renderer: &'a mut Renderer,
    columns: Columns<'a>,
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Rendering<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { renderer, columns, out } = self;
        let rows = columns.motion.iter().map(|column| column.len()).fold(out.len(), usize::min);
        let plain = renderer.is_plain();
        for at in (0..rows).step_by(LANES) {
            let asked = renderer.ahead(&columns, at);
            if let Some(asked) = asked
                && plain
                && at + LANES <= rows
                && renderer.glides(&columns, at)
                && renderer.glide(&columns, at, asked, out)
            {
                continue;
            }
            for i in at..(at + LANES).min(rows) {
                let hand = columns.hand.and_then(|h| h.get(i)).copied().filter(|tau| !tau.is_nan());
                let [theta, omega, alpha] = columns.motion.map(|column| column[i]);
                let lane = i - at;
                let known = asked.map(|a| Sliding { torque: a.torque.0[lane], inertia: a.inertia.0[lane] });
                out[i] = renderer.advance(Sensed { theta, omega, alpha, hand }, known);
            }
        }
    }
}
