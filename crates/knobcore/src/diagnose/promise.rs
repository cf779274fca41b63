//! What a step from each start of an effect promises to leave.

use super::chance::Chance;
use super::chosen::scanned;
use super::screen::{Screen, Start};
use crate::algebra::{dot, orthonormal_beside, project, subtract};
use crate::effects::{Id, Place};
use crate::model::{Model, Slot};
use crate::order::Ascending;
use crate::scalar::WIDE;

impl Screen<'_> {
    /// Models with an effect as starts, most promising first.
    pub fn by_promise(&self, id: Id, models: Vec<Model>) -> Vec<Start> {
        let mut starts: Vec<Start> = if id.info().place == Place::Coupling && !self.coupled {
            let start = |(model, predicted)| Start { model, predicted, by_chance: Vec::new() };
            let predicted = self.joined(&models);
            models.into_iter().zip(predicted).map(start).collect()
        } else {
            let wanted = models.into_iter().take_while(|_| self.watch.wanted());
            wanted.map(|model| self.start(id, model)).collect()
        };
        starts.retain(|start| start.predicted.is_finite());
        starts.sort_by_cached_key(|start| Ascending(start.predicted));
        starts
    }

    /// The same of starts of joints, which bring no columns in: as many are simulated side by side as a register has
    /// lanes.
    fn joined(&self, models: &[Model]) -> Vec<f64> {
        let of = |slot: &Slot| (slot.effect, slot.param.name, slot.run.clone());
        let alike = |a: &Model, b: &Model| {
            a.shafts() == b.shafts() && a.slots().iter().map(of).eq(b.slots().iter().map(of))
        };
        let side_by_side = models.chunk_by(alike).flat_map(|alike| alike.chunks(WIDE));
        let mut predicted = Vec::with_capacity(models.len());
        for few in side_by_side.take_while(|_| self.watch.wanted()) {
            let sets: Vec<Vec<f64>> = few.iter().map(Model::values).collect();
            for (residual, _) in self.thinned.residuals(self.data, &few[0], &sets) {
                predicted.push(self.promised(residual, &[]).0);
            }
        }
        predicted
    }

    fn start(&self, id: Id, model: Model) -> Start {
        let (columns, residual) = self.signature(id, &model);
        let residual = if self.coupled { self.residual.clone() } else { residual };
        let (predicted, beside) = self.promised(residual, &columns);
        // A wave that the data choose is told of by its frequency.
        let chance = self.chance.as_ref().filter(|_| !scanned(id));
        let by_chance = chance.map_or_else(Vec::new, |chance| met(chance, &beside));
        Start { model, predicted, by_chance }
    }

    /// The columns that an effect brings in, and the residual.
    fn signature(&self, id: Id, model: &Model) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (shown, own) = self.shown(model, self.brought(id, model));
        let (columns, residual, _) = self.thinned.columns(&self.seen_by(id, model), &shown, &own);
        (columns, residual)
    }

    /// What becomes of an effect's signature beside the model's columns where it is multiplied with noise.
    pub fn by_chance(&self, chance: &Chance, id: Id, model: &Model) -> Vec<Vec<f64>> {
        let (columns, residual) = self.signature(id, model);
        met(chance, &orthonormal_beside(&self.base, &columns, residual.len()))
    }

    /// What these columns and those of the base leave of the sum of squares, where this is the residual, and what they
    /// span beside the base.
    fn promised(&self, mut residual: Vec<f64>, columns: &[Vec<f64>]) -> (f64, Vec<Vec<f64>>) {
        let rows = residual.len();
        project(&mut residual, &self.base, rows);
        let beside = orthonormal_beside(&self.base, columns, rows);
        beside.iter().for_each(|direction| subtract(&mut residual, direction, rows));
        // What thinning changes is in both.
        (self.squares - dot(&self.residual, &self.residual) + dot(&residual, &residual), beside)
    }
}

fn met(chance: &Chance, directions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    directions.iter().map(|direction| chance.met_by(direction)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::super::watch::Watch;
    use super::*;
    use crate::fit::{refine, sketch};

    #[test]
    fn a_step_promises_of_what_is_linear_what_a_fit_then_takes_off() {
        let mut truth = knob(&[Id::ReturnSpring], &[("return_spring.k", 2e-3)]);
        truth.set("coulomb.pos", 6e-3).unwrap();
        let data = recorded(&truth, "a");
        let data = [&data];
        let base = refine(&data, &knob(&[], &[])).unwrap().model;
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &base, &watch);
        for id in [Id::QuadraticDrag, Id::Unbalance] {
            let start = &screen.starts(id)[0];
            let end = sketch(&data, &start.model).cost;
            assert!((start.predicted / end - 1.0).abs() < 0.02, "{id:?}: {} {end}", start.predicted);
            assert!(end < screen.squares);
        }
    }

    #[test]
    fn of_detents_that_are_the_harmonic_of_slower_ones_a_step_promises_what_a_fit_then_takes_off() {
        let detents =
            [("detent.A", 6e-3), ("detent.P", 0.1), ("detent.S", 0.3), ("detent_harmonics.A2", 0.03)];
        let truth = knob(&[Id::Detent, Id::DetentHarmonics], &detents);
        let data = recorded(&truth, "a");
        let data = [&data];
        let half = [("detent.A", 0.03), ("detent.P", 0.05), ("detent.S", 0.3)];
        let base = refine(&data, &knob(&[Id::Detent], &half)).unwrap().model;
        let watch = Watch::new(&|_| true, 1);
        let screen = Screen::new(&data, &base, &watch);
        let start = &screen.starts(Id::DetentHarmonics)[0];
        let period = start.model.values()[start.model.period().unwrap()];
        let end = sketch(&data, &start.model).cost;
        assert!((period / 0.1 - 1.0).abs() < 0.01 && end < 0.5 * screen.squares, "{period}");
        assert!((start.predicted / end - 1.0).abs() < 0.1, "{} {end}", start.predicted);
    }
}
