//! A law at work: step by step over numbers, packs of samples, or either with derivatives, without allocation.

use super::parse::DEPTH;
use super::{Formula, Function, Op, Variable};
use crate::motion::Motion;
use crate::scalar::{Dual, Packed, Scalar, WIDE, Wide};

impl Formula {
    /// What it answers at one instant.
    #[inline]
    pub fn at<T: Scalar>(&self, p: &[T], motion: &Motion<T>) -> T {
        let mut stack = Stack { numbers: [T::ZERO; DEPTH], count: 0 };
        for step in &self.steps {
            let mut pop = || stack.pop();
            let answer = match step.op {
                Op::Number(x) => T::of(x),
                Op::Parameter(at) => p.get(at).copied().unwrap_or(T::ZERO),
                Op::Motion(Variable::Time) => motion.t,
                Op::Motion(Variable::Theta) => motion.theta,
                Op::Motion(Variable::Omega) => motion.omega,
                Op::Motion(Variable::Alpha) => motion.alpha,
                Op::Motion(Variable::Direction) => motion.direction(),
                Op::Negate => -pop(),
                Op::Raise(exponent) => raised(pop(), exponent),
                Op::Call(Function::Min) => pop().min(pop()),
                Op::Call(Function::Max) => pop().max(pop()),
                Op::Call(function) => called(function, pop()),
                binary => {
                    let (right, left) = (pop(), pop());
                    match binary {
                        Op::Add => left + right,
                        Op::Subtract => left - right,
                        Op::Multiply => left * right,
                        Op::Divide => left / right,
                        _ => power(left, right),
                    }
                }
            };
            stack.push(answer);
        }
        stack.pop()
    }

    /// What it answers over columns (t, theta, omega, alpha, forward) of one length.
    pub fn over(&self, p: &[f64], columns: &[&[f64]; 5]) -> Vec<f64> {
        let wide: Vec<Wide> = p.iter().map(|x| Wide::of(*x)).collect();
        let packs = columns[0].len() / WIDE * WIDE;
        let mut answer = vec![0.0; columns[0].len()];
        for at in (0..packs).step_by(WIDE) {
            self.at(&wide, &Motion::over(columns, at)).into_packs(&mut answer, at);
        }
        for (at, answer) in answer.iter_mut().enumerate().skip(packs) {
            *answer = self.at(p, &instant(columns, at));
        }
        answer
    }

    /// The derivative of that by a parameter.
    pub fn slope(&self, p: &[f64], by: usize, columns: &[&[f64]; 5]) -> Vec<f64> {
        let seeds = |i: usize| if i == by { 1.0 } else { 0.0 };
        let wide: Vec<Dual<Wide, 1>> =
            p.iter().enumerate().map(|(i, x)| Dual { v: Wide::of(*x), d: [Wide::of(seeds(i))] }).collect();
        let plain: Vec<Dual<f64, 1>> =
            p.iter().enumerate().map(|(i, x)| Dual { v: *x, d: [seeds(i)] }).collect();
        let packs = columns[0].len() / WIDE * WIDE;
        let mut slope = vec![0.0; columns[0].len()];
        for at in (0..packs).step_by(WIDE) {
            let motion: Motion<Packed<WIDE>> = Motion::over(columns, at);
            let [own] = self.at(&wide, &motion.map(Dual::constant)).d;
            own.into_packs(&mut slope, at);
        }
        for (at, slope) in slope.iter_mut().enumerate().skip(packs) {
            *slope = self.at(&plain, &instant(columns, at).map(Dual::constant)).d[0];
        }
        slope
    }
}

/// The numbers that are kept while a law is worked out; a law that was read keeps no more than there is room for.
struct Stack<T> {
    numbers: [T; DEPTH],
    count: usize,
}

impl<T: Scalar> Stack<T> {
    #[inline]
    fn push(&mut self, number: T) {
        if let Some(place) = self.numbers.get_mut(self.count) {
            *place = number;
            self.count += 1;
        }
    }

    #[inline]
    fn pop(&mut self) -> T {
        self.count = self.count.saturating_sub(1);
        self.numbers.get(self.count).copied().unwrap_or(T::ZERO)
    }
}

fn instant([t, theta, omega, alpha, forward]: &[&[f64]; 5], at: usize) -> Motion<f64> {
    let of = |column: &[f64]| column.get(at).copied().unwrap_or(0.0);
    Motion { t: of(t), theta: of(theta), omega: of(omega), alpha: of(alpha), forward: of(forward) }
}

#[inline]
fn called<T: Scalar>(function: Function, x: T) -> T {
    let (one, none) = (T::of(1.0), T::of(f64::NAN));
    let sign = |x: T| x.where_positive(one, (-x).where_positive(-one, T::of(0.0)));
    match function {
        Function::Sin => x.sin_cos().0,
        Function::Cos => x.sin_cos().1,
        Function::Tan => {
            let (sin, cos) = x.sin_cos();
            sin / cos
        }
        Function::Exp => x.exp(),
        Function::Log => x.where_positive(x.ln(), none),
        Function::Sqrt => raised(x, 0.5),
        Function::Abs => x.abs(),
        Function::Sign => sign(x),
        Function::Tanh => {
            let e = (x.abs() * T::of(-2.0)).exp();
            sign(x) * (one - e) / (one + e)
        }
        Function::Min | Function::Max => x,
    }
}

/// x to a power that is known: whole ones by multiplication.
#[inline]
fn raised<T: Scalar>(x: T, exponent: f64) -> T {
    let times = exponent.abs();
    if times.fract() != 0.0 || times > 16.0 {
        return power(x, T::of(exponent));
    }
    let product = (0..times as usize).fold(T::of(1.0), |product, _| product * x);
    if exponent < 0.0 { T::of(1.0) / product } else { product }
}

/// x^y of a number from 0 on; of one below it is none.
#[inline]
fn power<T: Scalar>(x: T, y: T) -> T {
    // The logarithm of nothing is kept from the derivatives.
    let base = x.where_positive(x, T::of(1.0));
    let zero = y.where_positive(T::of(0.0), (-y).where_positive(T::of(f64::INFINITY), T::of(1.0)));
    x.where_positive((base.ln() * y).exp(), (-x).where_positive(T::of(f64::NAN), zero))
}
