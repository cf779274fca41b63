//! From a capture to prepared signals: the motion from its sensors, the torque through its filter.

mod direction;
mod edge;
mod fresh;
mod incoherent;
mod motion;

use crate::chain::SUBSTEPS;
use crate::error::{Error, Result};
use crate::filter::{ZeroPhase, butter, cheby1, cheby2};
use crate::model::Run;
use crate::param::Axis;
use crate::signals::Signals;
use crate::smooth::Noise;
use crate::spans::spans;

pub use edge::{Edge, Ripple, taken_off};
pub use incoherent::Incoherent;

use direction::{standing_still, without_unsure};
use fresh::Fresh;
use motion::{Moving, columns, forward, smoothed};
use std::ops::Range;

/// The sampling rate of the paper, Hz; its filter edges (Table 6) belong to it.
const PAPER_RATE_HZ: f64 = 5000.0;
/// Shortest stretch that is worth fitting, samples.
const SHORTEST: usize = 32;
/// Samples at each end where the smoother knows the acceleration badly.
const SMOOTHER_ENDS: usize = 50;

/// A low-pass filter by its design; it runs forward and backward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowPass {
    /// Chebyshev type II, 3rd order, 20 dB: the paper's, by its stopband edge in Hz.
    Paper(f64),
    /// Butterworth of this order with this cutoff in Hz, padded by three times its order as Matlab does.
    Butterworth(usize, f64),
    /// Chebyshev type I, 8th order, 0.05 dB, cutoff at 0.8 of the Nyquist frequency after decimation by this
    /// factor: the filter of Matlab's `decimate`.
    Decimation(usize),
}

impl LowPass {
    fn design(self, rate_hz: f64) -> Result<ZeroPhase> {
        match self {
            Self::Paper(edge) => Ok(ZeroPhase::new(cheby2(3, 20.0, edge, rate_hz)?)),
            Self::Butterworth(order, edge) => {
                Ok(ZeroPhase::new(butter(order, edge, rate_hz)?).padded_by(3 * order))
            }
            Self::Decimation(factor) => {
                let edge = 0.8 * 0.5 * rate_hz / factor as f64;
                Ok(ZeroPhase::new(cheby1(8, 0.05, edge, rate_hz)?).padded_by(24))
            }
        }
    }
}

/// Where theta, omega and alpha come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// One fixed-interval smoother over all motion sensors, with its uncertainty.
    Smoother,
    /// The columns, each through its own filter; omega and alpha that were not recorded are central
    /// differences of the filtered angle.
    Filtered {
        /// For theta.
        theta: LowPass,
        /// For omega, if recorded.
        omega: LowPass,
        /// For alpha, if recorded.
        alpha: LowPass,
    },
    /// The columns as they are; what was not recorded, by central differences.
    AsGiven,
}

/// How a capture is prepared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preparation {
    /// Where the motion comes from.
    pub source: Source,
    /// The measurement filter of the torque; the model's torque takes it too.
    pub torque: Option<LowPass>,
    /// Whether the edge of that filter, if it is the paper's, goes up to where the motion makes waves of the torque.
    pub follows: bool,
    /// Samples at the start that are left out before the torque is filtered.
    pub skip: usize,
    /// Samples at each end of a stretch that do not count; None: as long as the filter takes to settle.
    pub trim: Option<usize>,
    /// Of the filtered samples only every so many count.
    pub every: usize,
    /// Whether straight lines stand for the torque that was not measured; else it is what the motion made, and just
    /// does not count.
    pub bridged: bool,
    /// What is found and told, but left as it is.
    pub trusted: Trusted,
}

/// What a person knows better: nothing is done about it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Trusted {
    /// Readings of theta, omega and alpha that all the others contradict.
    pub readings: [bool; 3],
    /// Bands in which the motion is not what the torque made.
    pub bands: bool,
}

