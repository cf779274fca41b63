//! Pieces to lanes and back: sample `i` of all pieces in one register.

use std::ops::Range;

use super::pieces::Piece;
use super::registers::Registers;

/// Samples of each lane that are transposed at a time.
pub(super) const STEP: usize = 4;

/// Such steps that are brought back at a time.
const RUN: usize = 32;

/// Lanes of the widest registers.
const MOST_LANES: usize = 8;

/// The pieces of a batch into a block. Lanes without a piece repeat the first.
///
/// Which lane a piece gets is up to the registers' own order; [`scatter`] turns it back.
#[inline(always)]
pub(super) fn gather<R: Registers, C: AsRef<[f64]>>(
    registers: R,
    channels: &[C],
    pieces: &[Piece],
    block: &mut [R::f64s],
) {
    let piece = |lane: usize| pieces.get(lane).unwrap_or(&pieces[0]);
    let steps = block.as_chunks_mut::<STEP>().0;
    // Where no piece is in the extension of its channel.
    let inside = common(pieces, steps.len(), |piece| 0..channels[piece.channel].as_ref().len());
    let rows: [&[[f64; STEP]]; MOST_LANES] = std::array::from_fn(|lane| {
        let Piece { channel, start, .. } = piece(lane);
        let first = (start + (inside.start * STEP).cast_signed()).cast_unsigned();
        channels[*channel].as_ref()[first..first + inside.len() * STEP].as_chunks().0
    });
    for (step, lanes) in steps[inside.clone()].iter_mut().enumerate() {
        *lanes = transposed(registers, |lane| rows[lane][step]);
    }
    for step in (0..inside.start).chain(inside.end..steps.len()) {
        steps[step] = transposed(registers, |lane| {
            let Piece { channel, start, .. } = piece(lane);
            let first = start + (step * STEP).cast_signed();
            std::array::from_fn(|offset| extended(channels[*channel].as_ref(), first + offset.cast_signed()))
        });
    }
}

/// The cores of the pieces of a batch back from a block.
#[inline(always)]
pub(super) fn scatter<R: Registers>(
    registers: R,
    block: &[R::f64s],
    channels: &mut [&mut [f64]],
    pieces: &[Piece],
) {
    let steps = block.as_chunks::<STEP>().0;
    let inside = common(pieces, steps.len(), |piece| piece.core.clone());
    let mut windows = windows(channels, pieces, inside.clone());
    // Channel by channel, a run at a time: eight streams that are written to in turn take longer.
    let mut rows = [[[0.0; STEP]; MOST_LANES]; RUN];
    for (run, steps) in steps[inside.clone()].chunks(RUN).enumerate() {
        for (rows, lanes) in rows.iter_mut().zip(steps) {
            let mut turned = registers.interleave_shfl_f64s(*lanes);
            rows.iter_mut().zip(quarters::<R>(&mut turned)).for_each(|(row, turned)| *row = *turned);
        }
        for (lane, window) in windows.iter_mut().enumerate().take(R::F64_LANES) {
            let own = window.iter_mut().skip(run * RUN).zip(&rows[..steps.len()]);
            own.for_each(|(own, rows)| *own = rows[place::<R>(lane)]);
        }
    }
    for step in (0..inside.start).chain(inside.end..steps.len()) {
        let mut rows = registers.interleave_shfl_f64s(steps[step]);
        let rows = quarters::<R>(&mut rows);
        for (lane, Piece { channel, core, start }) in pieces.iter().enumerate() {
            let first = start + (step * STEP).cast_signed();
            let begin = first.max(core.start.cast_signed());
            let end = (first + STEP.cast_signed()).min(core.end.cast_signed());
            for index in begin..end {
                let sample = rows[place::<R>(lane)][(index - first).cast_unsigned()];
                channels[*channel][index.cast_unsigned()] = sample;
            }
        }
    }
}

/// What the pieces of a batch cover in the steps `inside` of their cores.
fn windows<'a>(
    channels: &'a mut [&mut [f64]],
    pieces: &[Piece],
    inside: Range<usize>,
) -> [&'a mut [[f64; STEP]]; MOST_LANES] {
    let mut windows: [&mut [[f64; STEP]]; MOST_LANES] = Default::default();
    let mut lanes = pieces.iter().zip(&mut windows).peekable();
    for (index, channel) in channels.iter_mut().enumerate() {
        let (mut rest, mut taken) = (&mut channel[..], 0);
        while let Some((piece, window)) = lanes.next_if(|(piece, _)| piece.channel == index) {
            let first = (piece.start + (inside.start * STEP).cast_signed()).cast_unsigned();
            let (covered, after) = rest[first - taken..].split_at_mut(inside.len() * STEP);
            *window = covered.as_chunks_mut().0;
            (rest, taken) = (after, first + inside.len() * STEP);
        }
    }
    windows
}

/// The steps in which every piece of a batch lies within its `range`.
#[inline(always)]
fn common(pieces: &[Piece], steps: usize, range: impl Fn(&Piece) -> Range<usize>) -> Range<usize> {
    let from_start = |piece: &Piece, index: usize| (index.cast_signed() - piece.start).max(0).cast_unsigned();
    let first = |piece: &Piece| from_start(piece, range(piece).start).div_ceil(STEP);
    let after = |piece: &Piece| from_start(piece, range(piece).end) / STEP;
    let end = pieces.iter().map(after).min().unwrap_or(0).min(steps);
    pieces.iter().map(first).max().unwrap_or(0).min(end)..end
}

/// Four samples of each lane, transposed.
#[inline(always)]
fn transposed<R: Registers>(registers: R, row: impl Fn(usize) -> [f64; STEP]) -> [R::f64s; STEP] {
    let mut rows = [registers.splat_f64s(0.0); STEP];
    let quarters = quarters::<R>(&mut rows);
    for lane in 0..R::F64_LANES {
        quarters[place::<R>(lane)] = row(lane);
    }
    registers.deinterleave_shfl_f64s(rows)
}

/// Registers as rows of four samples.
#[inline(always)]
fn quarters<R: Registers>(rows: &mut [R::f64s; STEP]) -> &mut [[f64; STEP]] {
    pulp::bytemuck::cast_slice_mut(rows)
}

/// Where the row of a lane lies: first the first row of each register, then the second.
#[inline(always)]
fn place<R: Registers>(lane: usize) -> usize {
    let rows = R::F64_LANES / STEP;
    lane % STEP * rows + lane / STEP
}

/// A sample of a channel or of its odd extension: each end continued by its own half turn about
/// the end point, which keeps value and slope. Zero beyond the extension.
fn extended(channel: &[f64], index: isize) -> f64 {
    let end = index.clamp(0, channel.len().cast_signed() - 1);
    let at = |index: isize| channel.get(index.cast_unsigned()).copied().unwrap_or(0.0);
    if index == end { at(index) } else { 2.0 * at(end) - at(2 * end - index) }
}
