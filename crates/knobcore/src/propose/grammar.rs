//! The grammar of proposed laws: an amplitude times a product of simple functions, of one variable each.

use std::f64::consts::TAU;

/// What of the motion a function looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variable {
    /// Time, s.
    Time,
    /// Angle, rad.
    Theta,
    /// Velocity, rad/s.
    Omega,
    /// Its magnitude.
    Speed,
    /// Acceleration, rad/s^2.
    Alpha,
    /// The magnitude of the angle.
    Aside,
    /// The magnitude of the acceleration.
    Jolt,
    /// Way since the last reversal, rad.
    Since,
}

impl Variable {
    /// All of them, in the order of the columns of [`Motions`].
    pub const ALL: [Self; 8] = [
        Self::Time,
        Self::Theta,
        Self::Omega,
        Self::Speed,
        Self::Alpha,
        Self::Aside,
        Self::Jolt,
        Self::Since,
    ];

    /// As it is written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::Theta => "theta",
            Self::Omega => "omega",
            Self::Speed => "abs(omega)",
            Self::Alpha => "alpha",
            Self::Aside => "abs(theta)",
            Self::Jolt => "abs(alpha)",
            Self::Since => "s",
        }
    }

    /// What it is counted as.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => Self::Omega.text(),
            Self::Aside => Self::Theta.text(),
            Self::Jolt => Self::Alpha.text(),
            _ => self.text(),
        }
    }
}

/// Columns of the motion: those of [`Variable::ALL`], then the direction, and what presses what slides together, N m.
pub type Motions = [Vec<f64>; Variable::ALL.len() + 2];
/// Where the last two stand.
const DIRECTION: usize = Variable::ALL.len();
const LOAD: usize = DIRECTION + 1;

/// A product of powers that has no parameter: the power of each variable, and whether the direction's sign is in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Powers {
    /// The variables, each with its power.
    pub of: &'static [(Variable, i32)],
    /// Whether it has the sign of the velocity.
    pub signed: bool,
    /// Whether it has the magnitude of the load that presses what slides together: friction under it.
    pub pressed: bool,
}

impl Powers {
    /// No power at all.
    pub const NONE: Self = Self { of: &[], signed: false, pressed: false };
    /// The sign of the velocity.
    pub const SIGN: Self = Self { of: &[], signed: true, pressed: false };
    /// The velocity.
    pub const OMEGA: Self = Self { of: &[(Variable::Omega, 1)], signed: false, pressed: false };
    /// The acceleration.
    pub const ALPHA: Self = Self { of: &[(Variable::Alpha, 1)], signed: false, pressed: false };
    /// Those that mechanics knows: stiffness, drag, inertia and what pushes with the square of the speed.
    pub const ALL: &'static [Self] = &[
        Self::NONE,
        Self::SIGN,
        Self::OMEGA,
        Self { of: &[(Variable::Speed, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Omega, 2)], signed: false, pressed: false },
        Self { of: &[(Variable::Omega, 1), (Variable::Speed, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Omega, 3)], signed: false, pressed: false },
        Self::ALPHA,
        Self { of: &[(Variable::Alpha, 2)], signed: false, pressed: false },
        Self { of: &[(Variable::Alpha, 3)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 2)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 3)], signed: false, pressed: false },
        Self { of: &[(Variable::Time, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Time, 2)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 1)], signed: true, pressed: false },
        Self { of: &[(Variable::Theta, 2)], signed: true, pressed: false },
        Self { of: &[(Variable::Theta, 1), (Variable::Omega, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 2), (Variable::Omega, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 1), (Variable::Omega, 2)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 1), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 2), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Time, 1)], signed: true, pressed: false },
        Self { of: &[(Variable::Time, 1), (Variable::Omega, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Time, 1), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Time, 1), (Variable::Theta, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Omega, 1), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Speed, 1), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Alpha, 1), (Variable::Jolt, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Theta, 1), (Variable::Aside, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Aside, 1), (Variable::Omega, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Aside, 1), (Variable::Alpha, 1)], signed: false, pressed: false },
        Self { of: &[(Variable::Aside, 1)], signed: true, pressed: false },
        Self { of: &[(Variable::Since, 1)], signed: true, pressed: false },
        Self { of: &[], signed: true, pressed: true },
    ];

    /// Those of some variables and their magnitudes.
    pub fn among(variables: &[Variable]) -> Vec<Self> {
        let known = |powers: &&Self| powers.of.iter().all(|(one, _)| variables.contains(one));
        Self::ALL.iter().filter(known).copied().collect()
    }

    /// Its value at every row.
    pub fn over(&self, motions: &Motions) -> Vec<f64> {
        let rows = motions[0].len();
        let mut product = if self.signed { motions[DIRECTION].clone() } else { vec![1.0; rows] };
        if self.pressed {
            product.iter_mut().zip(&motions[LOAD]).for_each(|(own, load)| *own *= load.abs());
        }
        for (variable, power) in self.of {
            for (own, x) in product.iter_mut().zip(&motions[*variable as usize]) {
                *own *= x.powi(*power);
            }
        }
        product
    }

    fn factors(&self) -> Vec<String> {
        let power = |(variable, power): &(Variable, i32)| match power {
            1 => variable.text().to_owned(),
            _ => format!("{}^{power}", variable.text()),
        };
        let load = self.pressed.then(|| "abs(load)".to_owned());
        let sign = self.signed.then(|| "sign(omega)".to_owned());
        self.of.iter().map(power).chain(load).chain(sign).collect()
    }
}

