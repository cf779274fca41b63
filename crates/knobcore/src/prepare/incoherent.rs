//! Above which frequency the recorded motion is none that the torque has made.
//!
//! Errors of a recorded motion grow with frequency: its acceleration has the square of it. A frame that was lost, a
//! stamp that came late or an encoder that shakes is an acceleration without torque, and an inertia that has to serve
//! for both is too small, the more so the wider the band (errors in the regressors). Estimates from a narrower band
//! then differ from those of a wider one (J. A. Hausman, *Specification Tests in Econometrics*, 1978). They also do
//! with a knob behind a spring, or a sensor that lags, but these follow the motion, or lie below the noise of the
//! torque, where the motion that is told from noise has none either.

use super::motion::{Moving, below};
use crate::algebra::{dot, rms};
use crate::filter::ZeroPhase;
use crate::param::Axis;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Of the torque of a band, the least share by which it follows the acceleration.
const COHERENT: f64 = 0.25;
/// The acceleration of a band would take so many times the torque that was recorded of it (RMS).
const TIMES: f64 = 2.0;
/// By so many times the inertia may be more than torque by acceleration.
const MARGIN: f64 = 10.0;
/// Samples of a period, of which no more than twice as many are kept.
const SAMPLED: f64 = 8.0;
/// Standard errors of the inertia below a band that it is known to, from nought.
const KNOWN: f64 = 5.0;
/// Standard errors by which the inertia is less with the band than without it, and the share of it.
const APART: f64 = 3.0;
/// See [`APART`].
const WORTH: f64 = 0.02;
/// A column is told from others by this share of its squares.
const OWN: f64 = 1e-9;
/// Independent samples of a band that tell anything.
const ENOUGH: f64 = 20.0;

/// Above a frequency the torque has nothing to do with the recorded motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incoherent {
    /// The frequency, Hz.
    pub hz: f64,
    /// The edge that the torque's filter would have had, Hz.
    pub edge_hz: f64,
    /// The motion would take this many times the torque that was recorded above it (RMS).
    pub times: f64,
}

/// Position, speed, acceleration and torque of a stretch.
type Piece = [Vec<f64>; 4];

/// Looks at bands of an octave from `edge_hz` down, as far as a filter with its edge there `leaves` enough.
pub(super) fn incoherent(
    moving: &Moving,
    tau: &[f64],
    axis: Axis,
    inside: &[Range<usize>],
    [mut rate_hz, edge_hz]: [f64; 2],
    leaves: impl Fn(f64) -> bool,
) -> Option<Incoherent> {
    let columns = [&moving.theta, &moving.omega, &moving.alpha, tau];
    let first = below(edge_hz, rate_hz).ok()?;
    let whole = |range: &Range<usize>| filtered(columns.map(|column| column[range.clone()].to_vec()), &first);
    let mut pieces: Vec<Piece> = inside.iter().filter_map(whole).collect();
    let mut found = None;
    let mut high = edge_hz;
    while leaves(0.5 * high) {
        let filter = below(0.5 * high, rate_hz).ok()?;
        let ends = (2.0 * rate_hz / high) as usize;
        pieces.retain(|[theta, ..]| theta.len() > (4 * ends).max(filter.padding()));
        let mut slow: Vec<Piece> =
            pieces.iter().filter_map(|piece| filtered(piece.clone(), &filter)).collect();
        let band = Band::of(&pieces, &slow, ends, rate_hz / high)?;
        if band.coherence > COHERENT {
            break;
        }
        if band.asks(&slow)
            && let Some(below) = Below::of(&slow, axis, &filter, ends, rate_hz / high)
            && let Some(times) = band.is_none_of(&below)
        {
            found = Some(Incoherent { hz: 0.5 * high, edge_hz, times });
        }
        high *= 0.5;
        while rate_hz > 2.0 * SAMPLED * high {
            for column in slow.iter_mut().flatten() {
                *column = column.iter().step_by(2).copied().collect();
            }
            rate_hz *= 0.5;
        }
        pieces = slow;
    }
    found
}

