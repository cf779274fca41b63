//! The chain along whole columns of a motion that is prescribed.

mod behind;
mod block;
mod rigid;

pub use behind::knob;
pub use block::Block;

use crate::chain::Follow;
use crate::effects::Id;
use crate::effects::law::Response;
use crate::model::Model;
use crate::scalar::WIDE;

/// Torque on the shaft and its derivatives along a motion: coupling and loads. `columns` says which column each
/// parameter has.
pub fn loads(model: &Model, p: &[f64], columns: &[Option<usize>], follow: Follow, over: &mut Response<'_>) {
    if model.is_coupled() {
        behind::loads(model, p, columns, follow, over);
    } else {
        rigid::loads(&model.parts(p, columns), follow.begins.bent, over);
    }
}

/// Passes torque and derivatives through the sensors.
pub fn sensors(model: &Model, p: &[f64], columns: &[Option<usize>], over: &mut Response<'_>) {
    for (id, p, columns) in model.parts(p, columns) {
        id.law().pass(p, columns, over);
    }
}

/// Whether several sets of parameters of a model are followed side by side.
pub fn go_together(model: &Model) -> bool {
    model.is_coupled() && !model.effects().any(|id| matches!(id, Id::User(_)))
}

/// The recorded torque along one motion of a model with several sets of parameters: behind a joint as many knobs are
/// followed side by side as a register has lanes. Those with laws of a user's own go one by one.
pub fn several(
    model: &Model,
    sets: &[Vec<f64>],
    follow: Follow,
    motion: [&[f64]; 5],
    dt: f64,
    torques: &mut [Vec<f64>],
) {
    let columns = vec![None; model.slots().len()];
    let together = go_together(model);
    for (sets, torques) in sets.chunks(WIDE).zip(torques.chunks_mut(WIDE)) {
        let wide = together && sets.len() > 1;
        if wide {
            behind::side_by_side(model, sets, follow, motion, dt, torques);
        }
        for (p, torque) in sets.iter().zip(torques) {
            let over = &mut Response { motion, dt, torque, slopes: &mut [] };
            if wide {
                sensors(model, p, &columns, over);
            } else {
                along(model, p, &columns, follow, over);
            }
        }
    }
}

/// The recorded torque and its derivatives along a motion: the whole chain.
pub fn along(model: &Model, p: &[f64], columns: &[Option<usize>], follow: Follow, over: &mut Response<'_>) {
    loads(model, p, columns, follow, over);
    sensors(model, p, columns, over);
}
