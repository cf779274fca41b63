//! The contract of a physical effect, and the registry: one line each.
//!
//! An effect is one file: equation, source, units, parameters with bounds. Simulating, fitting, comparing,
//! plotting and rendering all call its one function. To add an effect, write its file and add its line to the
//! `registry!` call below; nothing else names it.
//!
//! ```
//! use knobcore::effects::{Effect, LoadEffect, Words};
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
//!     const WORDS: Words = Words {
//!         title: "quadratic drag",
//!         name: "drag grows with the square of the speed",
//!         about: "Air that the knob stirs holds it back, four times as much at twice the speed.",
//!         causes: &["a fan or a vane on the shaft"],
//!         remedies: &["take the fan off"],
//!         latex: r"d\,\omega\,|\omega|",
//!     };
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

mod carrier;
mod context;
pub mod formula;
pub mod law;
mod registry;
mod shifted;
mod survey;
mod told;
mod user;

use crate::error::{Error, Result};
use crate::motion::{Channel, Load, Motion};
use crate::param::Param;
use crate::prelude::*;
use crate::scalar::{Branches, Scalar};
use core::marker::PhantomData;
use law::{Couples, Delays, Law, Loads, Remembers, Senses};
use registry::{lanes, registry};

pub use carrier::Carrier;
pub use context::Context;
pub(crate) use context::{rate, short};
pub use registry::Info;
pub use survey::{Survey, Wave, apart};
pub use told::{Base, Over, Section, TakenUp, Words};
pub use user::{Does, Function, User, version};

/// Why a law that bends over the acceleration has no place where a motion is simulated.
pub(crate) const BENT: &str = "is not in proportion to alpha, which no motion that is simulated can follow; write it \
                               as something times alpha, or leave alpha out";

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
pub enum Nonlinear {
    /// All that act before it in the chain.
    Everything,
    /// Those of effects that press the sliding surfaces together, inertia among them.
    ByLoad,
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
    /// Channels of its load that may differ from those of [`Load::none`]; work on the others is left out.
    const TOUCHES: &'static [Channel] = Channel::ALL;
    /// Whether its load is the same in every motion: what follows one sample by sample adds it up once.
    const STEADY: bool = false;
    /// What else it makes nonlinear.
    const MAKES_NONLINEAR: Option<Nonlinear> = None;
    /// What it tells people.
    const WORDS: Words;
    /// What its torque follows.
    const OVER: Over = Over::Several;
    /// What a cross-section draws it as.
    const SECTION: Option<Section> = None;
    /// Its part in the base model.
    const BASE: Option<Base> = None;
    /// Whether it describes whatever is there, and names no cause.
    const DESCRIBES: bool = false;
    /// Why no capture of a motion can show that it is missing, if none can.
    const UNSEARCHED: Option<&'static str> = None;
    /// Whether it predicts what a sensor at its limit reads; without it such readings do not count.
    const CLIPS: bool = false;
    /// Whether each of several runs may have it though the model does not: it says how a run was set up, and nothing of
    /// the knob. What all of them have alike must be [taken up](Effect::TAKEN_UP) by others.
    const EVERY_RUN: bool = false;
    /// What others do as well while their parameters are free.
    const TAKEN_UP: Option<TakenUp> = None;
    /// Why a voltage or a duty cycle that a motor is given cannot have it, if it cannot.
    const GIVEN: Option<&'static str> = None;
    /// The waves over position that its starts need, beside what the model explains.
    const SCAN: Option<Wave> = None;
    /// Multiples of the period that it follows at which a search starts too: what the base model found may be the
    /// harmonic of something slower.
    const SLOWER: &'static [f64] = &[];
    /// Parameters that are shares of one thing: together at most all of it.
    const SHARES: &'static [usize] = &[];

    /// Parameter values to start a search from, none of them given by a user. The neutral values, unless
    /// something that the effect needs to show at all vanishes there.
    fn starts(_: &Survey) -> Vec<[f64; N]> {
        vec![Self::PARAMS.map(|param| param.neutral)]
    }

