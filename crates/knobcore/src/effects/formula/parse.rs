//! From the text of a law to the steps that evaluate it.

use super::{Function, Op, Step, Variable};
use crate::prelude::*;

/// Characters of a law: what is longer nobody reads.
const LONGEST: usize = 1000;
/// Steps of a law.
const STEPS: usize = 200;
/// Numbers that are kept at a time while it is evaluated, and brackets within brackets.
const DEPTH: usize = 32;
/// Values of a spline: at least those of one piece, and no more than anybody looks at.
const VALUES: core::ops::RangeInclusive<usize> = 4..=64;
/// How a spline is written.
pub(super) const SPLINE: &str = "spline";
/// Parameters of a law.
pub(super) const PARAMETERS: usize = 12;

/// What is wrong with a law, and from which character on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Character, from 0.
    pub at: usize,
    /// Why, and the way out.
    pub why: String,
}

/// What a law was read as.
pub(super) struct Parsed {
    pub steps: Vec<Step>,
    /// Its parameters in the order in which they stand there.
    pub params: Vec<String>,
    /// Values of its splines.
    pub splines: Vec<Vec<f64>>,
}

/// Reads a law.
pub(super) fn parsed(text: &str) -> Result<Parsed, Mistake> {
    let count = text.chars().count();
    if count > LONGEST {
        return Err(Mistake { at: LONGEST, why: format!("has {count} characters; {LONGEST} are the most") });
    }
    let mut reader = Reader {
        tokens: tokens(text)?,
        at: 0,
        end: count,
        steps: Vec::new(),
        params: Vec::new(),
        splines: Vec::new(),
        deep: 0,
        kept: 0,
        bar: false,
    };
    reader.sum()?;
    match reader.peek() {
        None => Ok(Parsed { steps: reader.steps, params: reader.params, splines: reader.splines }),
        Some(_) => Err(reader
            .mistake("has nothing to stand for here; an operator is missing, or a bracket is one too many")),
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Sign(char),
}

/// The tokens of a text, each with its first character.
fn tokens(text: &str) -> Result<Vec<(usize, Token)>, Mistake> {
    let characters: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(&c) = characters.get(at) {
        let run = |from: usize, keep: &dyn Fn(char) -> bool| {
            from + characters.iter().skip(from).take_while(|c| keep(**c)).count()
        };
        let end = if c.is_whitespace() {
            at += 1;
            continue;
        } else if c.is_ascii_digit() || c == '.' {
            let mut end = run(at, &|c| c.is_ascii_digit() || c == '.');
            // An exponent only where digits follow: 2 e is two times e.
            if matches!(characters.get(end), Some('e' | 'E')) {
                let digits = end + 1 + usize::from(matches!(characters.get(end + 1), Some('+' | '-')));
                let last = run(digits, &|c| c.is_ascii_digit());
                end = if last > digits { last } else { end };
            }
            let number: String = characters.iter().take(end).skip(at).collect();
            let value = number.parse::<f64>().ok().filter(|x| x.is_finite());
            let value = value.ok_or_else(|| Mistake { at, why: format!("'{number}' is no number") })?;
            found.push((at, Token::Number(value)));
            end
        } else if c.is_ascii_alphabetic() || c == '_' {
            let end = run(at, &|c| c.is_ascii_alphanumeric() || c == '_');
            found.push((at, Token::Name(characters.iter().take(end).skip(at).collect())));
            end
        } else if "+-*/^(),|".contains(c) {
            let power = c == '*' && characters.get(at + 1) == Some(&'*');
            found.push((at, Token::Sign(if power { '^' } else { c })));
            at + 1 + usize::from(power)
        } else {
            let why = format!("'{c}' has no place in a law; it has numbers, names, + - * / ^ ( ) , and | |");
            return Err(Mistake { at, why });
        };
        at = end;
    }
    Ok(found)
}

/// Recursive descent, the steps written in the order in which they are evaluated.
struct Reader {
    tokens: Vec<(usize, Token)>,
    at: usize,
    end: usize,
    steps: Vec<Step>,
    params: Vec<String>,
    splines: Vec<Vec<f64>>,
    deep: usize,
    kept: usize,
    /// Whether what was opened last is a bar, which the next one then closes.
    bar: bool,
}

impl Reader {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|(_, token)| token)
    }

    fn place(&self) -> usize {
        self.tokens.get(self.at).map_or(self.end, |(at, _)| *at)
    }

    fn mistake(&self, why: &str) -> Mistake {
        Mistake { at: self.place(), why: why.to_owned() }
    }

    fn takes(&mut self, sign: char) -> bool {
        let is = self.peek() == Some(&Token::Sign(sign));
        self.at += usize::from(is);
        is
    }

    fn put(&mut self, at: usize, op: Op) -> Result<(), Mistake> {
        self.kept = (self.kept + 1).saturating_sub(op.takes());
        self.steps.push(Step { at, op });
        if self.steps.len() > STEPS || self.kept > DEPTH {
            let why = format!("is too long: a law has {STEPS} steps at most, {DEPTH} numbers kept at a time");
            return Err(Mistake { at, why });
        }
        Ok(())
    }

    /// a + b - c
    fn sum(&mut self) -> Result<(), Mistake> {
        self.deep += 1;
        if self.deep > DEPTH {
            return Err(self.mistake(&format!("lies in more than {DEPTH} brackets")));
        }
        self.product()?;
        loop {
            let at = self.place();
            let op = if self.takes('+') {
                Op::Add
            } else if self.takes('-') {
                Op::Subtract
            } else {
                break;
            };
            self.product()?;
            self.put(at, op)?;
        }
        self.deep -= 1;
        Ok(())
    }

    /// a * b / c, and a b for a * b
    fn product(&mut self) -> Result<(), Mistake> {
        self.signed()?;
        loop {
            let at = self.place();
            let op = if self.takes('*') {
                Op::Multiply
            } else if self.takes('/') {
                Op::Divide
            } else if self.stands_for_a_product() {
                self.power()?;
                self.put(at, Op::Multiply)?;
                continue;
            } else {
                return Ok(());
            };
            self.signed()?;
            self.put(at, op)?;
        }
    }

    /// Whether a factor follows without a sign before it.
    fn stands_for_a_product(&self) -> bool {
        match self.peek() {
            Some(Token::Number(_) | Token::Name(_) | Token::Sign('(')) => true,
            Some(Token::Sign('|')) => !self.bar,
            _ => false,
        }
    }

    /// -a^b is -(a^b).
    fn signed(&mut self) -> Result<(), Mistake> {
        let at = self.place();
        let mut negative = false;
        loop {
            if self.takes('-') {
                negative = !negative;
            } else if !self.takes('+') {
                break;
            }
        }
        self.power()?;
        if negative { self.put(at, Op::Negate) } else { Ok(()) }
    }

    /// a ^ b, from the right
    fn power(&mut self) -> Result<(), Mistake> {
        self.atom()?;
        let at = self.place();
        if !self.takes('^') {
            return Ok(());
        }
        self.deep += 1;
        if self.deep > DEPTH {
            return Err(self.mistake(&format!("lies under more than {DEPTH} powers")));
        }
        let before = self.steps.len();
        self.signed()?;
        self.deep -= 1;
        // A number is no step of its own: a square has no logarithm in it.
        let exponent = match self.steps.get(before..) {
            Some([Step { op: Op::Number(x), .. }]) => Some(*x),
            Some([Step { op: Op::Number(x), .. }, Step { op: Op::Negate, .. }]) => Some(-x),
            _ => None,
        };
        match exponent {
            Some(exponent) => {
                self.steps.truncate(before);
                self.kept -= 1;
                self.put(at, Op::Raise(exponent))
            }
            None => self.put(at, Op::Power),
        }
    }

    fn atom(&mut self) -> Result<(), Mistake> {
        let at = self.place();
        let Some(token) = self.peek().cloned() else {
            return Err(self.mistake("ends where a number, a name or a bracket should stand"));
        };
        self.at += 1;
        match token {
            Token::Number(x) => self.put(at, Op::Number(x)),
            Token::Sign('(') => {
                self.within(false)?;
                self.close(')', at)
            }
            Token::Sign('|') => {
                self.within(true)?;
                self.close('|', at)?;
                self.put(at, Op::Call(Function::Abs))
            }
            Token::Name(name) => self.named(at, name),
            Token::Sign(sign) => Err(Mistake {
                at,
                why: format!("'{sign}' stands where a number, a name or a bracket should"),
            }),
        }
    }

    /// A sum in brackets, or between bars.
    fn within(&mut self, bar: bool) -> Result<(), Mistake> {
        let before = core::mem::replace(&mut self.bar, bar);
        self.sum()?;
        self.bar = before;
        Ok(())
    }

    fn close(&mut self, sign: char, opened: usize) -> Result<(), Mistake> {
        if self.takes(sign) {
            return Ok(());
        }
        Err(self.mistake(&format!("wants the '{sign}' of what opened at character {}", opened + 1)))
    }

    /// spline(x, 0.1, -0.2, ...): what goes through numbers that are written there.
    fn spline(&mut self, at: usize) -> Result<(), Mistake> {
        if !self.takes('(') {
            return Err(self.mistake("wants (spline of what, and its values?): write spline(x, 0, 1, ...)"));
        }
        self.within(false)?;
        let mut values = Vec::new();
        while self.takes(',') {
            let sign = if self.takes('-') { -1.0 } else { 1.0 };
            let Some(&Token::Number(x)) = self.peek() else {
                return Err(self.mistake("wants a number: the values of a spline are written out"));
            };
            self.at += 1;
            values.push(sign * x);
        }
        self.close(')', at)?;
        if !VALUES.contains(&values.len()) {
            let (least, most) = (VALUES.start(), VALUES.end());
            let why = format!("a spline of {} values; it takes {least} to {most}", values.len());
            return Err(Mistake { at, why });
        }
        self.splines.push(values);
        self.put(at, Op::Spline(self.splines.len() - 1))
    }

    fn named(&mut self, at: usize, name: String) -> Result<(), Mistake> {
        if name == SPLINE {
            return self.spline(at);
        }
        if let Some(function) = Function::named(&name) {
            if !self.takes('(') {
                return Err(self.mistake(&format!("wants ({name} of what?): write {name}(...)")));
            }
            let first = self.steps.len();
            self.within(false)?;
            for _ in 1..function.takes() {
                if !self.takes(',') {
                    return Err(self.mistake(&format!("wants a comma: {name} takes {}", function.takes())));
                }
                self.within(false)?;
            }
            self.close(')', at)?;
            // Which way a slow motion goes is known less surely than the sign of its noise says.
            let omega =
                matches!(self.steps.get(first..), Some([Step { op: Op::Motion(Variable::Omega), .. }]));
            if function == Function::Sign && omega {
                self.steps.truncate(first);
                self.kept -= 1;
                return self.put(at, Op::Motion(Variable::Direction));
            }
            return self.put(at, Op::Call(function));
        }
        if let Some(variable) = Variable::named(&name) {
            return self.put(at, Op::Motion(variable));
        }
        if name == "pi" {
            return self.put(at, Op::Number(core::f64::consts::PI));
        }
        if self.peek() == Some(&Token::Sign('(')) && name.len() > 1 && !self.params.contains(&name) {
            let known: Vec<&str> = Function::ALL.iter().map(|function| function.name()).collect();
            let why = format!("'{name}' is no function; known are {}, {SPLINE}", known.join(", "));
            return Err(Mistake { at, why });
        }
        let place = self.params.iter().position(|known| *known == name).unwrap_or(self.params.len());
        if place == self.params.len() {
            if place == PARAMETERS {
                return Err(Mistake {
                    at,
                    why: format!("'{name}' is one parameter more than the {PARAMETERS} that a law may have"),
                });
            }
            self.params.push(name);
        }
        self.put(at, Op::Parameter(place))
    }
}
