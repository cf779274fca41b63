//! What a device says about itself: the meaning of its raw numbers, its limits and its body.
use super::field::{Serial, choice, record};
use super::sample::Sample;
use knobcore::error::{Error, Result};

choice! {
    /// Unit of a channel.
    pub enum Unit {
        /// The device has no such sensor.
        Absent = 0,
        /// rad/s.
        RadPerSecond = 1,
        /// V, of an accelerometer that is still to be calibrated.
        Volt = 2,
        /// N m.
        NewtonMetre = 3,
    }
}

record! {
    /// An analogue channel: `scale * raw + offset` in its unit.
    pub struct Channel {
        /// Units per step of the converter.
        pub scale: f32,
        /// Value of raw 0, in units.
        pub offset: f32,
        /// Unit of the value.
        pub unit: Unit,
        /// Lowest raw value that is a reading; at or below it the channel is clipped.
        pub lower: i16,
        /// Highest raw value that is a reading; at or above it the channel is clipped.
        pub upper: i16,
    }
}

impl Channel {
    /// A sensor that the device does not have.
    pub const ABSENT: Self = Self { scale: 0.0, offset: 0.0, unit: Unit::Absent, lower: 0, upper: 0 };

    /// The value in the channel's unit; none where there is no sensor or no reading.
    pub fn value(&self, raw: i16) -> Option<f64> {
        let reading = self.unit != Unit::Absent && raw != Sample::NO_READING;
        reading.then(|| f64::from(self.scale) * f64::from(raw) + f64::from(self.offset))
    }

    /// Whether the value is only a bound, because the sensor or its converter was at a limit.
    pub fn clipped(&self, raw: i16) -> bool {
        raw != Sample::NO_READING && (raw <= self.lower || raw >= self.upper)
    }

    fn check(&self, name: &str, unit: Unit) -> Result<()> {
        if self.unit == Unit::Absent {
            return Ok(());
        }
        if self.unit != unit {
            return lie(name, format!("its unit is {:?} where {unit:?} is expected", self.unit));
        }
        if !self.scale.is_finite() || self.scale == 0.0 || !self.offset.is_finite() {
            return lie(name, format!("scale {} and offset {} give no value", self.scale, self.offset));
        }
        if self.lower >= self.upper || self.lower == Sample::NO_READING {
            return lie(name, format!("its limits {} to {} are not a range", self.lower, self.upper));
        }
        Ok(())
    }
}

record! {
    /// The answer to DESCRIBE.
    pub struct Descriptor {
        /// Serial number, at most 16 printable ASCII characters.
        pub serial: Serial,
        /// Firmware, major number.
        pub firmware_major: u16,
        /// Firmware, minor number.
        pub firmware_minor: u16,
        /// Samples per second, Hz.
        pub rate_hz: f64,
        /// Encoder counts per rad; negative where the encoder counts backward.
        pub counts_per_rad: f64,
        /// Angular velocity.
        pub omega: Channel,
        /// Accelerometer.
        pub alpha: Channel,
        /// Torque that the rig applies.
        pub tau: Channel,
        /// Nominal C_cal of the accelerometer, (rad/s^2)/V; calibration replaces it.
        pub c_cal: f32,
        /// Greatest torque, N m.
        pub torque_limit: f32,
        /// Greatest change of torque, N m/s.
        pub torque_rate_limit: f32,
        /// Inertia of the device without a knob, kg m^2.
        pub inertia: f32,
        /// Viscous damping of the device without a knob, N m s/rad.
        pub damping: f32,
        /// Stiffness to which a stuck knob may be anchored on this device, N m/rad.
        pub anchor_stiffness: f32,
        /// Whole samples from an instant to the torque that answers to it.
        pub delay_samples: u16,
        /// Longest silence of the host while torque is possible, ms.
        pub heartbeat_ms: u16,
        /// Points that an uploaded motion may have.
        pub motion_capacity: u32,
        /// Bytes that an uploaded model may have.
        pub model_capacity: u32,
        /// Chunks of an upload that may be on their way without an answer.
        pub window: u8,
        /// Sum of `capability` bits.
        pub capabilities: u16,
    }
}

/// What a device can do: bits of `Descriptor::capabilities`.
pub mod capability {
    /// Drives an uploaded motion.
    pub const DRIVE: u16 = 1;
    /// Renders an uploaded model.
    pub const RENDER: u16 = 2;
    /// Renders a model while an uploaded motion moves the knob.
    pub const RENDER_DRIVEN: u16 = 4;
    /// Takes torque from the host, command by command.
    pub const COMMANDED: u16 = 8;
    /// Sends its temperature.
    pub const TEMPERATURE: u16 = 16;
}

