//! A parameter of an effect: one row, read by the fitter, the model file, the tables and the reports.

use crate::error::{Error, Result};
use crate::motion::Channel;
use crate::prelude::*;

/// How a parameter enters the torque; the fitter eliminates what is linear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The torque is proportional to it.
    Linear,
    /// The angle of a sinusoid whose amplitude is the parameter at this index of the same effect. The
    /// two together are linear: A sin(x + S) = (A cos S) sin x + (A sin S) cos x.
    PhaseOf(usize),
    /// Anything else.
    Nonlinear,
}

/// Powers of torque, angle and time; on a linear axis they read force, length and time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unit {
    torque: i8,
    angle: i8,
    time: i8,
    pure: bool,
}

/// A kind of axis: what one unit of `theta` is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// rad and N m.
    #[default]
    Rotary,
    /// m and N.
    Linear,
}

impl Unit {
    /// An angle that is no position (a phase): rad on every axis.
    pub const PHASE: Self = Self { torque: 0, angle: 0, time: 0, pure: false };
    /// A pure number.
    pub const NUMBER: Self = Self { pure: true, ..Self::PHASE };

    /// torque^a angle^b s^c
    pub const fn of(torque: i8, angle: i8, time: i8) -> Self {
        Self { torque, angle, time, pure: false }
    }

    /// Powers of torque, angle and time.
    pub const fn powers(self) -> [i32; 3] {
        [self.torque as i32, self.angle as i32, self.time as i32]
    }

    /// A value of this unit, by those of torque, angle and time.
    pub fn sized(self, [torque, angle, time]: [f64; 3]) -> f64 {
        let powers = [(torque, self.torque), (angle, self.angle), (time, self.time)];
        powers.into_iter().map(|(size, power)| size.powi(power.into())).product()
    }

    /// What a person writes, as [`Unit::text`] prints it: names with powers, after each `/` those below. With `m`
    /// for every `N` the torque is one of a rotary axis; without `rad`, and with other powers of `m`, of a linear
    /// one.
    ///
    /// # Errors
    /// Other names than N, m, rad and s, or a combination that is no torque, angle and time.
    pub fn parse(text: &str) -> Result<Self> {
        let bad = || {
            let why = "is no unit that an effect can have; write one such as N m, N m/rad, N m s/rad, rad, \
                       rad/s, s, 1/s or 1, on a linear axis N, N/m, N s/m, m or m/s";
            Error::invalid(format!("unit '{text}'"), why)
        };
        let plain = text.replace(['*', '\u{b7}'], " ").replace('\u{b2}', "^2").replace('\u{b3}', "^3");
        let [mut newton, mut metre, mut radian, mut second] = [0_i8; 4];
        for (side, names) in plain.split('/').enumerate() {
            for (at, word) in names.split_whitespace().enumerate() {
                let (name, power) = word.split_once('^').unwrap_or((word, "1"));
                let power = power.parse().ok().filter(|power| (-9..=9).contains(power)).ok_or_else(bad)?;
                let sum = match name {
                    "N" => &mut newton,
                    "m" => &mut metre,
                    "rad" => &mut radian,
                    "s" => &mut second,
                    "1" if at == 0 && power == 1 => continue,
                    _ => return Err(bad()),
                };
                *sum = sum.saturating_add(if side == 0 { power } else { -power });
            }
        }
        match (newton, metre, radian, second) {
            _ if plain.split('/').any(|names| names.trim().is_empty()) => Err(bad()),
            (0, 0, 0, 0) => Ok(Self::NUMBER),
            (_, _, angle, _) if metre == newton => Ok(Self::of(newton, angle, second)),
            (_, angle, 0, _) => Ok(Self::of(newton, angle, second)),
            _ => Err(bad()),
        }
    }

    /// As it is printed: `N m s^2/rad`, on a linear axis `N s^2/m`.
    pub fn text(self, axis: Axis) -> String {
        self.named(axis.units())
    }

    /// As it is printed where torque and angle have these units.
    pub fn named(self, [torque, angle]: [&str; 2]) -> String {
        if self == Self::PHASE {
            return "rad".into();
        }
        if self == Self::NUMBER {
            return "1".into();
        }
        let side = |sign: i8| -> Vec<String> {
            [(torque, self.torque), (angle, self.angle), ("s", self.time)]
                .into_iter()
                .filter(|(_, power)| power * sign > 0)
                .map(
                    |(name, power)| {
                        if power.abs() == 1 { name.into() } else { format!("{name}^{}", power.abs()) }
                    },
                )
                .collect()
        };
        let (above, below) = (side(1).join(" "), side(-1));
        match (above.is_empty(), below.len()) {
            (_, 0) => above,
            (true, _) => format!("1/{}", below.join("/")),
            (false, _) => format!("{above}/{}", below.join("/")),
        }
    }
}

/// What stands for a torque that nobody measured: what a motor was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Given {
    /// A current, A.
    Current,
    /// A voltage, V.
    Voltage,
    /// A share of the supply, -1 to 1.
    Duty,
}

impl Given {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Current, Self::Voltage, Self::Duty];

    /// Its unit, as it is printed.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Current => "A",
            Self::Voltage => "V",
            Self::Duty => "duty",
        }
    }
}

impl Axis {
    /// Its units of torque and of angle.
    pub const fn units(self) -> [&'static str; 2] {
        match self {
            Self::Rotary => ["N m", "rad"],
            Self::Linear => ["N", "m"],
        }
    }
}

