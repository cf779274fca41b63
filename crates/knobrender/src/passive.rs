//! Whether a model may be trusted with a hand: what it is, over the range that is declared for it, never feeds one.
//!
//! A fit that went wrong has a spring that pushes, an inertia that hurries, friction that helps; each of them
//! gives energy to whoever holds the handle, and the delay of a device has no part in it. So it is asked of the
//! model itself, before anything moves: signs at a grid of places and speeds, where the angle alone would take
//! the handle, and, where something is remembered, the work over cycles from rest on. The term that is most to blame is
//! named: the one without which the offence would be the least.

use super::device::Device;
use super::limits::Limits;
use super::sliding::{add_loads, at_rest};
use super::stability::check_stability;
use super::state::Sensed;
use super::step::Renderer;
use core::f64::consts::TAU;
use knobcore::effects::Id;
use knobcore::error::{Error, Result};
use knobcore::model::Model;
use knobcore::motion::{Load, Motion};
use knobcore::param::{Axis, Kind};
use knobcore::prelude::*;
use knobcore::scalar::Scalar;

/// Where a model is asked to be passive, to both sides of zero: angle, rad (m), and speed, rad/s (m/s).
///
/// What the model says of itself; by default a turn to each side and 5 rad/s, as fast as hands turn knobs, 1 m and 1 m/s
/// on a linear axis. Dry friction may
/// outweigh a negative viscous term so far (knobs 1 to 3 of the paper); what is faster is cut by the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// rad (m).
    pub angle: f64,
    /// rad/s (m/s).
    pub speed: f64,
}

impl Range {
    /// The range that is declared for a model.
    pub fn of(model: &Model) -> Self {
        let usual = if model.axis == Axis::Linear { [1.0, 1.0] } else { [TAU, 5.0] };
        let [angle, speed] = model.reach.unwrap_or(usual);
        Self { angle, speed }
    }
}

/// A torque that nobody feels, N m: a hundredth of what the finest sensor of the paper tells from none.
const UNFELT: f64 = 1e-6;
/// Share of the energy between the highest and the lowest place by which a lower one may be chance.
const CHANCE: f64 = 0.05;
/// Share of the energy that goes to and fro in a cycle by which its sum may miss zero.
const ROUNDED: f64 = 2e-3;
/// Angles and speeds that are looked at, and angles over which the torque is integrated, for each turn to both sides; the
/// second where a user's own function is called at each.
const GRID: [[usize; 3]; 2] = [[128, 16, 4096], [24, 6, 512]];
/// Instants at which the torque of a handle at rest has to be the same, s.
const CLOCK: [f64; 3] = [0.0, 0.37, 5.3];
/// Cycles from rest to rest: amplitude as a share of the declared speed over 2.5 Hz, and how many go into 0.4 s.
const CYCLES: [[f64; 2]; 3] = [[1.0, 1.0], [0.05, 1.0], [0.25, 4.0]];
const CYCLE_S: f64 = 0.4;

/// A model that is looked at.
struct Asked<'a> {
    model: &'a Model,
    own: bool,
    range: Range,
}

/// Refuses a model that would feed a hand, or, on a device, ring: the term, and why.
///
/// # Errors
/// The term that is most to blame, as the name of the error.
pub fn check_passive(model: &Model, device: Option<Device>, rate_hz: f64) -> Result<()> {
    stored(model, device, rate_hz).map(drop)
}

/// Energy between the highest and the lowest place within its declared range, J, of a model that passes.
///
/// # Errors
/// As of [`check_passive`].
pub(super) fn stored(model: &Model, device: Option<Device>, rate_hz: f64) -> Result<f64> {
    let own = model.effects().any(Id::calls_out);
    let asked = Asked { model, own, range: Range::of(model) };
    let p = model.values();
    let told = asked.signs(&p).and_then(|()| {
        let places = asked.heights(&p);
        asked.stays(&p, &places)?;
        asked.cycles(&p, rate_hz, &places)?;
        Ok(places.highest - places.lowest)
    });
    // A formula has a value wherever the knob may go; a function that fails somewhere ends the loop there.
    let failed: Vec<_> = model.failures().collect();
    if let Some((user, why)) = failed.into_iter().find(|(user, _)| user.formula().is_some()) {
        return Err(Error::invalid(format!("effect '{}'", user.info.id), why));
    }
    let energy = told?;
    if let Some(device) = device.filter(|device| !device.held) {
        rings(model, device, rate_hz)?;
    }
    Ok(energy)
}

/// What the places of a range hold, J, beside the place where it begins. Kept as it is met: of the places there may be many.
struct Heights {
    lowest: f64,
    highest: f64,
    /// The lowest in the middle half of the range, and its angle, rad.
    inner: [f64; 2],
    /// At the end of the range.
    last: f64,
    /// The least dry friction, N m.
    dry: f64,
}

