//! Why a loop ended.
use knobcore::error::Error;
use std::fmt;

/// Why a loop ended. Zero torque is written after each of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// Its time was over.
    Over,
    /// It was asked to stop.
    Asked,
    /// The controller found something wrong.
    Fault(Error),
    /// The controller answered with what is no torque.
    NotFinite(f64),
    /// The device failed.
    Device(Error),
    /// The time between a deadline and `during`, s, was longer than the watchdog allows, s.
    Stalled {
        /// What was then at hand.
        during: &'static str,
        /// How long after the deadline, s.
        late_s: f64,
        /// The most that is allowed, s.
        watchdog_s: f64,
    },
    /// Of the periods of the last second a larger share was missed than is allowed.
    Misses {
        /// The share that was missed.
        share: f64,
        /// The most that is allowed.
        limit: f64,
    },
    /// More periods in a row were missed than are allowed.
    Run {
        /// How many were missed.
        run: u64,
        /// The most that are allowed.
        limit: u64,
    },
    /// The device or the controller panicked.
    Panicked(String),
}

impl Ending {
    /// One word for it: time, asked, fault, device, stalled, misses or panic.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Over => "time",
            Self::Asked => "asked",
            Self::Fault(_) | Self::NotFinite(_) => "fault",
            Self::Device(_) => "device",
            Self::Stalled { .. } => "stalled",
            Self::Misses { .. } | Self::Run { .. } => "misses",
            Self::Panicked(_) => "panic",
        }
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Over => write!(f, "its time was over"),
            Self::Asked => write!(f, "it was asked to stop"),
            Self::Fault(error) => write!(f, "the controller found a fault: {error}"),
            Self::NotFinite(tau) => write!(f, "the controller answered with {tau}, which is no torque"),
            Self::Device(error) => write!(f, "the device failed: {error}"),
            Self::Stalled { during, late_s, watchdog_s } => write!(
                f,
                "{:.1} ms after its deadline the loop was only {during}, and the watchdog allows {:.1} ms: \
                 ask for real-time priority, or lower the rate",
                1e3 * late_s,
                1e3 * watchdog_s
            ),
            Self::Misses { share, limit } => write!(
                f,
                "{:.1} % of the periods of the last second were missed, and {:.1} % are allowed: \
                 ask for real-time priority, or lower the rate",
                100.0 * share,
                100.0 * limit
            ),
            Self::Run { run, limit } => write!(
                f,
                "{run} periods in a row were missed, and {limit} are allowed: ask for real-time priority, \
                 or lower the rate"
            ),
            Self::Panicked(message) => write!(f, "the device or the controller panicked: {message}"),
        }
    }
}
