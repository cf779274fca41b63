//! From prepared signals to parameters with intervals.

pub mod begun;
mod bootstrap;
mod detents;
mod expected;
mod held_out;
mod hidden;
mod layout;
mod moments;
mod orders;
mod parts;
mod passes;
mod runs;
mod scan;
mod separable;
mod serial;
mod solve;
mod status;
mod through;
mod trial;
mod undetermined;
mod uneven;
mod worth;

pub use expected::Expected;
pub use hidden::{behind, knocks, loads};
pub use moments::Moments;
pub(crate) use moments::{add_products, evaluate, residuals, used};
pub use orders::beside as beside_orders;
pub(crate) use runs::{differ, runs, settled};
pub use scan::Scan;
pub(crate) use scan::{band, range};
pub use separable::Found;
pub(crate) use solve::least;
pub use status::Status;
pub(crate) use through::{Shown, Through};
pub use undetermined::Undetermined;

use crate::effects::{Id, Wave};
use crate::error::{Error, Result};
use crate::floor::{Floor, loudest};
use crate::model::{Model, Role};
use crate::predict::Seeds;
use crate::signals::Signals;
use crate::special::Z95;
use detents::{Judge, beginning, best_from_scan, scan_beside};
use expected::sandwich;
use held_out::held_out;
use layout::Layout;
use moments::{Blocks, measured_squares};
use nalgebra::DMatrix;
use parts::Parts;
use separable::{Effort, at_least_own, descend};
use serial::{Meat, serial, thinned};
use solve::{Normal, independent, solvable};
use std::cell::OnceCell;
use undetermined::{silent, tame, undetermined, unheard};
use uneven::louder;

/// Blocks of the block bootstrap and of the held-out error.
const BLOCKS: f64 = 200.0;

/// Less than this share of the mean square error is no more than what the noise floor itself is unsure by.
const SEEN: f64 = 0.04;

/// How to find the detents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detents {
    /// Add them to the model where the data show them.
    Find,
    /// Take the model as it is; a free detent period is found from the data.
    #[default]
    AsModel,
}

/// A fitted model.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model at its best parameters.
    pub model: Model,
    /// The free parameters that the data determine, as indices into the slots of the model.
    pub free: Vec<usize>,
    /// Their covariance, with correlated residuals, and with what the model misses where it misses something.
    pub covariance: DMatrix<f64>,
    /// What the data say nothing about; those values are not results.
    pub undetermined: Vec<Undetermined>,
    /// Root mean square error, N m.
    pub rmse: f64,
    /// The same on blocks that the fit did not see.
    pub rmse_heldout: f64,
    /// What the torque sensor's noise alone would leave, N m.
    pub noise_floor: f64,
    /// What noise alone would leave of the sum of squares, in variances of the raw torque's white noise.
    pub white_squares: f64,
    /// Accepted steps.
    pub iterations: usize,
    /// Passes over the data.
    pub evaluations: usize,
    /// Why it stopped.
    pub status: Status,
    /// The detent scan, where one was made.
    pub scan: Option<Scan>,
    /// Normal equations of consecutive blocks at the optimum.
    pub blocks: Vec<Moments>,
    /// Columns of `blocks` that the data determine.
    kept: Vec<usize>,
    /// Samples that count.
    used: f64,
}

/// Fits `model` to one or several captures of the same knob; what belongs to a run may differ between them.
///
/// # Errors
/// The captures hold no sample that counts, fewer samples than parameters, or differ in axis.
pub fn fit(data: &[&Signals], model: &Model, detents: Detents) -> Result<Fit> {
    check(data, model)?;
    let model = model.among(&runs(data));
    settled(data, found(data, &model, detents)?, |model| found(data, model, detents))
}

