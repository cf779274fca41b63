//! Forward and backward in time: no phase lag, the squared gain.

use std::ops::Range;

use super::cascade::Cascade;
use super::interleave::{BLOCK, LANES, gather, scatter};
use super::registers::{Registers, Work, with_best_registers};
use super::sos::Sos;
use crate::error::{Error, Result};

/// A forward-backward filter, equal to SciPy's `sosfiltfilt` with its default padding
/// (F. Gustafsson, *Determining the initial states in forward-backward filtering*, 1996, discusses
/// the choices at the ends; this is the odd extension from the steady state).
///
/// Four channels at a time share one pass, and no memory beyond the channels is needed. A sample
/// that is not finite spoils its own channel only.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroPhase {
    sos: Sos,
    padding: usize,
}

impl ZeroPhase {
    /// The forward-backward filter of a chain.
    pub fn new(sos: Sos) -> Self {
        let sections = sos.sections();
        let flat_b = sections.iter().filter(|section| section.b[2] == 0.0).count();
        let flat_a = sections.iter().filter(|section| section.a[1] == 0.0).count();
        let padding = 3 * (2 * sections.len() + 1 - flat_b.min(flat_a));
        Self { sos, padding }
    }

    /// The same filter with its ends extended by another number of samples than SciPy's default.
    pub fn padded_by(self, samples: usize) -> Self {
        Self { padding: samples, ..self }
    }

    /// The chain of one pass.
    pub fn sos(&self) -> &Sos {
        &self.sos
    }

    /// Samples by which each end is extended.
    pub fn padding(&self) -> usize {
        self.padding
    }

    /// Filters one channel.
    ///
    /// # Errors
    /// The channel is not longer than the padding.
    pub fn filter_in_place(&self, channel: &mut [f64]) -> Result<()> {
        self.filter_channels(&mut [channel])
    }

    /// Filters channels of one length, four in a pass.
    ///
    /// # Errors
    /// The channels differ in length or are not longer than the padding.
    pub fn filter_channels(&self, channels: &mut [&mut [f64]]) -> Result<()> {
        self.check_lengths(channels.iter().map(|channel| channel.len()))?;
        self.run(None, channels, self.padding);
        Ok(())
    }

    /// Filters `source` into `target`, without copying the channels first.
    ///
    /// # Errors
    /// Source and target differ in number or length, or are not longer than the padding.
    pub fn filter_into(&self, source: &[&[f64]], target: &mut [&mut [f64]]) -> Result<()> {
        if source.len() != target.len() {
            return Err(Error::invalid(
                "channels",
                format!("{} sources need as many targets, not {}", source.len(), target.len()),
            ));
        }
        let targets = target.iter().map(|channel| channel.len());
        self.check_lengths(source.iter().map(|channel| channel.len()).chain(targets))?;
        self.run(Some(source), target, self.padding);
        Ok(())
    }

    /// Filters blocks that bring their own halo: no padding, each end starts from the steady state
    /// of its edge value. A halo of [`Sos::settle`] samples leaves nothing of that choice.
    ///
    /// # Errors
    /// The channels differ in length.
    pub fn filter_block(&self, channels: &mut [&mut [f64]]) -> Result<()> {
        equal_lengths(channels.iter().map(|channel| channel.len()))?;
        self.run(None, channels, 0);
        Ok(())
    }

    fn check_lengths(&self, lengths: impl Iterator<Item = usize>) -> Result<()> {
        match equal_lengths(lengths)? {
            Some(length) if length <= self.padding => Err(Error::invalid(
                "channels",
                format!(
                    "{length} samples are too few for this filter, which needs at least {}; \
                     record longer or lower the order",
                    self.padding + 1
                ),
            )),
            _ => Ok(()),
        }
    }

    /// Channels by fours, each four with the best instructions of this machine.
    fn run(&self, source: Option<&[&[f64]]>, target: &mut [&mut [f64]], padding: usize) {
        for (four, channels) in target.chunks_mut(LANES).enumerate() {
            let source = source.map(|s| &s[four * LANES..four * LANES + channels.len()]);
            if channels[0].is_empty() {
                continue;
            }
            with_best_registers(Pass { sos: &self.sos, source, target: channels, padding });
        }
    }
}

