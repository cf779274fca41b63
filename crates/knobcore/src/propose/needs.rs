//! Which variables what is left is of, before anybody has a formula for it.

use super::chance::Chance;
use super::penalized::Penalized;
use super::rows::Rows;
use super::spline::Smooth;
use super::surface::Surface;
use crate::algebra::dot;
use crate::diagnose::Watch;

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

/// What curves and surfaces over some rows say what is left is of, of the same variables the best.
pub fn needs(
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
            heldout: (1.0 + held.unseen / squares).max(0.0).sqrt(),
            p_value,
        })
        .collect();
    found.sort_by(|a, b| a.heldout.total_cmp(&b.heldout));
    let mut apart: Vec<Need> = Vec::new();
    for one in found {
        if !apart.iter().any(|other| other.variables == one.variables) {
            apart.push(one);
        }
    }
    apart
}