/// What becomes of a parameter when its effect enters a model, until a user says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Usual {
    /// It is fitted.
    Free,
    /// It stays as it is.
    Fixed,
    /// It equals this parameter of another effect, if the model has that.
    Follows(&'static str),
    /// It is fitted where the parameter at this index of its effect is not nought, and says nothing where it is.
    Beside(usize),
    /// It is fitted where effects of the model act in both of these ways, which it weighs against each other.
    Weighs([Channel; 2]),
    /// It is fitted on a linear axis; on a rotary one it stays, since a revolution is known.
    FreeAlong,
    /// It stays at what textbooks say, until a search finds that the data pay for another value. Real ones differ from
    /// that by so much, a standard deviation.
    WherePaid(f64),
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Param {
    /// Name within its effect.
    pub name: &'static str,
    /// Powers of torque, angle, time.
    pub unit: Unit,
    /// How it enters the torque.
    pub kind: Kind,
    /// Smallest value that a model may have.
    pub lower: f64,
    /// Largest value that a model may have.
    pub upper: f64,
    /// Value at which the effect is silent, or a harmless one for shape parameters.
    pub neutral: f64,
    /// Values that make physical sense; a fit may end outside, which says that the effect stands in for another.
    pub plausible: [f64; 2],
    /// Its usual role.
    pub usual: Usual,
    /// Whether it belongs to a run more than to the knob: of several runs each may have its own.
    pub of_a_run: bool,
    /// What it is, in a few words.
    pub meaning: &'static str,
}

impl Param {
    /// A parameter that the torque is proportional to; silent at zero, unbounded.
    pub const fn linear(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self {
            name,
            unit,
            kind: Kind::Linear,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            neutral: 0.0,
            plausible: [f64::NEG_INFINITY, f64::INFINITY],
            usual: Usual::Free,
            of_a_run: false,
            meaning,
        }
    }

    /// The phase that belongs to the amplitude at index `of`.
    pub const fn phase(name: &'static str, of: usize, meaning: &'static str) -> Self {
        let unbounded = Self::linear(name, Unit::PHASE, meaning);
        Self { kind: Kind::PhaseOf(of), ..unbounded }
    }

    /// A shape parameter within bounds.
    pub const fn shape(
        name: &'static str,
        unit: Unit,
        [lower, upper]: [f64; 2],
        neutral: f64,
        meaning: &'static str,
    ) -> Self {
        let unbounded = Self::linear(name, unit, meaning);
        Self { kind: Kind::Nonlinear, lower, upper, neutral, ..unbounded }
    }

    /// A size that its values may have: that of the neutral value or of its bounds.
    pub fn scale(&self) -> f64 {
        let size = |x: f64| if x.is_finite() { x.abs() } else { 0.0 };
        match size(self.neutral) {
            0.0 if size(self.upper - self.lower) > 0.0 => 0.1 * size(self.upper - self.lower).min(1e3),
            0.0 => 1.0,
            neutral => neutral,
        }
    }

    /// The same parameter in another usual role.
    pub const fn usually(self, usual: Usual) -> Self {
        Self { usual, ..self }
    }

    /// The same parameter as one that belongs to a run.
    pub const fn of_a_run(self) -> Self {
        Self { of_a_run: true, ..self }
    }

    /// The same parameter with the values that make physical sense.
    pub const fn plausibly(self, lower: f64, upper: f64) -> Self {
        Self { plausible: [lower, upper], ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_read_as_the_field_writes_them() {
        assert_eq!(Unit::of(1, -1, 2).text(Axis::Rotary), "N m s^2/rad");
        assert_eq!(Unit::of(1, -1, 2).text(Axis::Linear), "N s^2/m");
        assert_eq!(Unit::of(0, 1, -1).text(Axis::Rotary), "rad/s");
        assert_eq!(Unit::of(1, -3, 0).text(Axis::Linear), "N/m^3");
        assert_eq!(Unit::PHASE.text(Axis::Linear), "rad");
        assert_eq!(Unit::of(1, -1, 2).named(["A", "rad"]), "A s^2/rad");
        assert_eq!(Unit::of(0, 0, -1).text(Axis::Rotary), "1/s");
    }

    #[test]
    fn a_unit_that_is_printed_is_read_back() {
        for (torque, angle, time) in
            (0..=1).flat_map(|a| (-3..=3).flat_map(move |b| (-3..=3).map(move |c| (a, b, c))))
        {
            let unit = Unit::of(torque, angle, time);
            if unit == Unit::PHASE {
                continue;
            }
            assert_eq!(Unit::parse(&unit.text(Axis::Rotary)).unwrap(), unit);
            // Force times length reads as the torque that it is on a rotary axis.
            if (torque, angle) != (1, 1) {
                assert_eq!(Unit::parse(&unit.text(Axis::Linear)).unwrap(), unit);
            }
        }
        assert_eq!(Unit::parse("1").unwrap(), Unit::NUMBER);
        assert_eq!(Unit::parse(" N*m s\u{b2}/rad/rad ").unwrap(), Unit::of(1, -2, 2));
    }

    #[test]
    fn what_is_no_unit_is_refused_with_those_that_are() {
        for text in ["", "mNm", "N m/", "kg", "N m^2/rad", "rad^x", "s^99", "2 s", "N rad"] {
            let error = Unit::parse(text).unwrap_err().to_string();
            assert!(error.contains(&format!("'{text}'")) && error.contains("N m/rad"), "{error}");
        }
    }
}
