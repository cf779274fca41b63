//! The contract of a physical effect, and the registry: one line each.
//!
//! An effect is one file: equation, source, units, parameters with bounds. Simulating, fitting, comparing,
//! plotting and rendering all call its one function. To add an effect, write its file and name it in the
//! `registry!` call at the end of this one.
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

mod backlash;
mod compliance;
mod coulomb;
mod detent;
mod detent_harmonics;
mod directional_detent;
mod end_stop;
mod friction_drift;
mod inertia;
mod karnopp;
mod load_friction;
mod offset;
mod position_friction;
mod position_polynomial;
mod presliding;
mod quadratic_drag;
mod regional;
mod return_spring;
mod saturation;
mod stribeck;
mod survey;
mod sweep;
mod torque_drift;
mod torque_lag;
mod unbalance;
mod user;
mod viscous;
mod wavelet;

use crate::error::{Error, Result};
use crate::motion::{Load, Motion};
use crate::param::Param;
use crate::scalar::Scalar;
use sweep::{Gradient, Totals};

pub use survey::Survey;
pub use sweep::{Part, Sweep};
pub use user::{Torque, User};

/// Where in the chain from the motion to the measured torque an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Between the measured shaft and the knob.
    Coupling,
    /// On the knob: its torques add up.
    Load,
    /// Between the knob and the recorded torque.
    Sensor,
}

impl Place {
    /// As it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Coupling => "coupling",
            Self::Load => "load",
            Self::Sensor => "sensor",
        }
    }
}

/// Which parameters of other effects no longer enter the torque linearly beside an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bends {
    /// All that act before it in the chain.
    Everything,
    /// Those of effects that press the sliding surfaces together.
    Press,
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
    /// Effects that are easily taken for it.
    const CONFUSED: &'static [&'static str] = &[];
    /// The effect that it modifies and cannot be without.
    const NEEDS: Option<&'static str> = None;
    /// Whether it acts through the `level`, `mu` or `lag` of a [`Load`].
    const SHAPES_FRICTION: bool = false;
    /// Whether it acts through the `press` of a [`Load`].
    const PRESSES: bool = false;
    /// What else it makes nonlinear.
    const BENDS: Option<Bends> = None;
    /// Whether it describes whatever is there, and names no cause.
    const DESCRIBES: bool = false;

    /// Parameter values to start a search from, none of them given by a user. The neutral values, unless
    /// something that the effect needs to show at all vanishes there.
    fn starts(_: &Survey) -> Vec<[f64; N]> {
        vec![Self::PARAMS.map(|param| param.neutral)]
    }

    /// What is odd about such values beside those that no parameter may have alone.
    fn odd(_: &[f64; N]) -> Option<&'static str> {
        None
    }
}

/// An effect that loads the knob.
pub trait LoadEffect<const N: usize>: Effect<N> {
    /// What it asks of the rig at one instant.
    fn load<T: Scalar>(p: &[T; N], motion: &Motion<T>) -> Load<T>;
}

/// An effect that loads the knob and remembers where it has been; its state is `M` numbers, zero at first.
pub trait MemoryEffect<const N: usize, const M: usize>: Effect<N> {
    /// What it asks of the rig at one instant; call it once a sample, in order.
    fn load<T: Scalar>(p: &[T; N], state: &mut [T; M], motion: &Motion<T>) -> Load<T>;
}

/// An effect between the shaft, whose motion is measured, and the knob.
pub trait CouplingEffect<const N: usize>: Effect<N> {
    /// How the two are joined.
    fn joint<T: Scalar>(p: &[T; N]) -> Joint<T>;
}

/// A joint between shaft and knob: free play of a gap, and a spring and a damper beyond it.
#[derive(Debug, Clone, Copy)]
pub struct Joint<T> {
    /// Free play, rad.
    pub gap: T,
    /// Stiffness, N m/rad.
    pub stiffness: T,
    /// Damping, N m s/rad.
    pub damping: T,
    /// Share of the inertia that is on the knob's side.
    pub share: T,
    /// Whether shaft and knob hold on to each other: the joint then pulls as well as it pushes.
    pub welded: bool,
}

/// An effect between the knob and the recorded torque.
pub trait SensorEffect<const N: usize>: Effect<N> {
    /// The recorded torque where `tau` acts, N m.
    fn sense<T: Scalar>(p: &[T; N], motion: &Motion<T>, tau: T) -> T;
}

/// An effect between the knob and the recorded torque that remembers what it has seen.
pub trait LateEffect<const N: usize>: Effect<N> {
    /// The recorded torque where the torque goes through `tau` at steps of `dt` seconds, N m.
    fn late<T: Scalar>(p: &[T; N], dt: f64, tau: &[T]) -> Vec<T>;
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
    /// See [`Effect::CONFUSED`].
    pub confused: &'static [&'static str],
    /// See [`Effect::NEEDS`].
    pub needs: Option<&'static str>,
    /// See [`Effect::SHAPES_FRICTION`].
    pub shapes_friction: bool,
    /// See [`Effect::PRESSES`].
    pub presses: bool,
    /// See [`Effect::BENDS`].
    pub bends: Option<Bends>,
    /// See [`Effect::DESCRIBES`].
    pub describes: bool,
}

