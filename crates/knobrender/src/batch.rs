//! A whole motion at once: the same numbers as single steps, a pack of samples at a time where the knob just slides.
#![expect(clippy::needless_range_loop, reason = "a count known to the compiler becomes vector instructions")]

use super::sliding::{Sliding, braked};
use super::state::Sensed;
use super::step::Renderer;
use knobcore::chain::Block;
use knobcore::isa;
use knobcore::motion::Motion;
use knobcore::scalar::{Known, Scalar, WIDE, Wide};

/// Columns of a motion: angle, speed, acceleration, and the torque of the hand where it is measured.
#[derive(Clone, Copy)]
struct Columns<'a> {
    motion: [&'a [f64]; 3],
    hand: Option<&'a [f64]>,
}

impl Columns<'_> {
    fn sensed(&self, i: usize) -> Sensed {
        let [theta, omega, alpha] = self.motion;
        let hand = self.hand.map(|hand| hand[i]).filter(|tau| !tau.is_nan());
        Sensed { theta: theta[i], omega: omega[i], alpha: alpha[i], hand }
    }
}

/// What a block of samples asks for if the knob slides in all of them.
// Vectors of eight that lie across two lines of the cache take twice as long.
#[repr(align(64))]
struct Ahead {
    /// Time, angle when the torque acts, direction: beside the speed what an effect looks at.
    motion: [[f64; Block::SAMPLES]; 3],
    moving: Block,
    /// The same at rest, for a model that has to be guarded.
    resting: Block,
    /// Torque without inertia, N m, and inertia, kg m^2.
    asked: [[f64; Block::SAMPLES]; 2],
    /// The way in which the knob can slide through a sample: 1, -1, or 0 for none.
    ways: [f64; Block::SAMPLES],
}

const ZEROS: [f64; Block::SAMPLES] = [0.0; Block::SAMPLES];
const HALVES: [f64; Block::SAMPLES] = [0.5; Block::SAMPLES];

impl Ahead {
    fn new() -> Self {
        let (moving, resting) = (Block::default(), Block::default());
        Self { motion: [ZEROS; 3], moving, resting, asked: [ZEROS; 2], ways: ZEROS }
    }

    /// How many of the samples from `at` on, up to `end`, the knob can slide that way through: whole packs.
    #[inline(always)]
    fn slides(&self, at: usize, end: usize, way: f64) -> usize {
        let differ = |other: u64, one: &f64| other | (one.to_bits() ^ way.to_bits());
        let packs = self.ways.as_chunks::<WIDE>().0[at / WIDE..end / WIDE].iter();
        packs.take_while(|pack| pack.iter().fold(0, differ) == 0).count() * WIDE
    }
}

impl Renderer {
    /// The torque along a motion, N m, as single steps would give it, to the last bit; a hand torque that is
    /// NaN is one that is not known. Rows beyond the shortest column are left as they are.
    pub fn render(&mut self, motion: [&[f64]; 3], hand: Option<&[f64]>, out: &mut [f64]) {
        let rows = motion.into_iter().chain(hand).map(<[f64]>::len).fold(out.len(), usize::min);
        let columns = Columns { motion: motion.map(|column| &column[..rows]), hand };
        let out = &mut out[..rows];
        // Who remembers has to take every step, and so has friction under the torque of an inertia whose acceleration is
        // filtered.
        let remembers = self.hidden.is_some() || self.own || !self.state.memory.is_empty();
        let filtered = self.tuning.freshness != 1.0 && !self.model.is_plain();
        let single = remembers || filtered || self.forced || self.tuning.rush_s != 0.0;
        // The others look at the sample before theirs.
        let first = if single { rows } else { rows.min(1) };
        for i in 0..first {
            out[i] = self.step(columns.sensed(i));
        }
        if first < rows {
            isa::dispatch_wide(Rendering { renderer: self, columns, first, out });
        }
    }

    /// Whether single steps would only add up what a pack of samples asks for: nothing is filtered or rounded.
    fn is_plain(&self) -> bool {
        let tuning = &self.tuning;
        tuning.freshness == 1.0 && tuning.count == 0.0 && self.limits.torque_rate == f64::INFINITY
    }

    /// The direction in which the knob slides on, 1 or -1; 0 where that has to be looked into.
    fn way(&self) -> f64 {
        let state = &self.state;
        if state.samples == 0 || state.fault.is_some() {
            return 0.0;
        }
        state.contact.slides(0.0, state.contact.strain)
    }

    /// Looks at the samples from `at` on.
    #[inline(always)]
    fn look_ahead(&self, columns: &Columns<'_>, at: usize, count: usize, ahead: &mut Ahead) {
        let [theta, omega, _] = columns.motion.map(|column| &column[at..at + count]);
        let [clock, there, forward] = &mut ahead.motion;
        for i in 0..count {
            clock[i] = self.clock(self.state.samples + i as u64);
            there[i] = theta[i] + omega[i] * self.tuning.ahead_s;
            forward[i] = Motion::exact(0.0, 0.0, omega[i], 0.0).forward;
        }
        let [clock, there, forward] = &ahead.motion;
        let (clock, there, zeros) = (&clock[..count], &there[..count], &ZEROS[..count]);
        ahead.moving.fill(&self.model, &self.p, [clock, there, omega, zeros, &forward[..count]]);
        if self.guarded {
            let rest = [clock, there, zeros, zeros, &HALVES[..count]];
            ahead.resting.fill(&self.model, &self.p, rest);
        }
    }

