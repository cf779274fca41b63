//! The chain on a motion that is prescribed, through a joint: the hidden knob's torque and its derivatives.

use super::rigid;
use crate::chain::hidden::{Beside, Follow, Hidden};
use crate::effects::law::{CARRIED, Carried, D, Response};
use crate::effects::{Id, Place};
use crate::isa;
use crate::model::Model;
use crate::motion::Channel;
use crate::scalar::{Packed, Scalar, Wide};
use crate::threads::share;

/// Torque and derivatives on the shaft; what the columns held is replaced.
pub(super) fn loads(
    model: &Model,
    p: &[f64],
    columns: &[Option<usize>],
    follow: Follow,
    over: &mut Response<'_>,
) {
    knobs(model, p, columns, follow, over);
    if !model.shafts().is_empty() {
        shafts(model, p, columns, follow.begins.bent, over);
    }
}

/// Torques on the shaft of at most [`WIDE`](crate::scalar::WIDE) sets of parameters, none of which is a user's own.
pub(super) fn side_by_side(
    model: &Model,
    sets: &[Vec<f64>],
    follow: Follow,
    motion: [&[f64]; 5],
    dt: f64,
    torques: &mut [Vec<f64>],
) {
    // Lanes that are left over repeat the last set.
    let lane = |lane: usize| sets.get(lane).or(sets.last());
    let all = |at: usize| Packed(core::array::from_fn(|k| lane(k).map_or(0.0, |p| p[at])));
    let p: Vec<Wide> = (0..model.slots().len()).map(all).collect();
    let columns = vec![None; p.len()];
    let own = Own::default();
    let behind = Behind { model, columns: &columns, own: &own, motion, dt, follow };
    let out = |at: usize, tau: Wide| {
        torques.iter_mut().zip(tau.0).for_each(|(torque, tau)| torque[at] = tau);
    };
    isa::dispatch_wide(Simulation { of: &behind, p: &p, beside: |_| None, out });
    if !model.shafts().is_empty() {
        for (p, torque) in sets.iter().zip(torques) {
            let over = &mut Response { motion, dt, torque, slopes: &mut [] };
            shafts(model, p, &columns, follow.begins.bent, over);
        }
    }
}

/// Adds what loads the shaft itself: what a rigid knob would ask for with it, less what it would without. Friction
/// there is that of the model, as far as the effects at the shaft change it.
fn shafts(model: &Model, p: &[f64], columns: &[Option<usize>], bent: f64, over: &mut Response<'_>) {
    for (sign, parts) in [1.0, -1.0].into_iter().zip(model.sides(p, columns)) {
        let mut torque = vec![0.0; over.torque.len()];
        let mut slopes = vec![torque.clone(); over.slopes.len()];
        let side =
            &mut Response { motion: over.motion, dt: over.dt, torque: &mut torque, slopes: &mut slopes };
        rigid::loads(&parts, bent, side);
        over.torque.iter_mut().zip(&torque).for_each(|(sum, tau)| *sum += sign * tau);
        for (sum, slope) in over.slopes.iter_mut().zip(&slopes) {
            sum.iter_mut().zip(slope).for_each(|(sum, slope)| *sum += sign * slope);
        }
    }
}

