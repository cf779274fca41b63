//! Derivatives equal finite differences, through the whole chain from the motion to the recorded torque.

use super::*;
use knobcore::predict::{Columns, Seeds, raw};

/// Where a derivative is compared.
#[derive(Clone, Copy)]
enum Compared {
    /// At every sample but this share of them: where a step of the parameter crosses a kink of the law, and the
    /// difference belongs to neither side.
    Samples(f64),
    /// In the sum of squares against a torque that is not the model's, which is what a fit follows. The impacts
    /// of a hidden knob move in time, and single samples jump.
    Gradient,
}

/// Compares the derivatives by every parameter that is not tied.
fn check(model: &Model, compared: Compared, what: &str) {
    let still = signals(|_| 0.0);
    let n = still.len();
    let p = model.values();
    let own: Vec<usize> =
        (0..p.len()).filter(|&i| !matches!(model.slots()[i].role, Role::Tied(_))).collect();
    let mut columns = Columns::default();
    raw(model, &p, &Seeds::of(model, &own), &still, 0..n, &mut columns);
    let (_, slopes) = columns.split();
    for (&i, exact) in own.iter().zip(slopes) {
        let slot = &model.slots()[i];
        let h = 1e-6 * if p[i] == 0.0 { slot.param.scale() } else { p[i].abs() };
        let beside = |step: f64| {
            let mut moved = model.clone();
            let mut values = p.clone();
            values[i] += step;
            moved.set_values(&values);
            torque(&moved).tau
        };
        let difference: Vec<f64> =
            beside(h).iter().zip(beside(-h)).map(|(up, down)| (up - down) / (2.0 * h)).collect();
        let name = format!("{what}: {}", slot.name());
        match compared {
            Compared::Samples(spared) => {
                let scale = rms(exact.iter().copied());
                // The difference itself rounds: torques of tenths of N m over 2 h.
                let allowed = 1e-5 * scale + 1e-15 / h;
                let off = |(a, b): (&f64, &f64)| ((a - b).abs() > allowed + 1e-5 * a.abs()).then_some((*a, *b));
                let wrong: Vec<_> = exact.iter().zip(&difference).filter_map(off).collect();
                let share = wrong.len() as f64 / n as f64;
                assert!(share <= spared, "{name} at a share {share}: {:?}", wrong.first());
            }
            Compared::Gradient => {
                let rest = |t: f64| (TAU * 3.3 * t).sin() + 0.5 * (TAU * 11.0 * t).cos();
                let along = |slope: &[f64]| slope.iter().zip(&still.t).map(|(s, t)| s * rest(*t)).sum::<f64>();
                let (a, b) = (along(exact), along(&difference));
                let scale = rms(exact.iter().copied()) * (n as f64).sqrt();
                assert!((a - b).abs() <= 1e-2 * (a.abs() + scale), "{name}: {a} {b} of {scale}");
            }
        }
    }
}

#[test]
fn the_derivative_by_every_parameter_is_that_of_the_finite_difference() {
    let mut noise = Noise::new(4);
    for &id in Id::BUILT_IN {
        let compared = if is_joint(id) { Compared::Gradient } else { Compared::Samples(2e-3) };
        check(&plausible_knob(id, &mut noise), compared, name(id));
    }
}

#[test]
fn effects_that_shape_one_friction_have_their_derivatives_together() {
    let mut noise = Noise::new(5);
    // All that act on the dry friction at once, and what presses on it.
    let shapes = |id: &Id| id.info().shapes_friction || id.info().presses;
    let mut model = knob();
    for &id in Id::BUILT_IN.iter().filter(|id| shapes(id)) {
        if !model.has(id) {
            model = at(model.with(id).unwrap(), id, &plausible(id, &mut noise));
        }
    }
    check(&model, Compared::Samples(2e-3), "all together");
    // And read by every sensor.
    for &id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Sensor) {
        model = at(model.with(id).unwrap(), id, &plausible(id, &mut noise));
    }
    check(&model, Compared::Samples(1e-2), "all together, and sensed");
}
