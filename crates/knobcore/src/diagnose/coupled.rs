//! Couplings, fitted from coarse to fine.
//!
//! The torque of a contact comes in pulses of a few milliseconds: a gap that is a little off moves them, and the
//! error knows no way back once they no longer overlap. Through a slower filter they are broad and do.

use super::screen::{Screen, Start};
use crate::effects::Id;
use crate::error::Result;
use crate::filter::{ZeroPhase, cheby2};
use crate::fit::{Fit, Found, refine, settled, sketch};
use crate::floor::Floor;
use crate::model::Model;
use crate::prepare::slower;
use crate::signals::Signals;

/// Stopband edges at 5 kHz of the filter that the search goes through and of the one in between, Hz.
const COARSE_HZ: f64 = 60.0;
pub(super) const MIDDLE_HZ: f64 = 150.0;
/// Starts that are followed through the coarse filter.
const FOLLOWED: usize = 2;
/// Samples of a capture that the coarse search looks at.
const ENOUGH: usize = 12_000;
/// Share of what noise does not explain that a coupling must explain through the coarse filter.
const WORTH: f64 = 0.25;
/// An error this close to the noise floor needs no better end.
const EXPLAINED: f64 = 1.01;

/// The starts of a coupling beside a screen's model, most promising first, and where they lead to.
pub fn coupled(whole: &Screen<'_>, id: Id) -> (Vec<Start>, Option<(Model, Found)>) {
    let (data, base, watch) = (whole.data, whole.model, whole.watch);
    let coarse = beginnings(data);
    let coarse: Vec<&Signals> = coarse.iter().collect();
    let screen = Screen::new(&coarse, base, watch);
    let starts = screen.starts(id);
    // What is in the model beside the base may load the shaft as well as the knob.
    let beside: Vec<Id> = base.effects().filter(|id| Model::may_be_at_shaft(*id)).collect();
    let both = !beside.is_empty();
    let screen = screen.with_shaft(beside);
    let before = if both { screen.starts(id) } else { Vec::new() };
    let followed = before.iter().take(FOLLOWED).chain(starts.iter().take(FOLLOWED));
    let followed = followed.take_while(|_| watch.wanted());
    let sketched = followed.map(|start| (&start.model, sketch(&coarse, &start.model)));
    let best = sketched.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    // Not worth the fine search, then, at least until what explains more is in the model.
    let excess = screen.squares - Floor::of(&coarse, base).squares;
    let worth = best.filter(|_| watch.wanted());
    let worth = worth.filter(|(_, found)| screen.squares - found.cost >= WORTH * excess || excess.is_nan());
    let fine = worth.map(|(model, found)| {
        let mut model = model.clone();
        model.set_values(&found.p);
        let middle = slowed(data, MIDDLE_HZ);
        model.set_values(&sketch(&middle.iter().collect::<Vec<_>>(), &model).p);
        let fine = sketch(data, &model);
        (model, fine)
    });
    (starts, fine.filter(|(_, found)| found.cost.is_finite()))
}

/// Fits a model from values near its best. The error of one with a coupling is rough at its finest: it is
/// approached through slower filters too, and the best end counts.
///
/// # Errors
/// As of [`crate::fit::fit`].
pub fn converge(data: &[&Signals], model: &Model) -> Result<Fit> {
    let mut best = refine(data, model)?;
    if !model.is_coupled() {
        return settled(data, best, |model| refine(data, model));
    }
    for edges in [&[MIDDLE_HZ][..], &[COARSE_HZ, MIDDLE_HZ]] {
        if best.rmse <= EXPLAINED * best.noise_floor {
            break;
        }
        let mut model = best.model.clone();
        for edge in edges {
            let slow = slowed(data, *edge);
            model = refine(&slow.iter().collect::<Vec<_>>(), &model)?.model;
        }
        let fit = refine(data, &model)?;
        if fit.rmse < best.rmse {
            best = fit;
        }
    }
    settled(data, best, |model| refine(data, model))
}

/// The beginnings of captures through the coarse filter.
pub(super) fn beginnings(data: &[&Signals]) -> Vec<Signals> {
    let beginnings: Vec<Signals> = data.iter().map(|signals| beginning(signals)).collect();
    slowed(&beginnings.iter().collect::<Vec<_>>(), COARSE_HZ)
}

/// The first samples of a capture: enough to find what is then followed through all of it.
fn beginning(signals: &Signals) -> Signals {
    let mut left = ENOUGH;
    let mut segments = Vec::new();
    for segment in &signals.segments {
        let taken = segment.len().min(left);
        left -= taken;
        if taken >= ENOUGH / 10 {
            segments.push(segment.start..segment.start + taken);
        }
    }
    if segments.is_empty() {
        return signals.clone();
    }
    let mut weight = vec![0.0; signals.len()];
    for segment in &segments {
        weight[segment.clone()].copy_from_slice(&signals.weight[segment.clone()]);
    }
    Signals { weight, segments, ..signals.clone() }
}

/// The same captures through a slower measurement filter; without those that are sampled too slowly for it.
pub(super) fn slowed(data: &[&Signals], edge_hz: f64) -> Vec<Signals> {
    let slow = |signals: &&Signals| {
        let edge = edge_hz * slower(signals.rate_hz);
        let filter = ZeroPhase::new(cheby2(3, 20.0, edge, signals.rate_hz).ok()?);
        let mut slow = Signals { filter: Some(filter), substeps: 2, ..Signals::clone(signals) };
        slow.filter_torque();
        Some(slow)
    };
    data.iter().filter_map(slow).collect()
}