/// Torque and derivatives of the joint and of the shaft's own inertia. Only what moves the knob is carried along.
fn knobs(model: &Model, p: &[f64], columns: &[Option<usize>], follow: Follow, over: &mut Response<'_>) {
    let at_knob = |(at, column): (usize, &Option<usize>)| {
        let id = model.slots()[at].effect;
        column.filter(|_| id.info().place != Place::Sensor && !model.at_shaft(id))
    };
    let seen: Vec<Option<usize>> = columns.iter().enumerate().map(at_knob).collect();
    let carried: Vec<usize> = (0..over.slopes.len()).filter(|column| seen.contains(&Some(*column))).collect();
    let lane = |column: &usize| carried.binary_search(column).ok();
    let lanes: Vec<Option<usize>> = seen.iter().map(|column| column.as_ref().and_then(lane)).collect();
    let own = Own::over(model, p, &lanes, over.motion);
    let behind = Behind { model, columns: &lanes, own: &own, motion: over.motion, dt: over.dt, follow };
    let mut slopes = Vec::new();
    for (column, slope) in over.slopes.iter_mut().enumerate() {
        if lane(&column).is_some() {
            slopes.push(slope);
        } else {
            slope.fill(0.0);
        }
    }
    if slopes.is_empty() {
        let torque = &mut *over.torque;
        behind.simulate(p, |at| own.at(at), |at, tau: f64| torque[at] = tau);
        return;
    }
    // Each group is followed with the torque; that of the first is kept.
    let mut others = vec![vec![0.0; over.torque.len()]; slopes.len().div_ceil(CARRIED) - 1];
    let torques = core::iter::once(&mut *over.torque).chain(others.iter_mut().map(Vec::as_mut_slice));
    let groups = slopes.chunks_mut(CARRIED).zip(torques).enumerate().collect();
    share(groups, |(group, (few, torque))| behind.carry(p, group * CARRIED, torque, few));
}

/// The motion of the hidden knob along a shaft's: angle, speed and acceleration at each sample. Functions of a user's
/// own are left out of it. None without a joint.
pub fn knob(model: &Model, p: &[f64], motion: [&[f64]; 5], dt: f64, follow: Follow) -> Option<[Vec<f64>; 3]> {
    let mut state = model.begins(follow.begins.bent);
    let [t, theta, omega, alpha, _] = motion;
    let instant = |at: usize| [t[at], theta[at], omega[at], alpha[at]];
    if t.is_empty() {
        return None;
    }
    let mut hidden = Hidden::<f64>::new(model, p, instant(0), dt, follow)?;
    let (mut angles, mut speeds) = (Vec::with_capacity(t.len()), Vec::with_capacity(t.len()));
    for at in 0..t.len() {
        hidden.follow(model, p, &mut state, instant(at), missed(t, at, dt), None);
        let [theta, omega] = hidden.knob();
        angles.push(theta);
        speeds.push(omega);
    }
    let last = speeds.len() - 1;
    let slope = |at: usize| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(last));
        (speeds[after] - speeds[before]) / (dt * (after - before).max(1) as f64)
    };
    let accelerations = (0..=last).map(slope).collect();
    Some([angles, speeds, accelerations])
}

/// At most so many missing samples are stepped through one by one.
const MOST_MISSED: usize = 1000;

/// Samples that are missing before this one.
fn missed(t: &[f64], at: usize, dt: f64) -> usize {
    let before = t[at.saturating_sub(1)];
    // Less than one, or no number, is none.
    (((t[at] - before) / dt - 0.5) as usize).min(MOST_MISSED)
}

/// What is simulated, and by which parameters it is differentiated.
struct Behind<'a> {
    model: &'a Model,
    columns: &'a [Option<usize>],
    own: &'a Own,
    /// t, theta, omega, alpha, forward of the shaft.
    motion: [&'a [f64]; 5],
    dt: f64,
    follow: Follow,
}

impl Behind<'_> {
    /// Simulates with the derivatives whose columns begin at `first`.
    fn carry(&self, p: &[f64], first: usize, torque: &mut [f64], few: &mut [&mut Vec<f64>]) {
        let lane = |column: usize| column.checked_sub(first).filter(|lane| *lane < CARRIED);
        let seed =
            |(i, x): (usize, &f64)| D::seeded(*x, self.columns.get(i).copied().flatten().and_then(lane));
        let p: Vec<_> = p.iter().enumerate().map(seed).collect();
        let beside = |at: usize| {
            let Beside { drive, friction_scale } = self.own.at(at)?;
            let mut beside =
                Beside { drive: D::constant(drive), friction_scale: D::constant(friction_scale) };
            for (channel, column, slope) in &self.own.slopes {
                if let Some(lane) = lane(*column) {
                    match channel {
                        Channel::FrictionScale => beside.friction_scale.d[lane] += slope[at] * friction_scale,
                        _ => beside.drive.d[lane] += slope[at],
                    }
                }
            }
            Some(beside)
        };
        let out = |at: usize, tau: D| {
            torque[at] = tau.v;
            few.iter_mut().zip(tau.d).for_each(|(column, slope)| column[at] = slope);
        };
        self.simulate(&p, beside, out);
    }

    fn simulate<T: Carried>(
        &self,
        p: &[T],
        beside: impl Fn(usize) -> Option<Beside<T>>,
        out: impl FnMut(usize, T),
    ) {
        isa::dispatch(Simulation { of: self, p, beside, out });
    }
}

