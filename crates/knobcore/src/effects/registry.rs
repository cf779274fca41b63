//! How one line per effect becomes the catalogue: what every effect says of itself, and the dispatch to it.

use super::{Bends, Effect, Place, Survey};
use crate::motion::Channel;
use crate::param::Param;
use crate::scalar::Scalar;

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
    /// See [`Effect::TOUCHES`].
    pub touches: &'static [Channel],
    /// Whether it shapes the friction of other effects; see [`Effect::TOUCHES`].
    pub shapes_friction: bool,
    /// Whether it presses the sliding surfaces together; see [`Effect::TOUCHES`].
    pub presses: bool,
    /// See [`Effect::BENDS`].
    pub bends: Option<Bends>,
    /// See [`Effect::DESCRIBES`].
    pub describes: bool,
}

/// The first `N` of a slice, as an array; a model always hands over as many as the effect has.
#[inline(always)]
pub(super) fn take<T: Scalar, const N: usize>(p: &[T]) -> [T; N] {
    std::array::from_fn(|i| p.get(i).copied().unwrap_or(T::of(0.0)))
}

/// The first `M` of a state as an array to work on; it is written back by [`keep`].
#[inline(always)]
pub(super) fn keep<T: Scalar, const M: usize, R>(state: &mut [T], work: impl FnOnce(&mut [T; M]) -> R) -> R {
    let mut own: [T; M] = take(state);
    let result = work(&mut own);
    state.iter_mut().zip(own).for_each(|(slot, value)| *slot = value);
    result
}

pub(super) const fn info<const N: usize, E: Effect<N>>(place: Place, params: &'static [Param; N]) -> Info {
    Info {
        id: E::ID,
        place,
        law: E::LAW,
        source: E::SOURCE,
        shows: E::SHOWS,
        params,
        confused: E::CONFUSED,
        needs: E::NEEDS,
        touches: E::TOUCHES,
        shapes_friction: matches!(place, Place::Load) && Channel::shape_friction(E::TOUCHES),
        presses: matches!(place, Place::Load) && Channel::among(E::TOUCHES)[Channel::Press as usize],
        bends: E::BENDS,
        describes: E::DESCRIBES,
    }
}

pub(super) fn starts<const N: usize, E: Effect<N>>(survey: &Survey) -> Vec<Vec<f64>> {
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

pub(super) use registry;