/// A function of one variable with up to two parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// exp(-((x - c)/w)^2)
    Bump,
    /// exp(-x/w)
    Decay,
    /// tanh(x/w)
    Saturating,
    /// tanh((x - c)/w)
    Step,
    /// x/(w + |x|)
    Slow,
    /// 2 (x/w)/(1 + (x/w)^2)
    Peaked,
    /// 1/(1 + ((x - c)/w)^2)
    Resonant,
    /// (x/w)^n: w is any speed and stays, n is in the second place
    Power,
    /// sin(n x) of a whole number n = 1/w
    Sin,
    /// cos(n x)
    Cos,
    /// sin(n x + phase), of which sine and cosine are linear
    Turning,
    /// sin(x/w + phase), alike
    Sine,
}

impl Shape {
    /// How many parameters it has, the phase of a sine not counted.
    pub fn count(self) -> usize {
        match self {
            Self::Bump | Self::Step | Self::Resonant => 2,
            Self::Sin | Self::Cos | Self::Turning => 0,
            _ => 1,
        }
    }

    /// Whether it has a phase, so that it has two columns.
    pub fn is_wave(self) -> bool {
        matches!(self, Self::Sine | Self::Turning)
    }

    /// Its value. `w` is its first parameter, `c` its second.
    pub fn at(self, x: f64, w: f64, c: f64) -> f64 {
        match self {
            Self::Bump => (-((x - c) / w).powi(2)).exp(),
            Self::Decay => (-x / w).exp(),
            Self::Saturating => (x / w).tanh(),
            Self::Step => ((x - c) / w).tanh(),
            Self::Slow => x / (w + x.abs()),
            Self::Peaked => 2.0 * (x / w) / (1.0 + (x / w).powi(2)),
            Self::Resonant => 1.0 / (1.0 + ((x - c) / w).powi(2)),
            Self::Power => (x / w).powf(c),
            Self::Sin | Self::Turning | Self::Sine => (x / w).sin(),
            Self::Cos => (x / w).cos(),
        }
    }
}

/// A function at its place in a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factor {
    /// What it is a function of.
    pub of: Variable,
    /// Which.
    pub shape: Shape,
    /// Its width (in a sine the period over 2 pi), and its centre; of a power what it is held against, and its exponent.
    pub at: [f64; 2],
}

/// An amplitude times powers times functions; of the functions one at most is a sine, and that comes last.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What has no parameter.
    pub powers: Powers,
    /// What has.
    pub factors: Vec<Factor>,
}

impl Term {
    /// The number one.
    pub fn none() -> Self {
        Self { powers: Powers::NONE, factors: Vec::new() }
    }

    /// Its sine, if it has one.
    pub fn sine(&self) -> Option<&Factor> {
        self.factors.last().filter(|factor| factor.shape.is_wave())
    }

    /// Parameters: amplitude, those of its functions, a phase.
    pub fn count(&self) -> usize {
        let own: usize = self.factors.iter().map(|factor| factor.shape.count()).sum();
        1 + own + usize::from(self.sine().is_some())
    }

    /// How long it is: its parameters, functions and variables.
    pub fn complexity(&self) -> usize {
        let powers: usize = self.powers.of.iter().map(|(_, power)| power.unsigned_abs() as usize).sum();
        // A power of the velocity is one function, its sign with it, as tanh is.
        let sign = self.powers.signed && !self.has_power();
        self.count() + 2 * self.factors.len() + powers + usize::from(self.powers.pressed) + usize::from(sign)
    }

    fn has_power(&self) -> bool {
        self.factors.iter().any(|factor| factor.shape == Shape::Power)
    }

    /// Whether a function more says what the term could say without it: a power of a speed that it has a power of.
    pub fn says_already(&self, factor: &Factor) -> bool {
        let of_speed = |(one, _): &(Variable, i32)| matches!(one, Variable::Omega | Variable::Speed);
        factor.shape == Shape::Power && (self.has_power() || self.powers.of.iter().any(of_speed))
    }

