//! Laws that are written as formulas, `2 a (omega/w) / (1 + (omega/w)^2)`: read, checked for units, evaluated for
//! numbers, for packs of samples and with exact derivatives. No code of anybody is run.
//!
//! Names that stand for the motion are `t`, `theta`, `omega`, `alpha`, `direction` (of the motion, -1 to 1; also
//! `sign(omega)`), `s` (the distance since the last reversal) and `abs(load)` (of what presses the sliding surfaces together);
//! every other name is a parameter. What no formula says is written as a spline through numbers.

pub mod catalogued;
#[cfg(feature = "std")]
mod columns;
mod distance;
mod evaluate;
mod functions;
mod parse;
mod powers;
mod program;
mod starts;
mod tree;
mod units;
pub mod written;

use crate::motion::Motion;
use crate::param::Unit;
use crate::prelude::*;
use crate::random::Noise;
use crate::scalar::Dual;
pub(crate) use distance::{STATES, follow};
pub(crate) use evaluate::Room;
// What a file of the catalogue that was written from a formula may call.
use alloc::collections::BTreeMap;
#[allow(unused_imports)]
pub(crate) use functions::{log, power, raised, sign, spline, tan, tanh};
pub use parse::Mistake;
use parse::PARAMETERS;
pub(crate) use starts::starts;

/// Motions in which each parameter of a law is tried.
const TRIALS: usize = 100;

/// Share by which what cancels may change a value.
const ROUNDED: f64 = 1e-3;

fn filled(p: &[f64]) -> [f64; PARAMETERS] {
    core::array::from_fn(|i| p.get(i).copied().unwrap_or(0.0))
}

/// What of the motion a law looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Time, s.
    Time,
    /// Angle, rad.
    Theta,
    /// Angular velocity, rad/s.
    Omega,
    /// Angular acceleration, rad/s^2.
    Alpha,
    /// The expected sign of the velocity.
    Direction,
    /// The distance since the last reversal, rad.
    Distance,
    /// The magnitude of the load that presses the sliding surfaces together, N m.
    Load,
}

impl Variable {
    const ALL: [Self; 7] =
        [Self::Time, Self::Theta, Self::Omega, Self::Alpha, Self::Direction, Self::Distance, Self::Load];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::Theta => "theta",
            Self::Omega => "omega",
            Self::Alpha => "alpha",
            Self::Direction => "direction",
            Self::Distance => "s",
            Self::Load => "load",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|variable| variable.name() == name)
    }
}

/// What a law may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// sin x
    Sin,
    /// cos x
    Cos,
    /// tan x
    Tan,
    /// e^x
    Exp,
    /// The natural logarithm.
    Log,
    /// The square root.
    Sqrt,
    /// |x|
    Abs,
    /// -1, 0 or 1
    Sign,
    /// The hyperbolic tangent.
    Tanh,
    /// The smaller of two.
    Min,
    /// The larger of two.
    Max,
}

impl Function {
    const ALL: [Self; 11] = [
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Exp,
        Self::Log,
        Self::Sqrt,
        Self::Abs,
        Self::Sign,
        Self::Tanh,
        Self::Min,
        Self::Max,
    ];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Exp => "exp",
            Self::Log => "log",
            Self::Sqrt => "sqrt",
            Self::Abs => "abs",
            Self::Sign => "sign",
            Self::Tanh => "tanh",
            Self::Min => "min",
            Self::Max => "max",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == name)
    }

    fn takes(self) -> usize {
        1 + usize::from(matches!(self, Self::Min | Self::Max))
    }
}

/// What a step does with the numbers that came last.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Op {
    Number(f64),
    Motion(Variable),
    Parameter(usize),
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    /// To a power that is written there.
    Raise(f64),
    /// To any power.
    Power,
    /// A spline through values that are written there.
    Spline(usize),
    Call(Function),
}

