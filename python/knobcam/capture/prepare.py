"""From a capture to prepared signals: the motion from its sensors, the torque through its filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..base import showing
from ..base.arrays import runs
from ..base.door import checked
from ..base.said import Advice, OfColumn, said
from ..errors import InputError
from . import run
from .finding import Finding, spans
from .quality.held import held
from .quality.ruled import with_later

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base.arrays import BoolArray, FloatArray
    from ..base.showing import Figure
    from .capture import Capture
    from .finding import Rows

METHODS = ("smooth", "paper", "none", "differences")
_OPTIONS = {
    "smooth": {"torque_edge_hz"},
    "paper": {"torque_edge_hz", "motion_edge_hz"},
    "none": set[str](),
    "differences": {"cutoff_hz", "decimate"},
}
_READ = ("theta", "omega", "alpha", "tau")
_BRIDGE = 3  # rows
_EVEN = 0.05  # of a sampling interval, within which steps of the clock are whole numbers of them
_ALL = 0.995  # of the steps, that are where a clock is even
_MOSTLY = 0.9  # of them, that are one interval
_NAMED = 6  # times in a sentence
_PAPER_RATE_HZ = 5000.0


@dataclass(frozen=True, eq=False, repr=False)
class Prepared:
    """Prepared signals of a capture; arrays of shape (samples kept,), SI units.

    `rows` are the indices of the kept samples in the capture: masked ones are left out, and so are those in
    which a torque that is read more slowly than the motion only repeats a reading. Where a few samples were
    lost a line stands for them, with the index of the one before. `used` is True where a sample counts in a
    fit (not trimmed, not decimated away, and measured).
    """

    capture: Capture
    method: str
    rows: np.ndarray[Any, np.dtype[np.intp]]
    options: Mapping[str, float]
    notes: tuple[str, ...]
    core: _core.Signals
    findings: tuple[Finding, ...] = ()
    """What was found in the capture, and on the way from it."""

    def _column(self, name: str) -> FloatArray:
        values = self.core.column(name)
        assert values is not None  # these columns are always there
        return values

    @property
    def t(self) -> FloatArray:
        """Time since the first sample, s."""
        return self._column("t")

    @property
    def theta(self) -> FloatArray:
        """Angle, rad (m)."""
        return self._column("theta")

    @property
    def omega(self) -> FloatArray:
        """Angular velocity, rad/s (m/s)."""
        return self._column("omega")

    @property
    def alpha(self) -> FloatArray:
        """Angular acceleration, rad/s^2 (m/s^2)."""
        return self._column("alpha")

    @property
    def tau(self) -> FloatArray:
        """Measured torque after the measurement filter, N m (N)."""
        return self._column("tau")

    @property
    def tau_raw(self) -> FloatArray:
        """Measured torque as it came, N m (N)."""
        return self._column("tau_raw")

    @property
    def used(self) -> BoolArray:
        """True where a sample counts."""
        return self._column("weight") > 0.0

    def sd(self, name: str) -> FloatArray | None:
        """Standard deviation of theta, omega or alpha; None where the method does not know it."""
        return self.core.column(f"{name}_sd")

    @property
    def noise(self) -> Mapping[str, float] | None:
        """Noise level of each motion sensor (standard deviation, SI) and the smoother's driving jerk."""
        return self.core.noise

    def on_capture(self, values: FloatArray) -> FloatArray:
        """Spread values of the kept samples over all samples of the capture; NaN at masked ones."""
        out = np.full(self.capture.samples, np.nan)
        out[self.rows[::-1]] = values[::-1]  # of a sample and of what was lost behind it the sample's is kept
        return out

    def plot(self) -> Figure:
        """Motion and torque, as recorded and as prepared, over time."""
        return showing.plot(self)

    def __repr__(self) -> str:
        lines = [f"Prepared by '{self.method}': {self.core.used} of {self.capture.samples} samples count"]
        return "\n  ".join(lines + list(self.notes))


def travel(prepared: Sequence[Prepared]) -> float:
    """Return the range of position that the samples which count go through, rad or m."""
    return float(np.ptp(np.concatenate([one.theta[one.used] for one in prepared])))


