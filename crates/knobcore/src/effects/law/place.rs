//! The places of the chain at which an effect of the catalogue acts, each as a [`Law`].

use super::{Law, take};
use crate::effects::{
    CouplingEffect, Info, Joint, LateEffect, LoadEffect, MemoryEffect, Place, SensorEffect,
};
use crate::motion::{Channel, Load, Motion};
use crate::scalar::Scalar;
use core::marker::PhantomData;

/// A joint between shaft and knob.
pub(crate) struct Couples<E, const N: usize>(pub PhantomData<E>);
/// A load on the knob, differentiated by `L` parameters at a time.
pub(crate) struct Loads<E, const N: usize, const L: usize>(pub PhantomData<E>);
/// A load of `M` elements that remember, of whose parameters they share `S`.
pub(crate) struct Remembers<E, const N: usize, const S: usize, const M: usize>(pub PhantomData<E>);
/// A sensor that remembers what it has seen.
pub(crate) struct Delays<E, const N: usize>(pub PhantomData<E>);
/// A sensor; `L` is one more than its parameters.
pub(crate) struct Senses<E, const N: usize, const L: usize>(pub PhantomData<E>);

/// What an effect says of itself, whatever its place.
macro_rules! told {
    ($place:expr) => {
        fn info(&self) -> &'static Info {
            const { &Info::of::<N, E>($place, &E::PARAMS) }
        }

        fn builds_up_over(&self, p: &[f64]) -> Option<f64> {
            E::builds_up_over(&take(p))
        }
    };
}

impl<E: CouplingEffect<N> + Sync, const N: usize> Law for Couples<E, N> {
    told!(Place::Coupling);

    fn remembers(&self) -> bool {
        true
    }

    fn joint(&self, p: &[f64]) -> Option<Joint<f64>> {
        Some(E::joint(&take(p)))
    }
}

impl<E: LoadEffect<N> + Sync, const N: usize, const L: usize> Law for Loads<E, N, L> {
    told!(Place::Load);

    fn load(&self, p: &[f64], _: &mut [f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        sum.join(&E::load(&take(p), motion), const { Channel::among(E::TOUCHES) });
    }
}

impl<E: MemoryEffect<N, S, M> + Sync, const N: usize, const S: usize, const M: usize> Law
    for Remembers<E, N, S, M>
{
    told!(Place::Load);

    fn states(&self) -> usize {
        BEFORE + M
    }

    fn remembers(&self) -> bool {
        true
    }

    fn bend(&self, state: &mut [f64], bent: f64) {
        state.iter_mut().skip(BEFORE).take(M).for_each(|z| *z = bent);
    }

    fn load(&self, p: &[f64], state: &mut [f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        recall::<_, N, S, M, E>(p, state, motion, sum);
    }
}

impl<E: LateEffect<N> + Sync, const N: usize> Law for Delays<E, N> {
    told!(Place::Sensor);

    fn remembers(&self) -> bool {
        true
    }
}

impl<E: SensorEffect<N> + Sync, const N: usize, const L: usize> Law for Senses<E, N, L> {
    told!(Place::Sensor);
}

/// What comes before the elements in a state: 1 after the first sample, and the angle before.
pub(super) const BEFORE: usize = 2;

/// Brings the load at one instant into a sum. The state: [`BEFORE`], and what each element remembers.
#[inline(always)]
pub(super) fn recall<T: Scalar, const N: usize, const S: usize, const M: usize, E: MemoryEffect<N, S, M>>(
    p: &[T],
    state: &mut [T],
    motion: &Motion<T>,
    sum: &mut Load<T>,
) {
    let ([running, before, elements @ ..], Some(own)) = (state, p.get(S..)) else { return };
    let by = *running * (motion.theta - *before);
    (*running, *before) = (T::of(1.0), motion.theta);
    let shared: [T; S] = take(p);
    for ((z, own), element) in elements.iter_mut().zip(own).zip(E::ELEMENTS) {
        *z = E::remember(&shared, T::of(element), *z, by);
        sum.join(&E::load(*own, *z, motion), const { Channel::among(E::TOUCHES) });
    }
}