impl Op {
    /// How many numbers it takes for the one that it leaves.
    fn takes(self) -> usize {
        match self {
            Self::Number(_) | Self::Motion(_) | Self::Parameter(_) => 0,
            Self::Negate | Self::Raise(_) | Self::Spline(_) => 1,
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Power => 2,
            Self::Call(function) => function.takes(),
        }
    }
}

/// A step, and the character that it stands at.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    at: usize,
    op: Op,
}

/// A law that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    text: String,
    steps: Vec<Step>,
    params: Vec<String>,
    /// Values of its splines.
    splines: Vec<Vec<f64>>,
    program: Vec<program::Act>,
    remembers: bool,
}

impl Formula {
    /// Reads a law.
    ///
    /// # Errors
    /// What is wrong with it, and at which character.
    pub fn parse(text: &str) -> Result<Self, Mistake> {
        let parse::Parsed { steps, params, splines } = parse::parsed(text)?;
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let remembers = steps.iter().any(|step| step.op == Op::Motion(Variable::Distance));
        Ok(Self { text, program: program::program(&steps), steps, params, splines, remembers })
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names of its parameters.
    pub fn params(&self) -> &[String] {
        &self.params
    }

    /// What of the motion it looks at.
    pub fn variables(&self) -> Vec<Variable> {
        let looks = |one: &Variable| self.steps.iter().any(|step| step.op == Op::Motion(*one));
        Variable::ALL.into_iter().filter(looks).collect()
    }

    /// Whether it depends on where the knob has been.
    pub fn remembers(&self) -> bool {
        self.remembers
    }

    /// Units of all parameters, given those of some, where the law answers in `answer`.
    ///
    /// # Errors
    /// Where units do not agree, and which parameters have none that follows.
    pub fn units(&self, known: &BTreeMap<&str, Unit>, answer: Unit) -> Result<Vec<Unit>, Mistake> {
        units::inferred(self, known, answer)
    }

    /// Parameters that the law is proportional to, all of them together.
    pub fn linear(&self) -> Vec<usize> {
        let mut together = Vec::new();
        let mut class = Class::Free;
        for param in 0..self.params.len() {
            together.push(param);
            match self.class(|_, op| matches!(op, Op::Parameter(at) if together.contains(&at))) {
                Class::Other => {
                    together.pop();
                }
                found => class = found,
            }
        }
        if class == Class::Proportional { together } else { Vec::new() }
    }

    /// A parameter that changes nothing of what it answers, and where it stands: of a power of nought, or of a difference
    /// of two that are the same. Tried at values of all sizes.
    fn idle(&self) -> Option<(usize, &str)> {
        let mut noise = Noise::new(1);
        let mut any = || noise.normal().signum() * 10.0_f64.powf(8.0 * noise.uniform() - 4.0);
        let mut moves = vec![false; self.params.len()];
        for _ in 0..TRIALS {
            let p: Vec<f64> = self.params.iter().map(|_| any().abs()).collect();
            let motion = Motion::exact(any(), any(), any(), any());
            let distance = any().abs();
            let (mut steep, mut flat) = (Room::new(), Room::new());
            let (at, along) = (motion.map(Dual::constant), Dual::constant(distance));
            let slopes = self.worked(&mut steep, &Dual::<f64, PARAMETERS>::seeds(filled(&p), 0), &at, along);
            for (i, moves) in moves.iter_mut().enumerate() {
                let mut other = p.clone();
                other[i] *= 1.5;
                let by = self.worked(&mut flat, &other, &motion, distance) - slopes.v;
                // What jumps has no slope, and no value is as good as another.
                *moves |= slopes.d[i] != 0.0 || by.is_nan() || by.abs() > ROUNDED * slopes.v.abs();
            }
        }
        let at = moves.iter().position(|moves| !moves)?;
        let place = self.steps.iter().find(|step| step.op == Op::Parameter(at)).map_or(0, |step| step.at);
        Some((place, &self.params[at]))
    }

    /// A parameter at whose nought the law answers just this, whatever the motion and the others are.
    fn silent_without(&self, answer: f64) -> Option<usize> {
        let mut noise = Noise::new(2);
        let mut any = || noise.normal().signum() * 10.0_f64.powf(4.0 * noise.uniform() - 2.0);
        let mut silent = vec![true; self.params.len()];
        for _ in 0..TRIALS {
            let p: Vec<f64> = self.params.iter().map(|_| any().abs()).collect();
            let motion = Motion::exact(any(), any(), any(), any());
            for (at, silent) in silent.iter_mut().enumerate() {
                let mut p = p.clone();
                p[at] = 0.0;
                let own = self.worked(&mut Room::new(), &p, &motion, any().abs());
                *silent &= own == answer;
            }
        }
        silent.iter().position(|silent| *silent)
    }

    /// How the law follows the acceleration.
    pub fn over_alpha(&self) -> OverAlpha {
        match self.class(|_, op| op == Op::Motion(Variable::Alpha)) {
            Class::Free => OverAlpha::Not,
            Class::Proportional | Class::Affine => OverAlpha::Straight,
            Class::Other => OverAlpha::Bent,
        }
    }

    /// Where the load stands in a law that is no friction under it: that is not in proportion to `abs(load) sign(omega)`.
    fn misloaded(&self) -> Option<usize> {
        let magnitude = |at: usize, op: Op| {
            let of = |before: &Step| before.op == Op::Motion(Variable::Load);
            op == Op::Call(Function::Abs) && at.checked_sub(1).is_some_and(|at| of(&self.steps[at]))
        };
        let direction = |_: usize, op: Op| op == Op::Motion(Variable::Direction);
        let rubs =
            self.class(magnitude) == Class::Proportional && self.class(direction) == Class::Proportional;
        let mut loads = (0..self.steps.len()).filter(|at| self.steps[*at].op == Op::Motion(Variable::Load));
        let bare = |at: &usize| self.steps.get(at + 1).is_none_or(|next| !magnitude(at + 1, next.op));
        loads.find(|at| !rubs || bare(at)).map(|at| self.steps[at].at)
    }

    /// Where it looks at a load, if it does: it then is friction under it.
    fn loaded(&self) -> Option<usize> {
        self.steps.iter().find(|step| step.op == Op::Motion(Variable::Load)).map(|step| step.at)
    }

    /// Whether it is friction under a load.
    pub fn rubs(&self) -> bool {
        self.loaded().is_some()
    }

    /// How the law depends on the numbers that these steps leave.
    fn class(&self, of: impl Fn(usize, Op) -> bool) -> Class {
        use Class::{Affine, Free, Other, Proportional};
        let mut stack = Vec::new();
        for (at, step) in self.steps.iter().enumerate() {
            let right = if step.op.takes() > 0 { stack.pop().unwrap_or(Other) } else { Free };
            let left = if step.op.takes() > 1 { stack.pop().unwrap_or(Other) } else { Free };
            stack.push(match step.op {
                op if of(at, op) => Proportional,
                Op::Number(_) | Op::Motion(_) | Op::Parameter(_) => Free,
                Op::Negate => right,
                Op::Add | Op::Subtract => match (left, right) {
                    (Other, _) | (_, Other) => Other,
                    (a, b) if a == b => a,
                    _ => Affine,
                },
                Op::Multiply => match (left, right) {
                    (Free, other) | (other, Free) => other,
                    _ => Other,
                },
                Op::Divide if right == Free => left,
                _ if left == Free && right == Free => Free,
                _ => Other,
            });
        }
        stack.pop().unwrap_or(Other)
    }
}

/// How a law follows the acceleration: what is straight over it is an inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverAlpha {
    /// Not at all.
    Not,
    /// In proportion, beside what does not.
    Straight,
    /// In another way.
    Bent,
}

/// How a number depends on some others together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Free,
    Proportional,
    Affine,
    Other,
}

#[cfg(test)]
mod tests;
