//! What is left without any formula: which variables it is of, where in their plane it lives, and the curve or surface that is a
//! law where no formula is.

use super::Reach;
use super::chance::Chance;
use super::penalized::{Penalized, remains};
use super::rows::Rows;
use super::spline::{self, Smooth, Written};
use super::surface::{self, Map, Surface};
use crate::algebra::dot;
use crate::diagnose::Watch;
use crate::order::firsts;

/// One or two variables that what is left may be of, as a curve or a surface that no formula stands behind.
#[derive(Debug, Clone)]
pub struct Need {
    /// The variables.
    pub variables: Vec<&'static str>,
    /// What remains on blocks that it did not see, as a share of what the model leaves.
    pub heldout: f64,
    /// How often the best of all takes off as much where nothing is missing.
    pub p_value: f64,
}

/// What a model leaves, without a formula.
#[derive(Debug, Clone, Default)]
pub struct Shapes {
    /// What it is of, by curves and surfaces: the one first that does best on blocks that it did not see.
    pub needs: Vec<Need>,
    /// What is left over the best pair of variables.
    pub map: Option<Map>,
    /// A curve or a surface that explains more than every formula, if one does.
    pub written: Option<Written>,
}

/// What a model leaves of some rows, with the fewer that tell what is fast and what is slow, without a formula; `best` is what
/// the best formula takes off less the price of its parameters, in variances of the raw noise. None if it is no longer wanted.
pub fn shapes(
    (fine, [medium, coarse]): (&Rows<'_>, &[Rows<'static>; 2]),
    reach: &Reach,
    chance: &Chance<'_>,
    best: f64,
    watch: &Watch<'_>,
) -> Option<Shapes> {
    let splines = spline::all(coarse, reach, watch);
    watch.step();
    let surfaces = surface::all(coarse, reach, watch);
    watch.step();
    let needs = needs(&splines, &surfaces, coarse, (chance, watch));
    if !watch.wanted() {
        return None;
    }
    let surface = surfaces.first().and_then(|first| first.better(medium, reach));
    let map = surface.as_ref().map(|surface| surface.map(medium));
    // A surface says whatever a curve does: it has to do better on what neither saw.
    let curves = splines.iter().map(|one| one.held.unseen).fold(0.0, f64::min);
    let surface = surface.filter(|_| surfaces.first().is_some_and(|one| one.held.unseen < curves));
    let written = spline::beyond(best, (&splines, surface), fine, reach, chance.white);
    Some(Shapes { needs, map, written })
}

/// What curves and surfaces over some rows say what is left is of, of the same variables the best.
fn needs(
    splines: &[Smooth],
    surfaces: &[Surface],
    rows: &Rows<'_>,
    (chance, watch): (&Chance<'_>, &Watch<'_>),
) -> Vec<Need> {
    let curves = splines.iter().map(|one| (one.variables(), &one.held));
    let mut all: Vec<(Vec<&'static str>, &Penalized)> =
        curves.chain(surfaces.iter().map(|one| (one.variables().to_vec(), &one.held))).collect();
    all.iter_mut().for_each(|(variables, _)| variables.sort_unstable());
    let held: Vec<&Penalized> = all.iter().map(|(_, held)| *held).collect();
    let squares = dot(&rows.residual, &rows.residual);
    let mut found: Vec<Need> = all
        .iter()
        .zip(chance.of_each(&held, watch))
        .map(|((variables, held), p_value)| Need {
            variables: variables.clone(),
            heldout: remains(held.unseen, squares),
            p_value,
        })
        .collect();
    found.sort_by(|a, b| a.heldout.total_cmp(&b.heldout));
    firsts(found, |one, other| one.variables == other.variables)
}
