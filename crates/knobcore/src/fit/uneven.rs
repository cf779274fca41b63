//! Noise that is not equally loud all along: a motor that is off makes none, a duty makes the more of it the higher the
//! supply. What a parameter is told by may be there just where it is loud.
//!
//! How much more a parameter is unsure by that is a ratio of two sandwiches, whose middles are sums over short stretches:
//! each as loud as it was, and all as loud as on average (White 1980, Econometrica 48, 817; in stretches, so that noise
//! with a memory may differ within them). It is 1 where the noise is even. Of what is told in few stretches it is a
//! matter of chance, and counts as far as it is beyond its own standard error. Where a parameter is told in quiet, its
//! interval stays as it is: the error may be small there because the fit bends to it.

use super::moments::Moments;
use nalgebra::DMatrix;

/// By how much the variance of each kept parameter is larger than with noise that is even; 1 at least. One row of `every`
/// is independent of the others.
pub fn louder(blocks: &[Moments], kept: &[usize], bread: &DMatrix<f64>, every: f64) -> Vec<f64> {
    let (squares, rows) = blocks
        .iter()
        .fold((0.0, 0.0), |(squares, rows), block| (squares + block.squares(), rows + block.rows));
    let of = |own: usize| {
        let (mut uneven, mut even, mut chance) = (0.0, 0.0, 0.0);
        for block in blocks {
            let along = |j: usize| {
                let row = kept.iter().enumerate().map(|(l, &m)| block.gram(kept[j], m) * bread[(own, l)]);
                bread[(own, j)] * row.sum::<f64>()
            };
            let told: f64 = (0..kept.len()).map(along).sum();
            uneven += told * block.squares() / block.rows;
            even += told * squares / rows;
            // A mean square of n independent normal errors has the variance 2 / n of its square.
            chance += 2.0 * every / block.rows * (told * squares / rows).powi(2);
        }
        if even > 0.0 { ((uneven - chance.sqrt()) / even).max(1.0) } else { 1.0 }
    };
    (0..kept.len()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    /// A slope over a column that is 1 in the second half alone, with noise so loud in each half; what it is unsure by
    /// more than if it were even.
    fn told_in_the_second_half(loud: [f64; 2]) -> f64 {
        let mut noise = Noise::new(11);
        let blocks: Vec<Moments> = (0..200)
            .map(|at| {
                let column = vec![f64::from(u8::from(at >= 100)); 50];
                let rest: Vec<f64> = (0..50).map(|_| loud[at / 100] * noise.normal()).collect();
                let mut block = Moments::empty(1);
                block.add_columns(&[&column, &rest]);
                block.rows = 50.0;
                block
            })
            .collect();
        let gram: f64 = blocks.iter().map(|block| block.gram(0, 0)).sum();
        louder(&blocks, &[0], &DMatrix::from_element(1, 1, gram.recip()), 1.0)[0]
    }

    #[test]
    fn a_parameter_that_is_told_where_it_is_loud_is_less_sure_than_the_average_says() {
        let even = told_in_the_second_half([1.0, 1.0]);
        assert!(even < 1.02, "{even}");
        // Half of the rows have all of the noise: the average is half of it.
        let loud = told_in_the_second_half([0.0, 1.0]);
        assert!((loud - 2.0).abs() < 0.1, "{loud}");
        let quiet = told_in_the_second_half([1.0, 0.0]);
        assert!((quiet - 1.0).abs() < 1e-12, "{quiet}");
    }
}
