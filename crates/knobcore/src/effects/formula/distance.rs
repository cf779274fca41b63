//! How far a knob has gone since it turned round.

use crate::motion::Motion;
use crate::prelude::*;
use crate::scalar::Scalar;

/// What is remembered from sample to sample, zero at first: the way that the knob goes (1 or -1), where it turned round
/// and how far it has come.
pub(crate) const STATES: usize = 3;
/// Expected sign of the velocity from which on the knob is sure to go that way: the noise of a slow velocity turns no
/// knob round.
const SURE: f64 = 0.8;

/// The distance since the last reversal, or since the first motion before any; goes on from what was remembered.
#[inline]
pub(crate) fn follow<T: Scalar>(state: &mut [T], motion: &Motion<T>) -> T {
    let [way, turned, far] = state else { return T::ZERO };
    let (sign, before) = (motion.direction().value(), way.value());
    let now = if sign.abs() > SURE { sign.signum() } else { before };
    if before == 0.0 {
        (*turned, *far) = (motion.theta, motion.theta);
    } else if now != before {
        // It turned round where it had come furthest, which may be some uncertain samples ago.
        (*turned, *far) = (*far, motion.theta);
    }
    *way = T::of(now);
    *far = if now < 0.0 { far.min(motion.theta) } else { far.max(motion.theta) };
    (*way * (motion.theta - *turned)).max(T::ZERO)
}

/// The same along columns.
pub(super) fn distance(theta: &[f64], forward: &[f64]) -> Vec<f64> {
    let mut state = [0.0; STATES];
    let along = theta.iter().zip(forward);
    along
        .map(|(theta, forward)| {
            let motion = Motion { t: 0.0, theta: *theta, omega: 0.0, alpha: 0.0, forward: *forward };
            follow(&mut state, &motion)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_grows_from_where_the_knob_turned_round_and_noise_turns_it_not() {
        let theta = [0.0, 0.0, 0.1, 0.3, 0.4, 0.39, 0.3, 0.1, 0.1, 0.05, 0.2];
        let forward = [0.5, 1.0, 1.0, 0.95, 0.6, 0.4, 0.0, 0.05, 0.7, 0.0, 1.0];
        let right = [0.0, 0.0, 0.1, 0.3, 0.4, 0.39, 0.1, 0.3, 0.3, 0.35, 0.15];
        for (found, right) in distance(&theta, &forward).iter().zip(right) {
            assert!((found - right).abs() < 1e-15, "{found} {right}");
        }
    }
}
