//! Units: a law does not know in what they are counted.

use super::*;
use knobcore::param::Unit;

/// How many new units an old one of torque, angle and time has; none a power of another.
const NEW: [f64; 3] = [1.7, 0.6, 2.3];

/// A quantity of this unit, counted in new ones.
fn counted(unit: Unit, x: f64) -> f64 {
    let [torque, angle, time] = unit.powers();
    x * NEW[0].powi(torque) * NEW[1].powi(angle) * NEW[2].powi(time)
}

#[test]
fn a_torque_scales_with_the_units_that_its_parameters_say() {
    let mut noise = Noise::new(21);
    // An unbalance knows what a turn is: its angle is a pure number.
    for &id in Id::BUILT_IN.iter().filter(|id| **id != Id::Unbalance) {
        let mut model = plausible_knob(id, &mut noise);
        if id == Id::TorqueDrift {
            // What it creeps in a second, by a power of the seconds that passed: the second is part of its law.
            model.set("torque_drift.d", 0.0).unwrap();
        }
        let still = signals(|_| 0.0);
        let [_, angle, time] = NEW;
        let by = |column: &[f64], factor: f64| column.iter().map(|x| x * factor).collect::<Vec<f64>>();
        let other = Signals {
            rate_hz: still.rate_hz / time,
            t: by(&still.t, time),
            theta: by(&still.theta, angle),
            omega: by(&still.omega, angle / time),
            alpha: by(&still.alpha, angle / time / time),
            ..still.clone()
        };
        let mut scaled = model.clone();
        let values: Vec<f64> =
            model.slots().iter().map(|slot| counted(slot.param.unit, slot.value)).collect();
        scaled.set_values(&values);
        let (here, there) = (predict::torque_raw(&model, &still), predict::torque_raw(&scaled, &other));
        let scale = rms(here.iter().copied());
        let apart = rms(here.iter().zip(&there).map(|(a, b)| a * NEW[0] - b)) / scale;
        assert!(apart < 1e-6, "{}: {apart} of the torque apart", name(id));
    }
}
