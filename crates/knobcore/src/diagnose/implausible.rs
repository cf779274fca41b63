//! Whether the values that an effect was fitted with can be its own, or it stands in for another.

use crate::effects::{Context, Id};
use crate::fit::Fit;
use crate::model::{Model, Role};
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
    let speed = data.first().map_or(0.0, |signals| {
        let rows: Vec<usize> = counted(&signals);
        let squares: f64 = rows.iter().map(|&at| signals.omega[at].powi(2)).sum();
        (squares / rows.len().max(1) as f64).sqrt()
    });
    let column = |of: fn(&Signals) -> &[f64]| -> Vec<f64> {
        let rows = |signals: &&Signals| -> Vec<f64> {
            let rows: Vec<usize> = counted(&signals);
            rows.into_iter().map(|at| of(signals)[at]).collect()
        };
        data.iter().flat_map(rows).collect()
    };
    Context {
        errors: (0..slots.len())
            .filter(|&at| slots[at].effect == id && slots[at].run.is_none())
            .map(error)
            .collect(),
        t: column(|signals| &signals.t),
        theta: column(|signals| &signals.theta),
        speed,
        rate_hz: data.first().map_or(1.0, |signals| signals.rate_hz),
        noise_floor: fit.noise_floor,
        period: fit.model.period().map(|at| slots[at].value),
        revolution: (fit.model.axis == Axis::Rotary).then_some(1.0),
        clipped,
        first,
    }
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
        let squares: f64 = data.omega.iter().zip(&data.weight).map(|(x, w)| w * x * x).sum();
        assert!((known.speed / (squares / 3999.0).sqrt() - 1.0).abs() < 1e-9);
        assert!(known.theta.len() == 3999 && known.travel() < 3.0 && known.t.len() == 3999);
        assert!(known.clipped && !known.first && known.period.is_none());
        assert_eq!((known.noise_floor, known.revolution), (fit.noise_floor, Some(1.0)));
    }
}
