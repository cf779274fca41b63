//! Loads over a block of samples, for a step that renders many at once.

use crate::effects::law::{BLOCK, CHANNELS, Channels, Motions, Totals, load_of};
use crate::model::Model;
use crate::motion::Load;
use crate::scalar::{Pack, Scalar, lane_by_lane};

/// Loads on the moving knob over a block of samples, of effects that remember nothing: effect by effect, so that
/// each is compiled for whole vectors, and in the order of single samples, so that the sums are the same.
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

    /// The load on the pack of samples that begins at `at`.
    #[inline(always)]
    pub fn load(&self, at: usize) -> Load<Pack> {
        let mut channels = [Pack::of(0.0); CHANNELS];
        lane_by_lane!(CHANNELS, channel => {
            if let (Some(load), Some(column)) = (channels.get_mut(channel), self.0.get(channel)) {
                *load = Pack::of_packs(column, at);
            }
        });
        load_of(channels)
    }
}
