//! Whether the units of a law agree, and which its parameters must have for that.
//!
//! Each number has powers of torque, angle and time, linear in those of the parameters. What is added must be alike,
//! what a function is asked of must be a pure number (an angle too for sine and cosine), the whole must be the answer's:
//! linear equations, solved one after the other so that the first that cannot hold is named.

use super::parse::SPLINE;
use super::{Formula, Function, Mistake, Op, Variable};
use crate::param::{Axis, Unit};
use crate::prelude::*;
use alloc::collections::BTreeMap;

/// Powers below this are none.
const NONE: f64 = 1e-9;
/// Dimensions: torque, angle, time.
const DIMENSIONS: usize = 3;

/// Powers of a number: constant ones, and how many times those of each parameter, alike for each dimension.
#[derive(Debug, Clone)]
struct Powers {
    known: [f64; DIMENSIONS],
    of: Vec<f64>,
    /// Whether it is a nought that is written there, which is of any unit.
    nought: bool,
}

impl Powers {
    fn pure(params: usize) -> Self {
        Self { known: [0.0; DIMENSIONS], of: vec![0.0; params], nought: false }
    }

    fn plus(mut self, other: &Self, times: f64) -> Self {
        self.known.iter_mut().zip(other.known).for_each(|(a, b)| *a += times * b);
        self.of.iter_mut().zip(&other.of).for_each(|(a, b)| *a += times * b);
        self
    }

    fn times(self, by: f64) -> Self {
        let of = self.of.into_iter().map(|x| by * x).collect();
        Self { known: self.known.map(|x| by * x), of, nought: false }
    }

    fn text(&self) -> Option<String> {
        let whole = |x: f64| ((x - x.round()).abs() < NONE).then_some(x.round() as i8);
        let [torque, angle, time] = self.known.map(whole);
        let unit = Unit::of(torque?, angle?, time?);
        let plain = self.known.iter().all(|x| x.abs() < NONE);
        self.of
            .iter()
            .all(|x| x.abs() < NONE)
            .then(|| if plain { "a pure number".into() } else { unit.text(Axis::Rotary) })
    }
}

/// Equations of one dimension, each solved for one parameter: (its place, the powers that are nought together).
#[derive(Default)]
struct Equations(Vec<(usize, Vec<f64>, f64)>);

impl Equations {
    /// Brings in that `of . powers + known` is nought; whether it can be.
    fn hold(&mut self, mut of: Vec<f64>, mut known: f64) -> bool {
        for (place, row, rest) in &self.0 {
            let by = of.get(*place).copied().unwrap_or(0.0);
            if by != 0.0 {
                of.iter_mut().zip(row).for_each(|(a, b)| *a -= by * b);
                known -= by * rest;
            }
        }
        let size = |x: &f64| x.abs();
        let largest = (0..of.len()).max_by(|a, b| size(&of[*a]).total_cmp(&size(&of[*b])));
        let Some(place) = largest.filter(|at| of[*at].abs() > NONE) else { return known.abs() < NONE };
        let by = of[place];
        of.iter_mut().for_each(|x| *x /= by);
        known /= by;
        for (_, row, rest) in &mut self.0 {
            let by = row[place];
            row.iter_mut().zip(&of).for_each(|(a, b)| *a -= by * b);
            *rest -= by * known;
        }
        self.0.push((place, of, known));
        true
    }

    /// The power of a parameter; None where nothing says it.
    fn power(&self, param: usize) -> Option<f64> {
        let (_, row, rest) = self.0.iter().find(|(place, ..)| *place == param)?;
        let alone = row.iter().enumerate().all(|(at, x)| at == param || x.abs() < NONE);
        alone.then_some(-rest)
    }
}

/// What holds of the units of a law.
struct Checked {
    equations: [Equations; DIMENSIONS],
}

impl Checked {
    /// Powers that must all be nought, those of angles too unless `angle` may stay.
    fn nought(&mut self, powers: &Powers, angle: bool) -> bool {
        self.equations.iter_mut().enumerate().all(|(dimension, equations)| {
            (angle && dimension == 1) || equations.hold(powers.of.clone(), powers.known[dimension])
        })
    }
}

