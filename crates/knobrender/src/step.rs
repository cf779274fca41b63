//! The step itself.

use super::contact::{Budget, Contact, Moved};
use super::device::{Device, SLOWEST, Tuning};
use super::limits::{Fault, Limits};
use super::nature::Nature;
use super::sliding::{Sliding, add_loads, at_rest, braked, plain, sliding};
use super::state::{Sensed, State, TANK_J};
use knobcore::chain::{Beside, Follow, Hidden, SUBSTEPS};
use knobcore::effects::Id;
use knobcore::error::{Error, Result};
use knobcore::model::Model;
use knobcore::motion::{Channel, Load, Motion};
use knobcore::prelude::*;
use knobcore::scalar::{Known, Scalar};

/// A model that is rendered: the torque by which the knob answers, sample by sample.
///
/// The torque is that of the model (Equation 1): what the hand has to apply. The motor applies its negative.
#[derive(Debug, Clone)]
pub struct Renderer {
    pub(super) model: Model,
    pub(super) p: Vec<f64>,
    /// What of the load is the same in every motion.
    pub(super) steady: Load<f64>,
    pub(super) dt: f64,
    pub(super) tuning: Tuning,
    pub(super) limits: Limits,
    pub(super) guarded: bool,
    pub(super) own: bool,
    /// Rendered although it may feed a hand: as long as its tank lasts, which nothing fills beyond its beginning.
    pub(super) forced: bool,
    /// Energy that it may give out beyond what it took, J.
    pub(super) tank: f64,
    pub(super) hidden: Option<Hidden<f64>>,
    pub(super) spare: Vec<f64>,
    pub(super) state: State,
}

/// Missed periods in a row over which a knob behind a joint is still followed.
const LONGEST_GAP: u64 = 100;

impl Renderer {
    /// The same for a model that nobody vouches for: it may give out [`TANK_J`] beyond what it took, and then lets go.
    ///
    /// # Errors
    /// A rate that is none, a limit or a device that cannot be.
    pub fn forced(model: &Model, rate_hz: f64, device: Option<Device>, limits: Limits) -> Result<Self> {
        Ok(Self { forced: true, tank: TANK_J, ..Self::made(model, rate_hz, device, limits)? })
    }

    /// The model as it is, also where it feeds a hand, to look whether it does.
    pub(super) fn unguarded(model: &Model, rate_hz: f64, limits: Limits) -> Result<Self> {
        Ok(Self { guarded: false, ..Self::made(model, rate_hz, None, limits)? })
    }

    pub(super) fn made(model: &Model, rate_hz: f64, device: Option<Device>, limits: Limits) -> Result<Self> {
        if !(10.0..=1e6).contains(&rate_hz) {
            return Err(Error::invalid("rate", format!("is {rate_hz} Hz; choose 10 to 1e6, usually 5000")));
        }
        for (name, x) in [
            ("torque_limit", limits.torque),
            ("torque_rate_limit", limits.torque_rate),
            ("speed_limit", limits.speed),
        ] {
            if x.is_nan() || x <= 0.0 {
                return Err(Error::invalid(name, format!("is {x}; give one above 0, or none")));
            }
        }
        let pushes = |c: &Channel| matches!(c, Channel::Drive | Channel::NormalLoad | Channel::PositionLoad);
        if let Some(id) = model.shafts().iter().find(|id| !id.info().touches.iter().all(pushes)) {
            return Err(Error::invalid(
                format!("effect '{}'", id.info().id),
                "rubs at the shaft, and a rendered shaft has no friction of its own; leave out 'at' in the model file, \
                 so that it acts on the knob",
            ));
        }
        let device = device.map(Device::checked).transpose()?;
        let (dt, p) = (1.0 / rate_hz, model.values());
        let memory = vec![0.0; model.states()];
        let nature = Nature::of(model, &p, limits.speed);
        let tuning =
            device.map_or_else(|| Tuning::faithful(model.axis, &nature, dt), |d| Tuning::of(&d, &nature, dt));
        let limits = device.map_or(limits, |d| Limits {
            torque: limits.torque.min(d.torque_limit),
            torque_rate: limits.torque_rate.min(d.torque_rate_limit),
            ..limits
        });
        let mut hidden = Hidden::new(model, &p, [0.0; 4], dt, Follow::of(SUBSTEPS));
        if let Some(hidden) = &mut hidden {
            hidden.soften(tuning.stiffest);
        }
        let state = State {
            samples: 0,
            missed: 0,
            before: [0.0; 2],
            between: 0.0,
            alpha: 0.0,
            tau: 0.0,
            contact: Contact::default(),
            knob: [0.0; 2],
            memory,
            tank: TANK_J,
            fault: None,
        };
        Ok(Self {
            own: model.effects().any(Id::calls_out),
            guarded: !nature.dissipates,
            forced: false,
            tank: f64::INFINITY,
            spare: state.memory.clone(),
            model: model.clone(),
            steady: model.steady_load(&p),
            p,
            dt,
            tuning,
            limits,
            hidden,
            state,
        })
    }

