//! What an effect tells a person who has never heard of it, and where a picture shows it.

/// An effect in words.
#[derive(Debug, Clone, Copy)]
pub struct Words {
    /// What it is called in a list, in two or three words: "detent harmonics".
    pub title: &'static str,
    /// What a person would say is there: "the detent is not a pure sine".
    pub name: &'static str,
    /// What it is, in one sentence.
    pub about: &'static str,
    /// What usually brings it about, a short phrase each.
    pub causes: &'static [&'static str],
    /// What usually takes it away, a short phrase each.
    pub remedies: &'static [&'static str],
    /// Its law for typesetting, in the mathematics of LaTeX.
    pub latex: &'static str,
}

/// The one quantity that an effect's torque follows, over which a picture draws it as a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Position, rad.
    Position,
    /// Velocity, rad/s.
    Velocity,
    /// Acceleration, rad/s^2.
    Acceleration,
    /// Time since the start of the capture, s.
    Time,
    /// The torque that acts, which a sensor reads; N m.
    Torque,
    /// Distance since the last reversal, rad.
    Reversal,
    /// More than one of these: no curve shows it.
    Several,
}

impl Over {
    /// As it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Time => "time",
            Self::Torque => "torque",
            Self::Reversal => "reversal",
            Self::Several => "several",
        }
    }
}

/// The machine part that a cross-section draws an effect as, of one that where it acts and what it follows do not tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// Two parts that do not touch within it.
    Gap,
    /// A spring that is drawn out and pressed together.
    Spring,
    /// A weight off the axis, or on it where the axis slides.
    Weight,
    /// Magnets that pass poles.
    Poles,
    /// A fluid that is sheared or pushed aside.
    Fluid,
    /// Walls at the ends of the way.
    Stops,
}

impl Section {
    /// As it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Gap => "gap",
            Self::Spring => "spring",
            Self::Weight => "weight",
            Self::Poles => "poles",
            Self::Fluid => "fluid",
            Self::Stops => "stops",
        }
    }
}

/// The part of an effect in the base model, Equation 1 of the haptic-camera paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// It is part of it.
    Always,
    /// It is part of it where a capture shows it.
    WhereShown,
}

impl Base {
    /// As it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::WhereShown => "where it shows",
        }
    }
}

/// What other effects do as well.
#[derive(Debug, Clone, Copy)]
pub struct TakenUp {
    /// Their parameters, `effect.parameter`: where all of them are free, the effect has nothing left to say.
    pub by: &'static [&'static str],
    /// Why, in words.
    pub why: &'static str,
}
