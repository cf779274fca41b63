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
use crate::scalar::{Dual, LANES, Pack, Scalar};

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

/// Columns of a motion, and what an effect adds to the torque and its derivatives over them.
///
/// All columns have the length of the torque. A parameter with a column has its derivative added there.
pub struct Sweep<'a> {
    /// t, theta, omega, alpha, forward: the fields of [`Motion`].
    pub motion: [&'a [f64]; 5],
    /// Torque, N m.
    pub torque: &'a mut [f64],
    /// Derivatives of the torque, N m per unit of their parameter.
    pub slopes: &'a mut [Vec<f64>],
}

impl Sweep<'_> {
    #[inline(always)]
    fn motion<const L: usize>(&self, at: usize) -> Motion<Dual<Pack, L>> {
        let column = |i: usize| Dual::constant(Pack::load(self.motion[i], at));
        Motion { t: column(0), theta: column(1), omega: column(2), alpha: column(3), forward: column(4) }
    }

    #[inline(always)]
    fn add(column: &mut [f64], at: usize, more: Pack) {
        (Pack::load(column, at) + more).store(column, at);
    }

    /// Adds a load on the moving knob, with its derivatives.
    #[inline(always)]
    fn load<const N: usize, E: LoadEffect<N>>(&mut self, p: &[f64], columns: &[Option<usize>]) {
        let p: [Dual<Pack, N>; N] = seeded(p);
        for at in (0..self.torque.len()).step_by(LANES) {
            let motion = self.motion(at);
            let tau = E::load(&p, &motion).sliding(&motion);
            Self::add(self.torque, at, tau.v);
            for (column, slope) in columns.iter().zip(tau.d) {
                if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                    Self::add(column, at, slope);
                }
            }
        }
    }

    /// Passes torque and derivatives through a sensor: the chain rule by its own derivative to the torque.
    #[inline(always)]
    fn sense<const N: usize, E: SensorEffect<N>>(&mut self, p: &[f64], columns: &[Option<usize>]) {
        let p: [Dual<Pack, SENSOR_LANES>; N] = seeded(p);
        for at in (0..self.torque.len()).step_by(LANES) {
            let mut tau = Dual::constant(Pack::load(self.torque, at));
            tau.d[SENSOR_LANES - 1] = Pack::of(1.0);
            let sensed = E::sense(&p, &self.motion(at), tau);
            sensed.v.store(self.torque, at);
            for column in self.slopes.iter_mut() {
                (Pack::load(column, at) * sensed.d[SENSOR_LANES - 1]).store(column, at);
            }
            for (column, slope) in columns.iter().zip(sensed.d) {
                if let Some(column) = column.and_then(|c| self.slopes.get_mut(c)) {
                    Self::add(column, at, slope);
                }
            }
        }
    }
}

/// Derivatives of a sensor: its parameters (fewer than this), and last the torque that it senses.
const SENSOR_LANES: usize = 4;

/// Parameters that are differentiated by, one lane each.
#[inline(always)]
fn seeded<const N: usize, const L: usize>(p: &[f64]) -> [Dual<Pack, L>; N] {
    std::array::from_fn(|i| Dual::seeded(p.get(i).copied().unwrap_or(0.0), Some(i)))
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

            /// Adds the effect's torque and derivatives over a whole motion; `columns` says which column each
            /// of its parameters has.
            #[inline(always)]
            pub fn sweep(self, p: &[f64], columns: &[Option<usize>], over: &mut Sweep<'_>) {
                match self {
                    $(Self::$load => over.load::<$ln, $load>(p, columns),)*
                    $(Self::$sensor => over.sense::<$sn, $sensor>(p, columns),)*
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
