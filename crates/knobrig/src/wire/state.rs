//! The states of a device and which command leads from one to another.
use super::field::choice;

choice! {
    /// What a device is doing. Torque is other than zero in `Rendering` alone.
    pub enum State {
        /// Waits.
        Idle = 0,
        /// A run without torque.
        Recording = 1,
        /// START will bring torque; the watchdog watches the host.
        Armed = 2,
        /// A run with torque; the watchdog watches the host.
        Rendering = 3,
        /// Latched; only CLEAR leads out.
        Fault = 4,
    }
}

impl State {
    /// The state after the last sample of a run.
    pub fn ended(self) -> Self {
        match self {
            Self::Recording => Self::Idle,
            Self::Rendering => Self::Armed,
            other => other,
        }
    }

    /// Whether samples are recorded.
    pub fn runs(self) -> bool {
        matches!(self, Self::Recording | Self::Rendering)
    }

    /// Whether the silence of the host is a fault.
    pub fn watched(self) -> bool {
        matches!(self, Self::Armed | Self::Rendering)
    }
}

/// Why a command was refused: codes of NAK. From 0x100 on they are the firmware's own.
pub mod refusal {
    /// The type is unknown, or its body is not one of it.
    pub const UNKNOWN: u16 = 1;
    /// Not allowed in this state.
    pub const STATE: u16 = 2;
    /// A value is not finite, negative or above a limit of the descriptor; a motion jumps or begins elsewhere than at
    /// rest where the knob stands.
    pub const VALUE: u16 = 3;
    /// The device cannot do this.
    pub const UNABLE: u16 = 4;
    /// No whole motion or model is there.
    pub const MISSING: u16 = 5;
    /// The chunk does not follow on those before it.
    pub const ORDER: u16 = 6;
    /// The motion or model is larger than the device can keep.
    pub const LARGE: u16 = 7;
    /// The whole does not have the check sum that its chunks promised.
    pub const CHECK: u16 = 8;
    /// The model file is none that the device can render; the text says why.
    pub const MODEL: u16 = 9;
}

/// Why a device is in `State::Fault`: codes of FAULT. From 0x100 on they are the firmware's own.
pub mod fault {
    /// The host was silent for longer than the heartbeat.
    pub const WATCHDOG: u16 = 1;
    /// A sensor gave something that cannot be.
    pub const SENSOR: u16 = 2;
    /// The torque that was to be rendered is not finite.
    pub const TORQUE: u16 = 3;
    /// The knob is too far from the motion that drives it.
    pub const TRACKING: u16 = 4;
    /// Too hot.
    pub const TEMPERATURE: u16 = 5;
    /// The device missed its own deadline.
    pub const DEADLINE: u16 = 6;
    /// The port was closed while torque was possible.
    pub const PORT: u16 = 7;
    /// Of the emulated rig: a model gave out more energy than it may.
    pub const ENERGY: u16 = 256;
}
