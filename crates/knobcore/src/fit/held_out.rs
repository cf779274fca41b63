//! The error on blocks that a fit did not see: each part of the blocks, taken in turn, is predicted by the fit to the
//! others.
//!
//! A refit is a Gauss-Newton step by the products of the blocks, and the error after it is predicted by them too: exact
//! where parameters are linear, and near it where the error is smooth and the step short. Behind a contact it is not: a
//! knock that moves by a tenth of its length leaves what its derivative says. Nor is it where a few reversals tell all of
//! a law: without them its step goes anywhere. The prediction can be many times what any refit does: where it says that
//! the parts disagree, the refits are made and looked at.

use super::layout::Layout;
use super::moments::{Blocks, Evaluated, Moments, residuals};
use super::solve::{Normal, least_squares};
use crate::model::Model;
use crate::scalar::WIDE;
use crate::signals::Signals;
use crate::threads::share;

/// Parts that the blocks are held out in.
const FOLDS: usize = 10;
/// Times the error on all blocks from which refits are looked at that are no linear problem.
const DISAGREE: f64 = 1.02;
/// Of what all blocks tell of a parameter the others have to tell at least this share, for a step in it.
const TOLD: f64 = 0.1;
/// Parts of a step that are tried until the error falls on the blocks that it was made for; after these the step in
/// what is linear alone.
const TRIED: [f64; 2] = [1.0, 0.1];

/// Root mean square error on blocks that a fit did not see.
pub fn held_out(
    data: &[&Signals],
    model: &Model,
    layout: &Layout,
    blocks: &[Moments],
    every: f64,
    kept: &[usize],
) -> f64 {
    let Some(first) = blocks.first() else { return f64::NAN };
    let all = Moments::of_all(first.k, blocks);
    let folds = FOLDS.min(blocks.len());
    let own = |fold: usize| blocks.iter().skip(fold).step_by(folds);
    let seen = |fold: usize| {
        let mut seen = all.clone();
        own(fold).for_each(|block| seen.add_scaled(block, -1.0));
        seen
    };
    let step = |seen: &Moments, columns: &[usize]| {
        least_squares(seen, columns).unwrap_or_else(|| vec![0.0; first.k])
    };
    let steps: Vec<Vec<f64>> = (0..folds).map(|fold| step(&seen(fold), kept)).collect();
    let after = |fold: usize| own(fold).map(|block| block.squares_after(&steps[fold]).max(0.0)).sum::<f64>();
    let rows = blocks.iter().map(|block| block.rows).sum::<f64>();
    let predicted = ((0..folds).map(after).sum::<f64>() / rows).sqrt();
    if layout.is_linear() || predicted <= DISAGREE * (all.squares() / rows).sqrt() {
        return predicted;
    }
    let squares: Vec<f64> = blocks.iter().map(Moments::squares).collect();
    let linear = layout.linear();
    let linear: Vec<usize> =
        kept.iter().copied().filter(|column| linear.contains(&layout.free[*column])).collect();
    let variances = |seen: &Moments| Some(Normal::of(|i, j| seen.gram(i, j), kept)?.inverse().diagonal());
    let known = variances(&all);
    // What only the part itself tells stays where it is: no step in it means anything.
    let told = |seen: &Moments| {
        let (Some(known), Some(there)) = (&known, variances(seen)) else { return linear.clone() };
        (0..kept.len()).filter(|i| TOLD * there[*i] <= known[*i]).map(|i| kept[i]).collect()
    };
    let wholly: Vec<Vec<f64>> = (0..folds).map(seen).map(|seen| step(&seen, &told(&seen))).collect();
    let refit = |fold: usize, tried: usize| match TRIED.get(tried) {
        Some(part) => wholly[fold].iter().map(|step| part * step).collect(),
        None => step(&seen(fold), &linear),
    };
    (refitted(data, model, layout, every, &squares, folds, refit).iter().sum::<f64>() / rows).sqrt()
}

/// The sum of squares on each of so many parts of the blocks after the first of the steps, made for the others, that is
/// worth it to them: the `step` of a part that is tried so many times after others.
fn refitted(
    data: &[&Signals],
    model: &Model,
    layout: &Layout,
    every: f64,
    before: &[f64],
    folds: usize,
    step: impl Fn(usize, usize) -> Vec<f64>,
) -> Vec<f64> {
    let p = model.values();
    let own = |squares: &[f64], fold: usize| squares.iter().skip(fold).step_by(folds).sum::<f64>();
    let others = |squares: &[f64], fold: usize| squares.iter().sum::<f64>() - own(squares, fold);
    let mut left: Vec<f64> = (0..folds).map(|fold| own(before, fold)).collect();
    let mut open: Vec<usize> = (0..folds).collect();
    for tried in 0..=TRIED.len() {
        let sets = open.iter().map(|fold| layout.moved(model, &p, &step(*fold, tried))).collect();
        let ends = open.iter().copied().zip(blocks_after(data, model, every, sets));
        let worth = |(fold, after): &(usize, Vec<f64>)| {
            after.len() == before.len() && others(after, *fold) <= others(before, *fold)
        };
        let (moved, still): (Vec<_>, Vec<_>) = ends.partition(worth);
        moved.iter().for_each(|(fold, after)| left[*fold] = own(after, *fold));
        open = still.into_iter().map(|(fold, _)| fold).collect();
    }
    left
}