impl Asked<'_> {
    fn load(&self, p: &[f64], motion: &Motion<f64>) -> Load<f64> {
        let (mut memory, mut sum) = (vec![0.0; self.model.states()], self.model.steady_load(p));
        add_loads(self.model, p, self.own, &mut memory, motion, &mut sum);
        sum
    }

    /// Turns to both sides of zero, begun ones counted: what is as fine as a dent has to be met in each.
    fn turns(&self) -> usize {
        (self.range.angle / TAU).ceil().max(1.0) as usize
    }

    fn still(&self, p: &[f64], theta: f64, t: f64) -> f64 {
        self.load(p, &at_rest(&Motion::exact(t, theta, 0.0, 0.0))).drive
    }

    /// Names the term that is to blame for an offence.
    fn refuse(&self, p: &[f64], offence: impl Fn(&[f64]) -> f64, why: &str) -> Result<()> {
        Err(blamed(self.model, p, offence, why))
    }

    /// Inertia, dry friction and what depends on the speed have the signs that they have in nature.
    fn signs(&self, p: &[f64]) -> Result<()> {
        let [angles, speeds, _] = GRID[usize::from(self.own)];
        for i in 0..angles * self.turns() {
            // Golden-ratio steps meet every phase of any detent.
            let theta = self.range.angle * (2.0 * (0.618_033_988_75 * i as f64).fract() - 1.0);
            for k in 0..2 * speeds {
                let fast = self.range.speed * Scalar::powf(0.5, 0.75 * (k / 2) as f64);
                let motion = Motion::exact(0.0, theta, if k % 2 == 0 { fast } else { -fast }, 0.0);
                let dry = |p: &[f64]| self.load(p, &motion).dry(motion.forward, 0.0);
                let inertia = |p: &[f64]| self.load(p, &motion).inertia;
                let brakes = |p: &[f64]| {
                    let (load, rest) = (self.load(p, &motion), self.load(p, &at_rest(&motion)));
                    motion.direction() * (load.drive - rest.drive) + load.dry(motion.forward, 0.0)
                };
                for (finite, value) in [(inertia(p), "inertia"), (dry(p), "friction"), (brakes(p), "torque")]
                {
                    if !finite.is_finite() {
                        let why = format!("gives {finite} as {value}");
                        return self.refuse(p, |p| f64::from(u8::from(!brakes(p).is_finite())), &why);
                    }
                }
                if inertia(p) < 0.0 {
                    return self.refuse(p, |p| -inertia(p), "an inertia below 0 hurries the hand");
                }
                if dry(p) < -UNFELT {
                    return self.refuse(p, |p| -dry(p), "dry friction below 0 helps the hand");
                }
                if brakes(p) < -UNFELT {
                    let why = format!("feeds the hand at {} rad/s beyond friction", short(motion.omega));
                    return self.refuse(p, |p| -brakes(p), &why);
                }
            }
        }
        for i in 0..8 {
            let theta = self.range.angle * (0.25 * f64::from(i) - 0.9);
            let moved = |p: &[f64]| {
                let now = CLOCK.map(|t| self.still(p, theta, t));
                (now[1] - now[0]).abs().max((now[2] - now[0]).abs())
            };
            if moved(p) > UNFELT {
                return self.refuse(p, moved, "pushes by the clock, whatever the hand does");
            }
        }
        Ok(())
    }

    /// What each place holds, J, from one end of the range to the other, and the least dry friction between them.
    fn heights(&self, p: &[f64]) -> Heights {
        let places = GRID[usize::from(self.own)][2] * self.turns();
        let step = 2.0 * self.range.angle / places as f64;
        let middle = places / 4..=places - places / 4;
        let mut met = Heights {
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
            inner: [f64::INFINITY, 0.0],
            last: 0.0,
            dry: f64::INFINITY,
        };
        for i in 0..=places {
            let height = met.last;
            (met.lowest, met.highest) = (met.lowest.min(height), met.highest.max(height));
            if middle.contains(&i) && height < met.inner[0] {
                met.inner = [height, self.range.angle * (2.0 * i as f64 / places as f64 - 1.0)];
            }
            if i < places {
                let theta = -self.range.angle + (i as f64 + 0.5) * step;
                let load = self.load(p, &at_rest(&Motion::exact(0.0, theta, 0.0, 0.0)));
                met.last += load.drive * step;
                met.dry = met.dry.min(load.dry(0.0, 0.0)).min(load.dry(1.0, 0.0));
            }
        }
        met
    }

    /// The angle alone does not drive the handle out of its range, by more than dry friction takes.
    fn stays(&self, p: &[f64], places: &Heights) -> Result<()> {
        let &Heights { lowest, highest, inner: [inner, _], last, dry } = places;
        let span = highest - lowest;
        let rubbed = dry.max(0.0) * 0.5 * self.range.angle + CHANCE * span + UNFELT * self.range.angle;
        for (edge, theta) in [(0.0, -self.range.angle), (last, self.range.angle)] {
            let out = |p: &[f64]| -theta.signum() * self.still(p, theta, 0.0);
            if inner - edge > rubbed && edge <= lowest + CHANCE * span && out(p) > 0.0 {
                return self.refuse(p, out, "pushes the handle away, out of its range");
            }
        }
        Ok(())
    }

    /// What is remembered, and what hangs behind a joint, gives out no more than it was given, from rest on.
    fn cycles(&self, p: &[f64], rate_hz: f64, places: &Heights) -> Result<()> {
        if !self.model.remembers() && self.model.joint(p).is_none() {
            return Ok(());
        }
        // Where the angle alone holds the least: nothing is stored there.
        let [_, start] = places.inner;
        for [share, times] in CYCLES {
            let samples = (CYCLE_S / times * rate_hz).round().max(8.0) as usize;
            let w = TAU * rate_hz / samples as f64;
            let amplitude = share * self.range.speed * CYCLE_S / TAU;
            let work = |p: &[f64]| self.work(p, rate_hz, start, [amplitude, w], samples);
            let [least, scale] = work(p)?;
            if least.is_nan() || least < -ROUNDED * scale - UNFELT * amplitude {
                let why =
                    format!("feeds the hand by {} J in cycles of {} rad", short(-least), short(amplitude));
                return self.refuse(p, |p| work(p).map_or(f64::NAN, |[least, _]| -least), &why);
            }
        }
        Ok(())
    }

    /// The least that the work of the hand, J, has come to at the end of a cycle, and what went to and fro. Cycles go
    /// to one side and to the other in turn, each from rest to rest: a mass on a spring keeps some of one for the next.
    fn work(
        &self,
        p: &[f64],
        rate_hz: f64,
        start: f64,
        [amplitude, w]: [f64; 2],
        samples: usize,
    ) -> Result<[f64; 2]> {
        let mut model = self.model.clone();
        model.set_values(p);
        let open = Limits { torque: f64::INFINITY, torque_rate: f64::INFINITY, speed: 1000.0 };
        let mut knob = Renderer::unguarded(&model, rate_hz, open)?;
        let [mut work, mut least, mut scale] = [0.0, f64::INFINITY, 0.0];
        for side in [1.0, -1.0, 1.0, -1.0] {
            let amplitude = side * amplitude;
            for i in 0..samples {
                let (sin, cos) = Scalar::sin_cos(w * i as f64 / rate_hz);
                let (theta, omega) = (start + amplitude * (1.0 - cos), amplitude * w * sin);
                let sensed = Sensed { theta, omega, alpha: amplitude * w * w * cos, hand: None };
                let power = knob.step(sensed) * omega / rate_hz;
                (work, scale) = (work + power, scale + power.abs());
            }
            least = f64::min(least, work);
            if work.is_nan() {
                return Ok([work, scale]);
            }
        }
        Ok([least, scale])
    }
}

