//! Loads over a block of samples, for a step that renders many at once.

use crate::effects::law::{BLOCK, CHANNELS, Channels, Motions, PLAIN, SCALE, Totals, load_of};
use crate::model::Model;
use crate::motion::Load;
use crate::scalar::{Known, Scalar, Wide, lane_by_lane};

/// Loads on the moving knob over a block of samples, of effects that remember nothing: effect by effect, so that
/// each is compiled for whole vectors, and in the order of single samples, so that the sums are the same.
// Vectors of eight that lie across two lines of the cache take twice as long.
#[repr(align(64))]
pub struct Block(Channels, Motions);

impl Default for Block {
    fn default() -> Self {
        Self([[0.0; BLOCK]; CHANNELS], [[0.0; BLOCK]; 5])
    }
}

impl Block {
    /// Samples that it holds.
    pub const SAMPLES: usize = BLOCK;

    /// Brings the loads of a model together over a motion (t, theta, omega, alpha, forward) of at most
    /// [`Block::SAMPLES`].
    pub fn fill(&mut self, model: &Model, p: &[f64], motion: [&[f64]; 5]) {
        let mut totals = Totals::new(motion, 0..motion[0].len(), model.is_plain(), &mut self.0, &mut self.1);
        for (id, p) in model.chain(p) {
            id.law().total(p, &mut [], &mut totals);
        }
    }

    /// Channels that a plain model fills, and those that any does: what [`Block::load`] looks at.
    pub const CHANNELS: [usize; 2] = [PLAIN, CHANNELS];

    /// The load on the samples from `at` on, side by side, of which the first `C` channels differ from no load.
    #[inline(always)]
    pub fn load<const C: usize>(&self, at: usize) -> Load<Known<Wide>> {
        let mut channels = [Known::ZERO; CHANNELS];
        channels[SCALE] = Known::of(1.0);
        lane_by_lane!(C, channel => {
            if let (Some(load), Some(column)) = (channels.get_mut(channel), self.0.get(channel)) {
                *load = Known::any(Wide::of_packs(column, at));
            }
        });
        load_of(channels)
    }
}
