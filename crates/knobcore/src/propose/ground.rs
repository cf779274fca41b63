//! What laws are looked for in: what a fitted model leaves, the noise that it is held against, and all that is tried.

use super::chance::Chance;
use super::follow::Reach;
use super::grammar::{Factor, Powers, Variable};
use super::rows::Rows;
use super::scan::functions;
use super::{COARSE, MEDIUM, Search};
use crate::diagnose::Watch;
use crate::floor::{Floor, noises};
use crate::model::Model;
use crate::noise::Noise;
use crate::param::Axis;
use crate::signals::Signals;
use std::sync::OnceLock;

/// Captures beside a fitted model.
pub struct Ground<'a> {
    data: &'a [&'a Signals],
    /// All rows.
    pub fine: Rows<'a>,
    /// The sum of squares.
    pub squares: f64,
    /// What noise leaves of it.
    pub floor: Floor,
    noises: Vec<Noise>,
    /// Rows that tell what is fast, and fewer that tell what is slow.
    pub rows: [Rows<'static>; 2],
    /// How far the motion goes.
    pub reach: Reach,
    powers: Vec<Powers>,
    tried: Vec<Factor>,
    values: [OnceLock<Vec<Vec<f64>>>; 2],
    turns: bool,
}

impl<'a> Ground<'a> {
    /// None where there is nothing to look in, or the noise is not known.
    pub fn of(data: &'a [&'a Signals], model: &Model) -> Option<Self> {
        let (fine, squares) = Rows::of(data, model);
        let noises = noises(data, model);
        let floor = Floor::with(data, &noises);
        let white = floor.white;
        if fine.len() == 0 || !(white > 0.0 && floor.squares.is_finite()) {
            return None;
        }
        let reach = Reach::of(&fine);
        let turns = model.axis == Axis::Rotary;
        Some(Self {
            data,
            squares,
            floor,
            noises: noises.into_iter().map(|noise| noise.unwrap_or(Noise::white(white))).collect(),
            rows: [fine.coarse(MEDIUM), fine.coarse(COARSE)],
            powers: Powers::among(&Variable::ALL),
            tried: functions(&reach, &Variable::ALL, turns),
            values: [OnceLock::new(), OnceLock::new()],
            fine,
            reach,
            turns,
        })
    }

    /// A search in it.
    pub fn search<'s>(&'s self, watch: &'s Watch<'s>) -> Search<'s> {
        Search {
            rows: &self.rows,
            values: &self.values,
            reach: &self.reach,
            powers: &self.powers,
            tried: &self.tried,
            watch,
            white: self.floor.white,
            turns: self.turns,
        }
    }

    /// What such a search finds where nothing is missing.
    pub fn chance(&self) -> Chance<'_> {
        let scanned = (&self.powers[..], &self.tried[..]);
        Chance::of((self.data, &self.noises), &self.rows[1], scanned, self.floor.white)
    }
}
