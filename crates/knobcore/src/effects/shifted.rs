//! A signal at another time.

use crate::prelude::*;
use crate::scalar::Scalar;

/// Longest shift, samples.
const MOST: usize = 256;

/// A signal later by so many samples, earlier by a negative number of them.
///
/// Between samples it is read off the parabola through three of them. Beyond the first and the last sample it is taken
/// to be what it is there.
pub(super) fn shifted<T: Scalar>(x: &[T], samples: T) -> Vec<T> {
    // The whole samples, counted off one by one; the rest is within half a sample of nought.
    let (mut rest, mut whole) = (samples, 0_isize);
    let (half, one) = (T::of(0.5), T::of(1.0));
    for _ in 0..MOST {
        let (up, down) = ((rest - half).is_positive(), (-rest - half).is_positive());
        if !(up || down) {
            break;
        }
        whole += if up { 1 } else { -1 };
        rest = if up { rest - one } else { rest + one };
    }
    let last = x.len() as isize - 1;
    let at = |i: isize| x[i.clamp(0, last) as usize];
    (0..x.len() as isize)
        .map(|i| {
            let (past, here, next) = (at(i - whole - 1), at(i - whole), at(i - whole + 1));
            let (slope, bend) = (half * (past - next), half * (past + next) - here);
            here + rest * (slope + rest * bend)
        })
        .collect()
}