/// See [`Formula::units`].
pub(super) fn inferred(
    law: &Formula,
    known: &BTreeMap<&str, Unit>,
    answer: Unit,
) -> Result<Vec<Unit>, Mistake> {
    let count = law.params.len();
    let mut checked = Checked { equations: Default::default() };
    for (at, name) in law.params.iter().enumerate() {
        if let Some(unit) = known.get(name.as_str()) {
            let mut powers = Powers { known: unit.powers().map(|x| -f64::from(x)), ..Powers::pure(count) };
            powers.of[at] = 1.0;
            checked.nought(&powers, false);
        }
    }
    let mut stack: Vec<Powers> = Vec::new();
    for step in &law.steps {
        let at = step.at;
        let right = if step.op.takes() > 0 { stack.pop() } else { None }.unwrap_or(Powers::pure(count));
        let left = if step.op.takes() > 1 { stack.pop() } else { None }.unwrap_or(Powers::pure(count));
        let alike = |checked: &mut Checked, word: &str| {
            if left.nought || right.nought {
                return Ok(if left.nought { right.clone() } else { left.clone() });
            }
            if checked.nought(&left.clone().plus(&right, -1.0), false) {
                return Ok(left.clone());
            }
            let units = left.text().zip(right.text()).map(|(a, b)| format!(": {a} and {b}"));
            Err(Mistake { at, why: format!("{word} what has other units{}", units.unwrap_or_default()) })
        };
        let powers = match step.op {
            Op::Number(_) | Op::Motion(Variable::Direction) => right,
            Op::Motion(variable) => {
                let known = match variable {
                    Variable::Load => [1.0, 0.0, 0.0],
                    Variable::Time => [0.0, 0.0, 1.0],
                    Variable::Theta | Variable::Distance => [0.0, 1.0, 0.0],
                    Variable::Omega => [0.0, 1.0, -1.0],
                    _ => [0.0, 1.0, -2.0],
                };
                Powers { known, ..right }
            }
            Op::Parameter(param) => {
                let mut powers = right;
                powers.of[param] = 1.0;
                powers
            }
            Op::Negate | Op::Call(Function::Abs) => right,
            Op::Add => alike(&mut checked, "adds")?,
            Op::Subtract => alike(&mut checked, "subtracts")?,
            Op::Call(function @ (Function::Min | Function::Max)) => {
                alike(&mut checked, &format!("{} compares", function.name()))?
            }
            Op::Multiply => left.plus(&right, 1.0),
            Op::Divide => left.plus(&right, -1.0),
            Op::Raise(exponent) => right.times(exponent),
            Op::Call(Function::Sqrt) => right.times(0.5),
            Op::Call(Function::Sign) => Powers::pure(count),
            Op::Power => {
                if !checked.nought(&right, false) || !checked.nought(&left, false) {
                    return Err(Mistake {
                        at,
                        why: "raises what has a unit to a power that is no plain number; divide it by a \
                              parameter of that unit, as in (abs(omega)/w)^n"
                            .into(),
                    });
                }
                Powers::pure(count)
            }
            Op::Call(_) | Op::Spline(_) => {
                let (name, angle) = match step.op {
                    Op::Call(function @ (Function::Sin | Function::Cos | Function::Tan)) => {
                        (function.name(), true)
                    }
                    Op::Call(function) => (function.name(), false),
                    _ => (SPLINE, false),
                };
                if !checked.nought(&right, angle) {
                    let of =
                        right.text().map_or_else(|| "what has a unit".into(), |text| format!("of {text}"));
                    let want = if angle { "an angle or a pure number" } else { "a pure number" };
                    return Err(Mistake { at, why: format!("{name} {of}: it takes {want}") });
                }
                Powers::pure(count)
            }
        };
        stack.push(Powers { nought: step.op == Op::Number(0.0), ..powers });
    }
    let whole = stack.pop().unwrap_or(Powers::pure(count));
    let wanted = Powers { known: answer.powers().map(f64::from), ..Powers::pure(count) };
    if !checked.nought(&whole.clone().plus(&wanted, -1.0), false) {
        let has = whole.text().map_or_else(String::new, |text| format!(" {text}"));
        let wants = wanted.text().unwrap_or_default();
        return Err(Mistake {
            at: 0,
            why: format!("the whole law has another unit{has} than what it should answer in, {wants}"),
        });
    }
    (0..count).map(|param| of_param(law, &checked, param)).collect()
}

/// The unit of a parameter; what nothing says of its angle, as within a sine, is none.
fn of_param(law: &Formula, checked: &Checked, param: usize) -> Result<Unit, Mistake> {
    let name = &law.params[param];
    let at = law.steps.iter().find(|step| step.op == Op::Parameter(param)).map_or(0, |step| step.at);
    let mut powers = [0_i8; DIMENSIONS];
    for (dimension, (power, equations)) in powers.iter_mut().zip(&checked.equations).enumerate() {
        let Some(found) = equations.power(param) else {
            if dimension == 1 {
                continue;
            }
            return Err(Mistake {
                at,
                why: format!("the unit of '{name}' does not follow from the others; give it"),
            });
        };
        if (found - found.round()).abs() > NONE || found.abs() > 9.0 {
            return Err(Mistake {
                at,
                why: format!(
                    "'{name}' would need a broken power of a unit; divide what is raised by a parameter of its unit, as in (abs(omega)/w)^1.5"
                ),
            });
        }
        *power = found.round() as i8;
    }
    let [torque, angle, time] = powers;
    Ok(if powers == [0; DIMENSIONS] { Unit::NUMBER } else { Unit::of(torque, angle, time) })
}
