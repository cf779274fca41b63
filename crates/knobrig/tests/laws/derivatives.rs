//! Derivatives equal finite differences, through the whole chain from the motion to the recorded torque.

use super::*;
use knobcore::predict::{Columns, Seeds, raw};

/// How finely a derivative is compared.
#[derive(Clone, Copy)]
pub struct Compared {
    /// Step of the parameter, a share of its size.
    pub step: f64,
    /// Difference that is allowed, a share of the root mean square derivative.
    pub off: f64,
    /// Share of the samples that may differ by more: those where a step of the parameter crosses a kink of the
    /// law, so that the difference belongs to neither side.
    pub spared: f64,
}

/// What loads and sensors keep to.
pub const SMOOTH: Compared = Compared { step: 1e-6, off: 1e-5, spared: 2e-3 };
/// A knob that rattles in its gap amplifies a step of any parameter, by so much that smaller ones are compared.
const RATTLING: Compared = Compared { step: 1e-7, off: 1e-3, spared: 1e-2 };

/// Compares the derivatives by every parameter that is not tied.
pub fn check(model: &Model, compared: Compared, what: &str) {
    let still = signals(|_| 0.0);
    let n = still.len();
    let p = model.values();
    let own: Vec<usize> = (0..p.len()).filter(|&i| !matches!(model.slots()[i].role, Role::Tied(_))).collect();
    let mut columns = Columns::default();
    raw(model, &p, &Seeds::of(model, &own), &still, 0..n, &mut columns);
    let (_, slopes) = columns.split();
    for (&i, exact) in own.iter().zip(slopes) {
        let slot = &model.slots()[i];
        let h = compared.step * if p[i] == 0.0 { slot.param.scale() } else { p[i].abs() };
        // Beyond its bounds a parameter may say something else.
        let [down, up] = [-h, h].map(|step| (p[i] + step).clamp(slot.param.lower, slot.param.upper));
        let at = |value: f64| {
            let mut moved = model.clone();
            let mut values = p.clone();
            values[i] = value;
            moved.set_values(&values);
            torque(&moved).tau
        };
        let difference: Vec<f64> =
            at(up).iter().zip(at(down)).map(|(above, below)| (above - below) / (up - down)).collect();
        let name = format!("{what}: {}", slot.name());
        // The difference itself rounds: torques of tenths of N m over 2 h.
        let allowed = compared.off * rms(exact.iter().copied()) + 1e-15 / h;
        let off = |(a, b): &(&f64, &f64)| (**a - **b).abs() > allowed + compared.off * a.abs();
        let wrong: Vec<_> = exact.iter().zip(&difference).filter(off).collect();
        let share = wrong.len() as f64 / n as f64;
        assert!(share <= compared.spared, "{name} at a share {share}: {:?}", wrong.first());
    }
}

#[test]
fn the_derivative_by_every_parameter_is_that_of_the_finite_difference() {
    let mut noise = Noise::new(4);
    for &id in Id::BUILT_IN {
        let compared = if is_joint(id) { RATTLING } else { SMOOTH };
        check(&plausible_knob(id, &mut noise), compared, name(id));
    }
}

#[test]
fn effects_that_shape_one_friction_have_their_derivatives_together() {
    let mut noise = Noise::new(5);
    // All that act on the dry friction at once, and what presses on it, but for maps: their steps reach everywhere.
    let presses = |id: &Id| id.info().presses && !id.info().describes;
    let shapes = |id: &Id| id.info().shapes_friction || presses(id);
    let mut model = knob();
    for &id in Id::BUILT_IN.iter().filter(|id| shapes(id)) {
        if !model.has(id) {
            model = at(model.with(id).unwrap(), id, &plausible(id, &mut noise));
        }
    }
    check(&model, SMOOTH, "all together");
    // And read by every sensor.
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Sensor) {
        model = at(model.with(id).unwrap(), id, &plausible(id, &mut noise));
    }
    check(&model, SMOOTH, "all together, and sensed");
}
