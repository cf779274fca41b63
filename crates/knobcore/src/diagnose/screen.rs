//! Screening: what an effect would take off the error, to first order, from each of its starts.
//!
//! The columns of the base model are evaluated once and kept; a start costs its own columns alone, projected off all
//! of the base's, so that what the base parameters can absorb does not count. Of all columns as many samples are kept as
//! the measurement filter's bandwidth needs.

use super::chance::Chance;
use super::implausible::friction;
use super::thinned::Thinned;
use super::watch::Watch;
use crate::algebra::{dot, orthonormal, orthonormal_beside};
use crate::effects::{Id, Place, Survey, Wave, apart};
use crate::fit::{behind, beside_orders, glance, loads, runs, waves};
use crate::model::{Model, Role, Slot};
use crate::order::{Ascending, quantiles};
use crate::param::{Axis, Kind, Usual};
use crate::signals::Signals;

/// Steps of the quantiles of a survey.
const QUANTILES: usize = 400;

/// Sums of squares that a ripple instead of detents may leave, for those that it leaves beside them.
const SIMPLER: f64 = 1.5;

/// A fitted model, its derivative columns and its residual, ready to hold signatures against.
pub struct Screen<'a> {
    pub data: &'a [&'a Signals],
    pub model: &'a Model,
    pub survey: Survey,
    pub(super) thinned: Thinned,
    /// Derivative columns, thinned; an orthonormal base of them.
    pub(super) base: Vec<Vec<f64>>,
    /// The residual, thinned.
    pub(super) residual: Vec<f64>,
    /// Sum of squares of the whole residual, (N m)^2.
    pub squares: f64,
    /// Whether it is explained, and only what takes off enough of it to be named is looked for.
    pub explained: bool,
    /// Whether the model has a coupling.
    pub coupled: bool,
    /// What loads the shaft, and not the knob, once a joint is between them.
    shaft: Vec<Id>,
    /// The captures with the hidden knob's motion in place of the shaft's; none where they are one.
    behind: Vec<Signals>,
    /// How noise meets it, where chance is to be told of.
    pub chance: Option<Chance>,
    /// Who waits for it.
    pub watch: &'a Watch<'a>,
}

/// A start of an absent effect.
#[derive(Debug, Clone)]
pub struct Start {
    /// The model with the effect, at the start.
    pub model: Model,
    /// Sum of squares that one Gauss-Newton step from it promises, (N m)^2.
    pub predicted: f64,
    /// What becomes of its signature where that is multiplied with noise; none where chance is not to be told of.
    pub by_chance: Vec<Vec<f64>>,
}

