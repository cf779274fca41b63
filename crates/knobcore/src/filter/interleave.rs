//! Channels to lanes and back: sample `i` of channel `c` is number `4 i + c` of a block.

use std::ops::Range;

/// Channels that one pass filters: the lanes of one AVX2 register.
pub(super) const LANES: usize = 4;

/// Samples of a block: 8 KiB, so that interleaving, filtering and writing back stay in the cache.
pub(super) const BLOCK: usize = 256;

/// The samples `range` of up to four channels into a block. Lanes without a channel keep what they
/// have; lanes do not mix.
#[inline(always)]
pub(super) fn gather<C: AsRef<[f64]>>(channels: &[C], range: Range<usize>, block: &mut [f64]) {
    if let [a, b, c, d] = channels {
        let [a, b, c, d] = [a, b, c, d].map(|channel| &channel.as_ref()[range.clone()]);
        let samples = a.iter().zip(b).zip(c).zip(d);
        for (lanes, (((a, b), c), d)) in block.as_chunks_mut::<LANES>().0.iter_mut().zip(samples) {
            *lanes = [*a, *b, *c, *d];
        }
    } else {
        for (lane, channel) in channels.iter().enumerate() {
            let samples = &channel.as_ref()[range.clone()];
            for (lanes, sample) in block.as_chunks_mut::<LANES>().0.iter_mut().zip(samples) {
                lanes[lane] = *sample;
            }
        }
    }
}

/// A block back into the samples `range` of up to four channels.
#[inline(always)]
pub(super) fn scatter(block: &[f64], channels: &mut [&mut [f64]], range: Range<usize>) {
    if let [a, b, c, d] = channels {
        let [a, b, c, d] = [a, b, c, d].map(|channel| &mut channel[range.clone()]);
        let samples = a.iter_mut().zip(b).zip(c).zip(d);
        for (lanes, (((a, b), c), d)) in block.as_chunks::<LANES>().0.iter().zip(samples) {
            [*a, *b, *c, *d] = *lanes;
        }
    } else {
        for (lane, channel) in channels.iter_mut().enumerate() {
            let samples = &mut channel[range.clone()];
            for (lanes, sample) in block.as_chunks::<LANES>().0.iter().zip(samples) {
                *sample = lanes[lane];
            }
        }
    }
}
