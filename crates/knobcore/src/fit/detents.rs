//! Are there detents, and which?

use super::hidden::{behind, loads};
use super::layout::Layout;
use super::scan::{LEAST_PHASE, Scan, range, scan};
use super::separable::{Effort, Found, descend};
use super::status::Status;
use crate::effects::{Id, Wave};
use crate::error::Result;
use crate::floor::Floor;
use crate::model::Model;
use crate::param::Axis;
use crate::rule::rule;
use crate::signals::Signals;
use std::cell::OnceCell;
use std::f64::consts::{PI, TAU};

/// Widest period over 2 pi of what counts as detents on a rotary axis, rad: 1.25 to the turn. What comes once a
/// turn is gravity or a bent shaft.
const WIDEST: f64 = 0.8;
/// From this phase on (1.5 detents within the range) no cubic looks like detents.
const UNMISTAKABLE: f64 = 3.0 * PI;
/// Two parameters more must take off this many times the noise's variance.
const CLEARLY: f64 = 10.0;
/// Sums of squares that differ by less than this many times the noise's variance tie.
const TIE: f64 = 4.0;
/// What detents and a smooth torque may leave of the sum of squares, times what noise does.
const LEFT: f64 = 1.5;
/// Peaks of the scan that are followed to their optimum, if they reach this share of the best.
const CANDIDATES: usize = 3;
const RIVAL: f64 = 0.8;

/// The best descent over the peaks of the scan. The passes of every descent count as evaluations.
pub fn best_from_scan(
    data: &[&Signals],
    model: &Model,
    layout: &Layout,
    start: &[f64],
    scan: &Scan,
) -> Result<Option<Found>> {
    let peaks = scan.peaks();
    let best_gain = peaks.first().map_or(0.0, |peak| peak.gain);
    let detent = ["detent.A", "detent.P", "detent.S"].map(|name| model.index(name));
    let mut best: Option<Found> = None;
    let mut evaluations = 0;
    for peak in peaks.iter().take(CANDIDATES).filter(|peak| peak.gain >= RIVAL * best_gain) {
        let mut start = start.to_vec();
        for (at, value) in detent.clone().into_iter().zip([peak.amplitude, peak.period, peak.phase]) {
            let at = at?;
            // What the user fixed stays.
            if layout.free.contains(&at) {
                start[at] = value;
            }
        }
        let found = descend(data, model, layout, &start, Effort::Full);
        evaluations += found.evaluations;
        if best.as_ref().is_none_or(|b| found.cost < b.cost) {
            best = Some(found);
        }
    }
    Ok(best.map(|found| Found { evaluations, ..found }))
}

/// The scan beside everything of `model` but its detents, over the positions of the knob that they act on.
pub fn scan_beside(data: &[&Signals], model: &Model) -> Option<(Model, Found, Scan)> {
    let effects: Vec<Id> = model.effects().filter(|id| *id != Id::Detent).collect();
    let bare = model.only(&effects).ok()?;
    let layout = Layout::of(&bare);
    if layout.is_linear() {
        // The scan's own pass solves it.
        let start = bare.values();
        let (scan, step) = scan(data, &bare, &start, &layout.free, Wave::Torque)?;
        let found = Found {
            p: layout.moved(&bare, &start, &step),
            cost: scan.without,
            iterations: 1,
            evaluations: 1,
            status: Status::Linear,
        };
        return Some((bare, found, scan));
    }
    let found = descend(data, &bare, &layout, &bare.values(), Effort::Full);
    let joined = at(&bare, &found);
    let hidden = behind(data, &joined);
    let (scan, _) = if hidden.is_empty() {
        scan(data, &bare, &found.p, &layout.free, Wave::Torque)?
    } else {
        let (hidden, loads): (Vec<&Signals>, Model) = (hidden.iter().collect(), loads(&joined));
        scan(&hidden, &loads, &loads.values(), &Layout::of(&loads).free, Wave::Torque)?
    };
    Some((bare, found, scan))
}

/// The values of a model with detents where a search for them begins: the others are those without.
pub fn beginning(full: &Model, bare: &Model, without: &Found) -> Result<Vec<f64>> {
    let mut start = full.values();
    for (slot, value) in bare.slots().iter().zip(&without.p) {
        start[full.index(&slot.name())?] = *value;
    }
    Ok(start)
}

/// What decides whether there are detents.
pub struct Judge<'a> {
    /// The captures.
    pub data: &'a [&'a Signals],
    /// The model without detents.
    pub bare: &'a Model,
    /// Its optimum.
    pub without: &'a Found,
    /// The scan beside it.
    pub scan: &'a Scan,
    /// How loud the captures are at most.
    pub loudest: &'a [f64],
    /// What noise would leave; most detents are so much more that nobody asks.
    pub floor: OnceCell<Floor>,
}