impl<'a> Screen<'a> {
    /// Of a fitted model.
    pub fn new(data: &'a [&'a Signals], model: &'a Model, watch: &'a Watch<'a>) -> Self {
        let free: Vec<usize> = model.free().collect();
        let thinned = Thinned::of(data);
        let (columns, residual, squares) = thinned.columns(data, model, &free);
        let base = orthonormal(&columns, residual.len());
        let coupled = model.is_coupled();
        Self {
            data,
            model,
            survey: survey(data, model),
            thinned,
            base,
            residual,
            squares,
            explained: false,
            coupled,
            shaft: Vec::new(),
            behind: behind(data, model),
            chance: None,
            watch,
        }
    }

    /// The same, with these effects before a joint wherever one comes in.
    pub fn with_shaft(self, shaft: Vec<Id>) -> Self {
        Self { shaft, ..self }
    }

    /// All starts of an effect that the model may be given, most promising first; some, if no longer wanted.
    pub fn starts(&self, id: Id) -> Vec<Start> {
        let wave = id.info().scan;
        let beside = match wave {
            Some(Wave::Orders) => {
                let (data, model) = self.along(self.model);
                beside_orders(&data, &model).iter().map(|other| moved(self.model, other)).collect()
            }
            _ => vec![self.model.clone()],
        };
        let starts = |models: &[&Model]| {
            self.by_promise(id, models.iter().flat_map(|model| self.beside(id, model, wave)).collect())
        };
        let beside: Vec<&Model> = beside.iter().collect();
        let [own, bare, others @ ..] = &beside[..] else { return starts(&beside) };
        // Detents that are a whole order go, unless the ripple leaves much more without them. What they did, a promise
        // takes for absorbed: a few steps tell.
        let left = |starts: &[Start]| {
            starts.first().map_or(f64::INFINITY, |start| glance(self.data, &start.model).cost)
        };
        let (mut with, without) = (starts(&[&[*own], others].concat()), starts(&[*bare]));
        if left(&without) <= SIMPLER * left(&with) {
            return without;
        }
        with.extend(without);
        with.sort_by_cached_key(|start| Ascending(start.predicted));
        with
    }

    /// Models with an effect beside one, at each of the effect's starts.
    fn beside(&self, id: Id, beside: &Model, wave: Option<Wave>) -> Vec<Model> {
        let joins = |id: Id| id.info().place == Place::Coupling;
        let before = self.shaft.iter().filter(|_| joins(id));
        let with =
            beside.with(id).and_then(|with| before.copied().try_fold(with, |m, id| m.with_at_shaft(id)));
        let Ok(with) = with else { return Vec::new() };
        let values = match wave {
            Some(wave) => {
                let (data, model) = self.along(beside);
                let waves = Some(waves(&data, &model, wave));
                id.law().starts(&Survey { waves, ..self.survey.clone() })
            }
            None => id.law().starts(&self.survey),
        };
        values.iter().flat_map(|values| self.placed(&with, id, values)).collect()
    }

    /// The model with an effect as it starts from a wave: amplitude, period over 2 pi and phase. None where such a wave is no
    /// start of it.
    pub fn at_wave(&self, id: Id, wave: [f64; 3]) -> Option<Model> {
        let with = self.model.with(id).ok()?;
        let values = id.law().starts(&Survey { waves: Some(vec![wave]), ..self.survey.clone() });
        self.placed(&with, id, values.first()?).into_iter().next()
    }

    /// The same starts with what belongs to a run apart; none where there is nothing of the kind, or one run.
    pub fn apart(&self, id: Id, starts: &[Start]) -> Vec<Start> {
        let runs = runs(self.data);
        let models = starts.iter().filter_map(|start| start.model.apart(id, &runs));
        self.by_promise(id, models.collect())
    }

    /// The same starts before a joint and not behind it; none without one, or of what cannot be there.
    pub fn at_shaft(&self, id: Id, starts: &[Start]) -> Vec<Start> {
        if !self.coupled || !Model::may_be_at_shaft(id) {
            return Vec::new();
        }
        let moved = |start: &Start| start.model.with_at_shaft(id).ok();
        self.by_promise(id, starts.iter().filter_map(moved).collect())
    }

    /// The captures as an effect of a model sees them: with the motion of what it loads.
    pub fn seen_by(&self, id: Id, model: &Model) -> Vec<&Signals> {
        if self.behind.is_empty() || model.at_shaft(id) {
            return self.data.to_vec();
        }
        self.behind.iter().collect()
    }

    /// The captures along the motion of what loads the knob, and a model as it is looked at along it.
    fn along(&self, model: &Model) -> (Vec<&Signals>, Model) {
        if self.behind.is_empty() {
            return (self.data.to_vec(), model.clone());
        }
        (self.behind.iter().collect(), self.shown(model, Vec::new()).0)
    }

    /// The model at a start. What changes the detents may belong to slower ones, of which those that the base
    /// model found are the harmonic.
    fn placed(&self, with: &Model, id: Id, values: &[f64]) -> Vec<Model> {
        let mut p = with.values();
        let own = with.slots().iter().position(|slot| slot.effect == id).unwrap_or(p.len());
        for (slot, value) in p.iter_mut().skip(own).zip(values) {
            *slot = *value;
        }
        let at = |p: &[f64]| {
            let mut model = with.clone();
            model.set_values(p);
            model.settle();
            model
        };
        if id.info().place == Place::Coupling {
            level(with, &mut p);
        }
        let mut models = vec![at(&p)];
        // A coupling bends the inertia that the base model sees, even below zero.
        if let (Place::Coupling, Some(inertia)) = (id.info().place, with.inertia())
            && p[inertia] <= 0.0
        {
            models.clear();
            for times in [1.0, 3.0] {
                let mut heavier = p.clone();
                heavier[inertia] *= -times;
                models.push(at(&heavier));
            }
        }
        let followed = id.info().params.iter().find_map(|param| match param.usual {
            Usual::Follows(other) => with.index(other).ok(),
            _ => None,
        });
        models.extend(
            followed
                .into_iter()
                .flat_map(|period| id.info().slower.iter().map(move |times| (period, times)))
                .map(|(period, times)| {
                    let mut slower = p.clone();
                    slower[period] *= times;
                    at(&slower)
                }),
        );
        models
    }

    /// What the signatures of an effect beside the base have of the residual, from some of its starts each.
    pub fn leans(&self, id: Id, most: usize) -> Vec<Vec<f64>> {
        let models = self.beside(id, self.model, id.info().scan);
        let rows = self.residual.len();
        let lean = |model: &Model| {
            let (shown, own) = self.shown(model, self.brought(id, model));
            let columns = |of: &Model| self.thinned.columns(&self.seen_by(id, model), of, &own).0;
            let mut both = columns(&shown);
            both.extend(turned(&shown, id).iter().flat_map(columns));
            let beside = orthonormal_beside(&self.base, &both, rows);
            beside.iter().map(|direction| dot(&self.residual, direction)).collect()
        };
        evenly(&models, most).map(lean).collect()
    }

    /// Parameters of a start whose columns an effect brings in: its own, what runs have apart, and where it has slower
    /// detents in the place of those of the base, theirs. None of a coupling: columns of a hidden motion cost more than
    /// they tell.
    pub fn brought(&self, id: Id, model: &Model) -> Vec<usize> {
        let slots = model.slots();
        let slower = !id.info().slower.is_empty() && !self.keeps(model);
        let brings = |slot: &Slot| {
            let of_slower = slower && id.info().needs == Some(slot.effect.info().id);
            slot.effect == id || slot.run.is_some() || of_slower
        };
        (0..slots.len())
            .filter(|&i| slots[i].role == Role::Free && id.info().place != Place::Coupling)
            .filter(|&i| brings(&slots[i]))
            .collect()
    }

    /// Whether a start has the values of the screen's model in all that this has.
    pub fn keeps(&self, start: &Model) -> bool {
        let known = |slot: &Slot| self.model.index(&slot.name()).ok().map(|j| self.model.slots()[j].value);
        start.slots().iter().all(|slot| known(slot).is_none_or(|value| value == slot.value))
    }

    /// Whether a start of what may have slower detents in the place of the model's has the model's own. Many waves over
    /// slower detents draw more in one step than fewer over those of the model, which may be a few per cent off: they have
    /// their steps too.
    pub fn has_own(&self, id: Id, start: &Start) -> bool {
        !id.info().slower.is_empty() && self.keeps(&start.model)
    }

    /// A model and some of its parameters as they are looked at: beside a coupling as if it were rigid, along the
    /// motion of what they load. To simulate how a load moves the hidden knob takes a hundred times as long.
    pub fn shown(&self, model: &Model, mut params: Vec<usize>) -> (Model, Vec<usize>) {
        let mut shown = model.clone();
        if self.coupled {
            shown = loads(model);
            params.retain_mut(|i| {
                let at = shown.index(&model.slots()[*i].name());
                at.map(|at| *i = at).is_ok()
            });
        }
        (shown, params)
    }
}