impl Preparation {
    /// The default: the motion from the smoother, the torque through the paper's filter. Edges of Table 6
    /// belong to 5 kHz; at a lower rate they keep their share of it, or follow the torque.
    pub fn smooth(rate_hz: f64) -> Self {
        let torque = Some(LowPass::Paper(500.0 * slower(rate_hz)));
        Self { source: Source::Smoother, torque, follows: true, trim: None, ..Self::none() }
    }

    /// The same for a torque at this rate: where the edge is not given it keeps its share of it.
    fn at(self, rate_hz: f64) -> Self {
        Self { torque: if self.follows { Self::smooth(rate_hz).torque } else { self.torque }, ..self }
    }

    /// The paper's own: a filter per channel, the edges of Table 6.
    pub fn paper(rate_hz: f64) -> Self {
        let [fast, slow] = [1000.0, 500.0].map(|edge| LowPass::Paper(edge * slower(rate_hz)));
        let source = Source::Filtered { theta: fast, omega: fast, alpha: slow };
        Self { source, torque: Some(slow), trim: None, ..Self::none() }
    }

    /// Everything as it is.
    pub fn none() -> Self {
        let trusted = Trusted::default();
        Self {
            source: Source::AsGiven,
            torque: None,
            follows: false,
            skip: 0,
            trim: Some(0),
            every: 1,
            bridged: true,
            trusted,
        }
    }

    /// The practice of robot identification (Gautier 1997; Janot, Gautier & Brunot 2019): a 4th-order
    /// Butterworth on the position, central differences, everything decimated.
    pub fn differences(cutoff_hz: f64, decimate: usize) -> Self {
        let butterworth = LowPass::Butterworth(4, cutoff_hz);
        let source = Source::Filtered { theta: butterworth, omega: butterworth, alpha: butterworth };
        let torque = (decimate > 1).then_some(LowPass::Decimation(decimate));
        Self { source, torque, skip: 49, every: decimate.max(1), ..Self::none() }
    }
}

/// The factor by which the paper's filter edges shrink at this rate: none at 5 kHz and above.
pub fn slower(rate_hz: f64) -> f64 {
    (rate_hz / PAPER_RATE_HZ).min(1.0)
}

/// A capture as it was recorded, the rows that cannot be used left out; SI units.
#[derive(Debug, Clone, Copy)]
pub struct Recording<'a> {
    /// Which run of the knob it is.
    pub run: &'a Run,
    /// Rotary or linear.
    pub axis: Axis,
    /// Nominal sampling rate, Hz.
    pub rate_hz: f64,
    /// Time, s; increasing.
    pub t: &'a [f64],
    /// Angle, rad.
    pub theta: &'a [f64],
    /// Angular velocity, rad/s, if it was recorded.
    pub omega: Option<&'a [f64]>,
    /// Angular acceleration, rad/s^2, if it was recorded.
    pub alpha: Option<&'a [f64]>,
    /// Torque, N m; NaN where its sensor says nothing new, and the motion alone is measured.
    pub tau: &'a [f64],
    /// Whether rows were left out just before this one.
    pub after_gap: &'a [bool],
    /// Whether this row was measured: others bridge a fault of a few rows, go through the filters and do not count.
    pub measured: &'a [bool],
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// What a fit sees.
    pub signals: Signals,
    /// Standard deviation of theta and alpha where the source knows it.
    pub uncertainty: Option<[Vec<f64>; 2]>,
    /// Noise levels of the motion sensors, where they were estimated.
    pub noise: Option<Noise>,
    /// The edge of the torque's filter, where that is the paper's.
    pub edge: Option<Edge>,
    /// Readings of theta, omega and alpha, by row, that the smoother left out: all the others contradict them.
    pub strays: [Vec<usize>; 3],
}