/// The model as it is, and the detents that are asked for.
fn found(data: &[&Signals], model: &Model, detents: Detents) -> Result<Fit> {
    let silent = silent(data, model);
    let mut model = model.clone();
    for name in &silent {
        model.set_role(name, Role::Fixed)?;
    }
    let mut start = Start { model: model.clone(), found: None, scan: None };
    let loudest = loudest(data);
    let period = model.index("detent.P").is_ok_and(|i| model.slots()[i].role == Role::Free);
    if detents == Detents::Find || period {
        start = scanned(data, &model, detents, &loudest)?.unwrap_or(start);
    }
    let Start { model, found, scan } = start;
    let layout = Layout::of(&model);
    let found = match found {
        Some(found) if !model.is_coupled() => found,
        found => at_least_own(found, data, &model, &layout),
    };
    let mut fit = finish(data, model, &layout, found, scan, &loudest, true)?;
    for name in silent {
        fit.model.set_role(&name, Role::Free)?;
        fit.undetermined.push(Undetermined { name, why: unheard(data.len()) });
    }
    Ok(fit)
}

/// Fits `model` from the values that it has: no scan for detents, no search; for a model that is near its best.
///
/// # Errors
/// As of [`fit`].
pub fn refine(data: &[&Signals], model: &Model) -> Result<Fit> {
    check(data, model)?;
    let layout = Layout::of(model);
    let found = descend(data, model, &layout, &model.values(), Effort::Full);
    finish(data, model.clone(), &layout, found, None, &loudest(data), true)
}

/// Sinusoids over position that a scan beside a model finds: amplitude, period over 2 pi and phase of the best.
pub fn waves(data: &[&Signals], model: &Model, wave: Wave) -> Vec<[f64; 3]> {
    if wave == Wave::Orders {
        return orders::waves(data, model);
    }
    let linear = Layout::of(model).linear();
    let Some((scan, _)) = scan::scan(data, model, &model.values(), &linear, wave) else { return Vec::new() };
    scan.peaks().iter().take(4).map(|peak| [peak.amplitude, peak.period, peak.phase]).collect()
}

/// The values that a sketchy descent from those of `model` ends with.
pub fn sketch(data: &[&Signals], model: &Model) -> Found {
    sketch_within(data, model, f64::INFINITY)
}

/// The same, given up where an RMS error of so much seems out of reach.
pub fn sketch_within(data: &[&Signals], model: &Model, rmse: f64) -> Found {
    let most = rmse.powi(2) * used(data);
    descend(data, model, &Layout::of(model), &model.values(), Effort::Within(most))
}

/// The values that a few steps from those of `model` lead to.
pub fn glance(data: &[&Signals], model: &Model) -> Found {
    descend(data, model, &Layout::of(model), &model.values(), Effort::Glance)
}

/// What is to be reported where a search ended that weighs one model against others: its intervals are those of noise
/// alone.
///
/// # Errors
/// As of [`fit`].
pub fn report(data: &[&Signals], model: &Model, found: Found) -> Result<Fit> {
    check(data, model)?;
    finish(data, model.clone(), &Layout::of(model), found, None, &loudest(data), false)
}

/// A model to finish with, and what is known of its optimum.
struct Start {
    model: Model,
    found: Option<Found>,
    scan: Option<Scan>,
}

/// Looks for detents; None where there is no motion to scan over.
fn scanned(data: &[&Signals], model: &Model, detents: Detents, loudest: &[f64]) -> Result<Option<Start>> {
    let Some((bare, without, scan)) = scan_beside(data, model) else { return Ok(None) };
    let full = if model.has(Id::Detent) { model.clone() } else { bare.with(Id::Detent)? };
    let best = || best_from_scan(data, &full, &Layout::of(&full), &beginning(&full, &bare, &without)?, &scan);
    let with = if detents == Detents::AsModel {
        best()?
    } else {
        let floor = OnceCell::new();
        let judge = Judge { data, bare: &bare, without: &without, scan: &scan, loudest, floor };
        let found = if judge.promising() { best()? } else { None };
        let there = match found {
            Some(with) if judge.are_there(&full, &with)? => Some(with),
            _ => None,
        };
        match judge.beside_smooth(&full, there.as_ref())?.or(there) {
            None => return Ok(Some(Start { model: bare, found: Some(without), scan: Some(scan) })),
            with => with,
        }
    };
    let evaluations = without.evaluations;
    let found = with.map(|with| Found { evaluations: with.evaluations + evaluations, ..with });
    Ok(Some(Start { model: full, found, scan: Some(scan) }))
}