impl Judge<'_> {
    /// Whether the best peak of the scan is worth a descent. The scan sees detents through a filter that it
    /// does not know, so its gain is a little off.
    pub fn promising(&self) -> bool {
        self.scan.peaks().first().is_some_and(|peak| self.worth_it(1.5 * peak.gain))
    }

    /// Whether the detents that were found are there: worth it, repeating within the range that was turned
    /// through and within a turn, and no smooth function of position that only looks like them.
    pub fn are_there(&self, full: &Model, with: &Found) -> Result<bool> {
        let period = with.p[full.index("detent.P")?];
        let phase = self.seen(full, with)?;
        let within_a_turn = full.axis == Axis::Linear || period <= WIDEST;
        let finest = self.scan.inverse_period.last().map_or(0.0, |k| 0.9 / k);
        let detents = self.worth_it(self.without.cost - with.cost)
            && phase >= LEAST_PHASE
            && period >= finest
            && within_a_turn;
        Ok(detents && (phase > UNMISTAKABLE || self.beat_smooth(with)?))
    }

    /// Detents that stand out beside a smooth torque, which hides them, or looks like less than one whole detent itself:
    /// where none were found, or no more than that. None where none do, and where both leave more than noise: many
    /// things that are missing have a wave in them.
    pub fn beside_smooth(&self, full: &Model, with: Option<&Found>) -> Result<Option<Found>> {
        let phase = with.map(|with| self.seen(full, with)).transpose()?;
        if phase.is_some_and(|phase| phase >= TAU) || self.bare.has(Id::PositionPolynomial) {
            return Ok(None);
        }
        let smooth = self.bare.with(Id::PositionPolynomial)?;
        let Some((bare, without, scan)) = scan_beside(self.data, &smooth) else { return Ok(None) };
        let beside = Judge { bare: &bare, without: &without, scan: &scan, floor: OnceCell::new(), ..*self };
        if !beside.promising() {
            return Ok(None);
        }
        let both = bare.with(Id::Detent)?;
        let start = beginning(&both, &bare, &without)?;
        let found = best_from_scan(self.data, &both, &Layout::of(&both), &start, &scan)?;
        let most = LEFT * beside.floor().squares;
        let Some(found) = found.filter(|found| found.cost < most) else { return Ok(None) };
        if self.seen(&both, &found)? <= UNMISTAKABLE || !beside.are_there(&both, &found)? {
            return Ok(None);
        }
        let mut start = beginning(full, self.bare, self.without)?;
        for name in ["detent.A", "detent.P", "detent.S"] {
            start[full.index(name)?] = found.p[both.index(name)?];
        }
        Ok(Some(descend(self.data, full, &Layout::of(full), &start, Effort::Full)))
    }

    /// How much of the detents that were found the motion goes through, rad of their phase.
    fn seen(&self, model: &Model, found: &Found) -> Result<f64> {
        Ok(range(self.data) / found.p[model.index("detent.P")?])
    }

    /// Whether a detent that takes `gain` off the sum of squares stands out of the scan and explains a share
    /// of the error that a user would care about.
    ///
    /// In noise alone each gain is the noise's variance times a chi-square number of two degrees of freedom,
    /// so that the largest of n stays below twice the variance times ln(n / chance).
    fn worth_it(&self, gain: f64) -> bool {
        let by_chance = |white: f64| 2.0 * white * (self.scan.gain.len() as f64 / rule().detents_chance).ln();
        if gain < rule().detents_stand_out * self.scan.background() {
            return false;
        }
        let cost = self.without.cost;
        if gain >= by_chance(Floor::whitest(self.loudest, self.data, cost))
            && gain >= rule().detents_share * cost
        {
            return true;
        }
        let squares = self.floor().squares;
        let excess = (cost - if squares.is_finite() { squares } else { 0.0 }).max(0.0);
        gain >= by_chance(self.white()) && gain >= rule().detents_share * excess
    }

    fn floor(&self) -> &Floor {
        self.floor.get_or_init(|| Floor::below(self.loudest, self.data, &at(self.bare, self.without)))
    }

    /// Whether detents explain the error as well as a cubic over position, which has as many parameters (in a
    /// tie the paper's Equation 1 has detents), and clearly better than a spring, which has fewer.
    fn beat_smooth(&self, with: &Found) -> Result<bool> {
        let cost = |rival: Id, data: &[&Signals]| -> Result<f64> {
            if self.bare.has(rival) {
                return Ok(self.without.cost);
            }
            let model = self.bare.with(rival)?;
            Ok(descend(data, &model, &Layout::of(&model), &model.values(), Effort::Full).cost)
        };
        let clearly = CLEARLY * self.white();
        Ok(with.cost < cost(Id::PositionPolynomial, self.data)? + TIE * self.white()
            && with.cost + clearly < cost(Id::ReturnSpring, self.data)?)
    }

    fn white(&self) -> f64 {
        let white = self.floor().white;
        if white.is_finite() { white } else { 0.0 }
    }
}

/// The model where the search ended.
fn at(model: &Model, found: &Found) -> Model {
    let mut model = model.clone();
    model.set_values(&found.p);
    model
}
