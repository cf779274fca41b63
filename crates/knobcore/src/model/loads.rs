//! What loads the knob at one instant.

use super::Model;
use crate::effects::Id;
use crate::effects::law::Carried;
use crate::motion::{Load, Motion};
use crate::prelude::*;

impl Model {
    /// The sum of the loads on the knob, but for functions of a user's own ([`Model::own_load`]) and at the shaft; `state` has
    /// [`Model::states`] numbers, zero at first.
    #[inline]
    pub fn load<T: Carried>(&self, p: &[T], state: &mut [T], motion: &Motion<T>) -> Load<T> {
        let mut sum = self.steady_load(p);
        self.add_loads(p, state, motion, &mut sum);
        sum
    }

    /// What of it is the same in every motion: what the sum of the others begins with.
    pub fn steady_load<T: Carried>(&self, p: &[T]) -> Load<T> {
        let (still, mut sum) = (Motion::exact(T::ZERO, T::ZERO, T::ZERO, T::ZERO), Load::none());
        for (law, params, _) in &self.steady {
            T::load(*law, p.get(params.clone()).unwrap_or(&[]), &mut [], &still, &mut sum);
        }
        sum
    }

    /// Brings the others into it where it is: to copy a load right after it was written takes longer than most effects.
    #[inline]
    pub fn add_loads<T: Carried>(&self, p: &[T], state: &mut [T], motion: &Motion<T>, sum: &mut Load<T>) {
        for (law, params, states) in &self.loads {
            let own = state.get_mut(states.clone()).unwrap_or(&mut []);
            T::load(*law, p.get(params.clone()).unwrap_or(&[]), own, motion, sum);
        }
    }

    /// The load of one of its effects alone at instants (columns of t, theta, omega, alpha), as one that has seen nothing
    /// before.
    pub fn loads_of(&self, id: Id, [t, theta, omega, alpha]: [&[f64]; 4]) -> Vec<Load<f64>> {
        let p = self.values();
        let own = self.chain(&p).find(|(other, _)| *other == id).map_or(&[][..], |(_, own)| own);
        let instants = t.iter().zip(theta).zip(omega).zip(alpha);
        let load = |(((t, theta), omega), alpha): (((&f64, &f64), &f64), &f64)| {
            let (mut sum, mut state) = (Load::none(), vec![0.0; id.law().states()]);
            id.law().load(own, &mut state, &Motion::exact(*t, *theta, *omega, *alpha), &mut sum);
            sum
        };
        instants.map(load).collect()
    }
}