    /// Forgets everything, and faults too.
    pub fn reset(&mut self) {
        let state = &mut self.state;
        state.memory.fill(0.0);
        (state.samples, state.missed) = (0, 0);
        (state.before, state.between) = ([0.0; 2], 0.0);
        (state.alpha, state.tau) = (0.0, 0.0);
        (state.contact, state.knob, state.fault) = (Contact::default(), [0.0; 2], None);
        state.tank = if self.tank < f64::INFINITY { self.tank } else { TANK_J };
    }

    /// All that it remembers.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes on from there.
    ///
    /// # Errors
    /// The state is of a model that remembers other things.
    pub fn set_state(&mut self, state: State) -> Result<()> {
        if state.memory.len() != self.state.memory.len() {
            return Err(Error::invalid(
                "state",
                format!(
                    "remembers {} numbers and this model {}; give a state of the same model",
                    state.memory.len(),
                    self.state.memory.len()
                ),
            ));
        }
        let [theta, omega] = state.before;
        let there = theta + omega * self.tuning.ahead_s;
        let before = Motion::exact(self.clock(state.samples.saturating_sub(1)), there, omega, state.alpha);
        let beside = self.beside(&before);
        if let Some(hidden) = &mut self.hidden {
            let Motion { t, theta, omega, alpha, .. } = before;
            let mut memory = state.memory.clone();
            hidden.put(&self.model, &self.p, &mut memory, [t, theta, omega, alpha], beside, state.knob);
        }
        self.state = state;
        Ok(())
    }

    /// Why it renders nothing any more, if so.
    pub fn fault(&self) -> Option<Fault> {
        self.state.fault
    }

    /// The model that is rendered.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Whether the model has a function of a user's own, which a step then calls.
    pub fn calls_out(&self) -> bool {
        self.own
    }

