//! What Python calls by a name.
use super::convert::input_error;
use knobcore::effects::Id;
use knobcore::error::Result;
use knobcore::model::Model;
use knobcore::param::Axis;
use pyo3::prelude::*;

/// Rotary or linear, by name.
pub fn axis(name: &str) -> Axis {
    if name == "linear" { Axis::Linear } else { Axis::Rotary }
}

/// Effects by their names.
pub fn ids(effects: &[String]) -> PyResult<Vec<Id>> {
    effects.iter().map(|id| Id::parse(id)).collect::<Result<_>>().map_err(input_error)
}

/// An effect by its name: one that the model has first, whose law may be its own, then one of the catalogue.
pub fn own_id(model: &Model, name: &str) -> Result<Id> {
    model.effects().find(|id| id.info().id == name).map_or_else(|| Id::parse(name), Ok)
}
