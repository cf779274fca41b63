//! Algebra of whole columns: products, projections, orthonormal bases.

use crate::isa;
use crate::prelude::*;
use nalgebra::DMatrix;
use pulp::Simd;

/// The part of a new column that must not be in the others, as a share of its squares.
const OWN: f64 = 1e-9;

/// Sum of products of two columns of one length.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    isa::dispatch_wide(Dot { a, b })
}

struct Dot<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl pulp::WithSimd for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (a, a_rest) = S::as_simd_f64s(self.a);
        let (b, b_rest) = S::as_simd_f64s(self.b);
        // Sums side by side: each addition waits for the one before it.
        let mut sums = [simd.splat_f64s(0.0); 4];
        for (a, b) in a.chunks(4).zip(b.chunks(4)) {
            for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
                *sum = simd.mul_add_e_f64s(*a, *b, *sum);
            }
        }
        let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
        sums.iter().map(|sum| simd.reduce_sum_f64s(*sum)).sum::<f64>() + rest
    }
}

/// Rows of which products are summed at a time: those of a few columns stay in the nearest memory.
const ROWS: usize = 512;
/// Columns on the right that are gone through for all on the left, before the next: they stay in the memory behind it.
const COLUMNS: usize = 48;
/// Columns on the left, and on the right, whose products are summed side by side.
const SIDE: [usize; 2] = [4, 2];

/// Sums of products of each column on the left with each on the right, all of one length.
pub fn products(left: &[&[f64]], right: &[&[f64]]) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(left.len(), right.len());
    let rows = left.first().map_or(0, |column| column.len());
    let [high, wide] = SIDE;
    for from in (0..rows).step_by(ROWS) {
        let to = (from + ROWS).min(rows);
        for begin in (0..right.len()).step_by(COLUMNS) {
            let end = (begin + COLUMNS).min(right.len());
            for i in (0..left.len()).step_by(high) {
                for j in (begin..end).step_by(wide) {
                    // Where fewer are left than are done side by side, the last of them is done again.
                    let a = core::array::from_fn(|k| &left[(i + k).min(left.len() - 1)][from..to]);
                    let b = core::array::from_fn(|k| &right[(j + k).min(end - 1)][from..to]);
                    let few = isa::dispatch_wide(Few { a, b });
                    for (k, sum) in few.iter().enumerate().take(left.len() - i) {
                        for (l, sum) in sum.iter().enumerate().take(end - j) {
                            sums[(i + k, j + l)] += sum;
                        }
                    }
                }
            }
        }
    }
    sums
}

/// Columns as slices.
pub fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

struct Few<'a> {
    a: [&'a [f64]; SIDE[0]],
    b: [&'a [f64]; SIDE[1]],
}

impl pulp::WithSimd for Few<'_> {
    type Output = [[f64; SIDE[1]]; SIDE[0]];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let a = self.a.map(S::as_simd_f64s);
        let b = self.b.map(S::as_simd_f64s);
        let mut sums = [[simd.splat_f64s(0.0); SIDE[1]]; SIDE[0]];
        let many = a.iter().chain(&b).map(|(many, _)| many.len()).min().unwrap_or(0);
        for at in 0..many {
            let b = b.map(|(b, _)| b[at]);
            for (sums, (a, _)) in sums.iter_mut().zip(&a) {
                for (sum, b) in sums.iter_mut().zip(b) {
                    *sum = simd.mul_add_e_f64s(a[at], b, *sum);
                }
            }
        }
        let rest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        core::array::from_fn(|i| {
            core::array::from_fn(|j| simd.reduce_sum_f64s(sums[i][j]) + rest(a[i].1, b[j].1))
        })
    }
}

/// Root mean square; 0 of nothing.
pub fn rms(x: &[f64]) -> f64 {
    (dot(x, x) / x.len().max(1) as f64).sqrt()
}

/// Sum of weighted squares.
pub fn squares(x: &[f64], weight: &[f64]) -> f64 {
    isa::dispatch_wide(Squares { x, weight })
}

struct Squares<'a> {
    x: &'a [f64],
    weight: &'a [f64],
}

