//! What the sensors give at one instant, and a point of a motion that the device drives.
use super::field::record;

record! {
    /// One sample, 10 bytes of raw integers; the descriptor says what they mean.
    pub struct Sample {
        /// Encoder, counts since power-up.
        pub count: i32,
        /// Tachometer or gyroscope.
        pub omega: i16,
        /// Accelerometer.
        pub alpha: i16,
        /// Torque sensor.
        pub tau: i16,
    }
}

record! {
    /// One setpoint of an uploaded motion, 16 bytes, SI.
    pub struct Point {
        /// Angle from where the knob stands at START, rad.
        pub theta: f64,
        /// Angular velocity, rad/s.
        pub omega: f32,
        /// Angular acceleration, rad/s^2.
        pub alpha: f32,
    }
}

impl Sample {
    /// Bytes of a sample in a frame.
    pub const BYTES: usize = 10;
    /// Raw value of a channel without a reading at this instant.
    pub const NO_READING: i16 = i16::MIN;
}

impl Point {
    /// Bytes of a point in a frame.
    pub const BYTES: usize = 16;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::field::{Field, Writer};

    #[test]
    fn a_sample_takes_ten_bytes_and_a_point_sixteen() {
        let mut out = Writer::new();
        Sample { count: -1, omega: 2, alpha: 3, tau: Sample::NO_READING }.write(&mut out);
        assert_eq!(out.written(), [0xFF, 0xFF, 0xFF, 0xFF, 2, 0, 3, 0, 0, 0x80]);
        assert_eq!(out.written().len(), Sample::BYTES);
        let mut out = Writer::new();
        Point { theta: 0.0, omega: 0.0, alpha: 0.0 }.write(&mut out);
        assert_eq!(out.written().len(), Point::BYTES);
    }
}
