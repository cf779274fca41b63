//! How a loop shall run.
use super::clock::SECOND;
use knobcore::error::{Error, Result};

/// How a loop shall run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Steps a second, Hz; the period is rounded to a nanosecond.
    pub rate_hz: f64,
    /// How long, s; until it is stopped where None.
    pub seconds: Option<f64>,
    /// A loop that is later than this after a deadline, s, ends.
    pub watchdog_s: f64,
    /// The largest share of the periods of the last second that may be missed.
    pub missed_share: f64,
    /// The most periods in a row that may be missed; None leaves it to the watchdog.
    pub missed_run: Option<u64>,
}

impl Default for Plan {
    fn default() -> Self {
        Self { rate_hz: 5000.0, seconds: None, watchdog_s: 0.02, missed_share: 0.2, missed_run: None }
    }
}

/// Slower is no rendering, and faster than any system wakes a thread.
const RATES_HZ: std::ops::RangeInclusive<f64> = 1.0..=100_000.0;
/// A century of nanoseconds does not fit into the clock; a year of rendering is enough.
const LONGEST_S: f64 = 3.2e7;

impl Plan {
    /// Length of a period, ns.
    pub fn period(&self) -> u64 {
        (SECOND as f64 / self.rate_hz).round() as u64
    }

    /// Periods in a second.
    pub(super) fn periods_in_a_second(&self) -> usize {
        self.rate_hz.ceil() as usize
    }

    /// How many periods there are in all.
    pub(super) fn periods(&self) -> u64 {
        self.seconds.map_or(u64::MAX, |seconds| (seconds * self.rate_hz).round() as u64)
    }

    /// Longest time after a deadline, ns.
    pub(super) fn watchdog(&self) -> u64 {
        (self.watchdog_s * SECOND as f64) as u64
    }

    /// The plan, if it can be followed.
    pub fn checked(self) -> Result<Self> {
        if !RATES_HZ.contains(&self.rate_hz) {
            let why = format!("{} Hz is no rate to render at; choose one from 1 to 100000 Hz", self.rate_hz);
            return Err(Error::invalid("rate_hz", why));
        }
        if let Some(seconds) = self.seconds
            && !(seconds > 0.0 && seconds <= LONGEST_S)
        {
            return Err(Error::invalid("seconds", format!("{seconds} s is no time to render for")));
        }
        let period_s = 1.0 / self.rate_hz;
        if !(self.watchdog_s >= period_s && self.watchdog_s <= 1.0) {
            let why = format!("{} s must lie between one period ({period_s} s) and 1 s", self.watchdog_s);
            return Err(Error::invalid("watchdog_s", why));
        }
        if !(self.missed_share > 0.0 && self.missed_share <= 1.0) {
            let why =
                format!("{} is no share of the periods; choose one above 0, up to 1", self.missed_share);
            return Err(Error::invalid("missed_share", why));
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_that_cannot_be_followed_says_which_part_of_it() {
        let good = Plan::default();
        assert_eq!(good.checked(), Ok(good));
        for (plan, name) in [
            (Plan { rate_hz: 0.0, ..good }, "rate_hz"),
            (Plan { rate_hz: f64::NAN, ..good }, "rate_hz"),
            (Plan { seconds: Some(0.0), ..good }, "seconds"),
            (Plan { seconds: Some(f64::INFINITY), ..good }, "seconds"),
            (Plan { watchdog_s: 1e-4, ..good }, "watchdog_s"),
            (Plan { watchdog_s: f64::NAN, ..good }, "watchdog_s"),
            (Plan { missed_share: 0.0, ..good }, "missed_share"),
            (Plan { missed_share: 1.5, ..good }, "missed_share"),
        ] {
            let Err(error) = plan.checked() else { panic!("{plan:?} was taken") };
            assert!(error.to_string().starts_with(name), "{error}");
        }
    }

    #[test]
    fn five_kilohertz_is_a_period_of_two_hundred_microseconds() {
        assert_eq!(Plan::default().period(), 200_000);
        assert_eq!(Plan { seconds: Some(0.1), ..Plan::default() }.periods(), 500);
    }
}
