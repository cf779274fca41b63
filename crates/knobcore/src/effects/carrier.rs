//! What carries an effect: a knob, a motion and the sensors that watch it, by which the effect chooses its size.

use super::{Id, Survey};
use crate::param::{Param, Unit};
use crate::prelude::*;

/// An effect of ordinary size makes the bare model's error about this many times what noise leaves.
const TIMES: f64 = 4.0;
/// Trials of a size at the most.
const TRIALS: usize = 7;
/// A size that costs what it should but for this share of it will do.
const NEAR: f64 = 0.1;
/// The largest torque may be this share of the sensor's range: beyond it the range is what shows.
const WITHIN: f64 = 0.93;
/// What an effect with such parameters costs; see [`Carrier::cost`].
pub type Costs<'a> = Box<dyn Fn(Id, &[f64]) -> Option<[f64; 2]> + 'a>;

/// A knob without the effect, a motion that is known exactly, and what its sensors make of the torque.
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
    /// See [`Carrier::cost`].
    pub costs: Costs<'a>,
}

impl Carrier<'_> {
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
        (self.costs)(id, p)
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

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: f64 = 1e-3;
    const SIZES: [f64; 2] = [1e-6, 0.1];

    fn carrier(costs: impl Fn(f64) -> Option<[f64; 2]> + 'static) -> Carrier<'static> {
        let survey = Survey {
            theta: vec![-1.0, 1.0],
            speed: vec![5.0],
            torque: vec![0.05],
            duration_s: 2.0,
            rate_hz: 1000.0,
            inertia: 1e-4,
            friction: [0.01; 2],
            revolution: Some(1.0),
            waves: None,
        };
        let costs: Costs<'_> = Box::new(move |_, p| costs(p[0]));
        Carrier { survey, dry: 0.01, pushes: 0.0, detent: None, floor: FLOOR, limit: 1.0, costs }
    }

    fn sized(carrier: &Carrier<'_>) -> f64 {
        carrier.sized(Id::QuadraticDrag, SIZES, |size| [size])[0]
    }

    #[test]
    fn a_size_costs_a_clear_multiple_of_the_noise_however_costs_grow_with_it() {
        for (power, right) in [(0.5, 3e-5), (1.0, 2e-3), (2.0, 2e-3), (3.0, 0.04)] {
            let cost = move |size: f64| TIMES * FLOOR * (size / right).powf(power);
            let found = sized(&carrier(move |size| Some([cost(size), 0.1])));
            assert!((cost(found) / (TIMES * FLOOR) - 1.0).abs() < NEAR, "{power}: {found}");
        }
    }

    #[test]
    fn a_size_stays_within_the_sensors_range_and_one_that_is_still_too_weak_is_the_largest() {
        let found = sized(&carrier(|size| Some([0.1 * size, 100.0 * size])));
        assert!(100.0 * found <= WITHIN && 100.0 * found > 0.5 * WITHIN, "{found}");
        assert_eq!(sized(&carrier(|size| Some([0.9 * TIMES * FLOOR * size / SIZES[1], 0.1]))), SIZES[1]);
    }

    #[test]
    fn where_nothing_tells_what_it_costs_a_size_is_in_the_middle() {
        let found = sized(&carrier(|_| None));
        assert!((found / (SIZES[0] * SIZES[1]).sqrt() - 1.0).abs() < 1e-12);
    }
}