@checked
def prepare(capture: Capture, method: str = "smooth", **options: float) -> Prepared:
    """Return the prepared signals of a capture.

    `smooth` (default): theta, omega and alpha from one fixed-interval smoother that fuses the sensors
    (Rauch, Tung & Striebel 1965), torque through the paper's zero-phase filter. `paper`: a filter per channel
    (Table 6). `none`: everything as it is. `differences`: a 4th-order zero-phase Butterworth (`cutoff_hz`) on
    the position, central differences, everything decimated by `decimate`, as robot identification does
    (Gautier 1997). Options: `torque_edge_hz` (smooth, paper), `motion_edge_hz` (paper), `cutoff_hz` and
    `decimate` (differences).

    Raises InputError for an unknown method or option, a filter edge at or above the Nyquist frequency, and a
    capture with no stretch that is long enough.
    """
    check_options(method, options)
    # A capture without a masked sample goes as it is: picking rows would copy every column.
    whole = bool(capture.mask.all())
    rows = np.arange(capture.samples) if whole else np.flatnonzero(capture.mask | _bridges(capture))
    measured = capture.mask if whole else capture.mask[rows]
    kept = {name: values if whole else values[rows] for name, values in capture.columns.items()}
    lost = _lost(capture, rows, kept["t"])
    if lost.size:
        rows, measured = np.insert(rows, lost, rows[lost - 1]), np.insert(measured, lost, False)
        kept = {name: np.insert(values, lost, 0.0) for name, values in kept.items()}
    # A reading that stands until the next one is none anew.
    looked = [name for name in _READ if method == "smooth" and name in kept]
    stands = {name: held(kept[name]) for name in looked if not capture.overrules("held", name)}
    if not measured.all():
        known = np.flatnonzero(measured)
        lacking = np.flatnonzero(~measured)
        for name, values in kept.items():
            kept[name] = values.copy()
            kept[name][lacking] = np.interp(lacking, known, values[known])
    for name, repeated in stands.items():
        if repeated.any():
            kept[name] = np.where(repeated, np.nan, kept[name])
    gap = _gaps(capture, rows, kept["t"])
    try:
        core = _core.prepare(
            capture.coordinate,
            capture.rate_hz,
            kept["t"],
            kept["theta"],
            kept.get("omega"),
            kept.get("alpha"),
            kept["tau"],
            gap,
            measured,
            method,
            options,
            (run.name(capture), run.fingerprint(capture)),
            _trusted(capture),
        )
    except InputError as error:
        source = capture.meta.get("source")  # of several captures somebody wants to know which
        raise InputError(f"{source}: {error}" if source else str(error)) from None
    at = rows + int(capture.meta.get("first_row", 1))
    if "tau" in stands and stands["tau"].any():
        rows = rows[~stands["tau"]]
    notes = _notes(capture, method, options, core)
    later = [*_strays(core, kept["t"], at), *_wrong(core), *_cut(capture, method, options, core)]
    found = with_later(capture.findings, later)
    return Prepared(capture, method, rows, dict(options), notes, core, found)


def _trusted(capture: Capture) -> list[str]:
    """Return what the preparation tells of and leaves as it is: a person knows better."""
    names = [name for name in ("theta", "omega", "alpha") if capture.overrules("spike", name)]
    return [*names, "bands"] if capture.overrules("band", "theta") else names


def check_options(method: str, options: Mapping[str, float]) -> None:
    """Raise InputError for an unknown method, an option it does not have, or a broken `decimate`."""
    if method not in METHODS:
        raise InputError(f"prepare={method!r} is no method; choose {', '.join(METHODS)}")
    unknown = sorted(set(options) - _OPTIONS[method])
    if unknown:
        known = ", ".join(sorted(_OPTIONS[method])) or "no options"
        raise InputError(f"prepare={method!r} has no option {unknown[0]!r}; it takes {known}")
    every = options.get("decimate", 1.0)
    if not (every >= 1.0 and float(every).is_integer()):
        raise InputError(f"decimate={every} must be a whole number of samples from 1")


def _bridges(capture: Capture) -> BoolArray:
    """Return the masked samples that lie in so short a run that its neighbours tell what was there.

    They go through the filters as a straight line and do not count; else each would cost what a filter needs
    to settle on both sides. Of a torque beyond the sensor's limit the neighbours tell nothing.
    """
    beyond = capture.at_limit
    bridges = np.zeros(capture.samples, dtype=np.bool_)
    for first, end in zip(*runs(~capture.mask), strict=True):
        if end - first <= _BRIDGE and first > 0 and end < capture.samples:
            passed = (capture.t[end] - capture.t[first - 1]) * capture.rate_hz
            bridges[first:end] = abs(passed - (end - first + 1)) < 0.5 and not beyond[first:end].any()
    return bridges


def _ticks(capture: Capture, t: FloatArray) -> np.ndarray[Any, np.dtype[np.intp]] | None:
    """Return the sampling intervals between samples, of times `t`, where these are whole ones; else None."""
    steps = np.diff(t) * capture.rate_hz
    whole = np.rint(steps).astype(np.intp)
    even = np.abs(steps - whole) < _EVEN
    return whole if np.mean(even) >= _ALL and np.mean(even & (whole == 1)) >= _MOSTLY else None


