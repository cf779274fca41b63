//! What an effect of a fitted model is worth at least, without a fit that lacks it.

use super::Fit;
use super::moments::Moments;
use super::solve::Normal;
use crate::param::Kind;

impl Fit {
    /// What it would cost at least, in variances of the raw noise, to do without an effect, to first order: the most
    /// that holding one of the parameters in proportion to which its torque is at zero takes while all others follow.
    /// Nothing where it has none.
    pub fn worth(&self, effect: &str) -> f64 {
        let at = Moments::of_all(self.blocks.first().map_or(0, |block| block.k), &self.blocks);
        let Some(normal) = Normal::of(|i, j| at.gram(i, j), &self.kept) else { return 0.0 };
        let (bread, values, slots) = (normal.inverse(), self.model.values(), self.model.slots());
        let white = self.noise_floor.powi(2) * self.used / self.white_squares;
        let own = |i: &usize| {
            let slot = &slots[self.free[*i]];
            // A phase is no size, and what bends the rest of the model makes no torque of its own.
            slot.effect.info().id == effect && slot.param.kind == Kind::Linear
        };
        let takes = |i: usize| values[self.free[i]].powi(2) / bread[(i, i)] / white;
        (0..self.free.len()).filter(own).map(takes).filter(|x| x.is_finite()).fold(0.0, f64::max)
    }
}