/// A model with the phases of an effect's waves a quarter on; none where it has no wave without an amplitude, of which
/// the phase tells nothing and the amplitude no more than half.
fn turned(model: &Model, id: Id) -> Option<Model> {
    let mut p = model.values();
    let silent = |slot: &Slot| match slot.param.kind {
        Kind::PhaseOf(amplitude) => slot.effect == id && model.slots()[slot.base + amplitude].value == 0.0,
        _ => false,
    };
    let phases: Vec<usize> = (0..p.len()).filter(|&at| silent(&model.slots()[at])).collect();
    phases.iter().for_each(|&at| p[at] += std::f64::consts::FRAC_PI_2);
    let mut turned = model.clone();
    turned.set_values(&p);
    (!phases.is_empty()).then_some(turned)
}

/// At most so many of some things, spread over all of them.
pub fn evenly<T>(things: &[T], most: usize) -> impl Iterator<Item = &T> {
    things.iter().step_by(things.len().div_ceil(most).max(1))
}

/// Keeps the first of starts that are one: on a heavy machine many of a joint's lie at the same bounds.
pub(super) fn alone(starts: &mut Vec<(usize, Model)>) {
    let mut kept: Vec<(usize, Vec<Id>, Vec<f64>)> = Vec::new();
    starts.retain(|(of, model)| {
        let own = (*of, model.shafts().to_vec(), model.values());
        let other = !kept.contains(&own);
        kept.extend(other.then_some(own));
        other
    });
}

