//! The contract of a physical effect, and the registry: one line each.
//!
//! An effect is one file: equation, source, units, parameters with bounds, starting guess. Simulating,
//! fitting, comparing, plotting and rendering all call its one function. To add an effect, write its file
//! and name it in the [`registry!`] call at the end of this one.
//!
//! ```
//! use knobcore::effects::{Effect, LoadEffect};
//! use knobcore::motion::{Load, Motion};
//! use knobcore::param::{Param, Unit};
//! use knobcore::scalar::Scalar;
//!
//! /// Air drag: d omega |omega|.
//! struct Drag;
//!
//! impl Effect<1> for Drag {
//!     const ID: &'static str = "drag";
//!     const LAW: &'static str = "d omega |omega|";
//!     const SOURCE: &'static str = "Rayleigh 1876";
//!     const SHOWS: &'static str = "at high speed";
//!     const PARAMS: [Param; 1] = [Param::linear("d", Unit::of(1, -2, 2), "drag")];
//! }
//!
//! impl LoadEffect<1> for Drag {
//!     fn load<T: Scalar>([d]: &[T; 1], motion: &Motion<T>) -> Load<T> {
//!         Load::drive(*d * motion.omega * motion.omega.abs())
//!     }
//! }
//!
//! let tau = Drag::load(&[2.0], &Motion::exact(0.0, 0.0, -3.0, 0.0)).drive;
//! assert_eq!(tau, -18.0);
//! ```

mod coulomb;
mod detent;
mod inertia;
mod karnopp;
mod offset;
mod position_polynomial;
mod return_spring;
mod viscous;

use crate::error::{Error, Result};
use crate::motion::{Load, Motion};
use crate::param::Param;
use crate::scalar::Scalar;

/// Where in the chain from the motion to the measured torque an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// On the knob: its torques add up.
    Load,
    /// Between the knob and the recorded torque.
    Sensor,
}

impl Place {
    /// As it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Sensor => "sensor",
        }
    }
}

/// What every effect says of itself. `N` is its number of parameters.
pub trait Effect<const N: usize> {
    /// Public name: in model files, on the command line, in reports.
    const ID: &'static str;
    /// The equation in plain text.
    const LAW: &'static str;
    /// Author, year and equation.
    const SOURCE: &'static str;
    /// Where in a measurement it shows.
    const SHOWS: &'static str;
    /// Its parameters, in the order in which its function takes them.
    const PARAMS: [Param; N];
}

/// An effect that loads the knob.
pub trait LoadEffect<const N: usize>: Effect<N> {
    /// What it asks of the rig at one instant.
    fn load<T: Scalar>(p: &[T; N], motion: &Motion<T>) -> Load<T>;
}

/// An effect between the knob and the recorded torque.
pub trait SensorEffect<const N: usize>: Effect<N> {
    /// The recorded torque where `tau` acts, N m.
    fn sense<T: Scalar>(p: &[T; N], motion: &Motion<T>, tau: T) -> T;
}

/// The row of the catalogue that an effect fills.
#[derive(Debug, Clone, Copy)]
pub struct Info {
    /// See [`Effect::ID`].
    pub id: &'static str,
    /// Where it acts.
    pub place: Place,
    /// See [`Effect::LAW`].
    pub law: &'static str,
    /// See [`Effect::SOURCE`].
    pub source: &'static str,
    /// See [`Effect::SHOWS`].
    pub shows: &'static str,
    /// See [`Effect::PARAMS`].
    pub params: &'static [Param],
}

/// The first `N` of a slice, as an array; a model always hands over as many as the effect has.
#[inline(always)]
fn take<T: Scalar, const N: usize>(p: &[T]) -> [T; N] {
    std::array::from_fn(|i| p.get(i).copied().unwrap_or(T::of(0.0)))
}

const fn info<const N: usize, E: Effect<N>>(place: Place, params: &'static [Param; N]) -> Info {
    Info { id: E::ID, place, law: E::LAW, source: E::SOURCE, shows: E::SHOWS, params }
}

/// Generates [`Id`] and its dispatch from one line per effect: `Name(number of parameters) in module`.
macro_rules! registry {
    (loads { $($load:ident($ln:literal) in $lmod:ident),* $(,)? } sensors { $($sensor:ident($sn:literal) in $smod:ident),* $(,)? }) => {
        $(pub use $lmod::$load;)*
        $(pub use $smod::$sensor;)*

        /// An effect of the catalogue.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs)]
        pub enum Id { $($load,)* $($sensor,)* }

        impl Id {
            /// The whole catalogue, in its order.
            pub const ALL: &'static [Self] = &[$(Self::$load,)* $(Self::$sensor,)*];

            /// What the effect says of itself.
            pub fn info(self) -> &'static Info {
                match self {
                    $(Self::$load => const { &info::<$ln, $load>(Place::Load, &<$load as Effect<$ln>>::PARAMS) },)*
                    $(Self::$sensor => const { &info::<$sn, $sensor>(Place::Sensor, &<$sensor as Effect<$sn>>::PARAMS) },)*
                }
            }

            /// What the effect asks of the rig; a sensor effect asks nothing.
            #[inline(always)]
            pub fn load<T: Scalar>(self, p: &[T], motion: &Motion<T>) -> Load<T> {
                match self {
                    $(Self::$load => $load::load(&take::<T, $ln>(p), motion),)*
                    $(Self::$sensor => Load::none(),)*
                }
            }

            /// The recorded torque where `tau` acts; a load leaves it as it is.
            #[inline(always)]
            pub fn sense<T: Scalar>(self, p: &[T], motion: &Motion<T>, tau: T) -> T {
                match self {
                    $(Self::$load => tau,)*
                    $(Self::$sensor => $sensor::sense(&take::<T, $sn>(p), motion, tau),)*
                }
            }
        }
    };
}

registry! {
    loads {
        Inertia(1) in inertia,
        Coulomb(2) in coulomb,
        Viscous(2) in viscous,
        Detent(3) in detent,
        Karnopp(3) in karnopp,
        PositionPolynomial(3) in position_polynomial,
        ReturnSpring(2) in return_spring,
    }
    sensors {
        Offset(1) in offset,
    }
}

impl Id {
    /// The effect with this public name.
    pub fn parse(id: &str) -> Result<Self> {
        Self::ALL.iter().copied().find(|effect| effect.info().id == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|effect| effect.info().id).collect();
            Error::invalid(
                format!("effect '{id}'"),
                format!("is not in the catalogue; it has {}", known.join(", ")),
            )
        })
    }
}
