//! Long channels in pieces: several stretches of time to filter side by side.

use std::ops::Range;

/// Samples of a piece beyond which its block no longer stays in the cache.
const LONGEST: usize = 4096;

/// A stretch of a channel with its surroundings.
pub(super) struct Piece {
    /// Which channel.
    pub(super) channel: usize,
    /// First sample of the surroundings; before the channel's first in its extension.
    pub(super) start: isize,
    /// The samples whose filtered values count.
    pub(super) core: Range<usize>,
}

/// Channels in pieces of one length.
pub(super) struct Pieces {
    /// Samples of each piece.
    pub(super) length: usize,
    /// In the order of channel and time.
    pub(super) list: Vec<Piece>,
}

impl Pieces {
    /// `channels` of `samples`, extended by `padding` at both ends, in pieces that overlap by at
    /// least twice `settle`; in as many as take the fewest steps with `lanes` at a time.
    pub(super) fn new(channels: usize, samples: usize, padding: usize, settle: usize, lanes: usize) -> Self {
        let extended = samples + 2 * padding;
        let overlap = 2 * settle;
        let length = |count: usize| (extended + (count - 1) * overlap).div_ceil(count);
        let longest = LONGEST.max(4 * overlap);
        let fewest = extended.saturating_sub(overlap).div_ceil(longest - overlap).max(1);
        let count = (fewest..fewest + lanes)
            .take_while(|&count| count == fewest || length(count) >= 2 * overlap)
            .min_by_key(|&count| (count * channels).div_ceil(lanes) * length(count))
            .unwrap_or(fewest);

        let length = length(count);
        // Spread evenly from the start of the extension to its end.
        let start =
            |k: usize| (k * (extended - length) / (count - 1).max(1)).cast_signed() - padding.cast_signed();
        // Neighbours meet in the middle of their overlap.
        let border = |k: usize| match k {
            0 => 0,
            _ if k == count => samples,
            _ => ((start(k) + start(k - 1) + length.cast_signed()) / 2).cast_unsigned(),
        };
        let cores = move |k: usize| border(k)..border(k + 1);
        let list = (0..channels)
            .flat_map(|channel| (0..count).map(move |k| Piece { channel, start: start(k), core: cores(k) }));
        Self { length, list: list.collect() }
    }
}
