//! Mirror symmetry: which direction is forward is a convention.

use super::*;

/// The same knob seen in a mirror: what is said per direction or per side changes places.
pub fn mirrored(model: &Model) -> Model {
    let turned = |name: &str| match name {
        "neg" => "pos".to_owned(),
        "pos" => "neg".to_owned(),
        "lo" => "hi".to_owned(),
        "hi" => "lo".to_owned(),
        other => match other.rsplit_once('_') {
            Some((what, side @ ("neg" | "pos" | "lo" | "hi"))) => {
                let side = match side {
                    "neg" => "pos",
                    "pos" => "neg",
                    "lo" => "hi",
                    _ => "lo",
                };
                format!("{what}_{side}")
            }
            _ => other.to_owned(),
        },
    };
    let value = |at: usize| {
        let slot = &model.slots()[at];
        let own = format!("{}.{}", name(slot.effect), turned(slot.param.name));
        let from = model.index(&own).map_or(slot, |at| &model.slots()[at]);
        // Places and phases are counted the other way round.
        let place =
            matches!(slot.param.kind, Kind::PhaseOf(_)) || matches!(slot.param.name, "lo" | "hi" | "theta0");
        if place { -from.value } else { from.value }
    };
    let values: Vec<f64> = (0..model.slots().len()).map(value).collect();
    let mut mirrored = model.clone();
    mirrored.set_values(&values);
    mirrored
}

/// Effects whose mirror image has other signs in its series: even powers and even waves of the position, waves of the
/// direction, and what is added to the reading whichever way the knob goes.
const SERIES: [Id; 7] = [
    Id::PositionPolynomial,
    Id::PositionFriction,
    Id::DirectionalDetent,
    Id::TorqueDrift,
    Id::Offset,
    Id::Regional,
    Id::Wavelet,
];

#[test]
fn a_knob_in_a_mirror_answers_a_mirrored_motion_by_the_mirrored_torque() {
    let mut noise = Noise::new(22);
    for &id in Id::BUILT_IN.iter().filter(|id| !SERIES.contains(id)) {
        let model = plausible_knob(id, &mut noise);
        let here = signals(|_| 0.0);
        let turned = |column: &[f64]| column.iter().map(|x| -x).collect::<Vec<f64>>();
        let there = Signals {
            theta: turned(&here.theta),
            omega: turned(&here.omega),
            alpha: turned(&here.alpha),
            forward: here.forward.iter().map(|x| 1.0 - x).collect(),
            ..here.clone()
        };
        let (a, b) = (predict::torque_raw(&model, &here), predict::torque_raw(&mirrored(&model), &there));
        let apart = rms(a.iter().zip(&b).map(|(a, b)| a + b)) / rms(a.iter().copied());
        assert!(apart < 1e-6, "{}: {apart} of the torque apart", name(id));
    }
}