fn filtered(mut piece: Piece, filter: &ZeroPhase) -> Option<Piece> {
    filter.filter_channels(&mut piece.each_mut().map(Vec::as_mut_slice)).ok()?;
    Some(piece)
}

/// An octave.
struct Band {
    /// RMS of acceleration and torque.
    acceleration: f64,
    torque: f64,
    /// Torque by acceleration.
    inertia: f64,
    /// The share of the torque that follows the acceleration, at any phase.
    coherence: f64,
    /// Independent samples.
    samples: f64,
}

impl Band {
    /// Of what a filter takes off, without what is near the ends; `rows` of a sample are independent.
    fn of(pieces: &[Piece], slow: &[Piece], ends: usize, rows: f64) -> Option<Self> {
        let [mut alpha, mut quarter, mut tau] = [const { Vec::new() }; 3];
        for (piece, slow) in pieces.iter().zip(slow) {
            let [acceleration, torque] =
                [2, 3].map(|k| piece[k].iter().zip(&slow[k]).map(|(a, b)| a - b).collect::<Vec<f64>>());
            let inside = ends..torque.len() - ends;
            alpha.extend_from_slice(&acceleration[inside.clone()]);
            quarter.extend(inside.clone().map(|at| acceleration[at + 1] - acceleration[at - 1]));
            tau.extend_from_slice(&torque[inside]);
        }
        let (acceleration, torque) = (rms(&alpha), rms(&tau));
        let inertia = dot(&alpha, &tau) / dot(&alpha, &alpha);
        let samples = tau.len() as f64 / rows;
        let left = Fitted::of(&[alpha, quarter], &tau)?.left;
        let coherence = 1.0 - left / (torque * torque);
        Some(Self { acceleration, torque, inertia, coherence, samples })
    }

    /// Whether it may take more torque than was recorded, by what torque and acceleration are below: a torque that
    /// gravity takes off the inertia's is less than that.
    fn asks(&self, slow: &[Piece]) -> bool {
        let squares = |k: usize| slow.iter().map(|piece| dot(&piece[k], &piece[k])).sum::<f64>();
        let most = MARGIN * (squares(3) / squares(2)).sqrt();
        most * self.acceleration > TIMES * self.torque
    }

    /// How many times the torque that was recorded the motion would take, where that is beyond doubt and matters.
    fn is_none_of(&self, below: &Below) -> Option<f64> {
        let times = below.inertia * self.acceleration / self.torque;
        // The inertia would be a mean of both, each by the squares of its acceleration.
        let squares = [below.own, self.acceleration].map(|a| a * a);
        let less = (below.inertia - self.inertia) * squares[1] / (squares[0] + squares[1]);
        let known = below.inertia > KNOWN * below.error && self.samples > ENOUGH;
        let matters = less > (APART * below.error).max(WORTH * below.inertia);
        (known && matters && times > TIMES).then_some(times)
    }
}

/// What lies below: dry and viscous friction of either direction, a torque once per turn, and the inertia.
struct Below {
    inertia: f64,
    /// Its standard error.
    error: f64,
    /// RMS of the acceleration that nothing else stands in for.
    own: f64,
}

impl Below {
    fn of(slow: &[Piece], axis: Axis, filter: &ZeroPhase, ends: usize, rows: f64) -> Option<Self> {
        let shapes: [fn(f64, f64) -> f64; 6] = [
            |_, omega| f64::from(omega > 0.0),
            |_, omega| f64::from(omega < 0.0),
            |_, omega| omega.max(0.0),
            |_, omega| omega.min(0.0),
            |theta, _| theta.sin(),
            |theta, _| theta.cos(),
        ];
        let shapes = if axis == Axis::Linear { &shapes[..4] } else { &shapes[..] };
        let mut columns = vec![Vec::new(); 1 + shapes.len()];
        let mut tau = Vec::new();
        for [theta, omega, alpha, torque] in slow {
            let inside = ends..theta.len() - ends;
            columns[0].extend_from_slice(&alpha[inside.clone()]);
            for (shape, column) in shapes.iter().zip(&mut columns[1..]) {
                let mut whole: Vec<f64> = theta.iter().zip(omega).map(|(t, w)| shape(*t, *w)).collect();
                filter.filter_in_place(&mut whole).ok()?;
                column.extend_from_slice(&whole[inside.clone()]);
            }
            tau.extend_from_slice(&torque[inside]);
        }
        let own = Fitted::of(&columns[1..], &columns[0])?.left;
        let fitted = Fitted::of(&columns, &tau)?;
        let free = tau.len() as f64 / rows - columns.len() as f64;
        let error = (fitted.left / own / free.max(1.0)).sqrt();
        Some(Self { inertia: fitted.values[0], error, own: own.sqrt() })
    }
}

