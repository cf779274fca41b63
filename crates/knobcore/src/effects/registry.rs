//! How one line per effect becomes the catalogue: what every effect says of itself, and which of them there are.

use super::{Base, Effect, Nonlinear, Over, Place, Section, TakenUp, Wave, Words};
use crate::motion::Channel;
use crate::param::Param;
use crate::prelude::*;

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
    /// See [`Effect::STEADY`].
    pub steady: bool,
    /// Whether it shapes the friction of other effects; see [`Effect::TOUCHES`].
    pub shapes_friction: bool,
    /// Whether it presses the sliding surfaces together by position; see [`Effect::TOUCHES`].
    pub presses: bool,
    /// See [`Effect::MAKES_NONLINEAR`].
    pub makes_nonlinear: Option<Nonlinear>,
    /// See [`Effect::WORDS`].
    pub words: Words,
    /// See [`Effect::OVER`].
    pub over: Over,
    /// See [`Effect::SECTION`].
    pub section: Option<Section>,
    /// See [`Effect::BASE`].
    pub base: Option<Base>,
    /// See [`Effect::DESCRIBES`].
    pub describes: bool,
    /// See [`Effect::UNSEARCHED`].
    pub unsearched: Option<&'static str>,
    /// See [`Effect::CLIPS`].
    pub clips: bool,
    /// See [`Effect::EVERY_RUN`].
    pub every_run: bool,
    /// See [`Effect::TAKEN_UP`].
    pub taken_up: Option<TakenUp>,
    /// See [`Effect::GIVEN`].
    pub given: Option<&'static str>,
    /// See [`Effect::SCAN`].
    pub scan: Option<Wave>,
    /// See [`Effect::SLOWER`].
    pub slower: &'static [f64],
    /// See [`Effect::SHARES`].
    pub shares: &'static [usize],
}

impl Info {
    /// What an effect says of itself.
    pub(super) const fn of<const N: usize, E: Effect<N>>(place: Place, params: &'static [Param; N]) -> Self {
        Self {
            id: E::ID,
            place,
            law: E::LAW,
            source: E::SOURCE,
            shows: E::SHOWS,
            params,
            confused: E::CONFUSED,
            needs: E::NEEDS,
            touches: E::TOUCHES,
            steady: E::STEADY,
            shapes_friction: matches!(place, Place::Load) && Channel::shape_friction(E::TOUCHES),
            presses: matches!(place, Place::Load) && Channel::press(E::TOUCHES),
            makes_nonlinear: E::MAKES_NONLINEAR,
            words: E::WORDS,
            over: E::OVER,
            section: E::SECTION,
            base: E::BASE,
            describes: E::DESCRIBES,
            unsearched: E::UNSEARCHED,
            clips: E::CLIPS,
            every_run: E::EVERY_RUN,
            taken_up: E::TAKEN_UP,
            given: E::GIVEN,
            scan: E::SCAN,
            slower: E::SLOWER,
            shares: E::SHARES,
        }
    }

    /// The row of an effect of a user's own, which says little of itself.
    pub fn own(
        id: &'static str,
        place: Place,
        law: &'static str,
        params: &'static [Param],
        touches: &'static [Channel],
    ) -> Self {
        Self {
            id,
            place,
            law,
            source: "",
            shows: "",
            params,
            confused: &[],
            needs: None,
            touches,
            steady: false,
            shapes_friction: Channel::shape_friction(touches),
            presses: false,
            makes_nonlinear: None,
            words: Words {
                title: id,
                name: id,
                about: "An effect of your own.",
                causes: &[],
                remedies: &[],
                latex: "",
            },
            over: Over::Several,
            section: None,
            base: None,
            describes: false,
            unsearched: None,
            clips: false,
            every_run: false,
            taken_up: None,
            given: None,
            scan: None,
            slower: &[],
            shares: &[],
        }
    }

    /// Its parameters with these values, to say where it fails.
    pub(super) fn with_values(&self, p: &[f64]) -> String {
        let values = self.params.iter().zip(p).map(|(param, x)| format!("{} = {x}", param.name));
        values.collect::<Vec<_>>().join(", ")
    }

    /// Whether it is a torque of position alone beyond the base model: two of them draw nearly any map of position,
    /// unless they are bound to come again, order by order, within each turn.
    pub fn is_map(&self) -> bool {
        self.over == Over::Position && self.base.is_none() && self.scan != Some(Wave::Orders)
    }

    /// Whether it is of position but for the sign of the motion: a torque over it, or a friction.
    pub fn is_along(&self) -> bool {
        self.over == Over::Position || self.scan == Some(Wave::Friction)
    }

    /// Whether it stores energy of motion and does nothing else.
    pub fn stores(&self) -> bool {
        self.touches == [Channel::Inertia]
    }

    /// Whether it is part of the friction: it rubs, shapes what rubs, or opposes the motion by its speed.
    pub fn is_friction(&self) -> bool {
        let rubs = |channel: &Channel| {
            !matches!(channel, Channel::Drive | Channel::Inertia) && !Channel::press(&[*channel])
        };
        self.over == Over::Velocity || self.place == Place::Load && self.touches.iter().all(rubs)
    }
}

/// Parameters by which a load of so many is differentiated at a time: all, or shares that a compiler can bear.
pub(super) const fn lanes(params: usize) -> usize {
    const MOST: usize = 9;
    params.div_ceil(params.div_ceil(MOST))
}

/// Generates [`Id`] and the modules of the effects from one line each, `module::Name(number of parameters)`; an
/// effect with memory adds how many of them its elements share, and how many elements it has.
macro_rules! registry {
    (
        couplings { $($jmod:ident::$joint:ident($jn:literal)),* $(,)? }
        loads { $($lmod:ident::$load:ident($ln:literal)),* $(,)? }
        memories { $($mmod:ident::$memory:ident($mn:literal, $ms:literal, $mm:literal)),* $(,)? }
        lates { $($tmod:ident::$late:ident($tn:literal)),* $(,)? }
        sensors { $($smod:ident::$sensor:ident($sn:literal)),* $(,)? }
    ) => {
        $(mod $jmod; pub use $jmod::$joint;)*
        $(mod $lmod; pub use $lmod::$load;)*
        $(mod $mmod; pub use $mmod::$memory;)*
        $(mod $tmod; pub use $tmod::$late;)*
        $(mod $smod; pub use $smod::$sensor;)*

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

            /// What it does. Inlined into another crate it would have all effects compiled there once more.
            #[inline(never)]
            pub fn law(self) -> &'static dyn Law {
                match self {
                    $(Self::$joint => &Couples::<$joint, $jn>(PhantomData),)*
                    $(Self::$load => &Loads::<$load, $ln, { lanes($ln) }>(PhantomData),)*
                    $(Self::$memory => &Remembers::<$memory, $mn, $ms, $mm>(PhantomData),)*
                    $(Self::$late => &Delays::<$late, $tn>(PhantomData),)*
                    $(Self::$sensor => &Senses::<$sensor, $sn, { $sn + 1 }>(PhantomData),)*
                    Self::User(user) => user.law(),
                }
            }
        }
    };
}

pub(super) use registry;