/// A simulation as a value, so that its body is compiled for the machine's instruction set.
struct Simulation<'a, T, B, F> {
    of: &'a Behind<'a>,
    p: &'a [T],
    beside: B,
    out: F,
}

impl<T: Carried, B: Fn(usize) -> Option<Beside<T>>, F: FnMut(usize, T)> pulp::NullaryFnOnce
    for Simulation<'_, T, B, F>
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { of: Behind { model, motion, dt, follow, .. }, p, beside, mut out } = self;
        let [t, theta, omega, alpha, _] = *motion;
        let instant = |at: usize| [t, theta, omega, alpha].map(|column| column[at]);
        let mut state: Vec<T> = model.begins(follow.begins.bent).into_iter().map(T::of).collect();
        if t.is_empty() {
            return;
        }
        let Some(mut hidden) = Hidden::new(model, p, instant(0), *dt, *follow) else { return };
        for (at, alpha) in alpha.iter().enumerate() {
            let missed = missed(t, at, *dt);
            let force = hidden.follow(model, p, &mut state, instant(at), missed, beside(at));
            out(at, hidden.shafts.scaled(T::Value::of(*alpha)) + force);
        }
    }
}

/// What functions of a user's own do to the knob along the shaft's motion: torque and factor on the friction, empty
/// without any; and derivatives by column, those of factors as a share of the factor.
#[derive(Default)]
struct Own {
    drive: Vec<f64>,
    friction_scale: Vec<f64>,
    slopes: Vec<(Channel, usize, Vec<f64>)>,
}

impl Own {
    fn over(model: &Model, p: &[f64], columns: &[Option<usize>], motion: [&[f64]; 5]) -> Self {
        let mut own = Self::default();
        let samples = motion[0].len();
        for (id, p, columns) in model.parts(p, columns) {
            let Id::User(user) = id else { continue };
            if user.info.place != Place::Load || !id.calls_out() {
                continue;
            }
            own.drive.resize(samples, 0.0);
            own.friction_scale.resize(samples, 1.0);
            let (channel, values) = (user.channel(), user.over(p, &motion));
            for (i, value) in values.iter().enumerate() {
                match channel {
                    Channel::FrictionScale => own.friction_scale[i] *= value,
                    _ => own.drive[i] += value,
                }
            }
            for (i, column) in columns.iter().enumerate().filter_map(|(i, column)| Some((i, (*column)?))) {
                let mut slope = user.slope(p, i, &motion);
                if channel == Channel::FrictionScale {
                    slope.iter_mut().zip(&values).for_each(|(slope, value)| *slope /= value);
                }
                own.slopes.push((channel, column, slope));
            }
        }
        own
    }

    fn at(&self, at: usize) -> Option<Beside<f64>> {
        Some(Beside { drive: *self.drive.get(at)?, friction_scale: *self.friction_scale.get(at)? })
    }
}

#[cfg(test)]
mod tests {
    use crate::chain::{self, Follow};
    use crate::effects::law::Response;
    use crate::effects::{Id, Place};
    use crate::model::Model;
    use crate::param::Axis;

    const DT: f64 = 1e-3;

    /// A knob behind a joint, with an effect more.
    fn knob(coupling: Id, other: Option<Id>) -> Model {
        let mut model =
            Model::equation_1(Axis::Rotary, true).with(Id::Karnopp).unwrap().with(coupling).unwrap();
        if let Some(other) = other.filter(|other| !model.has(*other)) {
            model = model.with(other).unwrap();
        }
        model
    }

