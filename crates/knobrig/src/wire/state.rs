//! The states of a device and which command leads from one to another.
use super::field::choice;
use super::message::Message;

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
    /// The state after a command whose content the device accepts.
    ///
    /// # Errors
    /// The `refusal` code where the command is not allowed in this state, or is none.
    pub fn after(self, command: &Message) -> Result<Self, u16> {
        match (command, self) {
            (Message::Start { .. }, Self::Idle) => Ok(Self::Recording),
            (Message::Start { .. }, Self::Armed) => Ok(Self::Rendering),
            (Message::Arm { .. }, Self::Idle) => Ok(Self::Armed),
            (Message::Excite { .. } | Message::Model { .. }, Self::Idle) => Ok(Self::Idle),
            (
                Message::Start { .. } | Message::Arm { .. } | Message::Excite { .. } | Message::Model { .. },
                _,
            ) => Err(refusal::STATE),
            (Message::Stop, _) => Ok(self.ended()),
            (Message::Disarm, Self::Armed | Self::Rendering) => Ok(Self::Idle),
            (Message::Clear, Self::Fault) => Ok(Self::Idle),
            (command, _) if command.is_command() => Ok(self),
            _ => Err(refusal::UNKNOWN),
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::message::Mode;

    const ALL: [State; 5] = [State::Idle, State::Recording, State::Armed, State::Rendering, State::Fault];

    fn arm() -> Message {
        Message::Arm { mode: Mode::Render, torque_limit: 0.1, torque_rate_limit: 10.0 }
    }

    #[test]
    fn torque_needs_arm_and_then_start() {
        for (state, command) in [
            (State::Idle, Message::Start { samples: 0 }),
            (State::Recording, arm()),
            (State::Fault, Message::Clear),
            (State::Fault, Message::Start { samples: 0 }),
        ] {
            assert_ne!(state.after(&command), Ok(State::Rendering));
        }
        let armed = State::Idle.after(&arm()).unwrap();
        assert_eq!(armed.after(&Message::Start { samples: 0 }), Ok(State::Rendering));
    }

    #[test]
    fn a_fault_is_left_by_clear_alone_and_never_for_torque() {
        for command in [Message::Ping, Message::Describe, Message::Stop, Message::Disarm, Message::Heartbeat]
        {
            assert_eq!(State::Fault.after(&command), Ok(State::Fault));
        }
        assert_eq!(State::Fault.after(&arm()), Err(refusal::STATE));
        assert_eq!(State::Fault.after(&Message::Clear), Ok(State::Idle));
    }

    #[test]
    fn no_command_but_start_brings_torque() {
        for state in ALL {
            for command in [Message::Ping, Message::Describe, Message::Stop, Message::Disarm, Message::Clear]
            {
                let after = state.after(&command).unwrap();
                assert!(after == state || !matches!(after, State::Rendering | State::Recording));
            }
        }
    }

    #[test]
    fn a_device_does_not_obey_another_device() {
        for state in ALL {
            assert_eq!(state.after(&Message::Pong { command: 1 }), Err(refusal::UNKNOWN));
        }
    }

    #[test]
    fn whoever_may_give_torque_is_watched() {
        assert!(State::Armed.watched() && State::Rendering.watched() && !State::Recording.watched());
    }
}
