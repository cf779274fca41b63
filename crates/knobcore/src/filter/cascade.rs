//! The recursion itself: a chain of sections run over interleaved samples, one signal to a lane.

use super::registers::Registers;
use super::sos::{Section, Sos};

/// A section that passes its input on, to complete an odd number of sections.
const IDENTITY: Section = Section { b: [1.0, 0.0, 0.0], a: [0.0, 0.0] };

/// Samples from one look at what is left of a memory to the next. Within so many it fades by far less than what lies
/// between [`FADED`] and the least number that is not subnormal.
const FEW: usize = 128;

/// What fades away behind a step, as dry friction has them, comes to subnormal numbers and stays at them, and processors
/// take ten times as long for these. A memory below this is none.
const FADED: f64 = 1e-200;

/// Two sections and the last two values before, between and after them (newest first).
///
/// Two sections in one loop keep the adders busy: while the second works on one sample, the first
/// is at the next. Their state just fits the sixteen registers of AVX2.
struct Pair<R: Registers> {
    sections: [Section; 2],
    history: [[R::f64s; 2]; 3],
}

/// A chain of sections with its memory of one signal in each lane.
pub(super) struct Cascade<R: Registers> {
    registers: R,
    pairs: Vec<Pair<R>>,
}

impl<R: Registers> Cascade<R> {
    /// The chain, at rest at zero.
    #[inline(always)]
    pub(super) fn new(registers: R, sos: &Sos) -> Self {
        let rest = [[registers.splat_f64s(0.0); 2]; 3];
        let pairs = sos.sections().chunks(2).map(|chunk| match *chunk {
            [first, second] => Pair { sections: [first, second], history: rest },
            _ => Pair { sections: [IDENTITY, chunk[0]], history: rest },
        });
        Self { registers, pairs: pairs.collect() }
    }

    /// As if the input had been `value` forever.
    #[inline(always)]
    pub(super) fn settle_at(&mut self, mut value: R::f64s) {
        for pair in &mut self.pairs {
            pair.history[0] = [value; 2];
            for (section, after) in pair.sections.iter().zip(&mut pair.history[1..]) {
                value = self.registers.mul_f64s(value, self.registers.splat_f64s(section.dc_gain()));
                *after = [value; 2];
            }
        }
    }

    /// Filters interleaved samples in place, from the first to the last.
    #[inline(always)]
    pub(super) fn forward(&mut self, block: &mut [R::f64s]) {
        for pair in &mut self.pairs {
            for few in block.chunks_mut(FEW) {
                pair.filter(self.registers, few.iter_mut());
            }
        }
    }

    /// Filters interleaved samples in place, from the last to the first.
    #[inline(always)]
    pub(super) fn backward(&mut self, block: &mut [R::f64s]) {
        for pair in &mut self.pairs {
            for few in block.rchunks_mut(FEW) {
                pair.filter(self.registers, few.iter_mut().rev());
            }
        }
    }
}

impl<R: Registers> Pair<R> {
    /// Designs of odd order have a section of order one, and it comes first: two products less.
    #[inline(always)]
    fn filter<'a>(&mut self, registers: R, samples: impl Iterator<Item = &'a mut R::f64s>)
    where
        R::f64s: 'a,
    {
        match self.sections[0] {
            Section { b: [.., 0.0], a: [.., 0.0] } => self.run::<1>(registers, samples),
            _ => self.run::<2>(registers, samples),
        }
    }

    /// Direct form I. Of the five products of a section only `a1 y[n-1]` waits for the sample
    /// before, so it comes last: one multiply-add of latency per sample.
    #[inline(always)]
    fn run<'a, const FIRST: usize>(&mut self, registers: R, samples: impl Iterator<Item = &'a mut R::f64s>)
    where
        R::f64s: 'a,
    {
        let [mut x, mut u, mut y] = self.history;
        let first = Coefficients::new(registers, self.sections[0]);
        let second = Coefficients::new(registers, self.sections[1]);
        for sample in samples {
            let x0 = *sample;
            let u0 = first.step::<FIRST>(registers, x0, x, u);
            let y0 = second.step::<2>(registers, u0, u, y);
            x = [x0, x[0]];
            u = [u0, u[0]];
            y = [y0, y[0]];
            *sample = y0;
        }
        self.history = [x, u, y];
        // Loops: the bodies of closures are not sure to be compiled with the instruction set, and were not.
        for value in self.history.as_flattened_mut() {
            let small = registers.less_than_f64s(registers.abs_f64s(*value), registers.splat_f64s(FADED));
            *value = registers.select_f64s(small, registers.splat_f64s(0.0), *value);
        }
    }
}

/// The coefficients of a section, each in all lanes; the denominator with its sign turned.
struct Coefficients<R: Registers> {
    b: [R::f64s; 3],
    minus_a: [R::f64s; 2],
}

impl<R: Registers> Coefficients<R> {
    #[inline(always)]
    fn new(registers: R, section: Section) -> Self {
        let Section { b: [b0, b1, b2], a: [a1, a2] } = section;
        let all = |c| registers.splat_f64s(c);
        Self { b: [all(b0), all(b1), all(b2)], minus_a: [all(-a1), all(-a2)] }
    }

    /// The next output of a section of order `ORDER` from the input `x0` and the last two inputs and outputs.
    #[inline(always)]
    fn step<const ORDER: usize>(
        &self,
        registers: R,
        x0: R::f64s,
        x: [R::f64s; 2],
        y: [R::f64s; 2],
    ) -> R::f64s {
        let sum = registers.mul_f64s(self.b[0], x0);
        let mut sum = registers.multiply_add(self.b[1], x[0], sum);
        if ORDER == 2 {
            sum = registers.multiply_add(self.b[2], x[1], sum);
            sum = registers.multiply_add(self.minus_a[1], y[1], sum);
        }
        registers.multiply_add(self.minus_a[0], y[0], sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{butter, cheby2};
    use pulp::{Scalar256b, f64x4};

    #[test]
    fn a_memory_that_fades_away_ends_at_nothing_and_meets_no_subnormal_number() {
        for sos in [cheby2(3, 20.0, 500.0, 5000.0), butter(6, 900.0, 5000.0), butter(1, 1200.0, 5000.0)] {
            let mut cascade = Cascade::new(Scalar256b, &sos.unwrap());
            let all = |value| f64x4(value, value, value, value);
            cascade.settle_at(all(0.02));
            let mut subnormal = 0;
            for _ in 0..200 {
                cascade.forward(&mut [all(0.0); FEW]);
                let memory = cascade.pairs.iter().flat_map(|pair| pair.history.as_flattened());
                subnormal += memory.filter(|value| value.0.is_subnormal()).count();
            }
            assert_eq!(subnormal, 0);
            assert!(cascade.pairs.iter().all(|pair| pair.history == [[all(0.0); 2]; 3]));
        }
    }
}
