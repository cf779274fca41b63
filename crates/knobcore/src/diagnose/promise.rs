//! What a step from each start of an effect promises to leave.

use super::screen::{Screen, Start};
use crate::algebra::{dot, orthonormal_beside, project, subtract};
use crate::effects::{Id, Place};
use crate::model::{Model, Slot};
use crate::order::Ascending;
use crate::scalar::WIDE;

impl Screen<'_> {
    /// Models with an effect as starts, most promising first.
    pub fn by_promise(&self, id: Id, models: Vec<Model>) -> Vec<Start> {
        let predicted: Vec<f64> = if id.info().place == Place::Coupling && !self.coupled {
            self.joined(&models)
        } else {
            let wanted = models.iter().take_while(|_| self.watch.wanted());
            wanted.map(|model| self.predicted(id, model)).collect()
        };
        let start = |(model, predicted)| Start { model, predicted };
        let mut starts: Vec<Start> = models.into_iter().zip(predicted).map(start).collect();
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
                predicted.push(self.promised(residual, &[]));
            }
        }
        predicted
    }

    fn predicted(&self, id: Id, model: &Model) -> f64 {
        let (shown, own) = self.shown(model, self.brought(id, model));
        let (columns, residual, _) = self.thinned.columns(&self.seen_by(id, model), &shown, &own);
        self.promised(if self.coupled { self.residual.clone() } else { residual }, &columns)
    }

    /// What these columns and those of the base leave of the sum of squares, where this is the residual.
    fn promised(&self, mut residual: Vec<f64>, columns: &[Vec<f64>]) -> f64 {
        let rows = residual.len();
        project(&mut residual, &self.base, rows);
        for direction in orthonormal_beside(&self.base, columns, rows) {
            subtract(&mut residual, &direction, rows);
        }
        // What thinning changes is in both.
        self.squares - dot(&self.residual, &self.residual) + dot(&residual, &residual)
    }
}
