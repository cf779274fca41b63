//! The Wiener-process acceleration in units of one sampling step.
//!
//! With h the sampling step, the state is (theta, omega h, alpha h^2 / 2), all in radians: what theta gains
//! in one step from each. Its covariances then have entries of similar size, where those of (theta, omega,
//! alpha) at h = 0.2 ms are 15 decades apart.

use super::sensors::Noise;
use nalgebra::{Matrix3, Vector3};

/// Lower Cholesky factor of the driving noise of one step, for jerk^2 h^5 = 1: the covariance is
/// [1/20 1/8 1/12; 1/8 1/3 1/4; 1/12 1/4 1/4] (Bar-Shalom et al. 2001, section 6.2.3, in the scaled state).
const DRIVE: [[f64; 3]; 3] = [
    [0.223_606_797_749_978_97, 0.0, 0.0],
    [0.559_016_994_374_947_4, 0.144_337_567_297_406_43, 0.0],
    [0.372_677_996_249_964_94, 0.288_675_134_594_812_9, 0.166_666_666_666_666_66],
];

/// A sensor that is this many times finer than what the jerk does to it in one step adds nothing: the
/// smoother passes through its samples already. Noise is not taken below it, so that no covariance
/// becomes singular.
const FINEST: f64 = 1e-4;

/// The longest memory, in steps: with less jerk than theta noise / MEMORY^3 the motion is a parabola over
/// that many samples.
const MEMORY: f64 = 1e4;

/// Motion model and sensors' noise in the scaled state.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// Radians per unit of (theta, omega, alpha): 1, h, h^2 / 2.
    pub scale: Vector3<f64>,
    /// Variance of each sensor, rad^2; infinite if absent.
    pub variance: Vector3<f64>,
    /// What the jerk adds in one step, jerk h^(5/2), rad.
    pub jerk: f64,
}

impl Model {
    /// Model of a capture whose usual sampling step is `step` (s).
    pub fn new(noise: &Noise, step: f64) -> Self {
        let scale = Vector3::new(1.0, step, step * step / 2.0);
        let jerk =
            (noise.jerk * step.powf(2.5)).max(noise.theta / MEMORY.powi(3)).max(f64::MIN_POSITIVE.sqrt());
        let sd = Vector3::new(noise.theta, noise.omega, noise.alpha).component_mul(&scale);
        Self { scale, variance: sd.map(|sd| sd.max(FINEST * jerk).powi(2)), jerk }
    }

    /// Square root of the covariance that `lift` times the usual jerk adds over `r` steps.
    pub fn drive(&self, r: f64, lift: f64) -> Matrix3<f64> {
        let size = lift * self.jerk * r.sqrt();
        let rows = [size * r * r, size * r, size];
        Matrix3::from_fn(|i, j| rows[i] * DRIVE[i][j])
    }
}

/// The state, without jerk, `r` steps later.
#[inline]
pub fn coast(x: &Vector3<f64>, r: f64) -> Vector3<f64> {
    Vector3::new(x[0] + r * (x[1] + r * x[2]), x[1] + 2.0 * r * x[2], x[2])
}

/// The matrix of [`coast`].
pub fn transition(r: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, r, r * r, 0.0, 1.0, 2.0 * r, 0.0, 0.0, 1.0)
}