    /// Samples per second.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt
    }

    /// Periods went by without a step: the next one stands for all of them.
    ///
    /// What the handle moved meanwhile is then no jump, time goes on, and a stuck knob is still held where it
    /// stuck. The torque may change by no more than it may within one period.
    pub fn missed(&mut self, periods: u64) {
        if self.state.samples > 0 {
            self.state.missed = self.state.missed.saturating_add(periods);
        }
    }

    /// The torque by which the knob answers, N m; call it once a sample.
    ///
    /// A quantity that is not finite, or a motion that no handle makes, gives zero torque, then and until a reset.
    #[inline]
    pub fn step(&mut self, sensed: Sensed) -> f64 {
        self.advance(sensed, None)
    }

    /// What functions of a user's own do to a knob behind a joint, where there are any.
    fn beside(&self, motion: &Motion<f64>) -> Option<Beside<f64>> {
        if !self.own || self.hidden.is_none() {
            return None;
        }
        let mut load = Load::none();
        self.model.own_load(&self.p, motion, &mut load);
        Some(Beside { drive: load.drive, friction_scale: load.friction_scale })
    }

    pub(super) fn clock(&self, samples: u64) -> f64 {
        samples as f64 * self.dt
    }

    /// One step; `known` is what the knob asks for if it slides, where that has been worked out already.
    #[inline(always)]
    pub(super) fn advance(&mut self, sensed: Sensed, known: Option<Sliding>) -> f64 {
        if self.state.fault.is_some() {
            return 0.0;
        }
        let Sensed { theta, omega, alpha, hand } = sensed;
        let seen = [theta, omega, alpha, hand.unwrap_or(0.0)];
        if !seen.into_iter().all(f64::is_finite) {
            return self.give_up(Fault::NotFinite);
        }
        let first = self.state.samples == 0;
        let missed = core::mem::take(&mut self.state.missed);
        self.state.samples += missed;
        let since = (missed + 1) as f64 * self.dt;
        let jump = if first { 0.0 } else { theta - self.state.before[0] };
        if jump.abs() > self.limits.speed * since || omega.abs() > self.limits.speed {
            return self.give_up(Fault::Jump);
        }
        if self.tank < f64::INFINITY {
            // What the last torque took while the handle moved.
            let tank = self.state.tank + self.state.tau * jump;
            self.state.tank = if self.forced { tank.min(self.tank) } else { tank };
            if self.state.tank <= 0.0 {
                return self.give_up(Fault::Energy);
            }
        }
        // Between two counts the speed tells the angle better than the encoder does.
        let half = 0.5 * self.tuning.count;
        let between = self.state.between + omega * since;
        let between = Scalar::min(Scalar::max(between, theta - half), theta + half);
        let between = if first { theta } else { between };
        let by = if first { 0.0 } else { between - self.state.between };
        self.state.between = between;
        let fresh = self.tuning.freshness;
        let fresh = if missed == 0 { fresh } else { 1.0 - Scalar::powf(1.0 - fresh, (missed + 1) as f64) };
        let filtered = self.state.alpha + fresh * (alpha - self.state.alpha);
        let felt = if first || fresh == 1.0 { alpha } else { filtered };
        self.state.alpha = felt;
        let clock = self.clock(self.state.samples);
        let there = theta + omega * self.tuning.ahead_s;
        let motion = Motion::exact(clock, there, omega, felt);
        let beside = self.beside(&motion);
        let asked = if let Some(hidden) = &mut self.hidden {
            // A knob that was not followed for so long may be anywhere: it starts again with the shaft.
            let lost = first || missed > LONGEST_GAP;
            if lost {
                hidden.begin(there, omega);
            }
            let (memory, to) = (&mut self.state.memory, [clock, there, omega, felt]);
            let missed = if lost { 0 } else { missed as usize };
            let torque = hidden.follow(&self.model, &self.p, memory, to, missed, beside);
            self.state.knob = hidden.knob();
            let shaft = self.model.shaft_load(&self.p, &mut self.state.memory, &motion).drive;
            Sliding { torque: torque + shaft, inertia: hidden.shafts }
        } else {
            self.rubbed(&motion, by, hand, known)
        };
        let [inertia, damping] = self.tuning.own;
        let tau = asked.torque + (asked.inertia + inertia) * felt + damping * omega;
        if !tau.is_finite() {
            return self.give_up(Fault::Torque);
        }
        // The torque of a reset is zero: so it starts from there.
        let tau = self.limits.cut(tau, self.state.tau, self.dt);
        (self.state.before, self.state.tau) = ([theta, sensed.omega], tau);
        self.state.samples += 1;
        tau
    }

    /// The torque of a knob on a rigid shaft, with dry friction between sticking and sliding.
    #[inline(always)]
    fn rubbed(
        &mut self,
        motion: &Motion<f64>,
        by: f64,
        hand: Option<f64>,
        known: Option<Sliding>,
    ) -> Sliding {
        let (model, p, own) = (&self.model, &self.p, self.own);
        let state = &mut self.state;
        let still = at_rest(motion);
        let (steady, remembers) = (&self.steady, !state.memory.is_empty());
        // Looks, and remembers nothing. What it answered would be copied, which takes a fifth of a step.
        let mut look = |memory: &[f64], motion: &Motion<f64>, load: &mut Load<f64>| {
            if remembers {
                self.spare.copy_from_slice(memory);
            }
            add_loads(model, p, own, &mut self.spare, motion, load);
        };
        if state.samples > 0 && state.contact.slides(by, motion.omega) != 0.0 {
            if let Some(known) = known {
                return known;
            }
            let rest = if self.guarded {
                let mut rest = *steady;
                look(&state.memory, &still, &mut rest);
                Some(rest.drive)
            } else {
                None
            };
            let mut load = *steady;
            add_loads(model, p, own, &mut state.memory, motion, &mut load);
            let [torque, inertia] = if model.is_plain() {
                sliding(&plain(&load), rest.map(Known::any), &motion.map(Known::any)).map(|known| known.x)
            } else {
                sliding(&load, rest, motion)
            };
            return Sliding { torque, inertia };
        }
        let mut load = |motion: &Motion<f64>| {
            let mut load = *steady;
            look(&state.memory, motion, &mut load);
            load
        };
        let ways = [Motion { forward: 0.0, ..*motion }, Motion { forward: 1.0, ..*motion }];
        let [back, forth] = ways.map(|way| load(&way));
        let rest = if self.guarded { Some(load(&still).drive) } else { None };
        let drives = [(back, ways[0]), (forth, ways[1])].map(|(load, way)| {
            // Only the way that it goes may brake: the other one is not gone.
            let gone = way.direction() * motion.omega > 0.0;
            rest.filter(|_| gone).map_or(load.drive, |rest| braked(&load, &way, rest))
        });
        // A spring among the effects (presliding) holds already, whichever way the knob would go.
        let elastic = back.strained(&forth, motion.alpha);
        let slide = [elastic - back.friction(0.0, motion.alpha), forth.friction(1.0, motion.alpha) - elastic]
            .map(|x| x.max(0.0));
        let hold = [back.hold[0] + elastic, forth.hold[1] - elastic].map(|x| x.max(0.0));
        let band = forth.band.max(SLOWEST);
        if state.samples == 0 {
            state.contact = Contact::first(motion.omega, band);
        }
        let mean = 0.5 * (drives[0] + drives[1]);
        let inertia = forth.inertia;
        let other = hand.map(|hand| {
            let own = self.tuning.own;
            hand - mean - elastic - (inertia + own[0]) * motion.alpha - own[1] * motion.omega
        });
        let moved = Moved { by, omega: motion.omega, band };
        let (friction, strain) = state.contact.answer(&self.tuning, &Budget { slide, hold }, moved, other);
        // The effects that remember see the sample once, and go the way that the knob is strained.
        if own || !state.memory.is_empty() {
            add_loads(model, p, own, &mut state.memory, motion, &mut Load::none());
        }
        let torque = if state.contact.slipping && strain.abs() == 1.0 {
            let (drive, load, way) =
                if strain > 0.0 { (drives[1], forth, 1.0) } else { (drives[0], back, 0.0) };
            drive + load.friction(way, motion.alpha)
        } else {
            mean + 0.5 * strain * (drives[1] - drives[0]) + elastic + friction
        };
        Sliding { torque, inertia }
    }

    /// Zero torque from here on.
    #[cold]
    fn give_up(&mut self, fault: Fault) -> f64 {
        self.state.fault = Some(fault);
        self.state.tau = 0.0;
        0.0
    }
}