/// The first `N` of a slice, as an array; a model always hands over as many as the effect has.
#[inline(always)]
fn take<T: Scalar, const N: usize>(p: &[T]) -> [T; N] {
    std::array::from_fn(|i| p.get(i).copied().unwrap_or(T::of(0.0)))
}

/// The first `M` of a state as an array to work on; it is written back by [`keep`].
#[inline(always)]
fn keep<T: Scalar, const M: usize, R>(state: &mut [T], work: impl FnOnce(&mut [T; M]) -> R) -> R {
    let mut own: [T; M] = take(state);
    let result = work(&mut own);
    state.iter_mut().zip(own).for_each(|(slot, value)| *slot = value);
    result
}

const fn info<const N: usize, E: Effect<N>>(place: Place, params: &'static [Param; N]) -> Info {
    Info {
        id: E::ID,
        place,
        law: E::LAW,
        source: E::SOURCE,
        shows: E::SHOWS,
        params,
        confused: E::CONFUSED,
        needs: E::NEEDS,
        shapes_friction: E::SHAPES_FRICTION,
        presses: E::PRESSES,
        bends: E::BENDS,
        describes: E::DESCRIBES,
    }
}

fn starts<const N: usize, E: Effect<N>>(survey: &Survey) -> Vec<Vec<f64>> {
    E::starts(survey).into_iter().map(Vec::from).collect()
}

/// Generates [`Id`] and its dispatch from one line per effect: `Name(number of parameters) in module`; an effect
/// with memory adds the size of its state.
macro_rules! registry {
    (
        couplings { $($joint:ident($jn:literal) in $jmod:ident),* $(,)? }
        loads { $($load:ident($ln:literal) in $lmod:ident),* $(,)? }
        memories { $($memory:ident($mn:literal, $ms:literal) in $mmod:ident),* $(,)? }
        lates { $($late:ident($tn:literal) in $tmod:ident),* $(,)? }
        sensors { $($sensor:ident($sn:literal) in $smod:ident),* $(,)? }
    ) => {
        $(pub use $jmod::$joint;)*
        $(pub use $lmod::$load;)*
        $(pub use $mmod::$memory;)*
        $(pub use $tmod::$late;)*
        $(pub use $smod::$sensor;)*

        /// An effect of the catalogue, or of the user's own.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs)]
        pub enum Id {
            $($joint,)* $($load,)* $($memory,)*
            /// An effect that a user registered.
            User(&'static User),
            $($late,)* $($sensor,)*
        }

        impl Id {
            /// The built-in catalogue, in the order of the chain.
            pub const BUILT_IN: &'static [Self] = &[
                $(Self::$joint,)* $(Self::$load,)* $(Self::$memory,)* $(Self::$late,)* $(Self::$sensor,)*
            ];

            /// What the effect says of itself.
            pub fn info(self) -> &'static Info {
                match self {
                    $(Self::$joint => const { &info::<$jn, $joint>(Place::Coupling, &<$joint as Effect<$jn>>::PARAMS) },)*
                    $(Self::$load => const { &info::<$ln, $load>(Place::Load, &<$load as Effect<$ln>>::PARAMS) },)*
                    $(Self::$memory => const { &info::<$mn, $memory>(Place::Load, &<$memory as Effect<$mn>>::PARAMS) },)*
                    $(Self::$late => const { &info::<$tn, $late>(Place::Sensor, &<$late as Effect<$tn>>::PARAMS) },)*
                    $(Self::$sensor => const { &info::<$sn, $sensor>(Place::Sensor, &<$sensor as Effect<$sn>>::PARAMS) },)*
                    Self::User(user) => &user.info,
                }
            }

            /// Parameter values to start a search from.
            pub fn starts(self, survey: &Survey) -> Vec<Vec<f64>> {
                match self {
                    $(Self::$joint => starts::<$jn, $joint>(survey),)*
                    $(Self::$load => starts::<$ln, $load>(survey),)*
                    $(Self::$memory => starts::<$mn, $memory>(survey),)*
                    $(Self::$late => starts::<$tn, $late>(survey),)*
                    $(Self::$sensor => starts::<$sn, $sensor>(survey),)*
                    Self::User(user) if user.starts.is_empty() => {
                        vec![user.info.params.iter().map(|param| param.neutral).collect()]
                    }
                    Self::User(user) => user.starts.clone(),
                }
            }

            /// What is odd about such values, if anything is.
            pub fn odd(self, p: &[f64]) -> Option<&'static str> {
                match self {
                    $(Self::$joint => $joint::odd(&take::<f64, $jn>(p)),)*
                    $(Self::$load => $load::odd(&take::<f64, $ln>(p)),)*
                    $(Self::$memory => $memory::odd(&take::<f64, $mn>(p)),)*
                    $(Self::$late => $late::odd(&take::<f64, $tn>(p)),)*
                    $(Self::$sensor => $sensor::odd(&take::<f64, $sn>(p)),)*
                    Self::User(_) => None,
                }
            }

            /// Numbers that the effect remembers from sample to sample.
            pub const fn states(self) -> usize {
                match self {
                    $(Self::$memory => $ms,)*
                    _ => 0,
                }
            }

            /// Whether what it does depends on more than the present sample.
            pub fn remembers(self) -> bool {
                match self {
                    $(Self::$joint => true,)*
                    $(Self::$memory => true,)*
                    $(Self::$late => true,)*
                    Self::User(user) => user.remembers,
                    _ => false,
                }
            }

            /// What the effect asks of the rig; an effect elsewhere in the chain asks nothing, nor does a user's
            /// own, whose law is for numbers alone.
            #[inline(always)]
            pub fn load<T: Scalar>(self, p: &[T], state: &mut [T], motion: &Motion<T>) -> Load<T> {
                match self {
                    $(Self::$load => $load::load(&take::<T, $ln>(p), motion),)*
                    $(Self::$memory => keep(state, |own| $memory::load(&take::<T, $mn>(p), own, motion)),)*
                    _ => Load::none(),
                }
            }

            /// How the effect joins shaft and knob, if it does.
            #[inline(always)]
            pub fn joint<T: Scalar>(self, p: &[T]) -> Option<Joint<T>> {
                match self {
                    $(Self::$joint => Some($joint::joint(&take::<T, $jn>(p))),)*
                    _ => None,
                }
            }

            /// The recorded torque where `tau` acts, of an effect without memory.
            #[inline(always)]
            pub fn sense<T: Scalar>(self, p: &[T], motion: &Motion<T>, tau: T) -> T {
                match self {
                    $(Self::$sensor => $sensor::sense(&take::<T, $sn>(p), motion, tau),)*
                    _ => tau,
                }
            }

            /// Adds what the effect asks over a block of samples to the totals.
            #[inline(always)]
            fn total(self, p: &[f64], state: &mut [f64], totals: &mut Totals<'_>) {
                match self {
                    $(Self::$load => totals.add::<$ln, $load>(p),)*
                    $(Self::$memory => totals.add_remembering::<$mn, $ms, $memory>(p, state),)*
                    Self::User(_) => totals.add_user(state),
                    _ => {}
                }
            }

            /// Adds the derivatives of the torque by the effect's own parameters over a block of samples.
            #[inline(always)]
            fn slopes(self, p: &[f64], columns: &[Option<usize>], state: &mut [f64], gradient: &mut Gradient<'_>) {
                match self {
                    $(Self::$load => gradient.chain::<$ln, $load>(p, columns),)*
                    $(Self::$memory => gradient.chain_remembering::<$mn, $ms, $memory>(p, columns, state),)*
                    Self::User(_) => gradient.chain_user(columns, state),
                    _ => {}
                }
            }

            /// Passes torque and derivatives through the effect, if it is a sensor.
            #[inline(always)]
            fn pass(self, p: &[f64], columns: &[Option<usize>], over: &mut Sweep<'_>) {
                match self {
                    $(Self::$late => over.late::<$tn, $late>(p, columns),)*
                    $(Self::$sensor => over.sense::<$sn, $sensor>(p, columns),)*
                    _ => {}
                }
            }
        }
    };
}

