//! The places of the chain along whole columns, and with derivatives: see [`place`](super::super::place).

use super::Along;
use super::block::Totals;
use super::gradient::Gradient;
use super::memory;
use super::response::Response;
use crate::effects::law::place::{Couples, Delays, Loads, Remembers, Senses, recall};
use crate::effects::law::{Carried, D, take};
use crate::effects::{
    Carrier, Context, CouplingEffect, Joint, LateEffect, LoadEffect, MemoryEffect, SensorEffect, Survey,
};
use crate::isa;
use crate::motion::{Channel, Load, Motion};
use crate::scalar::{LANES, WIDE, Wide};
use core::marker::PhantomData;
use pulp::{NullaryFnOnce, Simd, WithSimd};

/// What a search asks of an effect, whatever its place.
macro_rules! asked {
    () => {
        fn starts(&self, survey: &Survey) -> Vec<Vec<f64>> {
            E::starts(survey).into_iter().map(Vec::from).collect()
        }

        fn typical(&self, carrier: &Carrier<'_>) -> Vec<f64> {
            E::typical(carrier).into()
        }

        fn implausible(&self, p: &[f64], context: &Context) -> Vec<String> {
            E::implausible(&take(p), context)
        }
    };
}

impl<E: CouplingEffect<N> + Sync, const N: usize> Along for Couples<E, N> {
    asked!();

    fn joint_carried(&self, p: &[D]) -> Option<Joint<D>> {
        Some(E::joint(&take(p)))
    }

    fn joint_wide(&self, p: &[Wide]) -> Option<Joint<Wide>> {
        Some(E::joint(&take(p)))
    }
}

impl<E: LoadEffect<N> + Sync, const N: usize, const L: usize> Along for Loads<E, N, L> {
    asked!();

    fn load_carried(&self, p: &[D], _: &mut [D], motion: &Motion<D>, sum: &mut Load<D>) {
        isa::dispatch(Summed::<_, E, N>(p, motion, sum, PhantomData));
    }

    fn load_wide(&self, p: &[Wide], _: &mut [Wide], motion: &Motion<Wide>, sum: &mut Load<Wide>) {
        isa::dispatch_wide(Summed::<_, E, N>(p, motion, sum, PhantomData));
    }

    fn total(&self, p: &[f64], _: &mut [f64], totals: &mut Totals<'_>) {
        isa::dispatch_wide(Totalled::<E, N>(p, totals, PhantomData));
    }

    fn slopes(&self, p: &[f64], columns: &[Option<usize>], _: &mut [f64], gradient: &mut Gradient<'_>) {
        if columns.iter().any(Option::is_some) {
            isa::dispatch_wide(Chained::<E, N, L>(p, columns, gradient, PhantomData));
        }
    }
}

impl<E: MemoryEffect<N, S, M> + Sync, const N: usize, const S: usize, const M: usize> Along
    for Remembers<E, N, S, M>
{
    asked!();

    fn kept(&self, _: &[f64], columns: &[Option<usize>], _: [&[f64]; 5]) -> Vec<f64> {
        memory::kept(if columns.iter().any(Option::is_some) { S } else { 0 })
    }

    fn load_carried(&self, p: &[D], state: &mut [D], motion: &Motion<D>, sum: &mut Load<D>) {
        isa::dispatch(Recalled::<_, E, N, S, M>(p, state, motion, sum, PhantomData));
    }

    fn load_wide(&self, p: &[Wide], state: &mut [Wide], motion: &Motion<Wide>, sum: &mut Load<Wide>) {
        isa::dispatch_wide(Recalled::<_, E, N, S, M>(p, state, motion, sum, PhantomData));
    }

    fn total(&self, p: &[f64], kept: &mut [f64], totals: &mut Totals<'_>) {
        isa::dispatch_wide(TotalledOn::<E, N, S, M>(p, kept, totals, PhantomData));
    }

    fn slopes(&self, p: &[f64], columns: &[Option<usize>], kept: &mut [f64], gradient: &mut Gradient<'_>) {
        if columns.iter().any(Option::is_some) {
            isa::dispatch(ChainedOn::<E, N, S, M>(p, columns, kept, gradient, PhantomData));
        }
    }
}

