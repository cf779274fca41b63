//! Block-bootstrap refits: a distribution of the parameters that assumes nothing about the residual but
//! that blocks of it are exchangeable.
//!
//! Source: Kuensch 1989. Each refit draws blocks with replacement; since a block enters the normal equations
//! by its products alone, a refit costs a sum of small matrices and one solve, whatever the capture's length
//! (one Gauss-Newton step from the optimum, exact where the parameters are linear).

use super::moments::Moments;
use crate::isa;
use crate::random::Noise;
use crate::scalar::{LANES, Pack, Scalar};

/// Steps away from the optimum of `draws` refits, for each kept column those of all; a draw whose equations have no
/// solution is left out.
pub fn refits(blocks: &[Moments], kept: &[usize], draws: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut steps = vec![Vec::with_capacity(draws); kept.len()];
    let Some(first) = blocks.first().filter(|_| !kept.is_empty()) else { return steps };
    let scale: Vec<f64> =
        kept.iter().map(|&i| blocks.iter().map(|b| b.gram(i, i)).sum::<f64>().sqrt().recip()).collect();
    // The lower triangle of the normal equations, the right-hand side as its last row; the residual's own
    // column is not needed.
    let mut order = kept.to_vec();
    order.push(first.k);
    let entries: Vec<_> =
        (0..order.len()).flat_map(|i| (0..=i.min(kept.len() - 1)).map(move |j| (i, j))).collect();
    let scaled = |i: usize| scale.get(i).copied().unwrap_or(1.0);
    let product = |block: &Moments, i, j| block.gram(order[i], order[j]) * scaled(i) * scaled(j);
    let of_blocks = |&(i, j): &(usize, usize)| blocks.iter().map(|block| product(block, i, j)).collect();
    let products: Vec<Vec<f64>> = entries.iter().map(of_blocks).collect();
    let mut noise = Noise::new(seed);
    let mut counts = vec![[Pack::of(0.0); PACKS]; blocks.len()];
    let mut equations = vec![[Pack::of(0.0); PACKS]; entries.len()];
    for done in (0..draws).step_by(AT_ONCE) {
        draw(&mut noise, &mut counts);
        isa::dispatch(Refits {
            products: &products,
            counts: &counts,
            equations: &mut equations,
            k: kept.len(),
        });
        let solution = &equations[entries.len() - kept.len()..];
        for lane in 0..AT_ONCE.min(draws - done) {
            let solved = |x: &[Pack; PACKS]| x[lane / LANES].0[lane % LANES];
            if solution.iter().all(|x| solved(x).is_finite()) {
                for ((steps, x), scale) in steps.iter_mut().zip(solution).zip(&scale) {
                    steps.push(solved(x) * scale);
                }
            }
        }
    }
    steps
}

/// Packs of draws that are summed in one pass over the blocks, which are more than the first cache holds.
const PACKS: usize = 2;
/// Draws that are summed in one pass.
const AT_ONCE: usize = PACKS * LANES;
/// Products that are summed in one pass: as many as stay in registers, for all of its draws.
const FEW: usize = 4;

/// The equations of the blocks that were drawn, summed and solved, a draw in each lane: the solution is their last
/// row, NaN where they are not positive definite.
struct Refits<'a> {
    products: &'a [Vec<f64>],
    counts: &'a [[Pack; PACKS]],
    equations: &'a mut [[Pack; PACKS]],
    k: usize,
}

impl pulp::NullaryFnOnce for Refits<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { products, counts, equations, k } = self;
        for (products, sums) in products.chunks(FEW).zip(equations.chunks_mut(FEW)) {
            // Each in a slice of its own: side by side they would be taken for the lanes.
            let products: [&[f64]; FEW] =
                std::array::from_fn(|at| &products[at.min(products.len() - 1)][..counts.len()]);
            let mut held = [[Pack::of(0.0); PACKS]; FEW];
            for (block, counts) in counts.iter().enumerate() {
                for (held, products) in held.iter_mut().zip(products) {
                    let product = Pack::of(products[block]);
                    for (held, count) in held.iter_mut().zip(counts) {
                        *held = *held + product * *count;
                    }
                }
            }
            sums.copy_from_slice(&held[..sums.len()]);
        }
        for pack in 0..PACKS {
            solve(equations, k, pack);
        }
    }
}

