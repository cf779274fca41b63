//! The torque on a knob that slides: for one sample or a pack of them, by the same arithmetic.

use knobcore::model::Model;
use knobcore::motion::{Load, Motion};
use knobcore::scalar::Scalar;

/// Torque and inertia of a sliding knob.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding {
    /// All torque but that of inertia, N m.
    pub torque: f64,
    /// Inertia, kg m^2.
    pub inertia: f64,
}

/// Brings in what loads the knob, with functions of a user's own if there are any.
pub(super) fn add_loads(
    model: &Model,
    p: &[f64],
    own: bool,
    state: &mut [f64],
    motion: &Motion<f64>,
    sum: &mut Load<f64>,
) {
    model.add_loads(p, state, motion, sum);
    if own {
        model.own_load(p, motion, sum);
    }
}

/// What a load asks for on a motion whose direction is known; `rest` is what pushes at rest, for a model that may
/// create energy.
#[inline(always)]
pub(super) fn sliding(load: &Load<f64>, rest: Option<f64>, motion: &Motion<f64>) -> Sliding {
    let drive = rest.map_or(load.drive, |rest| braked(load, motion, rest));
    Sliding { torque: drive + load.friction(motion.forward, motion.alpha), inertia: load.inertia }
}

/// The same place and time, at rest.
#[inline(always)]
pub(super) fn at_rest(motion: &Motion<f64>) -> Motion<f64> {
    Motion { omega: 0.0, forward: 0.5, ..*motion }
}

/// The torque that pushes, cut where what depends on the motion would push along with it by more than dry
/// friction takes: a negative viscous coefficient (knobs 1 to 3 of the paper) would else create energy.
#[inline(always)]
pub(super) fn braked<T: Scalar>(load: &Load<T>, motion: &Motion<T>, rest: T) -> T {
    let (sign, dry) = (motion.direction(), load.dry(motion.forward, motion.alpha));
    (sign * (load.drive - rest) + dry).where_positive(load.drive, rest - sign * dry)
}