fn check(data: &[&Signals], model: &Model) -> Result<()> {
    if data.iter().any(|signals| signals.axis != model.axis) {
        return Err(Error::invalid(
            "model",
            "is of another kind of axis than the capture; give both as rotary or both as linear",
        ));
    }
    let constant = |signals: &&Signals| {
        let mut tau = signals.segments.iter().flat_map(|segment| &signals.tau_raw[segment.clone()]);
        let first = tau.next();
        tau.all(|tau| Some(tau) == first)
    };
    if data.iter().all(constant) {
        return Err(Error::invalid(
            "tau",
            "is the same in every sample; check that the torque sensor was connected and mapped",
        ));
    }
    let still = |signals: &&Signals| signals.theta.iter().all(|x| Some(x) == signals.theta.first());
    if data.iter().all(still) {
        return Err(Error::invalid(
            "theta",
            "never moves; record a motion, or map the column that holds the angle",
        ));
    }
    let used: usize = data.iter().map(|signals| signals.used()).sum();
    let free = Layout::of(model).free.len();
    if used <= 2 * free + 10 {
        let said = format!("has {used} samples that count, too few to fit {free} parameters");
        // Nobody knows which way what hardly moves is going, nor what moves faster than its readings show.
        let unknown = ": its direction is not known anywhere, as it moves too little, or too fast for its readings; \
                       move more or log faster, map a velocity (omega), or prepare it with --prepare paper";
        return Err(Error::invalid(
            "capture",
            said + if used == 0 { unknown } else { "; record longer, or mask less" },
        ));
    }
    Ok(())
}