/// How often each block is drawn in as many draws with replacement as there are blocks, a resample in each lane. A
/// random number gives four indices: 16 bits each are uneven by less than n / 65536.
fn draw(noise: &mut Noise, counts: &mut [[Pack; PACKS]]) {
    let n = counts.len();
    counts.fill([Pack::of(0.0); PACKS]);
    for lane in 0..AT_ONCE {
        for draw in 0..n.div_ceil(4) {
            let bits = noise.bits();
            for part in 0..4.min(n - 4 * draw) {
                let index = (((bits >> (16 * part)) & 0xffff) as usize * n) >> 16;
                counts[index][lane / LANES].0[lane % LANES] += 1.0;
            }
        }
    }
}

/// Solves packed normal equations in place by Cholesky's method: `k` rows of a lower triangle and the right-hand side
/// as one more row, where the solution then is; NaN in lanes where they are not positive definite.
#[inline(always)]
fn solve(a: &mut [[Pack; PACKS]], k: usize, pack: usize) {
    let row = |i: usize| i * (i + 1) / 2;
    for i in 0..=k {
        for j in 0..=i.min(k - 1) {
            let mut value = a[row(i) + j][pack];
            for l in 0..j {
                value = value - a[row(i) + l][pack] * a[row(j) + l][pack];
            }
            a[row(i) + j][pack] = if i == j { root(value) } else { value / a[row(j) + j][pack] };
        }
    }
    for i in (0..k).rev() {
        let mut value = a[row(k) + i][pack];
        for l in i + 1..k {
            value = value - a[row(l) + i][pack] * a[row(k) + l][pack];
        }
        a[row(k) + i][pack] = value / a[row(i) + i][pack];
    }
}

/// The square root of a pivot, NaN where it is none.
#[inline(always)]
fn root(mut pivot: Pack) -> Pack {
    for x in &mut pivot.0 {
        *x = if *x > 1e-14 { x.sqrt() } else { f64::NAN };
    }
    pivot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_equations_are_solved() {
        // [4 2; 2 3] x = [2; 5] in one lane, and equations that have no solution in the others.
        let mut equations = [[Pack::of(1.0); PACKS]; 5];
        for (entry, value) in equations.iter_mut().zip([4.0, 2.0, 3.0, 2.0, 5.0]) {
            entry[1].0[2] = value;
        }
        solve(&mut equations, 2, 1);
        let x = [3, 4].map(|i: usize| equations[i][1].0);
        assert!((x[0][2] + 0.5).abs() < 1e-15 && (x[1][2] - 2.0).abs() < 1e-15, "{x:?}");
        assert!([0, 1, 3].iter().all(|&lane: &usize| x[0][lane].is_nan() && x[1][lane].is_nan()), "{x:?}");
    }

    #[test]
    fn every_resample_has_as_many_blocks_as_there_are() {
        let mut noise = Noise::new(1);
        for n in [1, 7, 200] {
            let (mut drawn, mut counts) = (vec![0.0; n], vec![[Pack::of(0.0); PACKS]; n]);
            for _ in 0..300 / AT_ONCE {
                draw(&mut noise, &mut counts);
                for lane in 0..AT_ONCE {
                    let own = counts.iter().map(|counts| counts[lane / LANES].0[lane % LANES]);
                    assert_eq!(own.clone().sum::<f64>(), n as f64);
                    drawn.iter_mut().zip(own).for_each(|(sum, count)| *sum += count);
                }
            }
            let resamples = (300 / AT_ONCE * AT_ONCE) as f64;
            assert!(drawn.iter().all(|d| (d - resamples).abs() < 90.0), "{drawn:?}");
        }
    }
}
