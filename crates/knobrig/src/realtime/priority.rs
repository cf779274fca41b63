//! Real-time priority of the thread that runs a loop.
use knobcore::error::{Error, Result};

/// Whether a loop needs real-time priority.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Realtime {
    /// Refuse to run without.
    Enforce,
    /// Run without, and say so.
    Warn,
    /// Do not ask for it.
    Off,
}

impl Realtime {
    /// Reads `enforce`, `warn` or `off`.
    pub fn parse(word: &str) -> Result<Self> {
        match word {
            "enforce" => Ok(Self::Enforce),
            "warn" => Ok(Self::Warn),
            "off" => Ok(Self::Off),
            _ => Err(Error::invalid("rt", format!("'{word}' is unknown; choose enforce, warn or off"))),
        }
    }
}

/// With what right a loop ran.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// It had real-time priority.
    Realtime,
    /// It had none, and this is why.
    Ordinary(String),
}

impl Standing {
    /// What `rt` and the answer of the system to the request make of it.
    pub(super) fn ask(rt: Realtime, request: impl FnOnce() -> Result<()>) -> Result<Self> {
        if rt == Realtime::Off {
            return Ok(Self::Ordinary("real-time priority was not asked for (rt='off')".into()));
        }
        match request() {
            Ok(()) => Ok(Self::Realtime),
            Err(error) if rt == Realtime::Enforce => Err(error),
            Err(error) => Ok(Self::Ordinary(error.to_string())),
        }
    }
}

/// Of 1 to 99: above threaded interrupts (50), below what keeps the kernel itself alive (99).
#[cfg(unix)]
const PRIORITY: u8 = 80;

/// Asks the system for real-time priority of the calling thread.
pub fn real_time_priority() -> Result<()> {
    granted().map_err(|why| {
        let way = "allow it (Linux: 'ulimit -r 80' by an rtprio line in /etc/security/limits.conf, or the \
                   capability CAP_SYS_NICE), or go without (rt='warn' or 'off')";
        Error::invalid("rt", format!("the system refuses real-time priority ({why}); {way}"))
    })
}

#[cfg(unix)]
fn granted() -> std::result::Result<(), String> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let priority = ThreadPriorityValue::try_from(PRIORITY)?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(priority),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|error| match error {
        thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code).to_string(),
        other => other.to_string(),
    })
}

#[cfg(not(unix))]
fn granted() -> std::result::Result<(), String> {
    use thread_priority::{ThreadPriority, set_current_thread_priority};
    set_current_thread_priority(ThreadPriority::Max).map_err(|error| error.to_string())
}

/// Linux wakes an ordinary thread up to 50 us late to save power; a quarter of a period is too dear for that.
#[cfg(target_os = "linux")]
pub(super) fn wake_without_slack() {
    // Where it is refused the wake-up is later, which the histogram tells.
    let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
}

#[cfg(not(target_os = "linux"))]
pub(super) fn wake_without_slack() {}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused() -> Result<()> {
        Err(Error::invalid("rt", "not permitted"))
    }

    #[test]
    fn enforce_refuses_where_priority_is_not_granted() {
        assert_eq!(Standing::ask(Realtime::Enforce, refused), Err(refused().unwrap_err()));
        assert_eq!(Standing::ask(Realtime::Enforce, || Ok(())), Ok(Standing::Realtime));
    }

    #[test]
    fn warn_runs_anyway_and_keeps_the_reason() {
        assert_eq!(
            Standing::ask(Realtime::Warn, refused),
            Ok(Standing::Ordinary("rt: not permitted".into()))
        );
    }

    #[test]
    fn off_does_not_ask() {
        let standing = Standing::ask(Realtime::Off, || panic!("asked"));
        assert!(matches!(standing, Ok(Standing::Ordinary(why)) if why.contains("not asked")));
    }

    #[test]
    fn an_unknown_word_names_the_known_ones() {
        let error = Realtime::parse("always").unwrap_err().to_string();
        assert!(error.contains("enforce, warn or off"), "{error}");
    }
}