    /// The torque of the block wherever the knob slides, and for each sample the way in which it can; the first `C`
    /// channels of the load differ from no load.
    #[inline(always)]
    fn slide_through<const C: usize>(
        &self,
        columns: &Columns<'_>,
        start: usize,
        ahead: &mut Ahead,
        out: &mut [f64],
    ) {
        let n = out.len();
        let [theta, omega, alpha] = columns.motion.map(|column| &column[start..start + n]);
        let before = &columns.motion[0][start - 1..start - 1 + n];
        let Ahead { motion: [_, _, forward], moving, resting, asked: [asked, inertias], ways } = ahead;
        let [inertia, damping] = self.tuning.own.map(Wide::of);
        let (fastest, limit) = (Wide::of(self.limits.speed), Wide::of(self.limits.torque));
        let (most, beyond) = (fastest * Wide::of(self.dt), Wide::of(f64::INFINITY));
        let (one, zero) = (Wide::of(1.0), Wide::of(0.0));
        for at in (0..n).step_by(WIDE) {
            let load = moving.load::<C>(at);
            let (omega, alpha) = (Wide::load(omega, at), Wide::load(alpha, at));
            let known = Known::any;
            let motion = Motion {
                t: Known::ZERO,
                theta: Known::ZERO,
                omega: known(omega),
                alpha: known(alpha),
                forward: known(Wide::of_packs(forward, at)),
            };
            let drive =
                if self.guarded { braked(&load, &motion, resting.load::<C>(at).drive) } else { load.drive };
            let torque = (drive + load.friction(motion.forward, motion.alpha)).x;
            torque.into_packs(asked, at);
            load.inertia.x.into_packs(inertias, at);
            let tau = torque + (load.inertia.x + inertia) * alpha + damping * omega;
            tau.max(-limit).min(limit).store(out, at);
            let by = Wide::load(theta, at) - Wide::load(before, at);
            // What is not a number is below nothing, and fails.
            let within = |x: Wide, most: Wide, way: Wide| most.where_above(x.abs(), way, zero);
            let forth = omega.where_positive((-by).where_positive(zero, one), zero);
            let way = (-omega).where_positive(by.where_positive(zero, -one), forth);
            let way = within(by, most, within(omega, fastest, way));
            within(alpha, beyond, within(tau, beyond, way)).into_packs(ways, at);
        }
        if let Some(hand) = columns.hand {
            // A hand that is NaN is not known.
            for (way, hand) in ways.iter_mut().zip(&hand[start..start + n]) {
                *way = if hand.is_infinite() { 0.0 } else { *way };
            }
        }
    }

    /// Remembers what sliding through `count` samples up to `end` leaves behind.
    fn remember(&mut self, columns: &Columns<'_>, out: &[f64], count: usize, end: usize) {
        let Some(last) = end.checked_sub(1).filter(|_| count > 0) else { return };
        let [theta, omega, alpha] = columns.motion;
        let state = &mut self.state;
        state.samples += count as u64;
        (state.before, state.between) = ([theta[last], omega[last]], theta[last]);
        (state.alpha, state.tau) = (alpha[last], out[last]);
    }
}

/// A rendering as a value, so that its body is compiled for the machine's instruction set.
struct Rendering<'a> {
    renderer: &'a mut Renderer,
    columns: Columns<'a>,
    first: usize,
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Rendering<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { renderer, columns, first, out } = self;
        let plain = renderer.is_plain();
        let few = renderer.model.is_plain();
        let mut way = renderer.way();
        let mut ahead = Ahead::new();
        let mut start = first;
        while start < out.len() {
            let end = (start + Block::SAMPLES).min(out.len());
            renderer.look_ahead(&columns, start, end - start, &mut ahead);
            let block = &mut out[start..end];
            if few {
                renderer.slide_through::<{ Block::CHANNELS[0] }>(&columns, start, &mut ahead, block);
            } else {
                renderer.slide_through::<{ Block::CHANNELS[1] }>(&columns, start, &mut ahead, block);
            }
            let mut at = start;
            while at < end {
                let slid = if plain && way != 0.0 { ahead.slides(at - start, end - start, way) } else { 0 };
                at += slid;
                renderer.remember(&columns, out, slid, at);
                for i in at..(at + WIDE).min(end) {
                    let [torque, inertia] = [0, 1].map(|j: usize| ahead.asked[j][i - start]);
                    out[i] = renderer.advance(columns.sensed(i), Some(Sliding { torque, inertia }));
                }
                at += WIDE;
                way = renderer.way();
            }
            start = end;
        }
    }
}
