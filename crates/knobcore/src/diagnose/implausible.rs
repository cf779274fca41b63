//! Whether the values that an effect was fitted with can be its own, or it stands in for another.

use crate::effects::{Context, Id};
use crate::fit::Fit;
use crate::model::{Model, Role};
use crate::motion::Motion;
use crate::param::Axis;
use crate::rule::rule;
use crate::signals::Signals;
use std::f64::consts::TAU;

/// What is implausible about the values of an effect of a fit, a sentence each, beside those that no parameter may
/// have alone. `clipped` says that the torque sensor was seen at its limit, `first` that the effect is the first that
/// is added.
pub fn implausible(data: &[&Signals], fit: &Fit, id: Id, clipped: bool, first: bool) -> Vec<String> {
    let context = context(data, fit, id, clipped, first);
    let slots = fit.model.slots().iter().filter(|slot| slot.effect == id && slot.run.is_none());
    let values: Vec<f64> = slots.map(|slot| slot.value).collect();
    let mut said = Vec::new();
    // A change of one detent alone is any map of position.
    if let Some(period) = context.period.filter(|_| changes_detents(&fit.model, id)) {
        let crossed = context.travel() / (TAU * period);
        if crossed < rule().crossed {
            said.push(format!("only {crossed:.1} detents were crossed"));
        }
    }
    said.extend(id.law().implausible(&values, &context));
    said
}

fn changes_detents(model: &Model, id: Id) -> bool {
    let detents = model.period().map(|at| model.slots()[at].effect.info().id);
    detents.is_some() && id.info().needs == detents
}

fn context(data: &[&Signals], fit: &Fit, id: Id, clipped: bool, first: bool) -> Context {
    let slots = fit.model.slots();
    let errors = fit.standard_errors();
    let error = |at: usize| match slots[at].role {
        Role::Fixed => Some(0.0),
        Role::Free => fit.free.iter().position(|free| *free == at).map(|i| errors[i]),
        Role::Tied(to) => fit.free.iter().position(|free| *free == to).map(|i| errors[i]),
    };
    let counted = |signals: &&&Signals| (0..signals.len()).filter(|&at| signals.weight[at] > 0.0).collect();
    let turns = |signals: &Signals, at: usize| {
        let counts = signals.weight[at - 1].min(signals.weight[at]) > 0.0;
        counts && signals.omega[at - 1] * signals.omega[at] <= 0.0
    };
    let squares = |signals: &&Signals| -> Vec<f64> {
        (1..signals.len()).filter(|&at| turns(signals, at)).map(|at| signals.alpha[at].powi(2)).collect()
    };
    let squares: Vec<f64> = data.iter().flat_map(squares).collect();
    let turning = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
    let column = |of: fn(&Signals) -> &[f64]| -> Vec<f64> {
        let rows = |signals: &&Signals| -> Vec<f64> {
            let rows: Vec<usize> = counted(&signals);
            rows.into_iter().filter_map(|at| of(signals).get(at).copied()).collect()
        };
        data.iter().flat_map(rows).collect()
    };
    Context {
        errors: (0..slots.len())
            .filter(|&at| slots[at].effect == id && slots[at].run.is_none())
            .map(error)
            .collect(),
        t: column(|signals| &signals.t),
        torque: column(|signals| &signals.tau_raw),
        theta: column(|signals| &signals.theta),
        turning,
        rate_hz: data.first().map_or(1.0, |signals| signals.rate_hz),
        noise_floor: fit.noise_floor,
        period: fit.model.period().map(|at| slots[at].value),
        period_error: fit.model.period().and_then(error).unwrap_or(0.0),
        revolution: (fit.model.axis == Axis::Rotary).then_some(1.0),
        friction: friction(&fit.model),
        clipped,
        first,
    }
}

/// Dry friction backward and forward, N m.
pub(super) fn friction(model: &Model) -> [f64; 2] {
    model.load(&model.values(), &mut vec![0.0; model.states()], &Motion::exact(0.0, 0.0, 0.0, 0.0)).resist
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded::{knob, recorded};
    use super::*;
    use crate::fit::refine;

    #[test]
    fn what_is_known_of_an_effect_are_its_own_errors_and_how_it_was_turned() {
        let model = knob(&[Id::ReturnSpring], &[("return_spring.k", 2e-3)]);
        let mut data = recorded(&model, "a");
        (data.theta[9], data.omega[9], data.weight[9]) = (50.0, 50.0, 0.0);
        let fit = refine(&[&data], &model).unwrap();
        let known = context(&[&data], &fit, Id::ReturnSpring, true, false);
        let slots = fit.model.slots();
        let own: Vec<usize> = (0..slots.len()).filter(|at| slots[*at].effect == Id::ReturnSpring).collect();
        assert_eq!(known.errors.len(), own.len());
        for (error, at) in known.errors.iter().zip(own) {
            let free = fit.free.iter().position(|free| *free == at);
            let right = if slots[at].role == Role::Fixed { Some(0.0) } else { None };
            assert_eq!(*error, free.map(|i| fit.standard_errors()[i]).or(right), "{}", slots[at].name());
        }
        let forth: Vec<(usize, bool)> =
            (0..4000).filter(|at| *at != 9).map(|at| (at, data.omega[at] > 0.0)).collect();
        let turned = |pair: &&[(usize, bool)]| pair[0].1 != pair[1].1;
        let at: Vec<f64> = forth.windows(2).filter(turned).map(|pair| data.alpha[pair[1].0]).collect();
        let mean = at.iter().map(|alpha| alpha * alpha).sum::<f64>() / at.len() as f64;
        assert!(at.len() > 2 && (known.turning / mean.sqrt() - 1.0).abs() < 1e-9);
        assert!(known.theta.len() == 3999 && known.travel() < 3.0 && known.t.len() == 3999);
        assert_eq!(known.friction, [slots[1].value, slots[2].value]);
        assert!(known.clipped && !known.first && known.period.is_none());
        assert_eq!((known.noise_floor, known.revolution), (fit.noise_floor, Some(1.0)));
    }
}