    /// Parameter values of an ordinary size on a knob, in a motion that shows them and to sensors that see them.
    fn typical(carrier: &Carrier<'_>) -> [f64; N] {
        let values = carrier.by_unit(&Self::PARAMS);
        core::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
    }

    /// What is implausible about such values in such a fit, a sentence each, beside those that no parameter may have
    /// alone.
    fn implausible(_: &[f64; N], _: &Context) -> Vec<String> {
        Vec::new()
    }

    /// Over which distance its friction builds up after a reversal, rad or m; none of what is there at once.
    fn builds_up_over(_: &[f64; N]) -> Option<f64> {
        None
    }
}

/// An effect that loads the knob.
pub trait LoadEffect<const N: usize>: Effect<N> {
    /// What it asks of the rig at one instant.
    fn load<T: Scalar>(p: &[T; N], motion: &Motion<T>) -> Load<T>;
}

/// An effect that loads the knob and remembers where it has been: `M` elements in parallel, of which each remembers one
/// number, zero at first. The first `S` of its parameters belong to all of them, of the others each has one.
pub trait MemoryEffect<const N: usize, const S: usize, const M: usize>: Effect<N> {
    /// What tells one element from the other in what they remember.
    const ELEMENTS: [f64; M];

    /// What an element that remembered `z` remembers after the knob has turned `by` so much; called once a sample.
    fn remember<T: Scalar>(shared: &[T; S], element: T, z: T, by: T) -> T;

    /// What an element that remembers `z` asks of the rig.
    fn load<T: Scalar>(own: T, z: T, motion: &Motion<T>) -> Load<T>;
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

impl<T: Branches> Joint<T> {
    /// The same without derivatives.
    #[inline(always)]
    pub fn plain(&self) -> Joint<T::Value> {
        let Self { gap, stiffness, damping, share, welded } = *self;
        let [gap, stiffness, damping, share] = [gap, stiffness, damping, share].map(T::plain);
        Joint { gap, stiffness, damping, share, welded }
    }
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

registry! {
    couplings {
        backlash::Backlash(4),
        compliance::Compliance(3),
    }
    loads {
        inertia::Inertia(1),
        coulomb::Coulomb(2),
        viscous::Viscous(2),
        detent::Detent(3),
        karnopp::Karnopp(3),
        stribeck::Stribeck(3),
        quadratic_drag::QuadraticDrag(2),
        detent_harmonics::DetentHarmonics(9),
        second_detent::SecondDetent(3),
        directional_detent::DirectionalDetent(3),
        position_polynomial::PositionPolynomial(3),
        return_spring::ReturnSpring(2),
        unbalance::Unbalance(2),
        cogging::Cogging(28),
        end_stop::EndStop(6),
        position_friction::PositionFriction(9),
        load_friction::LoadFriction(3),
        friction_drift::FrictionDrift(2),
        regional::Regional(11),
        wavelet::Wavelet(33),
    }
    memories {
        presliding::Presliding(7, 1, 6),
    }
    lates {
        actuation_delay::ActuationDelay(1),
        torque_lag::TorqueLag(2),
    }
    sensors {
        torque_drift::TorqueDrift(8),
        offset::Offset(1),
        saturation::Saturation(2),
    }
}

impl Id {
    /// What the effect says of itself.
    pub fn info(self) -> &'static Info {
        self.law().info()
    }

    /// Whether it calls a function of the user's own, which is given whole columns and may take any time.
    pub fn calls_out(self) -> bool {
        matches!(self, Self::User(user) if user.formula().is_none())
    }

    /// Whether it follows the acceleration in another way than an inertia does.
    pub fn bends_over_alpha(self) -> bool {
        let Self::User(user) = self else { return false };
        user.formula().is_some_and(|law| match law.over_alpha() {
            formula::OverAlpha::Not => false,
            formula::OverAlpha::Straight => {
                user.info.place == Place::Load && !user.info.touches.contains(&Channel::Inertia)
            }
            formula::OverAlpha::Bent => user.info.place == Place::Load,
        })
    }

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