/// Prepares a recording.
///
/// # Errors
/// A filter edge that the rate does not allow, times that do not increase, no stretch that is long enough.
pub fn prepare(recording: &Recording<'_>, how: &Preparation) -> Result<Prepared> {
    let stretches = stretches(recording);
    let moving = match how.source {
        Source::Smoother => smoothed(recording, &stretches, how.trusted.readings)?,
        Source::Filtered { theta, omega, alpha } => {
            let design = |low_pass: LowPass| low_pass.design(recording.rate_hz).map(Some);
            columns(recording, &stretches, [design(theta)?, design(omega)?, design(alpha)?])?
        }
        Source::AsGiven => columns(recording, &stretches, [None, None, None])?,
    };
    match Fresh::of(recording) {
        None => with_motion(recording, how, moving, &stretches),
        Some(fresh) => {
            let told = fresh.recording(recording);
            with_motion(&told, &how.at(told.rate_hz), fresh.moving(&moving), &self::stretches(&told))
        }
    }
}

/// Prepares a recording whose motion is known.
fn with_motion(
    recording: &Recording<'_>,
    how: &Preparation,
    mut moving: Moving,
    stretches: &[Range<usize>],
) -> Result<Prepared> {
    let mut filter = how.torque.map(|design| design.design(recording.rate_hz)).transpose()?;
    let mut usable = Usable::of(stretches, how, filter.as_ref())?;
    let mut edge = None;
    if let (Some(LowPass::Paper(hz)), Some(given)) = (how.torque, &filter) {
        let found = Edge::of(recording, &moving, stretches, given, hz, how.follows);
        if found.hz > hz {
            filter = Some(LowPass::Paper(found.hz).design(recording.rate_hz)?);
            usable = Usable::of(stretches, how, filter.as_ref())?;
        }
        edge = Some(found);
        if how.follows
            && let Some(without) = beside(recording, &moving, &usable, found.hz)
        {
            edge = Some(Edge { incoherent: Some(without), ..found });
            if !how.trusted.bands {
                let lowered = LowPass::Paper(without.hz).design(recording.rate_hz)?;
                usable = Usable::within(&usable.inside(), &lowered)?;
                filter = Some(lowered);
                moving.keep_below(without.hz, recording, &usable.segments)?;
                edge = Some(found.lowered(without));
            }
        }
    }
    let Usable { settle, trim, segments } = usable;
    let mut weight = vec![0.0; recording.t.len()];
    for segment in &segments {
        let counted = segment.start + trim..segment.end - trim;
        let last = counted.end - 1;
        for at in counted {
            // A division takes longer than everything else here.
            let counts = recording.measured[at] && (how.every == 1 || (last - at).is_multiple_of(how.every));
            weight[at] = if counts { 1.0 } else { 0.0 };
        }
    }
    let stuck = standing_still(&moving, &segments, recording.rate_hz);
    for at in stuck.iter().flat_map(Clone::clone) {
        weight[at] = 0.0;
    }
    weight = without_unsure(&weight, &moving, &segments, settle / 2).unwrap_or(weight);
    let bridged = segments.iter().filter(|_| how.bridged);
    let bridges = bridged.flat_map(|segment| spans(segment.clone(), 0, |at| !recording.measured[at]));
    let start = recording.t.first().copied().unwrap_or(0.0);
    let mut signals = Signals {
        run: recording.run.clone(),
        axis: recording.axis,
        rate_hz: recording.rate_hz,
        t: recording.t.iter().map(|t| t - start).collect(),
        forward: moving.omega.iter().zip(&moving.omega_sd).map(|(omega, sd)| forward(*omega, *sd)).collect(),
        theta: moving.theta,
        omega: moving.omega,
        alpha: moving.alpha,
        omega_sd: moving.omega_sd,
        tau: Vec::new(),
        tau_raw: recording.tau.to_vec(),
        weight,
        bridges: bridges.collect(),
        knocks: Vec::new(),
        segments,
        stuck,
        filter,
        substeps: SUBSTEPS,
        begins: Vec::new(),
    };
    signals.filter_torque();
    let Moving { uncertainty, noise, strays, .. } = moving;
    Ok(Prepared { signals, uncertainty, noise, edge, strays })
}

