//! What powers with a free exponent ask of a law: a speed that they are held against, which no capture tells from the
//! amplitude, and an exponent that leaves them a value at rest.

use super::functions::applied;
use super::parse::PARAMETERS;
use super::{Formula, Op, Room, filled};
use crate::algebra::{dot, orthonormal, project};
use crate::motion::Motion;
use crate::prelude::*;
use crate::random::Noise;
use crate::scalar::Dual;

/// Values of an exponent over what comes to nought: below nought there is no value, and no power of a motion is beyond ten.
pub(super) const EXPONENTS: [f64; 2] = [0.0, 10.0];
/// Sets of parameter values that are tried.
const TRIALS: usize = 6;
/// Motions of each.
const MOTIONS: usize = 48;
/// What is left of a slope that others make up, as a share.
const ROUNDED: f64 = 1e-8;

impl Formula {
    /// Parameters of which any change is one of those that the law is proportional to, whatever the motion, as that of the
    /// speed in `a (|omega|/w)^n`: no capture tells them.
    pub(super) fn undone(&self) -> Vec<usize> {
        let linear = self.linear();
        if linear.is_empty() {
            return Vec::new();
        }
        let made_up = |slopes: &Vec<Vec<f64>>, at: usize| {
            let rows = slopes[at].len();
            let base: Vec<Vec<f64>> = linear.iter().map(|at| slopes[*at].clone()).collect();
            let mut own = slopes[at].clone();
            let size = dot(&own, &own);
            project(&mut own, &orthonormal(&base, rows), rows);
            // Rows that are fewer than the columns would make anything up.
            rows > 2 * self.params.len() && dot(&own, &own) <= ROUNDED.powi(2) * size
        };
        let mut undone: Vec<usize> = (0..self.params.len()).filter(|at| !linear.contains(at)).collect();
        let mut noise = Noise::new(3);
        for _ in 0..TRIALS {
            let slopes = self.slopes_anywhere(&mut noise);
            undone.retain(|at| made_up(&slopes, *at));
        }
        undone
    }

    /// The slopes by all parameters, at one set of values, over motions at which they are numbers.
    fn slopes_anywhere(&self, noise: &mut Noise) -> Vec<Vec<f64>> {
        let mut any = || noise.normal();
        let p: Vec<f64> = self.params.iter().map(|_| 0.5 + any().abs()).collect();
        let p = Dual::<f64, PARAMETERS>::seeds(filled(&p), 0);
        let mut columns = vec![Vec::new(); self.params.len()];
        for _ in 0..MOTIONS {
            let motion = Motion::exact(any().abs(), any(), any(), any()).map(Dual::constant);
            let answer = self.worked(&mut Room::new(), &p, &motion, Dual::constant(any().abs()));
            if answer.d.iter().all(|slope| slope.is_finite()) {
                columns.iter_mut().zip(answer.d).for_each(|(column, slope)| column.push(slope));
            }
        }
        columns
    }

    /// Exponents that stand alone over what is nought at rest.
    pub(super) fn exponents(&self) -> Vec<usize> {
        let mut noise = Noise::new(4);
        let p: Vec<f64> = self.params.iter().map(|_| 0.5 + noise.uniform()).collect();
        let (mut stack, mut found): (Vec<(f64, Option<usize>)>, _) = (Vec::new(), Vec::new());
        for step in &self.steps {
            let right = if step.op.takes() > 0 { stack.pop() } else { None }.unwrap_or_default();
            let left = if step.op.takes() > 1 { stack.pop() } else { None }.unwrap_or_default();
            let value = match step.op {
                Op::Parameter(at) => p[at],
                Op::Motion(_) => 0.0,
                Op::Spline(_) => 1.0,
                op if op.takes() == 1 => applied(op, right.0, right.0),
                op => applied(op, left.0, right.0),
            };
            if let (Op::Power, 0.0, Some(at)) = (step.op, left.0, right.1) {
                found.push(at);
            }
            stack.push((value, if let Op::Parameter(at) = step.op { Some(at) } else { None }));
        }
        found
    }
}