impl<E: LateEffect<N> + Sync, const N: usize> Along for Delays<E, N> {
    asked!();

    fn pass(&self, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
        over.late::<N, E>(p, columns);
    }
}

impl<E: SensorEffect<N> + Sync, const N: usize, const L: usize> Along for Senses<E, N, L> {
    asked!();

    fn pass(&self, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
        isa::dispatch(Sensed::<E, N, L>(p, columns, over, PhantomData));
    }
}

// Work as values: their bodies, unlike those of closures, are sure to be compiled into the function that has the
// machine's instruction set.

struct Summed<'a, T, E, const N: usize>(&'a [T], &'a Motion<T>, &'a mut Load<T>, PhantomData<E>);

impl<T: Carried, E: LoadEffect<N>, const N: usize> NullaryFnOnce for Summed<'_, T, E, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.2.join(&E::load(&take(self.0), self.1), const { Channel::among(E::TOUCHES) });
    }
}

struct Recalled<'a, T, E, const N: usize, const S: usize, const M: usize>(
    &'a [T],
    &'a mut [T],
    &'a Motion<T>,
    &'a mut Load<T>,
    PhantomData<E>,
);

impl<T: Carried, E: MemoryEffect<N, S, M>, const N: usize, const S: usize, const M: usize> NullaryFnOnce
    for Recalled<'_, T, E, N, S, M>
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        recall::<_, N, S, M, E>(self.0, self.1, self.2, self.3);
    }
}

struct Totalled<'a, 'b, E, const N: usize>(&'a [f64], &'a mut Totals<'b>, PhantomData<E>);

impl<E: LoadEffect<N>, const N: usize> NullaryFnOnce for Totalled<'_, '_, E, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.1.add::<N, E>(self.0);
    }
}

struct TotalledOn<'a, 'b, E, const N: usize, const S: usize, const M: usize>(
    &'a [f64],
    &'a mut [f64],
    &'a mut Totals<'b>,
    PhantomData<E>,
);

impl<E: MemoryEffect<N, S, M>, const N: usize, const S: usize, const M: usize> NullaryFnOnce
    for TotalledOn<'_, '_, E, N, S, M>
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.2.add_remembering::<N, S, M, E>(self.0, self.1);
    }
}

struct Chained<'a, 'b, E, const N: usize, const L: usize>(
    &'a [f64],
    &'a [Option<usize>],
    &'a mut Gradient<'b>,
    PhantomData<E>,
);

impl<E: LoadEffect<N>, const N: usize, const L: usize> WithSimd for Chained<'_, '_, E, N, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if S::F64_LANES == WIDE {
            self.2.chain::<WIDE, N, L, E>(self.0, self.1);
        } else {
            self.2.chain::<LANES, N, L, E>(self.0, self.1);
        }
    }
}

struct ChainedOn<'a, 'b, E, const N: usize, const S: usize, const M: usize>(
    &'a [f64],
    &'a [Option<usize>],
    &'a [f64],
    &'a mut Gradient<'b>,
    PhantomData<E>,
);

impl<E: MemoryEffect<N, S, M>, const N: usize, const S: usize, const M: usize> NullaryFnOnce
    for ChainedOn<'_, '_, E, N, S, M>
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.3.chain_remembering::<N, S, M, E>(self.0, self.1, self.2);
    }
}

struct Sensed<'a, 'b, E, const N: usize, const L: usize>(
    &'a [f64],
    &'a [Option<usize>],
    &'a mut Response<'b>,
    PhantomData<E>,
);

impl<E: SensorEffect<N>, const N: usize, const L: usize> NullaryFnOnce for Sensed<'_, '_, E, N, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.2.sense::<N, L, E>(self.0, self.1);
    }
}
