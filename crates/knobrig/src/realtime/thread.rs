//! A loop on a thread of its own.
use super::clock::Clock;
use super::live::{Live, Snapshot};
use super::plan::Plan;
use super::priority::{Realtime, Standing, wake_without_slack};
use super::run::{Loop, Report};
use super::{Controller, Plant};
use knobcore::error::{Error, Result};
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// A loop that was started. Letting go of it asks the loop to stop.
pub struct Running {
    plan: Plan,
    standing: Standing,
    live: Arc<Live>,
    outcome: Arc<Outcome>,
}

#[derive(Default)]
struct Outcome {
    report: Mutex<Option<Arc<Report>>>,
    ended: Condvar,
}

/// Starts a loop. `request` asks the system for real-time priority of the thread that calls it.
pub fn start<C, D, K, R>(
    plan: Plan,
    rt: Realtime,
    request: R,
    controller: C,
    device: D,
    clock: K,
) -> Result<Running>
where
    C: Controller + Send + 'static,
    D: Plant + Send + 'static,
    K: Clock + Send + 'static,
    R: FnOnce() -> Result<()> + Send + 'static,
{
    let (live, outcome) = (Arc::new(Live::default()), Arc::new(Outcome::default()));
    let ready = Loop::new(plan, Arc::clone(&live))?;
    let (tell, told) = sync_channel(1);
    let end = Arc::clone(&outcome);
    let thread = std::thread::Builder::new().name("knobcam-loop".into());
    let body = move || {
        wake_without_slack();
        let standing = Standing::ask(rt, request);
        let refused = standing.is_err();
        // Who started the loop waits for this word, so it is received.
        let _ = tell.send(standing);
        if !refused {
            let report = ready.run(controller, device, clock);
            *end.report.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(report));
            end.ended.notify_all();
        }
    };
    thread.spawn(body).map_err(|error| thread_error(&error.to_string()))?;
    let standing = told.recv().map_err(|_| thread_error("it ended before it began"))??;
    Ok(Running { plan, standing, live, outcome })
}

fn thread_error(why: &str) -> Error {
    Error::invalid("thread", format!("the system starts none for the loop: {why}"))
}

impl Running {
    /// How the loop was to run.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// With what right it runs.
    pub fn standing(&self) -> &Standing {
        &self.standing
    }

    /// What it reached lately.
    pub fn snapshot(&self) -> Snapshot {
        self.live.snapshot()
    }

    /// Asks it to stop; it does so in its next period.
    pub fn stop(&self) {
        self.live.stop();
    }

    /// Waits for its end, but no longer than this; the report, if it ended.
    pub fn wait(&self, longest: Duration) -> Option<Arc<Report>> {
        let report = self.outcome.report.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.outcome.ended.wait_timeout_while(report, longest, |report| report.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.clone()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.live.stop();
    }
}