/// Refuses a model that the delay of a device makes ring.
fn rings(model: &Model, device: Device, rate_hz: f64) -> Result<()> {
    let margin = |p: &[f64]| {
        let mut other = model.clone();
        other.set_values(p);
        check_stability(&other, device, rate_hz).map(|found| found.sliding_margin.min(found.sticking_margin))
    };
    let p = model.values();
    if margin(&p)? > 0.0 {
        return Ok(());
    }
    let late = 1e3 * device.late_s(1.0 / rate_hz);
    let why = format!("rings on this device, whose torque acts {} ms late", short(late));
    Err(blamed(model, &p, |p| margin(p).map_or(f64::INFINITY, |margin| -margin), &why))
}

/// The term without which `offence` would be the least, with its value, and `why`.
fn blamed(model: &Model, p: &[f64], offence: impl Fn(&[f64]) -> f64, why: &str) -> Error {
    let worst = offence(p);
    let without = |at: usize| {
        let mut other = p.to_vec();
        other[at] = model.slots()[at].param.neutral;
        (other[at] != p[at]).then(|| worst - offence(&other)).filter(|by| *by > 0.0)
    };
    let linear = |at: &usize| model.slots()[*at].param.kind == Kind::Linear;
    let best = |these: Vec<usize>| {
        let gains = these.into_iter().filter_map(|at| without(at).map(|by| (at, by)));
        gains.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
    };
    let every = 0..model.slots().len();
    let at = best(every.clone().filter(linear).collect()).or_else(|| best(every.collect()));
    let Some(at) = at else {
        return Error::invalid("model", format!("{why}; correct the model, or force it"));
    };
    let slot = &model.slots()[at];
    let unit = model.unit(slot);
    let value = short(slot.value);
    Error::invalid(slot.name(), format!("is {value} {unit}: {why}; correct it, or force it"))
}

/// A number in four figures.
fn short(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}
