//! Forward and backward in time: no phase lag, the squared gain.

use super::cascade::Cascade;
use super::interleave::{STEP, gather, scatter};
use super::pieces::{Piece, Pieces};
use super::registers::{Registers, Work, with_best_registers};
use super::sos::Sos;
use crate::error::{Error, Result};

/// A forward-backward filter, equal to SciPy's `sosfiltfilt` with its default padding
/// (F. Gustafsson, *Determining the initial states in forward-backward filtering*, 1996, discusses
/// the choices at the ends; this is the odd extension from the steady state).
///
/// Channels and stretches of long channels are filtered side by side, one in each lane of a
/// register. A stretch begins and ends so far outside of what is kept of it ([`Sos::settle`]) that
/// nothing is left of the cut. A sample that is not finite spoils its own channel only.
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

    /// The same filter with its ends extended by another number of samples than SciPy's default. Without any, as
    /// for a block that brings its own halo, each end starts from the steady state of its edge value; a halo of
    /// [`Sos::settle`] samples leaves nothing of that choice.
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

    /// Filters channels of one length.
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

    /// All channels with the best instructions of this machine.
    fn run(&self, source: Option<&[&[f64]]>, target: &mut [&mut [f64]], padding: usize) {
        if target.first().is_some_and(|channel| !channel.is_empty()) {
            with_best_registers(Pass { sos: &self.sos, source, target, padding });
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

/// Channels of one length, not empty and longer than the padding.
struct Pass<'a, 'c> {
    sos: &'a Sos,
    /// The samples to filter; without it those of the target.
    source: Option<&'a [&'a [f64]]>,
    target: &'a mut [&'c mut [f64]],
    padding: usize,
}

impl Work for Pass<'_, '_> {
    /// Pieces of the channels side by side, as many as a register has lanes.
    #[inline(always)]
    fn run<R: Registers>(self, registers: R) {
        let (channels, samples) = (self.target.len(), self.target[0].len());
        let pieces = Pieces::new(channels, samples, self.padding, self.sos.settle(), R::F64_LANES);
        let mut cascade = Cascade::new(registers, self.sos);
        let (mut block, mut next) = (Vec::new(), Vec::new());

        let mut batches = pieces.list.chunks(R::F64_LANES).peekable();
        if let Some(first) = batches.peek() {
            self.gather(registers, first, pieces.length, &mut block);
        }
        while let Some(batch) = batches.next() {
            let samples = &mut block[..pieces.length];
            cascade.settle_at(samples[0]);
            cascade.forward(samples);
            cascade.settle_at(samples[pieces.length - 1]);
            cascade.backward(samples);
            // In place: what the next batch shares with this one, it must see unfiltered.
            if let Some(following) = batches.peek() {
                self.gather(registers, following, pieces.length, &mut next);
            }
            scatter(registers, &block, self.target, batch);
            std::mem::swap(&mut block, &mut next);
        }
        spread_what_is_not_finite(&pieces, self.target);
    }
}

impl Pass<'_, '_> {
    /// A batch of pieces of `length` samples before filtering.
    #[inline(always)]
    fn gather<R: Registers>(&self, registers: R, batch: &[Piece], length: usize, block: &mut Vec<R::f64s>) {
        block.resize(length.next_multiple_of(STEP), registers.splat_f64s(0.0));
        match self.source {
            Some(source) => gather(registers, source, batch, block),
            None => gather(registers, self.target, batch, block),
        }
    }
}

/// A recursion never forgets a sample that is not finite, so forward and backward it spoils its
/// whole channel. Within a piece it reaches the first sample of the core; here, the other pieces.
fn spread_what_is_not_finite(pieces: &Pieces, target: &mut [&mut [f64]]) {
    for pieces in pieces.list.chunk_by(|a, b| a.channel == b.channel) {
        let channel = &mut *target[pieces[0].channel];
        if pieces.iter().any(|piece| !channel[piece.core.start].is_finite()) {
            channel.fill(f64::NAN);
        }
    }
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

    fn long_channels() -> Vec<Vec<f64>> {
        let sample = |channel: usize, n: usize| (0.01 * (n * n % (977 + channel)) as f64).sin();
        (0..5).map(|channel| (0..30_000).map(|n| sample(channel, n)).collect()).collect()
    }

    fn borrowed(channels: &mut [Vec<f64>]) -> Vec<&mut [f64]> {
        channels.iter_mut().map(Vec::as_mut_slice).collect()
    }

    #[test]
    fn nothing_is_left_of_the_cuts_between_pieces() {
        for order in 1..=6 {
            let filter = ZeroPhase::new(butter(order, 700.0, 5000.0).unwrap());
            let mut pieces = long_channels();
            let source = pieces.clone();
            filter.filter_channels(&mut borrowed(&mut pieces)).unwrap();
            let mut elsewhere = vec![vec![0.0; 30_000]; 5];
            let source: Vec<&[f64]> = source.iter().map(Vec::as_slice).collect();
            filter.filter_into(&source, &mut borrowed(&mut elsewhere)).unwrap();
            assert_eq!(pieces, elsewhere);
            for (channel, source) in pieces.iter().zip(source) {
                // Blocks with a wide halo, cut where the pieces are not.
                let halo = 2 * filter.sos.settle();
                for start in (halo..30_000 - 1001 - halo).step_by(1001) {
                    let mut block = source[start - halo..start + 1001 + halo].to_vec();
                    filter.clone().padded_by(0).filter_in_place(&mut block).unwrap();
                    for (a, b) in channel[start..].iter().zip(&block[halo..halo + 1001]) {
                        assert!((a - b).abs() < 1e-13, "order {order}, from {start}: {a} and {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_sample_that_is_not_finite_spoils_all_of_its_long_channel_and_no_other() {
        let filter = ZeroPhase::new(butter(3, 700.0, 5000.0).unwrap());
        let mut clean = long_channels();
        filter.filter_channels(&mut borrowed(&mut clean)).unwrap();
        for (at, bad) in [(0, f64::NAN), (15_000, f64::INFINITY), (29_999, f64::NEG_INFINITY)] {
            let mut spoilt = long_channels();
            spoilt[1][at] = bad;
            filter.filter_channels(&mut borrowed(&mut spoilt)).unwrap();
            assert!(spoilt[1].iter().all(|y| y.is_nan()));
            for other in [0, 2, 3, 4] {
                assert_eq!(spoilt[other], clean[other]);
            }
        }
    }
}