impl pulp::WithSimd for Squares<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (x, x_rest) = S::as_simd_f64s(self.x);
        let (w, w_rest) = S::as_simd_f64s(self.weight);
        let mut sum = simd.splat_f64s(0.0);
        for (x, w) in x.iter().zip(w) {
            sum = simd.mul_add_e_f64s(simd.mul_f64s(*x, *x), *w, sum);
        }
        simd.reduce_sum_f64s(sum) + x_rest.iter().zip(w_rest).map(|(x, w)| x * x * w).sum::<f64>()
    }
}

/// Takes a direction off a column. Only the first `rows` of both are multiplied; what follows goes along.
pub fn subtract(x: &mut [f64], direction: &[f64], rows: usize) {
    let along = dot(&x[..rows], &direction[..rows]);
    x.iter_mut().zip(direction).for_each(|(x, d)| *x -= along * d);
}

/// Takes all directions of an orthonormal base off a column; see [`subtract`].
pub fn project(x: &mut [f64], base: &[Vec<f64>], rows: usize) {
    base.iter().for_each(|direction| subtract(x, direction, rows));
}

/// Columns that span the same as these, orthonormal over the first `rows` (modified Gram-Schmidt; what depends on
/// others is dropped).
pub fn orthonormal(columns: &[Vec<f64>], rows: usize) -> Vec<Vec<f64>> {
    orthonormal_beside(&[], columns, rows)
}

/// What columns span that a base does not, orthonormal over the first `rows`. A column that lies in the base leaves
/// what rounding made of it, which is no direction: what is left is compared with what there was.
pub fn orthonormal_beside(base: &[Vec<f64>], columns: &[Vec<f64>], rows: usize) -> Vec<Vec<f64>> {
    let mut beside: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let before = dot(&column[..rows], &column[..rows]);
        let mut own = column.clone();
        project(&mut own, base, rows);
        project(&mut own, &beside, rows);
        let length = dot(&own[..rows], &own[..rows]);
        if length > OWN * before && length > 0.0 && length.is_finite() {
            let scale = length.sqrt().recip();
            own.iter_mut().for_each(|x| *x *= scale);
            beside.push(own);
        }
    }
    beside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_the_rows_goes_along_with_them() {
        let base = orthonormal(&[vec![2.0, 0.0, 5.0], vec![2.0, 3.0, 7.0]], 2);
        assert_eq!(base, [[1.0, 0.0, 2.5], [0.0, 1.0, 2.0 / 3.0]]);
        let mut column = vec![4.0, 6.0, 1.0];
        project(&mut column, &base, 2);
        assert_eq!(column, [0.0, 0.0, 1.0 - 10.0 - 4.0]);
    }

    #[test]
    fn what_lies_in_a_base_spans_nothing_beside_it() {
        // Of 0.1, 0.2 and 0.3 rounding leaves something.
        let base = orthonormal(&[vec![0.1, 0.2, 0.3], vec![0.3, 0.1, 0.7]], 3);
        let within = vec![0.1 + 0.3, 0.2 + 0.1, 0.3 + 0.7];
        assert!(orthonormal_beside(&base, std::slice::from_ref(&within), 3).is_empty());
        let beside = orthonormal_beside(&base, &[within, vec![1.0, 0.0, 0.0]], 3);
        assert_eq!(beside.len(), 1);
        assert!(base.iter().all(|direction| dot(direction, &beside[0]).abs() < 1e-14));
        assert!((dot(&beside[0], &beside[0]) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn products_of_many_columns_are_those_of_each_two() {
        let column = |at: usize| (0..1301).map(|i| ((i * (at + 3)) % 17) as f64 - 8.0).collect::<Vec<f64>>();
        let [left, right] = [(0, 7), (7, 60)].map(|(from, to)| (from..to).map(column).collect::<Vec<_>>());
        let [a, b] = [&left, &right].map(|columns| slices(columns));
        let all = products(&a, &b);
        assert_eq!(all.shape(), (7, 53));
        assert!((0..7).all(|i| (0..53).all(|j| all[(i, j)] == dot(a[i], b[j]))));
        assert_eq!(products(&[], &b).shape(), (0, 53));
    }

    #[test]
    fn weighted_squares_are_those_of_every_sample() {
        let x: Vec<f64> = (0..37).map(f64::from).collect();
        let weight: Vec<f64> = (0..37).map(|i| f64::from(u8::from(i % 3 > 0))).collect();
        let sum: f64 = (0..37).filter(|i| i % 3 > 0).map(|i| f64::from(i * i)).sum();
        assert_eq!(squares(&x, &weight), sum);
    }
}
