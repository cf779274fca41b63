//! The torque on a knob that slides: for one sample or eight, by the same arithmetic.

use crate::model::Model;
use crate::motion::{Load, Motion};
use crate::scalar::Scalar;

/// Torque and inertia of a sliding knob.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding<T> {
    /// All torque but that of inertia, N m.
    pub torque: T,
    /// Inertia, kg m^2.
    pub inertia: T,
}

/// What the model asks for on a motion whose direction is known. `spare` is what its effects remember, to
/// look from without remembering; none is needed for a model that is `dissipative`.
#[inline(always)]
pub(super) fn sliding<T: Scalar>(
    model: &Model,
    p: &[T],
    state: &mut [T],
    spare: Option<&mut [T]>,
    motion: &Motion<T>,
) -> Sliding<T> {
    let load = model.load(p, state, motion);
    let friction = load.friction(motion.forward);
    let drive = match spare {
        None => load.drive,
        Some(spare) => braked(&load, motion, model.load(p, spare, &at_rest(motion)).drive),
    };
    Sliding { torque: drive + friction, inertia: load.inertia }
}

/// The same place and time, at rest.
#[inline(always)]
pub(super) fn at_rest<T: Scalar>(motion: &Motion<T>) -> Motion<T> {
    Motion { omega: T::of(0.0), forward: T::of(0.5), ..*motion }
}

/// The torque that pushes, cut where what depends on the motion would push along with it by more than dry
/// friction takes: a negative viscous coefficient (knobs 1 to 3 of the paper) would else create energy.
#[inline(always)]
pub(super) fn braked<T: Scalar>(load: &Load<T>, motion: &Motion<T>, rest: T) -> T {
    let sign = motion.direction();
    let [back, forth] = motion.directions();
    let dry = (load.resist[0] * back + load.resist[1] * forth) * load.level + load.mu * load.press.abs();
    (sign * (load.drive - rest) + dry).where_positive(load.drive, rest - sign * dry)
}