    /// A motion to and fro: t, theta, omega, alpha, forward of so many samples.
    fn swung(samples: u32, dt: f64, angle: f64, w: f64) -> [Vec<f64>; 5] {
        let over = |of: &dyn Fn(f64) -> f64| (0..samples).map(|i| of(f64::from(i) * dt)).collect();
        [
            over(&|t| t),
            over(&|t| angle * (w * t).sin()),
            over(&|t| angle * w * (w * t).cos()),
            over(&|t| -angle * w * w * (w * t).sin()),
            over(&|t| f64::from(u8::from((w * t).cos() > 0.0))),
        ]
    }

    /// Parameters of ordinary sizes, other ones in each set.
    fn sets(model: &Model, count: usize) -> Vec<Vec<f64>> {
        let value = |set: usize| {
            move |(at, slot): (usize, &crate::model::Slot)| {
                let param = slot.param;
                let share = 0.2 + 0.6 * ((7 * set + 3 * at) % 11) as f64 / 11.0;
                (param.neutral + share * param.scale()).clamp(param.lower, param.upper)
            }
        };
        (0..count).map(|set| model.slots().iter().enumerate().map(value(set)).collect()).collect()
    }

    #[test]
    fn derivatives_that_died_away_while_surfaces_stick_together_do_not_stay_as_numbers_that_take_long() {
        let mut model = Model::equation_1(Axis::Rotary, false).with(Id::Backlash).unwrap();
        let base = [("inertia.M", 4e-5), ("coulomb.neg", 3e-3), ("coulomb.pos", 3e-3)];
        let joint = [("backlash.gap", 2e-3), ("backlash.k", 3000.0), ("backlash.d", 0.2)];
        for (name, value) in base.into_iter().chain(joint) {
            model.set(name, value).unwrap();
        }
        let columns = swung(5000, 2e-4, 1.0, 8.0);
        let motion = columns.each_ref().map(Vec::as_slice);
        let all: Vec<Option<usize>> = (0..model.slots().len()).map(Some).collect();
        let mut torque = vec![0.0; 5000];
        let mut slopes = vec![torque.clone(); all.len()];
        let over = &mut Response { motion, dt: 2e-4, torque: &mut torque, slopes: &mut slopes };
        chain::along(&model, &model.values(), &all, Follow::of(2), over);
        // 13 of 100 were subnormal, and a pass took four times as long.
        let tiny = slopes.iter().flatten().filter(|slope| slope.is_subnormal()).count();
        assert!(tiny * 1000 < slopes.len() * 5000, "{tiny}");
        assert!(slopes.iter().all(|column| column.iter().any(|slope| slope.abs() > 1e-9)));
    }

    #[test]
    fn knobs_that_are_followed_side_by_side_go_where_each_goes_alone() {
        let columns = swung(1500, DT, 0.3, 9.0);
        let motion = columns.each_ref().map(Vec::as_slice);
        let others = Id::BUILT_IN.iter().filter(|id| id.info().place != Place::Coupling);
        for other in others.map(|id| Some(*id)).chain([None]) {
            for coupling in [Id::Backlash, Id::Compliance] {
                let model = knob(coupling, other);
                // One pack, and one with lanes that are left over.
                let sets = sets(&model, 11);
                let mut torques = vec![vec![0.0; 1500]; sets.len()];
                chain::several(&model, &sets, Follow::of(2), motion, DT, &mut torques);
                let none = vec![None; model.slots().len()];
                let mut moved = 0;
                for (p, side) in sets.iter().zip(&torques) {
                    let mut alone = vec![0.0; 1500];
                    let over = &mut Response { motion, dt: DT, torque: &mut alone, slopes: &mut [] };
                    chain::along(&model, p, &none, Follow::of(2), over);
                    let size = alone.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
                    moved += usize::from(size.is_finite() && size > 0.0);
                    for (at, (side, alone)) in side.iter().zip(&alone).enumerate() {
                        let same = (side - alone).abs() <= 1e-12 * size || side.is_nan() && alone.is_nan();
                        assert!(same, "{other:?} {coupling:?} {at}: {side} {alone}");
                    }
                }
                assert!(moved > 8, "{other:?} {coupling:?}: {moved}");
            }
        }
    }
}
