//! Block-bootstrap refits: a distribution of the parameters that assumes nothing about the residual but
//! that blocks of it are exchangeable.
//!
//! Source: Kuensch 1989. Each refit draws blocks with replacement; since a block enters the normal equations
//! by its products alone, a refit costs a sum of small matrices and one solve, whatever the capture's length
//! (one Gauss-Newton step from the optimum, exact where the parameters are linear).

use super::moments::Moments;
use super::solve::least_squares;
use crate::isa;
use crate::random::Noise;
use crate::scalar::{LANES, Pack, Scalar};

/// Steps away from the optimum of `draws` refits, each with a value per kept column; a draw whose equations
/// have no solution is left out.
pub fn refits(blocks: &[Moments], kept: &[usize], draws: usize, seed: u64) -> Vec<Vec<f64>> {
    let Some(first) = blocks.first().filter(|_| !kept.is_empty()) else { return Vec::new() };
    let scale: Vec<f64> =
        kept.iter().map(|&i| blocks.iter().map(|b| b.gram(i, i)).sum::<f64>().sqrt().recip()).collect();
    // The lower triangle of the normal equations, the right-hand side as its last row; the residual's own
    // column is not needed.
    let mut order = kept.to_vec();
    order.push(first.k);
    let scaled = |i: usize| scale.get(i).copied().unwrap_or(1.0);
    let row = |i: usize| (0..=i.min(kept.len() - 1)).map(move |j| (i, j));
    let pack = |block: &Moments| {
        let entries = (0..order.len()).flat_map(row);
        let products: Vec<f64> =
            entries.map(|(i, j)| block.gram(order[i], order[j]) * scaled(i) * scaled(j)).collect();
        let mut packs: Vec<Pack> = products.chunks(LANES).map(|few| Pack::load(few, 0)).collect();
        packs.resize(packs.len().next_multiple_of(2), Pack::of(0.0));
        packs
    };
    let packed: Vec<Vec<Pack>> = blocks.iter().map(pack).collect();
    let mut noise = Noise::new(seed);
    let mut steps = Vec::with_capacity(draws);
    while steps.len() < draws {
        let counts: [Vec<f64>; AT_ONCE] = std::array::from_fn(|_| counts(&mut noise, blocks.len()));
        let drawn = isa::dispatch(Drawn { packed: &packed, counts: &counts });
        for mut equations in drawn {
            let step = solve(&mut equations, kept.len()).unwrap_or_else(|| vec![f64::NAN; kept.len()]);
            steps.push(step.iter().zip(&scale).map(|(x, scale)| x * scale).collect::<Vec<f64>>());
        }
    }
    steps.truncate(draws);
    steps.retain(|step| step.iter().all(|x| x.is_finite()));
    steps
}

/// Draws that are summed in one pass over the blocks, which are more than the first cache holds.
const AT_ONCE: usize = 4;

/// The equations of the blocks that were drawn, summed, for each draw.
struct Drawn<'a> {
    packed: &'a [Vec<Pack>],
    counts: &'a [Vec<f64>; AT_ONCE],
}

impl pulp::NullaryFnOnce for Drawn<'_> {
    type Output = [Vec<f64>; AT_ONCE];

    #[inline(always)]
    fn call(self) -> [Vec<f64>; AT_ONCE] {
        let packs = self.packed.first().map_or(0, Vec::len);
        let mut sums: [Vec<f64>; AT_ONCE] = std::array::from_fn(|_| Vec::with_capacity(packs * LANES));
        // Two packs for each draw at a time stay in registers while all blocks pass by.
        for first in (0..packs).step_by(2) {
            let mut held = [[Pack::of(0.0); 2]; AT_ONCE];
            for (at, block) in self.packed.iter().enumerate() {
                let Some(&[one, two]) = block.get(first..first + 2).and_then(|two| two.first_chunk()) else {
                    break;
                };
                for (held, counts) in held.iter_mut().zip(self.counts) {
                    let count = Pack::of(counts[at]);
                    held[0] = held[0] + one * count;
                    held[1] = held[1] + two * count;
                }
            }
            for (sum, held) in sums.iter_mut().zip(held) {
                sum.extend_from_slice(&held[0].0);
                sum.extend_from_slice(&held[1].0);
            }
        }
        sums
    }
}

/// How often each of `n` blocks is drawn in `n` draws with replacement. A random number gives four indices:
/// 16 bits each are uneven by less than n / 65536.
fn counts(noise: &mut Noise, n: usize) -> Vec<f64> {
    let mut counts = vec![0.0; n];
    for draw in 0..n.div_ceil(4) {
        let bits = noise.bits();
        for part in 0..4.min(n - 4 * draw) {
            let index = (((bits >> (16 * part)) & 0xffff) as usize * n) >> 16;
            counts[index] += 1.0;
        }
    }
    counts
}

/// Solves packed normal equations in place by Cholesky's method: `k` rows of a lower triangle and the
/// right-hand side as one more row. None where they are not positive definite.
fn solve(a: &mut [f64], k: usize) -> Option<Vec<f64>> {
    let row = |i: usize| i * (i + 1) / 2;
    for i in 0..=k {
        for j in 0..=i.min(k - 1) {
            let mut value = a[row(i) + j];
            for l in 0..j {
                value -= a[row(i) + l] * a[row(j) + l];
            }
            a[row(i) + j] = if i == j {
                if value.is_nan() || value <= 1e-14 {
                    return None;
                }
                value.sqrt()
            } else {
                value / a[row(j) + j]
            };
        }
    }
    let mut x = a[row(k)..row(k) + k].to_vec();
    for i in (0..k).rev() {
        for l in i + 1..k {
            x[i] -= a[row(l) + i] * x[l];
        }
        x[i] /= a[row(i) + i];
    }
    Some(x)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_equations_are_solved() {
        // [4 2; 2 3] x = [2; 5]
        let x = solve(&mut [4.0, 2.0, 3.0, 2.0, 5.0], 2).unwrap();
        assert!((x[0] + 0.5).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15, "{x:?}");
        assert_eq!(solve(&mut [1.0, 1.0, 1.0, 0.0, 0.0], 2), None);
    }

    #[test]
    fn every_resample_has_as_many_blocks_as_there_are() {
        let mut noise = Noise::new(1);
        for n in [1, 7, 200] {
            let drawn = (0..300).fold(vec![0.0; n], |mut sum, _| {
                let counts = counts(&mut noise, n);
                assert_eq!(counts.iter().sum::<f64>(), n as f64);
                sum.iter_mut().zip(counts).for_each(|(s, c)| *s += c);
                sum
            });
            assert!(drawn.iter().all(|d| (d - 300.0_f64).abs() < 90.0), "{drawn:?}");
        }
    }
}