impl Descriptor {
    /// Whether the numbers can be those of a rig.
    ///
    /// # Errors
    /// The first field that cannot be, and why.
    pub fn check(&self) -> Result<()> {
        let positive = [
            ("sample rate", self.rate_hz),
            ("torque limit", self.torque_limit.into()),
            ("torque rate limit", self.torque_rate_limit.into()),
            ("heartbeat", self.heartbeat_ms.into()),
            ("window", self.window.into()),
        ];
        let never_negative = [
            ("inertia", self.inertia),
            ("damping", self.damping),
            ("anchor stiffness", self.anchor_stiffness),
        ];
        if self.serial.is_empty() {
            return lie("serial number", "it is empty");
        }
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return lie(name, format!("{value} is not positive"));
            }
        }
        for (name, value) in never_negative {
            if !(value.is_finite() && value >= 0.0) {
                return lie(name, format!("{value} is none"));
            }
        }
        if !self.counts_per_rad.is_finite() || self.counts_per_rad == 0.0 {
            return lie("counts per rad", format!("{} gives no angle", self.counts_per_rad));
        }
        self.omega.check("velocity channel", Unit::RadPerSecond)?;
        self.alpha.check("acceleration channel", Unit::Volt)?;
        self.tau.check("torque channel", Unit::NewtonMetre)?;
        if self.alpha.unit == Unit::Volt && !(self.c_cal.is_finite() && self.c_cal != 0.0) {
            return lie("C_cal", format!("{} gives no acceleration", self.c_cal));
        }
        Ok(())
    }
}

fn lie(name: &str, why: impl std::fmt::Display) -> Result<()> {
    Err(Error::invalid(
        format!("descriptor, {name}"),
        format!("{why}; the firmware must be corrected before this device can be used"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::field::{Field, Writer};

    fn descriptor() -> Descriptor {
        let channel = |scale, unit| Channel { scale, offset: 0.0, unit, lower: -32000, upper: 32000 };
        Descriptor {
            serial: Serial::from("KC-0007").unwrap(),
            firmware_major: 1,
            firmware_minor: 2,
            rate_hz: 5000.0,
            counts_per_rad: 102_400.0,
            omega: channel(1e-3, Unit::RadPerSecond),
            alpha: channel(1e-4, Unit::Volt),
            tau: channel(2e-5, Unit::NewtonMetre),
            c_cal: 512.0,
            torque_limit: 0.5,
            torque_rate_limit: 250.0,
            inertia: 2e-5,
            damping: 3e-5,
            anchor_stiffness: 16.0,
            delay_samples: 2,
            heartbeat_ms: 100,
            motion_capacity: 300_000,
            model_capacity: 65_536,
            window: 4,
            capabilities: 31,
        }
    }

    #[test]
    fn a_descriptor_takes_a_hundred_and_fourteen_bytes() {
        let mut out = Writer::new();
        descriptor().write(&mut out);
        assert_eq!(out.written().len(), 114);
    }

    #[test]
    fn a_descriptor_that_cannot_be_is_refused_by_name() {
        assert_eq!(descriptor().check(), Ok(()));
        let refused = |change: fn(&mut Descriptor)| {
            let mut lying = descriptor();
            change(&mut lying);
            lying.check().unwrap_err().to_string()
        };
        assert!(refused(|d| d.rate_hz = 0.0).contains("sample rate"));
        assert!(refused(|d| d.rate_hz = f64::NAN).contains("sample rate"));
        assert!(refused(|d| d.counts_per_rad = 0.0).contains("counts per rad"));
        assert!(refused(|d| d.tau.unit = Unit::Volt).contains("torque channel"));
        assert!(refused(|d| d.omega.upper = d.omega.lower).contains("velocity channel"));
        assert!(refused(|d| d.c_cal = 0.0).contains("C_cal"));
        assert!(refused(|d| d.inertia = -1.0).contains("inertia"));
        assert!(refused(|d| d.serial = Serial::new()).contains("serial"));
    }

    #[test]
    fn a_raw_value_is_scaled_clipped_or_absent() {
        let channel = Channel { scale: 0.5, offset: 1.0, unit: Unit::Volt, lower: -100, upper: 200 };
        assert_eq!(channel.value(4), Some(3.0));
        assert_eq!(channel.value(Sample::NO_READING), None);
        assert_eq!(Channel::ABSENT.value(4), None);
        assert!(channel.clipped(200) && channel.clipped(-100) && !channel.clipped(199));
        assert!(!channel.clipped(Sample::NO_READING));
    }
}