/// A model with the values and roles that another has by the same names.
fn moved(model: &Model, other: &Model) -> Model {
    let mut moved = model.clone();
    for slot in other.slots() {
        // What only the other has does not count.
        let _ = moved.set(&slot.name(), slot.value).and_then(|()| moved.set_role(&slot.name(), slot.role));
    }
    moved
}

/// Brings what resists forward and backward nearer to each other: a joint bends them apart, even below zero, and a
/// knob that nothing brakes one way goes where no other does.
fn level(model: &Model, p: &mut [f64]) {
    for at in 1..p.len() {
        let slots = &model.slots()[at - 1..=at];
        if slots[0].effect != slots[1].effect || [slots[0].param.name, slots[1].param.name] != ["neg", "pos"]
        {
            continue;
        }
        let (neg, pos) = (p[at - 1], p[at]);
        let mean = 0.5 * (neg + pos);
        if apart(neg, pos) && mean > 0.0 {
            p[at - 1] = mean;
            p[at] = mean;
        }
    }
}

/// What a capture and a model say to starts of effects.
pub(super) fn survey(data: &[&Signals], model: &Model) -> Survey {
    let counted = |of: &dyn Fn(&Signals, usize) -> f64| -> Vec<f64> {
        let values =
            data.iter().flat_map(|s| (0..s.len()).filter(|&at| s.weight[at] > 0.0).map(|at| of(s, at)));
        quantiles(values.collect(), QUANTILES)
    };
    Survey {
        theta: counted(&|s, at| s.theta[at]),
        speed: counted(&|s, at| s.omega[at].abs()),
        torque: counted(&|s, at| s.tau_raw[at].abs()),
        duration_s: data.iter().filter_map(|s| s.t.last()).fold(0.0, |a: f64, b| a.max(*b)),
        rate_hz: data.first().map_or(1.0, |s| s.rate_hz),
        inertia: model.inertia().map_or(0.0, |i| model.slots()[i].value.abs()),
        friction: friction(model),
        revolution: (model.axis == Axis::Rotary).then_some(1.0),
        waves: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_brakes_one_way_alone_is_shared_out_and_what_brakes_both_is_left() {
        let model = Model::equation_1(Axis::Rotary, false);
        for (given, right) in [
            ([-1.0, 3.0], [1.0, 1.0]),
            ([0.5, 1.0], [0.75, 0.75]),
            ([0.7, 1.0], [0.7, 1.0]),
            ([1.0, 0.1], [0.55, 0.55]),
            ([-3.0, 1.0], [-3.0, 1.0]),
        ] {
            let mut p = [vec![1e-4], given.to_vec(), vec![2.0, 2.0]].concat();
            level(&model, &mut p);
            assert_eq!(p, [vec![1e-4], right.to_vec(), vec![2.0, 2.0]].concat(), "{given:?}");
        }
    }
}
