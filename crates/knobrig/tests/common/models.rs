//! Random knobs, and what their places hold.

use knobcore::effects::Id;
use knobcore::model::Model;
use knobcore::motion::Motion;
use knobcore::param::Axis;
use knobcore::random::Noise;

/// Energy between the highest and the lowest place of a model within these angles, J.
pub fn stored(model: &Model, [from, to]: [f64; 2]) -> f64 {
    let p = model.values();
    let steps = (160.0 * (to - from)).ceil() as u32;
    let step = (to - from) / f64::from(steps);
    let (mut sum, mut ends) = (0.0_f64, [0.0_f64; 2]);
    for i in 0..steps {
        let motion = Motion::exact(0.0, from + (f64::from(i) + 0.5) * step, 0.0, 0.0);
        sum += step * model.load(&p, &mut vec![0.0; model.states()], &motion).drive;
        ends = [ends[0].min(sum), ends[1].max(sum)];
    }
    ends[1] - ends[0]
}

/// A knob of some effects; a value has the wrong sign with the probability `wrong`.
pub fn random_model(noise: &mut Noise, wrong: f64) -> Model {
    let more = [Id::ReturnSpring, Id::Unbalance, Id::PositionPolynomial, Id::QuadraticDrag, Id::Stribeck];
    let mut effects = vec![Id::Inertia, Id::Coulomb, Id::Viscous];
    if noise.uniform() < 0.6 {
        effects.push(Id::Detent);
    }
    effects.extend(more.into_iter().filter(|_| noise.uniform() < 0.25));
    let mut model = Model::new(&effects, Axis::Rotary);
    for (name, size) in [
        ("inertia.M", 1e-4),
        ("coulomb.neg", 0.02),
        ("coulomb.pos", 0.02),
        ("viscous.neg", 1e-3),
        ("viscous.pos", 1e-3),
        ("detent.A", 0.05),
        ("return_spring.k", 0.3),
        ("unbalance.a", 0.02),
        ("position_polynomial.p1", 0.02),
        ("position_polynomial.p3", 0.01),
        ("quadratic_drag.d", 1e-4),
    ] {
        let sign = if noise.uniform() < wrong { -1.0 } else { 1.0 };
        // The seldom size of a fit that went wrong.
        let size = if sign < 0.0 { size * 10_f64.powf(2.0 * noise.uniform() - 0.5) } else { size };
        if model.index(name).is_ok() {
            model.set(name, sign * size * noise.uniform()).unwrap();
        }
    }
    if noise.uniform() < 0.3 {
        model.reach = Some([0.5 + 20.0 * noise.uniform(), 1.0 + 9.0 * noise.uniform()]);
    }
    if model.has(Id::Detent) {
        model.set("detent.P", 0.03 + 0.2 * noise.uniform()).unwrap();
    }
    model
}
