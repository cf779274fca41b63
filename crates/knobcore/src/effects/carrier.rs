//! What carries an effect: a knob, a motion and the sensors that watch it, by which the effect chooses its size.

use super::{Id, Survey};
use crate::model::{Model, Role};
use crate::param::{Param, Unit};
use crate::predict::{Columns, Seeds, measured, torque_raw};
use crate::signals::Signals;

/// An effect of ordinary size makes the bare model's error about this many times what noise leaves.
const TIMES: f64 = 4.0;
/// Where the sensors have no noise, this share of the torque stands for it.
const SHARE: f64 = 0.005;
/// Trials of a size at the most.
const TRIALS: usize = 7;
/// A size that costs what it should but for this share of it will do.
const NEAR: f64 = 0.1;
/// The largest torque may be this share of the sensor's range: beyond it the range is what shows.
const WITHIN: f64 = 0.93;
/// Below this share of the fastest speed sensors cannot tell the direction, so that such samples will not count.
const UNSURE: f64 = 0.003;
/// As long as this share of the samples does.
const MOSTLY: f64 = 0.75;
/// Parts of a survey's quantiles.
const QUANTILES: usize = 200;

/// A knob without the effect, a motion that is known exactly, and what its sensors make of the torque.
#[derive(Debug)]
pub struct Carrier<'a> {
    /// How far, how fast, how hard, how long.
    pub survey: Survey,
    /// Dry friction, N m.
    pub dry: f64,
    /// How much its viscous friction pushes where it is negative, N m s/rad: a joint must damp more than that.
    pub pushes: f64,
    /// Amplitude (N m) and period over 2 pi (rad) of its detents, if it has some.
    pub detent: Option<[f64; 2]>,
    /// RMS that the torque sensor's noise leaves, N m.
    pub floor: f64,
    /// Range of the torque sensor, N m; infinite where it has none.
    pub limit: f64,
    /// The knob.
    pub model: &'a Model,
    signals: &'a Signals,
    torque: Vec<f64>,
    /// Torques that the bare model takes up, orthonormal.
    taken: Vec<Vec<f64>>,
    /// 1 where a sample will count, else 0.
    counts: Vec<f64>,
}

impl<'a> Carrier<'a> {
    /// A knob on a motion. `signals` hold the motion, and the measurement filter; `noise` is the standard deviation
    /// of the raw torque, N m.
    pub fn of(model: &'a Model, signals: &'a Signals, noise: f64, limit: f64) -> Self {
        let free: Vec<usize> =
            (0..model.slots().len()).filter(|&i| model.slots()[i].role == Role::Free).collect();
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
        Self {
            dry: 0.5 * both(["coulomb.neg", "coulomb.pos"]).iter().map(|dry| dry.abs()).sum::<f64>(),
            pushes: drag.iter().fold(0.0, |pushes: f64, b| pushes.max(-b)),
            detent: value("detent.A").zip(value("detent.P")).map(|(a, p)| [a.abs(), p]),
            floor: (noise * gain.sqrt()).max(SHARE * rms(&torque)),
            limit,
            survey: survey(signals, &torque, value("inertia.M").map_or(0.0, f64::abs)),
            taken: orthonormal(taken),
            counts,
            model,
            signals,
            torque,
        }
    }

    /// Largest torque of the knob without the effect, N m.
    pub fn peak(&self) -> f64 {
        Survey::quantile(&self.survey.torque, 1.0)
    }

    /// Inertia of the knob, kg m^2; that of a small one where it has none.
    pub fn inertia(&self) -> f64 {
        if self.survey.inertia > 0.0 { self.survey.inertia } else { 5e-5 }
    }

    /// Fastest speed, rad/s.
    pub fn fastest(&self) -> f64 {
        Survey::quantile(&self.survey.speed, 1.0).max(1e-9)
    }

    /// Half the range of positions, rad.
    pub fn reach(&self) -> f64 {
        (0.5 * self.survey.range()).max(1e-9)
    }

    /// Middle of the range of positions, rad.
    pub fn middle(&self) -> f64 {
        Survey::quantile(&self.survey.theta, 0.0) + 0.5 * self.survey.range()
    }