registry! {
    couplings {
        Backlash(4) in backlash,
        Compliance(3) in compliance,
    }
    loads {
        Inertia(1) in inertia,
        Coulomb(2) in coulomb,
        Viscous(2) in viscous,
        Detent(3) in detent,
        Karnopp(3) in karnopp,
        Stribeck(3) in stribeck,
        QuadraticDrag(1) in quadratic_drag,
        DetentHarmonics(7) in detent_harmonics,
        DirectionalDetent(3) in directional_detent,
        PositionPolynomial(3) in position_polynomial,
        ReturnSpring(2) in return_spring,
        Unbalance(2) in unbalance,
        EndStop(5) in end_stop,
        PositionFriction(7) in position_friction,
        LoadFriction(1) in load_friction,
        FrictionDrift(2) in friction_drift,
        Regional(11) in regional,
        Wavelet(33) in wavelet,
    }
    memories {
        Presliding(7, 8) in presliding,
    }
    lates {
        TorqueLag(2) in torque_lag,
    }
    sensors {
        TorqueDrift(4) in torque_drift,
        Offset(1) in offset,
        Saturation(1) in saturation,
    }
}

impl Id {
    /// The catalogue in the order of the chain, the effects of the user's own among the loads.
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = Self::BUILT_IN.iter().copied().chain(user::all().map(Self::User)).collect();
        all.sort();
        all
    }

    /// The effect with this public name.
    pub fn parse(id: &str) -> Result<Self> {
        let all = Self::all();
        all.iter().copied().find(|effect| effect.info().id == id).ok_or_else(|| {
            let known: Vec<_> = all.iter().map(|effect| effect.info().id).collect();
            Error::invalid(
                format!("effect '{id}'"),
                format!(
                    "is not in the catalogue; it has {}; one of your own has to be registered first",
                    known.join(", ")
                ),
            )
        })
    }
}