/// The one length of all channels; none without channels.
fn equal_lengths(mut lengths: impl Iterator<Item = usize>) -> Result<Option<usize>> {
    let Some(first) = lengths.next() else { return Ok(None) };
    match lengths.enumerate().find(|&(_, length)| length != first) {
        None => Ok(Some(first)),
        Some((index, length)) => Err(Error::invalid(
            "channels",
            format!("channel {} has {length} samples, the first has {first}; all need one length", index + 2),
        )),
    }
}

/// Up to four channels of one length, not empty and longer than the padding.
struct Pass<'a, 'c> {
    sos: &'a Sos,
    /// The samples to filter; without it those of the target.
    source: Option<&'a [&'a [f64]]>,
    target: &'a mut [&'c mut [f64]],
    padding: usize,
}

impl Work for Pass<'_, '_> {
    #[inline(always)]
    fn run<R: Registers>(self, registers: R) {
        let length = self.target[0].len();
        let mut block = [0.0; LANES * BLOCK];
        let [mut head, mut tail] = self.extensions();
        let mut cascade = Cascade::new(self.sos);

        cascade.settle_at(head.first().copied().unwrap_or_else(|| self.input(0)));
        cascade.forward(registers, head.as_flattened_mut());
        for range in blocks(length) {
            let samples = &mut block[..LANES * range.len()];
            match self.source {
                Some(source) => gather(source, range.clone(), samples),
                None => gather(self.target, range.clone(), samples),
            }
            cascade.forward(registers, samples);
            scatter(samples, self.target, range);
        }
        cascade.forward(registers, tail.as_flattened_mut());

        cascade.settle_at(tail.last().copied().unwrap_or_else(|| lanes(self.target, length - 1)));
        cascade.backward(registers, tail.as_flattened_mut());
        for range in blocks(length).rev() {
            let samples = &mut block[..LANES * range.len()];
            gather(self.target, range.clone(), samples);
            cascade.backward(registers, samples);
            scatter(samples, self.target, range);
        }
    }
}

impl Pass<'_, '_> {
    /// Sample `index` of each channel before filtering.
    fn input(&self, index: usize) -> [f64; LANES] {
        match self.source {
            Some(source) => lanes(source, index),
            None => lanes(self.target, index),
        }
    }

    /// The odd extension before the first and after the last sample: each end continued by its own
    /// half turn about the end point, which keeps value and slope.
    fn extensions(&self) -> [Vec<[f64; LANES]>; 2] {
        let turned = |end: usize, index: usize| {
            let (pivot, sample) = (self.input(end), self.input(index));
            std::array::from_fn(|lane| 2.0 * pivot[lane] - sample[lane])
        };
        let last = self.target[0].len() - 1;
        [
            (1..=self.padding).rev().map(|distance| turned(0, distance)).collect(),
            (1..=self.padding).map(|distance| turned(last, last - distance)).collect(),
        ]
    }
}

/// Sample `index` of up to four channels; zero in lanes without a channel.
fn lanes<C: AsRef<[f64]>>(channels: &[C], index: usize) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    gather(channels, index..index + 1, &mut lanes);
    lanes
}

/// `0..length` in blocks.
fn blocks(length: usize) -> impl DoubleEndedIterator<Item = Range<usize>> {
    (0..length.div_ceil(BLOCK)).map(move |k| k * BLOCK..length.min((k + 1) * BLOCK))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::butter;

    #[test]
    fn plain_arrays_and_the_registers_of_this_machine_agree() {
        for order in 1..=8 {
            let filter = ZeroPhase::new(butter(order, 700.0, 5000.0).unwrap());
            let mut best: Vec<f64> = (0..1000).map(|n| (0.1 * f64::from(n)).sin()).collect();
            let mut plain = best.clone();
            filter.filter_in_place(&mut best).unwrap();
            let target = &mut [plain.as_mut_slice()];
            let pass = Pass { sos: &filter.sos, source: None, target, padding: filter.padding };
            pass.run(pulp::Scalar256b);
            for (a, b) in best.iter().zip(&plain) {
                assert!((a - b).abs() < 1e-12, "order {order}: {a} and {b}");
            }
        }
    }
}