    /// What an effect with such parameters costs who does not know of it: the RMS error, beside noise, that the bare
    /// model keeps to first order, N m, and the largest torque with it. None where the knob cannot have it.
    pub fn cost(&self, id: Id, p: &[f64]) -> Option<[f64; 2]> {
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
            self.signals.measure(&mut [&mut piece]);
            added.extend_from_slice(&piece[chunk.inner()]);
        }
        weigh(&mut added, &self.counts);
        project(&mut added, &self.taken);
        let counted: f64 = self.counts.iter().sum();
        Some([(dot(&added, &added) / counted.max(1.0)).sqrt(), peak])
    }

    /// The parameters of an effect at the size at which it costs a clear multiple of the noise, and by which the
    /// torque stays within the sensor's range: `of` makes them from a size between two ordinary ones, larger ones
    /// costing more.
    pub fn sized<const N: usize>(
        &self,
        id: Id,
        [small, large]: [f64; 2],
        of: impl Fn(f64) -> [f64; N],
    ) -> [f64; N] {
        let params = id.info().params;
        let of = |size: f64| {
            let mut values = of(size);
            values.iter_mut().zip(params).for_each(|(x, param)| *x = x.clamp(param.lower, param.upper));
            values
        };
        let limit = (WITHIN * self.limit).max(self.peak());
        // What it costs, in what it should: more than all where the torque leaves the range.
        let costs = |size: f64| {
            let [cost, peak] = self.cost(id, &of(size))?;
            Some(if peak > limit { f64::INFINITY } else { cost / (TIMES * self.floor) })
        };
        let Some(mut most) = costs(large) else { return of((small * large).sqrt()) };
        if most <= 1.0 {
            return of(large);
        }
        let (mut below, mut above) = (small, large);
        for _ in 0..TRIALS {
            // Most costs are nearly proportional to the size; where that leads nowhere, halfway.
            let guess = above / most;
            let inside = most.is_finite() && guess > below * 1.01 && guess < above / 1.01;
            let trial = if inside { guess } else { (below * above).sqrt() };
            match costs(trial) {
                Some(share) if (share - 1.0).abs() < NEAR => return of(trial),
                Some(share) if share > 1.0 => (above, most) = (trial, share),
                _ => (below, most) = (trial, f64::INFINITY),
            }
        }
        of(below)
    }

    /// Values by their units alone, in powers of this knob's torque, way and time; neutral where that says something.
    pub fn by_unit(&self, params: &[Param]) -> Vec<f64> {
        let torque = (3.0 * TIMES * self.floor).min(0.5 * self.limit);
        let (angle, time) = (0.5 * self.reach(), self.reach() / self.fastest());
        let value = |param: &Param| {
            let size = match param.neutral {
                0.0 if param.unit == Unit::NUMBER || param.unit == Unit::PHASE => 0.5,
                0.0 => param.unit.sized([torque, angle, time]),
                neutral => neutral,
            };
            size.clamp(param.lower, param.upper)
        };
        params.iter().map(value).collect()
    }
}

fn survey(signals: &Signals, torque: &[f64], inertia: f64) -> Survey {
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

fn rms(x: &[f64]) -> f64 {
    (dot(x, x) / x.len().max(1) as f64).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn project(x: &mut [f64], base: &[Vec<f64>]) {
    for own in base {
        let along = dot(x, own);
        x.iter_mut().zip(own).for_each(|(x, own)| *x -= along * own);
    }
}

fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut base: Vec<Vec<f64>> = Vec::new();
    for mut own in columns {
        let before = dot(&own, &own);
        project(&mut own, &base);
        project(&mut own, &base);
        let length = dot(&own, &own);
        if length > 1e-9 * before && length.is_finite() {
            own.iter_mut().for_each(|x| *x /= length.sqrt());
            base.push(own);
        }
    }
    base
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::Axis;

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
        let carrier = Carrier::of(&knob, &signals, 1e-3, 0.18);
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
            let carrier = Carrier::of(&knob, &signals, noise, 0.18);
            for id in Id::BUILT_IN {
                let values = id.law().typical(&carrier);
                let params = id.info().params;
                assert_eq!(values.len(), params.len());
                for (param, value) in params.iter().zip(&values) {
                    assert!((param.lower..=param.upper).contains(value), "{id:?} {} {value}", param.name);
                    assert!(*value != 0.0, "{id:?} {}", param.name);
                }
                if let Some([_, peak]) = carrier.cost(*id, &values) {
                    assert!(peak < 0.18, "{id:?} {peak}");
                }
            }
        }
    }
}
