//! What can be told about a recording while it goes on.
use crate::wire::{Descriptor, Piece, Run, Sample, State};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Pieces into which the last second is cut to count what came in it.
const SLICES: u32 = 20;

/// A recording at one moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Bytes that came.
    pub bytes: u64,
    /// Bytes of these that are in the log.
    pub logged: u64,
    /// Whole frames of this version.
    pub frames: u64,
    /// Stretches that were no frame.
    pub corrupt: u64,
    /// Version of the last frame of another version.
    pub foreign_version: Option<u8>,
    /// Messages that the host did not fetch in time and that were forgotten.
    pub forgotten: u64,
    /// State of the device, as it said last.
    pub state: Option<State>,
    /// Temperature of the device, degrees Celsius, as it said last.
    pub temperature: Option<f32>,
    /// The newest run, and all that follows of that run alone.
    pub run: Option<u16>,
    /// Samples that came, each counted once.
    pub received: u64,
    /// Samples that did not come, as far as is known.
    pub missing: u64,
    /// Whether the device has said how many it produced.
    pub complete: bool,
    /// Samples per second that came during the last second of this computer, Hz.
    pub rate_hz: f64,
    /// Samples per second of the device's own clock, Hz; none while its clock has not moved on.
    pub device_rate_hz: Option<f64>,
    /// Time of the device's clock from which that rate is known, s.
    pub device_span_s: f64,
    /// Greatest torque so far, N m; none before the first reading.
    pub peak_torque: Option<f64>,
    /// Clipped samples of omega, alpha and tau.
    pub clipped: [u64; 3],
    /// Why nothing is recorded any more: the log's error.
    pub log_error: Option<String>,
    /// Why nothing comes any more: the port's error.
    pub ended: Option<String>,
}

/// Counts what came, for [`Figures`].
#[derive(Debug, Default)]
pub(super) struct Meter {
    device: Option<Descriptor>,
    /// Which of the ledger's runs is measured.
    run: Option<usize>,
    /// Index and device time of the first frame and of the last one.
    stamps: Option<[(i64, u64); 2]>,
    /// Samples of each slice of the last second: when it began, how many.
    recent: VecDeque<(Instant, u64)>,
}

impl Meter {
    /// The device that the numbers come from.
    pub fn describe(&mut self, device: Descriptor) {
        self.device = Some(device);
    }

    /// Turns to a run, if it is newer than the one that is measured.
    pub fn turn_to(&mut self, run: Option<usize>, figures: &mut Figures) {
        if run > self.run {
            (self.run, self.stamps) = (run, None);
            self.recent.clear();
            (figures.device_rate_hz, figures.device_span_s) = (None, 0.0);
            (figures.peak_torque, figures.clipped) = (None, [0; 3]);
        }
    }

    /// Counts the samples of a piece.
    pub fn count(&mut self, piece: Piece<'_>, now: Instant, figures: &mut Figures) {
        self.turn_to(Some(piece.run), figures);
        if self.run != Some(piece.run) {
            return;
        }
        let stamp = (piece.frame_index, piece.frame_time_us);
        let [first, last] = self.stamps.unwrap_or([stamp; 2]);
        self.stamps = Some([first.min(stamp), last.max(stamp)]);
        let slice = Duration::from_secs(1) / SLICES;
        let count = piece.samples.len() as u64;
        match self.recent.back_mut() {
            Some((began, so_far)) if now.saturating_duration_since(*began) < slice => *so_far += count,
            _ => self.recent.push_back((now, count)),
        }
        let Some(device) = &self.device else { return };
        for sample in piece.samples {
            let Sample { omega, alpha, tau, .. } = *sample;
            let channels = [(&device.omega, omega), (&device.alpha, alpha), (&device.tau, tau)];
            for (count, (channel, raw)) in figures.clipped.iter_mut().zip(channels) {
                *count += u64::from(channel.clipped(raw));
            }
            if let Some(torque) = device.tau.value(tau) {
                figures.peak_torque =
                    Some(figures.peak_torque.map_or(torque.abs(), |peak| peak.max(torque.abs())));
            }
        }
    }

    /// Enters what follows from the books and from the clocks.
    pub fn enter(&mut self, runs: &[Run], now: Instant, figures: &mut Figures) {
        while self
            .recent
            .front()
            .is_some_and(|(began, _)| now.saturating_duration_since(*began).as_secs() >= 1)
        {
            self.recent.pop_front();
        }
        figures.rate_hz = self.recent.iter().map(|(_, count)| *count as f64).sum();
        if let Some([first, last]) = self.stamps
            && last.1 > first.1
        {
            figures.device_span_s = (last.1 - first.1) as f64 * 1e-6;
            figures.device_rate_hz = Some((last.0 - first.0) as f64 / figures.device_span_s);
        }
        self.turn_to(runs.len().checked_sub(1), figures);
        if let Some(run) = runs.last() {
            let account = run.account();
            figures.run = Some(run.tag);
            (figures.received, figures.missing) = (account.received, account.missing);
            figures.complete = account.produced.is_some();
        }
    }
}
