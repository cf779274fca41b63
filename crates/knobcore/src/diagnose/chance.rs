//! What an effect would do to the torque, and what becomes of it where it is multiplied with noise.

use super::screen::Screen;
use super::thinned::{Thinned, whole};
use crate::algebra::{orthonormal, orthonormal_beside};
use crate::effects::Id;
use crate::model::Model;
use crate::noise::Noise;
use crate::signals::Signals;

/// Samples that are looked at: what chance gives does not depend on how many there are.
const ENOUGH: usize = 30_000;

/// Signatures, and what they become on the way back through the measurement filter and the noise's colour: the products
/// of a signature with noise behind the filter are those of the latter with white noise.
pub struct Chance<'a> {
    screen: &'a Screen<'a>,
    noises: &'a [Noise],
    thinned: Thinned,
    /// Rows of a signature; as many follow of what it becomes.
    rows: usize,
    base: Vec<Vec<f64>>,
}

impl<'a> Chance<'a> {
    pub fn of(screen: &'a Screen<'a>, noises: &'a [Noise]) -> Self {
        let thinned = Thinned::of(screen.data, ENOUGH);
        let mut chance = Self { screen, noises, rows: thinned.rows(), thinned, base: Vec::new() };
        let free: Vec<usize> = screen.model.free().collect();
        chance.base = orthonormal(&chance.both(screen.data, screen.model, &free), chance.rows);
        chance
    }

    /// Derivative columns and what they become, one after the other, thinned.
    fn both(&self, data: &[&Signals], model: &Model, params: &[usize]) -> Vec<Vec<f64>> {
        let mut columns = whole(data, model, params);
        let mut both: Vec<Vec<f64>> = columns.iter().map(|column| self.thinned.pick(data, column)).collect();
        // The filter runs forward and backward and so is its own transpose, up to its ends, which do not count.
        let mut from = 0;
        for (signals, noise) in data.iter().zip(self.noises) {
            for segment in &signals.segments {
                let to = from + segment.len();
                let mut parts: Vec<&mut [f64]> =
                    columns.iter_mut().map(|column| &mut column[from..to]).collect();
                signals.measure(&mut parts);
                parts.iter_mut().for_each(|part| noise.colour_back(part));
                from = to;
            }
        }
        both.iter_mut().zip(&columns).for_each(|(both, column)| both.extend(self.thinned.pick(data, column)));
        both
    }

    /// What the orthonormal derivative columns of a start, off those of the model, become.
    pub fn signature(&self, id: Id, model: &Model) -> Vec<Vec<f64>> {
        let (shown, own) = self.screen.shown(model, self.screen.brought(id, model));
        let columns = self.both(&self.screen.seen_by(id, model), &shown, &own);
        let beside = orthonormal_beside(&self.base, &columns, self.rows);
        beside.into_iter().map(|mut both| both.split_off(self.rows)).collect()
    }
}