/// Least squares.
struct Fitted {
    values: Vec<f64>,
    /// Mean of the squares that are left.
    left: f64,
}

impl Fitted {
    /// A direction that the motion does not have, and a column that says what others do, has next to no part.
    fn of(columns: &[Vec<f64>], target: &[f64]) -> Option<Self> {
        let lengths: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
        let scale = |k: usize| if lengths[k] > 0.0 { lengths[k].recip() } else { 0.0 };
        let gram = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
            dot(&columns[i], &columns[j]) * scale(i) * scale(j) + if i == j { OWN } else { 0.0 }
        });
        let slope = DVector::from_fn(columns.len(), |i, _| dot(&columns[i], target) * scale(i));
        let values = gram.cholesky()?.solve(&slope);
        let left = (dot(target, target) - values.dot(&slope)).max(0.0) / target.len() as f64;
        Some(Self { values: values.iter().enumerate().map(|(k, x)| x * scale(k)).collect(), left })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    const RATE: f64 = 1000.0;
    const INERTIA: f64 = 2e-4;

    /// Ten seconds in which the torque makes all of the motion but a shake at so many rad/s^2 and Hz, and the torque
    /// follows the acceleration late, by so many rows.
    fn found(shake: f64, hz: f64, late: usize) -> Option<Incoherent> {
        let mut noise = Noise::new(3);
        let mut columns = [const { Vec::<f64>::new() }; 4];
        for i in 0..10_000 {
            let t = f64::from(i) / RATE;
            let wave = |amplitude: f64, w: f64, derivative: i32| {
                amplitude
                    * w.powi(derivative)
                    * (w * t + f64::from(derivative) * 0.5 * std::f64::consts::PI).sin()
            };
            let moved = |d: i32| {
                [(3.0, 4.0), (0.4, 21.0), (0.02, 95.0)].map(|(a, w)| wave(a, w, d)).iter().sum::<f64>()
            };
            let w = std::f64::consts::TAU * hz;
            let shaken = |d: i32| moved(d) + wave(shake / (w * w), w, d);
            let torque = INERTIA * moved(2) + 0.01 * moved(1).signum() + 2e-3 * noise.normal();
            for (column, value) in columns.iter_mut().zip([shaken(0), shaken(1), shaken(2), torque]) {
                column.push(value);
            }
        }
        let [theta, omega, alpha, mut tau] = columns;
        tau.rotate_right(late);
        let omega_sd = vec![0.0; theta.len()];
        let moving = Moving {
            theta,
            omega,
            alpha,
            omega_sd,
            uncertainty: None,
            noise: None,
            strays: Default::default(),
        };
        let inside = late..10_000 - late;
        incoherent(&moving, &tau, Axis::Rotary, std::slice::from_ref(&inside), [RATE, 100.0], |hz| hz > 5.0)
    }

    #[test]
    fn a_shake_that_no_torque_makes_is_left_out_by_whole_octaves() {
        assert_eq!(found(400.0, 70.0, 0).map(|found| found.hz), Some(50.0));
        assert_eq!(found(400.0, 35.0, 0).map(|found| found.hz), Some(25.0));
        assert!(found(400.0, 70.0, 0).unwrap().times > TIMES);
    }

    #[test]
    fn a_motion_that_its_torque_makes_soon_or_late_has_no_such_band() {
        for late in [0, 3, 8] {
            assert_eq!(found(0.0, 70.0, late), None);
        }
    }

    #[test]
    fn a_shake_that_costs_the_inertia_nothing_stays() {
        assert_eq!(found(10.0, 70.0, 0), None);
    }
}
