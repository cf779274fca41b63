//! What captures say nothing about, and why.

use super::layout::Layout;
use super::moments::Moments;
use super::solve::Normal;
use crate::model::{Model, Role};
use crate::param::Kind;
use crate::predict::{Columns, Seeds, raw};
use crate::signals::Signals;

/// A parameter that the capture does not determine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Undetermined {
    /// `effect.parameter`.
    pub name: String,
    /// Why, and what to record.
    pub why: String,
}

/// Why a parameter without influence is undetermined.
pub(super) fn unheard(captures: usize) -> String {
    format!("nothing in {} depends on it; record a motion that does, or fix it", these(captures))
}

fn these(captures: usize) -> &'static str {
    if captures == 1 { "this capture" } else { "these captures" }
}

/// Linear parameters that the torque of no counted sample depends on. The filter smears a trace of them into
/// counted samples from others, which would let them be fitted, to anything.
pub(super) fn silent(data: &[&Signals], model: &Model) -> Vec<String> {
    let slots = model.slots();
    let linear: Vec<usize> = (0..slots.len())
        .filter(|&i| slots[i].role == Role::Free && model.kind(&slots[i]) == Kind::Linear)
        .collect();
    let seeds = Seeds::of(model, &linear);
    let mut heard = vec![false; linear.len()];
    let mut columns = Columns::default();
    for signals in data {
        for chunk in signals.chunks(model.remembers()) {
            raw(model, &model.values(), &seeds, signals, chunk.core.clone(), &mut columns);
            let weight = &signals.weight[chunk.core];
            for (heard, column) in heard.iter_mut().zip(columns.split().1) {
                *heard = *heard || column.iter().zip(weight).any(|(d, w)| d * w != 0.0);
            }
            if heard.iter().all(|heard| *heard) {
                return Vec::new();
            }
        }
    }
    linear.iter().zip(heard).filter(|(_, heard)| !heard).map(|(&i, _)| slots[i].name()).collect()
}

/// Times the torque that a parameter as large as it is may move it by, by its derivative.
const WILD: f64 = 1e5;
/// Why one that moves it by more is undetermined.
const LEAPS: &str =
    "behind the joint the least change of it leads to another motion; record a slower or smaller one";

/// Whether a derivative tells nothing: where surfaces knock again and again each knock multiplies what the one before it
/// was off by, until the last digit of a parameter decides where the knob is.
/// `total` is the sum of squares of the torque.
fn wild(model: &Model, layout: &Layout, at: &Moments, total: f64, column: usize) -> bool {
    let value = model.slots()[layout.free[column]].value;
    model.is_coupled() && at.gram(column, column) * value * value > WILD * WILD * total
}

/// The columns that are not wild, those that are linear first.
pub(super) fn tame(model: &Model, layout: &Layout, at: &Moments, total: f64) -> Vec<usize> {
    layout.linear_first().into_iter().filter(|column| !wild(model, layout, at, total, *column)).collect()
}

/// Says why a column is not determined: it is silent or wild, or a combination of others.
pub(super) fn undetermined(
    model: &Model,
    layout: &Layout,
    at: &Moments,
    total: f64,
    kept: &[usize],
    column: usize,
    captures: usize,
) -> Undetermined {
    let name = |column: usize| model.slots()[layout.free[column]].name();
    let length = at.gram(column, column);
    let why = if wild(model, layout, at, total, column) {
        LEAPS.into()
    } else if length > 0.0 {
        let along = Normal::of(|i, j| at.gram(i, j), kept)
            .map(|normal| normal.solve(|i| at.gram(kept[i], column)))
            .unwrap_or_default();
        let parts = kept.iter().zip(&along).filter(|(i, x)| (*x * *x) * at.gram(**i, **i) > 1e-4 * length);
        let others: Vec<String> = parts.map(|(&i, _)| name(i)).collect();
        format!(
            "{} cannot tell it from {}; record a motion that does, or fix or tie one of them",
            these(captures),
            others.join(", ")
        )
    } else {
        unheard(captures)
    };
    Undetermined { name: name(column), why }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Id;
    use crate::param::Axis;

    #[test]
    fn what_several_captures_cannot_tell_is_said_of_all_of_them() {
        for (captures, whose) in [(1, "this capture"), (2, "these captures")] {
            assert!(unheard(captures).contains(whose));
            let model = Model::equation_1(Axis::Rotary, false);
            let layout = Layout::of(&model);
            let mut at = Moments::empty(layout.free.len());
            // All columns are one: of two of them either does.
            let mut columns = vec![[1.0, 2.0]; layout.free.len()];
            columns.push([0.0; 2]);
            at.add_columns(&columns.iter().map(<[f64; 2]>::as_slice).collect::<Vec<_>>());
            let why = undetermined(&model, &layout, &at, 1.0, &[0], 1, captures).why;
            assert!(why.starts_with(&format!("{whose} cannot tell it from")), "{why}");
        }
    }

    #[test]
    fn a_derivative_of_which_the_last_digit_moves_all_is_told_to_be_wild_behind_a_joint_and_nowhere_else() {
        let bare = Model::equation_1(Axis::Rotary, false);
        let joined = bare.with(Id::Compliance).unwrap();
        for (mut model, behind) in [(bare, false), (joined, true)] {
            model.set("inertia.M", 2e-4).unwrap();
            let layout = Layout::of(&model);
            let mass = layout.free.iter().position(|i| model.slots()[*i].name() == "inertia.M").unwrap();
            // Of two samples: what the mass moves, and what is left of a torque of one.
            for (times, leaps) in [(1.1, behind), (0.9, false)] {
                let columns =
                    (0..layout.free.len()).map(|c| if c == mass { times * WILD / 2e-4 } else { 0.0 });
                let mut columns: Vec<[f64; 2]> = columns.map(|moves| [moves, 0.0]).collect();
                columns.push([0.0; 2]);
                let mut at = Moments::empty(layout.free.len());
                at.add_columns(&columns.iter().map(<[f64; 2]>::as_slice).collect::<Vec<_>>());
                assert_eq!(!tame(&model, &layout, &at, 1.0).contains(&mass), leaps, "{behind} {times}");
                let why = undetermined(&model, &layout, &at, 1.0, &[], mass, 1).why;
                assert_eq!(why == LEAPS, leaps, "{why}");
            }
        }
    }
}