/// Everything that is reported about the optimum; `wholly` with what a missing effect does to the intervals.
fn finish(
    data: &[&Signals],
    mut model: Model,
    layout: &Layout,
    found: Found,
    scan: Option<Scan>,
    loudest: &[f64],
    wholly: bool,
) -> Result<Fit> {
    model.set_values(&found.p);
    let seeds = layout.seeds(&model);
    let k = layout.free.len();
    let used = used(data);
    let floor = Floor::below(loudest, data, &model).if_left(found.cost, data, &model);
    // The part of the mean square error that noise does not explain; none where noise is unknown.
    let excess = (1.0 - floor.squares / found.cost).max(0.0);
    let mut parts = (wholly && excess > SEEN).then(|| Parts::of(data, k));
    let mut blocks = Blocks::of(used / BLOCKS);
    let every = data.iter().map(|signals| signals.spacing()).min().unwrap_or(1);
    let mut residuals: Vec<Vec<f64>> =
        data.iter().map(|signals| Vec::with_capacity(signals.len() / every + 1)).collect();
    evaluate(data, &model, &found.p, &seeds, |evaluated| {
        blocks.add(evaluated);
        if let Some(parts) = &mut parts {
            parts.add(evaluated);
        }
        let rest = thinned(evaluated, every).map(|row| evaluated.columns[k][row]);
        residuals[evaluated.capture].extend(rest);
    });
    let blocks = blocks.done();
    let at = Moments::of_all(k, &blocks);
    let gram = |i: usize, j: usize| at.gram(i, j);
    let total = measured_squares(data);
    let kept = solvable(gram, independent(gram, &tame(&model, layout, &at, total)));
    let serial = serial(&residuals.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let mut meat = Meat::new(&serial, k, every);
    if serial.coefficients.is_empty() {
        meat.of_white(gram);
    } else {
        evaluate(data, &model, &found.p, &seeds, |evaluated| meat.add(evaluated));
    }
    let covariance = match Normal::of(gram, &kept) {
        Some(normal) => {
            let bread = normal.inverse();
            let middle =
                DMatrix::from_fn(kept.len(), kept.len(), |i, j| meat.products[kept[i] * k + kept[j]]);
            let degrees = used / (used - kept.len() as f64);
            let sandwich = sandwich(&bread, &middle);
            let louder = louder(&blocks, &kept, &bread, every as f64);
            let by_parts = parts.map(|parts| parts.variances(&kept));
            // What is missing is no noise: what comes back of it adds to what noise with a memory does.
            let wider = |i: usize| {
                let more = by_parts.as_ref().map_or(0.0, |all| all[kept[i]]);
                (louder[i] + excess * more / (sandwich[(i, i)] * degrees)).sqrt()
            };
            let wider: Vec<f64> = (0..kept.len()).map(wider).collect();
            DMatrix::from_fn(kept.len(), kept.len(), |i, j| sandwich[(i, j)] * degrees * wider[i] * wider[j])
        }
        None => DMatrix::zeros(0, 0),
    };
    let undetermined = (0..layout.free.len())
        .filter(|c| !kept.contains(c))
        .map(|c| undetermined(&model, layout, &at, total, &kept, c, data.len()))
        .collect();
    Ok(Fit {
        free: kept.iter().map(|&column| layout.free[column]).collect(),
        covariance,
        undetermined,
        rmse: (at.squares() / used).sqrt(),
        rmse_heldout: held_out(data, &model, layout, &blocks, used / BLOCKS, &kept),
        noise_floor: floor.rms(),
        white_squares: floor.squares / floor.white,
        iterations: found.iterations,
        evaluations: found.evaluations,
        status: found.status,
        scan,
        blocks,
        kept,
        used,
        model,
    })
}

impl Fit {
    /// Standard error of each determined parameter, in the order of `free`.
    pub fn standard_errors(&self) -> Vec<f64> {
        (0..self.free.len()).map(|i| self.covariance[(i, i)].max(0.0).sqrt()).collect()
    }

    /// Correlation of the estimates, in the order of `free`.
    pub fn correlation(&self) -> DMatrix<f64> {
        let se = self.standard_errors();
        DMatrix::from_fn(se.len(), se.len(), |i, j| {
            let own = se[i] * se[j];
            if i == j { 1.0 } else { (self.covariance[(i, j)] / own).clamp(-1.0, 1.0) }
        })
    }

    /// Block-bootstrap refits: for each determined parameter, in the order of `free`, its value in all of them.
    pub fn bootstrap(&self, draws: usize, seed: u64) -> Vec<Vec<f64>> {
        let values = self.model.values();
        let mut refits = bootstrap::refits(&self.blocks, &self.kept, draws, seed);
        for (refits, &i) in refits.iter_mut().zip(&self.free) {
            refits.iter_mut().for_each(|step| *step += values[i]);
        }
        refits
    }

    /// Half-width of the 95 % band of the mean prediction at every sample of a capture, N m (Matlab's
    /// `nlpredci`, with the covariance of correlated residuals); NaN outside of every segment.
    pub fn band(&self, signals: &Signals) -> Vec<f64> {
        let seeds = Seeds::of(&self.model, &self.free);
        let mut band = vec![f64::NAN; signals.len()];
        let unweighted = Signals { weight: vec![1.0; signals.len()], ..signals.clone() };
        evaluate(&[&unweighted], &self.model, &self.model.values(), &seeds, |evaluated| {
            for (row, at) in evaluated.rows.clone().enumerate() {
                let j = |c: usize| evaluated.columns[c][row];
                let mut variance = 0.0;
                for a in 0..self.free.len() {
                    for b in 0..self.free.len() {
                        variance += j(a) * self.covariance[(a, b)] * j(b);
                    }
                }
                band[at] = Z95 * variance.max(0.0).sqrt();
            }
        });
        band
    }
}

#[cfg(test)]
mod tests;
