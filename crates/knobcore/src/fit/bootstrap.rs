//! Block-bootstrap refits: a distribution of the parameters that assumes nothing about the residual but
//! that blocks of it are exchangeable.
//!
//! Source: Kuensch 1989. Each refit draws blocks with replacement; since a block enters the normal equations
//! by its products alone, a refit costs a sum of small matrices and one solve, whatever the capture's length
//! (one Gauss-Newton step from the optimum, exact where the parameters are linear).

use super::moments::Moments;
use super::solve::least_squares;
use crate::random::Noise;

/// Steps away from the optimum of `draws` refits, each with a value per column; undetermined columns are 0.
pub fn refits(blocks: &[Moments], kept: &[usize], draws: usize, seed: u64) -> Vec<Vec<f64>> {
    let Some(first) = blocks.first() else { return Vec::new() };
    let mut noise = Noise::new(seed);
    (0..draws)
        .filter_map(|_| {
            let mut counts = vec![0.0; blocks.len()];
            for _ in 0..blocks.len() {
                let block = (noise.uniform() * blocks.len() as f64) as usize;
                counts[block.min(blocks.len() - 1)] += 1.0;
            }
            let mut drawn = Moments::empty(first.k);
            for (block, count) in blocks.iter().zip(counts) {
                if count > 0.0 {
                    drawn.add_scaled(block, count);
                }
            }
            least_squares(&drawn, kept)
        })
        .collect()
}

/// Root mean square error on blocks that a fit did not see: each of `folds` parts of the blocks, taken in
/// turn, is predicted by the fit to the others.
pub fn held_out(blocks: &[Moments], kept: &[usize], folds: usize) -> f64 {
    let Some(first) = blocks.first() else { return f64::NAN };
    let mut all = Moments::empty(first.k);
    blocks.iter().for_each(|block| all.add(block));
    let (mut squares, mut rows) = (0.0, 0.0);
    for fold in 0..folds.min(blocks.len()) {
        let mut seen = all.clone();
        let own: Vec<&Moments> = blocks.iter().skip(fold).step_by(folds).collect();
        own.iter().for_each(|block| seen.add_scaled(block, -1.0));
        let step = least_squares(&seen, kept).unwrap_or_else(|| vec![0.0; first.k]);
        squares += own.iter().map(|block| block.squares_after(&step).max(0.0)).sum::<f64>();
        rows += own.iter().map(|block| block.rows).sum::<f64>();
    }
    (squares / rows).sqrt()
}
