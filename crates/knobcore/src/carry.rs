//! Carriers: what an effect costs on a knob, in a motion, to the sensors that watch it.

use crate::algebra::{dot, orthonormal, project, rms};
use crate::effects::{Carrier, Id, Survey};
use crate::model::Model;
use crate::param::Axis;
use crate::predict::{Columns, Seeds, measured, torque_raw};
use crate::signals::Signals;

/// Where the sensors have no noise, this share of the torque stands for it.
const SHARE: f64 = 0.005;
/// Below this share of the fastest speed sensors cannot tell the direction, so that such samples will not count.
const UNSURE: f64 = 0.003;
/// As long as this share of the samples does.
const MOSTLY: f64 = 0.75;
/// Parts of a survey's quantiles.
const QUANTILES: usize = 200;

/// A knob on a motion. `signals` hold the motion, and the measurement filter; `noise` is the standard deviation
/// of the raw torque, N m.
pub fn carrier<'a>(model: &'a Model, signals: &'a Signals, noise: f64, limit: f64) -> Carrier<'a> {
    let free: Vec<usize> = model.free().collect();
    let seeds = Seeds::of(model, &free);
    let mut taken: Vec<Vec<f64>> = vec![Vec::new(); free.len()];
    let mut columns = Columns::default();
    for chunk in signals.chunks(model.remembers()) {
        measured(model, &model.values(), &seeds, signals, &chunk, &mut columns);
        let (_, slopes) = columns.split();
        for (own, slope) in taken.iter_mut().zip(slopes) {
            own.extend_from_slice(&slope[chunk.inner()]);
        }
    }
    let counts = counted(signals);
    for own in &mut taken {
        weigh(own, &counts);
    }
    let torque = torque_raw(model, signals);
    let gain = signals.filter.as_ref().map_or(1.0, |filter| filter.sos().mean_power());
    let value = |name: &str| model.index(name).map(|i| model.slots()[i].value).ok();
    let both = |names: [&str; 2]| names.into_iter().filter_map(value).collect::<Vec<f64>>();
    let drag = both(["viscous.neg", "viscous.pos"]);
    let dry = 0.5 * both(["coulomb.neg", "coulomb.pos"]).iter().map(|dry| dry.abs()).sum::<f64>();
    let survey = survey(signals, &torque, value("inertia.M").map_or(0.0, f64::abs), dry);
    let floor = (noise * gain.sqrt()).max(SHARE * rms(&torque));
    let rows = taken.first().map_or(0, Vec::len);
    let bare = Bare { model, signals, torque, taken: orthonormal(&taken, rows), counts };
    Carrier {
        dry,
        pushes: drag.iter().fold(0.0, |pushes: f64, b| pushes.max(-b)),
        detent: value("detent.A").zip(value("detent.P")).map(|(a, p)| [a.abs(), p]),
        floor,
        limit,
        survey,
        costs: Box::new(move |id, p| bare.cost(id, p)),
    }
}

/// The knob without the effect.
struct Bare<'a> {
    model: &'a Model,
    signals: &'a Signals,
    torque: Vec<f64>,
    /// Torques that the bare model takes up, orthonormal.
    taken: Vec<Vec<f64>>,
    /// 1 where a sample will count, else 0.
    counts: Vec<f64>,
}

impl Bare<'_> {
    /// See [`Carrier::cost`].
    fn cost(&self, id: Id, p: &[f64]) -> Option<[f64; 2]> {
        let mut model = self.model.with(id).ok()?;
        let own = model.slots().iter().position(|slot| slot.effect == id)?;
        let mut values = model.values();
        values.iter_mut().skip(own).zip(p).for_each(|(value, p)| *value = *p);
        model.set_values(&values);
        let torque = torque_raw(&model, self.signals);
        let peak = torque.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        let raw: Vec<f64> = torque.iter().zip(&self.torque).map(|(with, without)| with - without).collect();
        let mut added = Vec::with_capacity(raw.len());
        for chunk in self.signals.chunks(true) {
            let mut piece = raw[chunk.whole.clone()].to_vec();
            self.signals.measure_over(&chunk.whole, &mut [&mut piece]);
            added.extend_from_slice(&piece[chunk.inner()]);
        }
        weigh(&mut added, &self.counts);
        let rows = added.len();
        project(&mut added, &self.taken, rows);
        let counted: f64 = self.counts.iter().sum();
        Some([(dot(&added, &added) / counted.max(1.0)).sqrt(), peak])
    }
}

