//! The torque on a knob that slides: for one sample or a pack of them, by the same arithmetic.

use knobcore::model::Model;
use knobcore::motion::{Load, Motion};
use knobcore::scalar::{Known, Scalar};

/// Torque and inertia of a sliding knob.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding {
    /// All torque but that of inertia, N m.
    pub torque: f64,
    /// Inertia, kg m^2.
    pub inertia: f64,
}

/// Brings in what loads the knob beside [what is steady](Model::steady_load), with functions of a user's own if there
/// are any.
#[inline(always)]
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

/// Torque without inertia, and inertia, that a load asks for on a motion whose direction is known; `rest` is what
/// pushes at rest, for a model that may create energy.
#[inline(always)]
pub(super) fn sliding<T: Scalar>(load: &Load<T>, rest: Option<T>, motion: &Motion<T>) -> [T; 2] {
    let drive = if let Some(rest) = rest { braked(load, motion, rest) } else { load.drive };
    [drive + load.friction(motion.forward, motion.alpha), load.inertia]
}

/// The load of a model that is [plain](Model::is_plain): of the channels that shape friction it is known that they do
/// nothing.
#[inline(always)]
pub(super) fn plain(load: &Load<f64>) -> Load<Known<f64>> {
    let (zero, [drive, inertia, band]) = (Known::ZERO, [load.drive, load.inertia, load.band].map(Known::any));
    Load {
        drive,
        normal_load: zero,
        position_load: zero,
        resist: load.resist.map(Known::any),
        friction_scale: Known::of(1.0),
        mu: zero,
        position_share: zero,
        inertia_share: zero,
        hysteresis: zero,
        builds_up: zero,
        inertia,
        hold: load.hold.map(Known::any),
        band,
    }
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