def _lost(
    capture: Capture, rows: np.ndarray[Any, np.dtype[np.intp]], t: FloatArray
) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return before which of the kept samples, of times `t`, a few were lost, as often as so many were.

    Only of an even clock that is known: there they are where it lets expect them. As masked ones they go
    through the filters as a straight line.
    """
    steps = np.diff(t) * capture.rate_hz
    ticks = _ticks(capture, t) if np.max(steps, initial=0.0) > 1.5 else None
    if ticks is None:
        return np.zeros(0, dtype=np.intp)
    beyond = np.cumsum(capture.at_limit)[rows]
    few = (ticks > 1) & (ticks <= _BRIDGE + 1) & (np.abs(steps - ticks) < _EVEN) & (np.diff(beyond) == 0)
    return np.repeat(np.flatnonzero(few) + 1, ticks[few] - 1)


def _gaps(capture: Capture, rows: np.ndarray[Any, np.dtype[np.intp]], t: FloatArray) -> BoolArray:
    """Return where samples are missing or masked just before a kept one, of times `t`."""
    gap = np.zeros(len(rows), dtype=bool)
    if len(rows) < capture.samples:
        gap[1:] = np.diff(rows) > 1
        if gap.any() and (ticks := _ticks(capture, t)) is not None:
            gap[1:] &= ticks != 1  # a row in which no time passed was no reading
    steps = np.diff(t)
    if np.max(steps, initial=0.0) * capture.rate_hz > 1.5:
        # Half as long again as the longest ordinary step: jittery clocks have no gaps, lost samples do.
        at = len(steps) * 99 // 100
        ordinary = max(1.0 / capture.rate_hz, float(np.partition(steps, at)[at]))
        gap[1:] |= steps > 1.5 * ordinary
    return gap


def _notes(
    capture: Capture, method: str, options: Mapping[str, float], core: _core.Signals
) -> tuple[str, ...]:
    notes = []
    slower = min(core.rate_hz / _PAPER_RATE_HZ, 1.0)
    edge_hz = core.edge_hz or 0.0
    # Where a band is left out a finding says why the edge is where it is.
    if method in ("smooth", "paper") and "torque_edge_hz" not in options and core.incoherent is None:
        if core.ripple is not None and edge_hz > 500.0 * slower:
            notes.append(
                f"the torque has {waves(capture, core.ripple)}: its filter's edge is raised from "
                f"{500.0 * slower:.6g} Hz to {edge_hz:.4g} Hz (torque_edge_hz= sets another)"
            )
        elif slower < 1.0:
            notes.append(
                f"sampled at {core.rate_hz:.6g} Hz: the paper's torque filter edge of 500 Hz is for "
                f"5000 Hz and is lowered to {500.0 * slower:.6g} Hz (torque_edge_hz= sets another)"
            )
    if method != "none":
        absent = [name for name in ("omega", "alpha") if name not in capture.columns]
        if absent:
            notes.append(f"{' and '.join(absent)} not recorded: derived from theta")
    return tuple(notes)


def _strays(core: _core.Signals, t: FloatArray, rows: Rows) -> list[Finding]:
    """Readings that all the others contradict, by sensor; what is there of a row beside them counts."""
    found = []
    for name in ("theta", "omega", "alpha"):
        at = sorted(row for column, row in core.strays if column == name)
        if at:
            times = ", ".join(f"{t[row]:.6g}" for row in at[:_NAMED]) + (", ..." if len(at) > _NAMED else "")
            stray = said(
                "{name}: {count} readings are of no motion beside all the others (at {t} = {times} s); left "
                "out of the motion",
                name=OfColumn(name),
                count=len(at),
                times=times,
            )
            found.append(Finding("spike", name, len(at), spans(rows[at]), stray, "masked"))
    return found


def _wrong(core: _core.Signals) -> list[Finding]:
    """A band in which the motion is not what the torque made."""
    if core.incoherent is None:
        return []
    hz, edge_hz, times = core.incoherent
    found = said(
        "{theta}: above {hz:.3g} Hz the torque has nothing to do with the recorded motion, which would take "
        "{times:.2g} times as much: both are taken below, and the torque filter's edge is lowered from "
        "{edge:.4g} Hz",
        hz=hz,
        times=times,
        edge=edge_hz,
    )
    return [
        Finding(
            "band", "theta", core.used, (), found, "mended", Advice("torque_edge_hz= sets another", "command")
        )
    ]


def _cut(capture: Capture, method: str, options: Mapping[str, float], core: _core.Signals) -> list[Finding]:
    """What the torque has that its filter takes off."""
    if core.ripple is None or not core.lost:
        return []
    advice = Advice("log faster, or turn slower")
    if "torque_edge_hz" in options:
        advice = Advice("raise torque_edge_hz, or leave it out", "command")
    elif method == "paper":
        advice = Advice("prepare by 'smooth', whose edge goes up", "command")
    found = said(
        "{tau}: it has {waves}, and its filter's edge is at {edge:.4g} Hz: what lies beyond is not fitted",
        waves=waves(capture, core.ripple),
        edge=core.edge_hz,
    )
    return [Finding("edge", "tau", core.used, (), found, "warning", advice)]


def waves(capture: Capture, ripple: tuple[float, float, float]) -> str:
    """Return waves of the torque over position, as the core has them, in words."""
    per_turn, hz, _ = ripple
    length = f"{per_turn:.3g} waves per turn"
    if capture.coordinate == "linear":
        length = f"a wave every {2000.0 * np.pi / per_turn:.3g} mm"
    return f"{length}, {hz:.4g} Hz at the highest speed"