/// The sum of squares of each block with each of these sets of parameters, which are evaluated side by side.
fn blocks_after(data: &[&Signals], model: &Model, every: f64, sets: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut blocks: Vec<Blocks> = sets.iter().map(|_| Blocks::of(every)).collect();
    let most = sets.len().div_ceil(sets.len().div_ceil(WIDE).max(1)).max(1);
    let together = sets.chunks(most).zip(blocks.chunks_mut(most)).collect();
    share(together, |(sets, blocks): (&[Vec<f64>], &mut [Blocks])| {
        residuals(data, model, sets, |evaluated| {
            for (blocks, column) in blocks.iter_mut().zip(evaluated.columns) {
                let Evaluated { capture, signals, .. } = *evaluated;
                let rows = evaluated.rows.clone();
                blocks.add(&Evaluated { capture, signals, rows, columns: &[column] });
            }
        });
    });
    blocks.into_iter().map(|blocks| blocks.done().iter().map(Moments::squares).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::moments::evaluate;
    use super::super::tests::turned;
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;
    use crate::predict;
    use crate::random::Noise;

    #[test]
    fn a_refit_goes_as_far_as_the_other_blocks_gain_and_stays_where_they_lose() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        let values =
            [("inertia.M", 1e-4), ("coulomb.neg", 4e-3), ("coulomb.pos", 4e-3), ("backlash.gap", 0.02)];
        let contact = [("backlash.k", 20.0), ("backlash.d", 0.02), ("backlash.share", 0.6)];
        values.iter().chain(&contact).for_each(|(name, value)| model.set(name, *value).unwrap());
        let mut data = turned(0.3, 0.0, |_, _| 0.0);
        data.tau = predict::torque_raw(&model, &data);
        model.set("backlash.gap", 0.0207).unwrap();
        let layout = Layout::of(&model);
        let mut blocks = Blocks::of(20.0);
        evaluate(&[&data], &model, &model.values(), &layout.seeds(&model), |evaluated| blocks.add(evaluated));
        let before: Vec<f64> = blocks.done().iter().map(Moments::squares).collect();
        let gap = model.index("backlash.gap").unwrap();
        let after = |by: f64| {
            let step: Vec<f64> = layout.free.iter().map(|at| if *at == gap { by } else { 0.0 }).collect();
            let part = |_, tried: usize| {
                let part = TRIED.get(tried).copied().unwrap_or(0.0);
                step.iter().map(|step| part * step).collect()
            };
            refitted(&[&data], &model, &layout, 20.0, &before, 10, part)[3]
        };
        let still: f64 = before.iter().skip(3).step_by(10).sum();
        assert!(still > 0.0 && after(-0.0007) < 1e-12 * still);
        assert_eq!(after(0.005), still);
        // Ten times too far, which a tenth of the way mends.
        assert!(after(-0.007) < 1e-12 * still);
    }

    #[test]
    fn a_law_that_one_reversal_tells_is_not_refuted_by_blocks_without_it() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Presliding).unwrap();
        let knob = [("inertia.M", 1e-4), ("coulomb.neg", 4e-3), ("coulomb.pos", 5e-3)];
        let bristles = [("presliding.s", 0.04), ("presliding.w5", 0.35), ("presliding.w6", 0.6)];
        knob.iter().chain(&bristles).for_each(|(name, value)| model.set(name, *value).unwrap());
        let mut data = turned(0.3, 0.0, |_, _| 0.0);
        for (i, t) in data.t.iter().enumerate() {
            let turn = 1.2 * t + 0.7;
            data.theta[i] = -30.0 * turn.cos();
            data.omega[i] = 36.0 * turn.sin();
            data.alpha[i] = 43.2 * turn.cos();
            data.forward[i] = f64::from(u8::from(data.omega[i] > 0.0));
        }
        let mut noise = Noise::new(5);
        data.tau_raw =
            predict::torque_raw(&model, &data).iter().map(|tau| tau + 3e-4 * noise.normal()).collect();
        data.tau = data.tau_raw.clone();
        // Somewhat off, so that there is a step to make, of which that reversal tells all.
        model.set("presliding.s", 0.09).unwrap();
        let layout = Layout::of(&model);
        let mut blocks = Blocks::of(50.0);
        evaluate(&[&data], &model, &model.values(), &layout.seeds(&model), |evaluated| blocks.add(evaluated));
        let blocks = blocks.done();
        let all: Vec<usize> = (0..layout.free.len()).collect();
        let seen = (Moments::of_all(all.len(), &blocks).squares() / data.len() as f64).sqrt();
        let unseen = held_out(&[&data], &model, &layout, &blocks, 50.0, &all);
        assert!((0.9..1.1).contains(&(unseen / seen)), "{unseen} {seen}");
    }
}
