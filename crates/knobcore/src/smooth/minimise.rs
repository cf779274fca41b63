//! Minimum of a smooth function of a few variables: BFGS with differences for the gradient (J. Nocedal and
//! S. J. Wright, "Numerical Optimization", Springer 2006, algorithm 6.1).

use nalgebra::{Matrix4, Vector4};

/// Step of the differences. The variables are logarithms, wanted to about a percent.
const NUDGE: f64 = 1e-3;

/// Largest step: a factor of e^2.
const LONGEST: f64 = 2.0;

const ITERATIONS: usize = 40;
const HALVINGS: usize = 12;

/// The minimum of `f` near `x` over the `free` variables. `curvature` is a first guess of the second
/// derivatives; `enough` is a fall of `f` that is not worth another step.
pub fn minimise(
    f: impl Fn(&Vector4<f64>) -> f64,
    mut x: Vector4<f64>,
    free: [bool; 4],
    curvature: f64,
    enough: f64,
) -> Vector4<f64> {
    let gradient = |x: &Vector4<f64>, here: f64| {
        Vector4::from_fn(|i, _| {
            if !free[i] {
                return 0.0;
            }
            let mut nudged = *x;
            nudged[i] += NUDGE;
            (f(&nudged) - here) / NUDGE
        })
    };
    let mut inverse = Matrix4::identity() / curvature;
    let mut value = f(&x);
    let mut slope = gradient(&x, value);
    for _ in 0..ITERATIONS {
        let mut step = -(inverse * slope);
        step *= (LONGEST / step.norm()).min(1.0);
        let promised = -slope.dot(&step);
        if !(promised > enough) {
            break;
        }
        let Some((length, lower)) = backtrack(|length| f(&(x + step * length)), value, promised) else {
            break;
        };
        step *= length;
        x += step;
        let fall = value - lower;
        value = lower;
        if fall < enough {
            break;
        }
        let turned = gradient(&x, value);
        update(&mut inverse, &step, &(turned - slope));
        slope = turned;
    }
    x
}

/// The first of the lengths 1, 1/2, 1/4... that yields a tenth of the promised fall, and the value there.
fn backtrack(f: impl Fn(f64) -> f64, value: f64, promised: f64) -> Option<(f64, f64)> {
    let lengths = (0..HALVINGS).scan(1.0, |length, _| {
        let this = *length;
        *length /= 2.0;
        Some(this)
    });
    lengths.map(|length| (length, f(length))).find(|(length, lower)| value - lower > 0.1 * length * promised)
}

/// The BFGS update of the inverse Hessian; skipped where the function curves the wrong way.
fn update(inverse: &mut Matrix4<f64>, step: &Vector4<f64>, change: &Vector4<f64>) {
    let along = step.dot(change);
    if along <= 1e-12 * step.norm() * change.norm() {
        return;
    }
    let left = Matrix4::identity() - step * change.transpose() / along;
    *inverse = left * *inverse * left.transpose() + step * step.transpose() / along;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_valley_is_followed_to_its_floor() {
        let f = |x: &Vector4<f64>| 50.0 * (x[0] - 2.0 * x[1]).powi(2) + (x[1] - 3.0).powi(2) + x[2].powi(2);
        let x = minimise(f, Vector4::new(0.0, 0.0, 1.0, 7.0), [true, true, true, false], 10.0, 1e-6);
        assert!((x - Vector4::new(6.0, 3.0, 0.0, 7.0)).amax() < 0.02);
    }
}