/// Whether the torque, filtered as it is `how`, with an edge at `hz`, has bands that the motion is not made of.
fn beside(recording: &Recording<'_>, moving: &Moving, usable: &Usable, hz: f64) -> Option<Incoherent> {
    let inside = usable.inside();
    let leaves = |hz: f64| {
        let filter = LowPass::Paper(hz).design(recording.rate_hz).ok();
        let fewer = filter.and_then(|filter| Usable::within(&inside, &filter).ok());
        fewer.is_some_and(|fewer| 2 * fewer.counted() >= usable.counted())
    };
    let rates = [recording.rate_hz, hz];
    incoherent::incoherent(moving, recording.tau, recording.axis, &inside, rates, leaves)
}

/// What is left of the stretches beside what the filter needs.
struct Usable {
    /// Samples after which the filter's response is down to 1e-4, a quarter of the way to 1e-16.
    settle: usize,
    /// Samples at each end of a segment that do not count.
    trim: usize,
    segments: Vec<Range<usize>>,
}

impl Usable {
    fn of(stretches: &[Range<usize>], how: &Preparation, filter: Option<&ZeroPhase>) -> Result<Self> {
        let settle = filter.map_or(0, |filter| filter.sos().settle() / 4);
        let ends = if how.source == Source::Smoother { SMOOTHER_ENDS } else { 0 };
        let trim = how.trim.unwrap_or(settle.max(ends));
        let stretches = stretches.iter().map(|s| s.start.max(how.skip)..s.end);
        Self::long(stretches.collect(), filter, settle, trim)
    }

    /// Of ranges in which the motion is known, with a filter so slow that it would leave little: a tenth of its
    /// response is all that counts, since the model's torque ends where the measured one does.
    fn within(inside: &[Range<usize>], filter: &ZeroPhase) -> Result<Self> {
        let settle = filter.sos().settle() / 16;
        Self::long(inside.to_vec(), Some(filter), settle, settle)
    }

    fn long(
        mut segments: Vec<Range<usize>>,
        filter: Option<&ZeroPhase>,
        settle: usize,
        trim: usize,
    ) -> Result<Self> {
        let shortest = SHORTEST.max(2 * trim + 1).max(filter.map_or(0, ZeroPhase::padding) + 1);
        let longest = segments.iter().map(ExactSizeIterator::len).max().unwrap_or(0);
        segments.retain(|segment| segment.len() >= shortest);
        if segments.is_empty() {
            return Err(Error::invalid(
                "capture",
                format!(
                    "its longest stretch without gap has {longest} good samples, and {shortest} are needed for \
                     this filter; record longer, or raise the filter's edge"
                ),
            ));
        }
        Ok(Self { settle, trim, segments })
    }

    /// The segments without the ends, where the smoother knows the acceleration badly.
    fn inside(&self) -> Vec<Range<usize>> {
        let ends = self.trim.min(SMOOTHER_ENDS);
        self.segments.iter().map(|s| s.start + ends..s.end - ends).collect()
    }

    /// Samples that count, of those that were measured.
    fn counted(&self) -> usize {
        self.segments.iter().map(|s| s.len() - 2 * self.trim).sum()
    }
}

/// Runs of rows without gap.
fn stretches(recording: &Recording<'_>) -> Vec<Range<usize>> {
    let n = recording.t.len();
    let mut borders: Vec<usize> = (1..n).filter(|&i| recording.after_gap[i]).collect();
    borders.insert(0, 0);
    borders.push(n);
    borders.windows(2).map(|pair| pair[0]..pair[1]).filter(|s| !s.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_the_paper_shrink_below_its_rate_and_stay_above_it() {
        assert_eq!(Preparation::smooth(1000.0).torque, Some(LowPass::Paper(100.0)));
        assert_eq!(Preparation::smooth(20_000.0).torque, Some(LowPass::Paper(500.0)));
    }
}
