//! The passes of one descent: derivative columns that none of its steps changes are worked out once.

use super::moments::{Moments, evaluate, used};
use crate::model::Model;
use crate::predict::Seeds;
use crate::signals::Signals;

/// Numbers that are kept at most: memory does not grow with a capture.
const MOST: usize = 1 << 22;

/// The normal equations at one set of parameters after another.
pub struct Passes<'a> {
    data: &'a [&'a Signals],
    model: &'a Model,
    /// All columns, and those that change.
    seeds: [Seeds; 2],
    /// Which columns last.
    lasts: Vec<bool>,
    /// Of these what the first pass left, chunk by chunk.
    kept: Vec<Vec<Vec<f64>>>,
}

impl<'a> Passes<'a> {
    /// None is made yet; for a descent in these free parameters, in one step or in several.
    pub fn of(data: &'a [&'a Signals], model: &'a Model, free: &[usize], several: bool) -> Self {
        let samples: usize = data.iter().map(|signals| signals.len()).sum();
        let mut lasts: Vec<bool> = free.iter().map(|&i| model.lasts(i)).collect();
        let lasting = lasts.iter().filter(|lasts| **lasts).count();
        // What is solved in one pass has no second one.
        if !several || samples * lasting > MOST {
            lasts.fill(false);
        }
        let changing: Vec<usize> =
            free.iter().zip(&lasts).filter(|(_, lasts)| !**lasts).map(|(&i, _)| i).collect();
        let seeds = [Seeds::of(model, free), Seeds::of(model, &changing)];
        Self { data, model, seeds, lasts, kept: Vec::new() }
    }

    /// The normal equations at `p`.
    pub fn moments(&mut self, p: &[f64]) -> Moments {
        let Self { data, model, seeds: [all, changing], lasts, kept } = self;
        let mut sum = Moments::empty(all.columns());
        if kept.is_empty() {
            evaluate(data, model, p, all, |evaluated| {
                sum.add_columns(evaluated.columns);
                let lasting = evaluated.columns.iter().zip(lasts.iter()).filter(|(_, lasts)| **lasts);
                kept.push(lasting.map(|(column, _)| column.to_vec()).collect());
            });
        } else {
            let mut chunks = kept.iter();
            evaluate(data, model, p, changing, |evaluated| {
                let mut lasting = chunks.next().into_iter().flatten().map(Vec::as_slice);
                let mut fresh = evaluated.columns.iter().copied();
                // The residual comes last.
                let columns = lasts.iter().chain([&false]);
                let columns = columns.filter_map(|lasts| if *lasts { lasting.next() } else { fresh.next() });
                sum.add_columns(&columns.collect::<Vec<_>>());
            });
        }
        sum.rows = used(data);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::moments::moments;
    use super::super::tests::turned;
    use super::*;
    use crate::effects::{Id, Place};
    use crate::param::Axis;

    fn knob(effects: &[Id]) -> Model {
        let bare = Model::equation_1(Axis::Rotary, false);
        effects.iter().fold(bare, |model, id| model.with(*id).unwrap())
    }

    #[test]
    fn a_later_pass_is_what_all_of_it_would_be_to_the_last_bit() {
        let signals = [turned(0.9, 1e-3, |_, _| 0.0), turned(0.3, 1e-3, |theta, _| 1e-3 * theta)];
        let data = signals.each_ref();
        let bare = knob(&[Id::Detent]);
        // At neutral values a hidden knob weighs nothing.
        let rigid = Id::BUILT_IN.iter().filter(|id| id.info().place != Place::Coupling);
        let mut models: Vec<Model> = rigid.filter_map(|id| bare.with(*id).ok()).collect();
        models.extend([Id::LoadFriction, Id::Unbalance, Id::TorqueLag].map(|id| knob(&[Id::Stribeck, id])));
        let mut lasting = 0;
        for model in models {
            let free: Vec<usize> = model.free().collect();
            let mut passes = Passes::of(&data, &model, &free, true);
            lasting += passes.lasts.iter().filter(|lasts| **lasts).count();
            let mut p = model.values();
            for step in [0.0, 0.2, 0.7] {
                for &at in &free {
                    let bounds = model.slots()[at].param;
                    p[at] = (p[at] + step * (1e-3 + 0.3 * p[at].abs())).clamp(bounds.lower, bounds.upper);
                }
                let whole = moments(&data, &model, &p, &Seeds::of(&model, &free));
                assert_eq!(passes.moments(&p), whole, "{:?}", model.effects().collect::<Vec<_>>());
            }
        }
        assert!(lasting > 70, "{lasting}");
    }

    #[test]
    fn of_captures_that_are_too_long_nothing_is_kept() {
        let (signals, model) = (turned(0.9, 1e-3, |_, _| 0.0), knob(&[]));
        let free: Vec<usize> = model.free().collect();
        let kept = |captures: usize, several: bool| {
            let data = vec![&signals; captures];
            Passes::of(&data, &model, &free, several).lasts.contains(&true)
        };
        let most = MOST / (5 * signals.len());
        assert!(kept(most, true) && !kept(most + 1, true) && !kept(1, false));
    }

    #[test]
    fn what_others_shape_does_not_last() {
        let lasting = |effects: &[Id]| {
            let model = knob(effects);
            let free = model.free().filter(|i| model.lasts(*i)).map(|i| model.slots()[i].name());
            free.collect::<Vec<_>>().join(" ")
        };
        let plain = "inertia.M coulomb.neg coulomb.pos viscous.neg viscous.pos";
        assert_eq!(lasting(&[]), plain);
        assert_eq!(lasting(&[Id::Detent]), plain);
        assert_eq!(lasting(&[Id::Stribeck]), "inertia.M viscous.neg viscous.pos");
        for id in [Id::LoadFriction, Id::TorqueLag, Id::Compliance, Id::Saturation] {
            assert_eq!(lasting(&[id]), "", "{id:?}");
        }
    }
}
