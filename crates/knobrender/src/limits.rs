//! What the step never exceeds, and what makes it let go for good.

use knobcore::scalar::Scalar;

/// Bounds on the torque and on what may be believed of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest torque, N m.
    pub torque: f64,
    /// Fastest change of torque, N m/s.
    pub torque_rate: f64,
    /// Speed that no handle reaches, rad/s: faster motion is a broken sensor.
    pub speed: f64,
}

impl Limits {
    /// `tau` within the limits, where the torque one step of `dt` seconds before was `before`.
    #[inline]
    pub fn cut(&self, tau: f64, before: f64, dt: f64) -> f64 {
        let most = self.torque_rate * dt;
        let change = tau - before;
        // What changes slowly enough must not be touched: x - before + before is not x.
        let tau =
            if change.abs() <= most { tau } else { before + Scalar::min(Scalar::max(change, -most), most) };
        Scalar::min(Scalar::max(tau, -self.torque), self.torque)
    }
}

/// Why the step renders no torque any more. It stays until a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A sensed quantity is not finite.
    NotFinite,
    /// The angle jumped, or the speed is beyond what a handle reaches.
    Jump,
    /// The model's torque is not finite.
    Torque,
    /// It gave out more energy than it may: 0.1 J beyond what it took and, unless it was forced, its places hold.
    Energy,
}

impl Fault {
    /// What happened and what to do.
    pub fn text(self) -> &'static str {
        match self {
            Self::NotFinite => {
                "a sensed angle, speed, acceleration or torque was not finite; check the sensor, then reset"
            }
            Self::Jump => {
                "the angle jumped, or the speed is beyond the speed limit; check the encoder and the rate, then reset"
            }
            Self::Torque => "the model's torque was not finite; check the model, then reset",
            Self::Energy => {
                "it gave out 0.1 J more than it took and its places hold; correct the model, then reset"
            }
        }
    }

    /// Every fault.
    pub const ALL: [Self; 4] = [Self::NotFinite, Self::Jump, Self::Torque, Self::Energy];

    /// Short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotFinite => "not finite",
            Self::Jump => "jump",
            Self::Torque => "torque",
            Self::Energy => "energy",
        }
    }
}