fn survey(signals: &Signals, torque: &[f64], inertia: f64, dry: f64) -> Survey {
    let ranked = |values: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().saturating_sub(1);
        (0..=QUANTILES).filter_map(|i| values.get(last * i / QUANTILES).copied()).collect()
    };
    Survey {
        theta: ranked(&mut signals.theta.iter().copied()),
        speed: ranked(&mut signals.omega.iter().map(|omega| omega.abs())),
        torque: ranked(&mut torque.iter().map(|tau| tau.abs())),
        duration_s: signals.t.last().copied().unwrap_or(0.0),
        rate_hz: signals.rate_hz,
        inertia,
        friction: [dry; 2],
        revolution: (signals.axis == Axis::Rotary).then_some(1.0),
        waves: None,
    }
}

/// Samples that a fit will count: not those that a direction which nobody can tell reaches through the filter.
fn counted(signals: &Signals) -> Vec<f64> {
    let reach = signals.filter.as_ref().map_or(0, |filter| filter.sos().settle() / 8);
    let fastest = signals.omega.iter().fold(0.0_f64, |most, omega| most.max(omega.abs()));
    let mut counts = vec![1.0; signals.len()];
    for at in (0..signals.len()).filter(|&at| signals.omega[at].abs() < UNSURE * fastest) {
        counts[at.saturating_sub(reach)..(at + reach).min(signals.len())].fill(0.0);
    }
    if counts.iter().sum::<f64>() < MOSTLY * counts.len() as f64 {
        counts.fill(1.0);
    }
    counts
}

fn weigh(x: &mut [f64], weights: &[f64]) {
    x.iter_mut().zip(weights).for_each(|(x, weight)| *x *= weight);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::{Axis, Usual};

    /// A knob that swings to and fro, in 3 s at 1 kHz.
    fn swings() -> Signals {
        let over = |f: &dyn Fn(f64) -> f64| (0..3000).map(|i| f(f64::from(i) / 1e3)).collect::<Vec<f64>>();
        Signals {
            rate_hz: 1e3,
            substeps: 4,
            t: over(&|t| t),
            theta: over(&|t| (4.0 * t).sin()),
            omega: over(&|t| 4.0 * (4.0 * t).cos()),
            alpha: over(&|t| -16.0 * (4.0 * t).sin()),
            forward: over(&|t| f64::from(u8::from((4.0 * t).cos() > 0.0))),
            segments: vec![0..3000; 1],
            ..Signals::default()
        }
    }

    fn knob() -> Model {
        let mut knob = Model::equation_1(Axis::Rotary, true);
        for (name, value) in [
            ("inertia.M", 5e-5),
            ("coulomb.neg", 0.02),
            ("coulomb.pos", 0.02),
            ("detent.A", 0.02),
            ("detent.P", 0.07),
        ] {
            knob.set(name, value).unwrap();
        }
        knob
    }

    #[test]
    fn what_the_knob_has_already_costs_nothing() {
        let (knob, signals) = (knob(), swings());
        let carrier = carrier(&knob, &signals, 1e-3, 0.18);
        // Proportional to the position is, on this motion, proportional to the acceleration.
        let [cost, peak] = carrier.cost(Id::ReturnSpring, &[0.01, 0.0]).unwrap();
        assert!(cost < 1e-9 && peak > 0.0, "{cost}");
        let [cost, _] = carrier.cost(Id::QuadraticDrag, &[1e-3]).unwrap();
        assert!(cost > 1e-4, "{cost}");
        assert!(carrier.cost(Id::Detent, &[1.0, 1.0, 0.0]).is_none());
    }

    #[test]
    fn every_effect_chooses_sizes_within_its_bounds_and_the_sensors_range() {
        let (knob, signals) = (knob(), swings());
        for noise in [1e-3, 0.0] {
            let carrier = carrier(&knob, &signals, noise, 0.18);
            for id in Id::BUILT_IN {
                let values = id.law().typical(&carrier);
                let params = id.info().params;
                assert_eq!(values.len(), params.len());
                for (param, value) in params.iter().zip(&values) {
                    assert!((param.lower..=param.upper).contains(value), "{id:?} {} {value}", param.name);
                    // An order that a ripple does not use is nought.
                    let may_idle = matches!(param.usual, Usual::Fixed | Usual::Beside(_));
                    assert!(may_idle || *value != 0.0, "{id:?} {}", param.name);
                }
                if let Some([_, peak]) = carrier.cost(*id, &values) {
                    assert!(peak < 0.18, "{id:?} {peak}");
                }
            }
        }
    }
}
