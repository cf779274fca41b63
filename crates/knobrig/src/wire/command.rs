//! Which command leads from one state of a device to another.
use super::message::Message;
use super::state::{State, refusal};

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
