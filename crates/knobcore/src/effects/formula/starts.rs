//! Where a search for the parameters of a law begins.

use crate::effects::Survey;
use crate::param::{Kind, Param, Usual};
use crate::prelude::*;

/// Starts of a search at most.
const STARTS: usize = 27;

/// Parameter values to start a search from: shapes at a part of what the motion goes through, by their units.
pub(crate) fn starts(params: &[Param], survey: &Survey) -> Vec<Vec<f64>> {
    let speed = |q| Survey::quantile(&survey.speed, q).max(1e-6);
    let scales =
        [Survey::quantile(&survey.torque, 0.5), survey.range(), survey.duration_s].map(|x| x.max(1e-9));
    let sizes = |param: &Param| match param.unit.powers() {
        _ if param.kind == Kind::Linear => vec![0.0],
        [0, 1, -1] if param.usual == Usual::Fixed => vec![speed(0.9)],
        [0, 1, -1] => vec![speed(0.2), speed(0.5), speed(0.9)],
        // No exponent of a speed sets out from friction's own powers, where its slope says nothing.
        [0, 0, 0] => vec![0.6, 1.6],
        _ => [0.1, 0.4].map(|share| param.unit.sized(scales.map(|size| share * size))).to_vec(),
    };
    let mut all = vec![Vec::new()];
    for param in params {
        let sizes = sizes(param);
        let sizes = if all.len() * sizes.len() > STARTS { &sizes[..1] } else { &sizes[..] };
        let within = |x: &f64| x.max(param.lower).min(param.upper);
        all = all
            .iter()
            .flat_map(|before| sizes.iter().map(|x| [&before[..], &[within(x)]].concat()).collect::<Vec<_>>())
            .collect();
    }
    all
}