    /// What it is a law of, by name.
    pub fn variables(&self) -> Vec<&'static str> {
        let mut names: Vec<&'static str> =
            self.powers.of.iter().map(|(variable, _)| variable.name()).collect();
        names.extend(self.powers.pressed.then_some("load"));
        names.extend(self.powers.signed.then_some(Variable::Omega.name()));
        names.extend(self.factors.iter().map(|factor| factor.of.name()));
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Its linear columns: itself, or with a sine those of sine and cosine.
    pub fn columns(&self, motions: &Motions) -> Vec<Vec<f64>> {
        let mut product = self.powers.over(motions);
        for Factor { of, shape, at: [w, c] } in &self.factors {
            let x = &motions[*of as usize];
            if shape.is_wave() {
                let cosine = product.iter().zip(x).map(|(own, x)| own * (x / w).cos()).collect();
                product.iter_mut().zip(x).for_each(|(own, x)| *own *= (x / w).sin());
                return vec![product, cosine];
            }
            product.iter_mut().zip(x).for_each(|(own, x)| *own *= shape.at(*x, *w, *c));
        }
        vec![product]
    }

    /// As it is written, with these linear coefficients (two with a sine), its parameters put to those that have a name
    /// already.
    pub fn written(&self, coefficients: &[f64], params: &mut Vec<(String, f64)>) -> String {
        let amplitude = coefficients.iter().map(|x| x * x).sum::<f64>().sqrt();
        let amplitude = if coefficients.len() == 1 { coefficients[0] } else { amplitude };
        let mut names = |wish: &str, value: f64| {
            let taken =
                params.iter().filter(|(name, _)| name.trim_end_matches(char::is_numeric) == wish).count();
            let name = if taken == 0 { wish.to_owned() } else { format!("{wish}{}", taken + 1) };
            params.push((name.clone(), value));
            name
        };
        let first = names("a", amplitude);
        let mut texts = self.powers.factors();
        let mut times_two = 1;
        for Factor { of, shape, at: [width, centre] } in &self.factors {
            let x = of.text();
            let text = match shape {
                Shape::Bump => {
                    let (c, w) = (names("c", *centre), names("w", width.abs()));
                    format!("exp(-(({x} - {c})/{w})^2)")
                }
                Shape::Decay => {
                    format!("exp(-{x}/{})", names(if *of == Variable::Time { "T" } else { "d" }, *width))
                }
                Shape::Saturating => format!("tanh({x}/{})", names("w", *width)),
                Shape::Step => {
                    let (c, w) = (names("c", *centre), names("w", *width));
                    format!("tanh(({x} - {c})/{w})")
                }
                Shape::Slow if *of == Variable::Speed => {
                    let w = names("w", *width);
                    format!("{x}/({w} + {x})")
                }
                Shape::Slow => {
                    let w = names("w", *width);
                    format!("{x}/({w} + abs({x}))")
                }
                Shape::Peaked => {
                    let w = names("w", *width);
                    times_two *= 2;
                    format!("({x}/{w})/(1 + ({x}/{w})^2)")
                }
                Shape::Resonant => {
                    let (c, w) = (names("c", *centre), names("w", width.abs()));
                    format!("1/(1 + (({x} - {c})/{w})^2)")
                }
                Shape::Power => {
                    let (w, n) = (names("w", *width), names("n", *centre));
                    format!("({x}/{w})^{n}")
                }
                Shape::Sin => format!("sin({})", times(1.0 / width, x)),
                Shape::Cos => format!("cos({})", times(1.0 / width, x)),
                Shape::Turning => {
                    let phase = coefficients.get(1).copied().unwrap_or(0.0).atan2(coefficients[0]);
                    format!("sin({} + {})", times(1.0 / width, x), names("ph", phase))
                }
                Shape::Sine => {
                    let phase = coefficients.get(1).copied().unwrap_or(0.0).atan2(coefficients[0]);
                    if *of == Variable::Time {
                        let f = names("f", 1.0 / (TAU * width));
                        format!("sin(2*pi*{f}*{x} + {})", names("ph", phase))
                    } else {
                        let k = names("k", 1.0 / width);
                        format!("sin({k}*{x} + {})", names("ph", phase))
                    }
                }
            };
            // A fraction is multiplied as one.
            texts.push(if matches!(shape, Shape::Slow | Shape::Resonant) {
                format!("({text})")
            } else {
                text
            });
        }
        let front = if times_two > 1 { format!("{times_two}*") } else { String::new() };
        let product: Vec<String> = std::iter::once(first).chain(texts).collect();
        format!("{front}{}", product.join("*"))
    }
}

/// A whole number times a variable.
fn times(number: f64, x: &str) -> String {
    if (number - 1.0).abs() < 1e-9 { x.to_owned() } else { format!("{number:.0}*{x}") }
}
