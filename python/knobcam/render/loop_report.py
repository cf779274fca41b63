"""What became of a render loop: how punctual it was, why it ended, and its last second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from ..base import showing
from ..base.tables import TextTable, text_table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..base.arrays import FloatArray
    from ..base.showing import Figure

_FIGURES = ("min", "median", "p99", "p999", "max", "mean")


class Durations(NamedTuple):
    """Durations in s: quantiles (to 3 %), exact ends and mean, and their histogram.

    `edges`, shape (n + 1,), s, and `counts`, shape (n,).
    """

    min: float
    median: float
    p99: float
    p999: float
    max: float
    mean: float
    edges: FloatArray
    counts: NDArray[np.uint64]

    def document(self) -> dict[str, float]:
        """Return the figures, s."""
        return {name: getattr(self, name) for name in _FIGURES}


class LastSecond(NamedTuple):
    """The steps of the last second, oldest first, shape (n,) each, SI.

    `t`: when the step woke up, s since the first deadline; `hand`: the torque of the hand, NaN where it is
    not measured; `tau`: the torque that was written; `late`: how long after its deadline it woke up, s.
    """

    t: FloatArray
    theta: FloatArray
    omega: FloatArray
    alpha: FloatArray
    hand: FloatArray
    tau: FloatArray
    late: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class LoopReport(showing.Tabled):
    """What became of a render loop, or what it reached so far while it runs.

    `late`: how long after its deadline each step woke up; `busy`: how long each step took to read, answer and
    write. `missed` periods were skipped because a step before them ended too late, `longest_run` of them in a
    row. While the loop runs, `last` has the newest step alone.

    `ending`: None while it runs, else time, asked, interrupted, fault, device, stalled, misses or panic;
    `why` says it in words. `not_relieved`: what the device said to the zero torque at the end, None where it
    took it.
    `why_not_realtime`: None where the loop had real-time priority.
    """

    rate_hz: float
    watchdog_s: float
    steps: int
    missed: int
    longest_run: int
    late: Durations
    busy: Durations
    last: LastSecond
    ending: str | None
    why: str
    not_relieved: str | None
    why_not_realtime: str | None

    @property
    def periods(self) -> int:
        """Periods that passed: steps and misses."""
        return self.steps + self.missed

    @property
    def missed_share(self) -> float:
        """The share of all periods that was missed."""
        return self.missed / max(self.periods, 1)

    @property
    def reached_hz(self) -> float:
        """Steps a second that were taken, Hz."""
        return self.rate_hz * (1.0 - self.missed_share) if self.periods else 0.0

    @property
    def realtime(self) -> bool:
        """Whether the loop had real-time priority."""
        return self.why_not_realtime is None

    @property
    def running(self) -> bool:
        """Whether the loop had not ended."""
        return self.ending is None

    @property
    def well(self) -> bool:
        """Whether the loop ended because it should, and the device took the zero torque."""
        return self.ending in ("time", "asked", "interrupted") and self.not_relieved is None

    def plot(self) -> Figure:
        """Histogram of the wake-ups, and the lateness over the last second."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return the figures as they stand in a JSON document; the last second is not in it."""
        names = ("rate_hz", "reached_hz", "periods", "steps", "missed", "missed_share", "longest_run")
        return {
            **{name: getattr(self, name) for name in names},
            "late_s": self.late.document(),
            "busy_s": self.busy.document(),
            "realtime": self.realtime,
            "why_not_realtime": self.why_not_realtime,
            "ending": self.ending,
            "why": self.why,
            "not_relieved": self.not_relieved,
        }

    @property
    def headline(self) -> str:
        """One sentence: how many periods, how many missed."""
        return (
            f"{self.steps} steps at {self.rate_hz:g} Hz, {self.missed} periods missed "
            f"({100.0 * self.missed_share:.2g} %), at most {self.longest_run} in a row"
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """What else must be known, a sentence each."""
        said = [f"ended ({self.ending}): {self.why}" if self.ending else "still running"]
        if self.not_relieved is not None:
            said.append(f"the device did not take the zero torque at the end: {self.not_relieved}")
        if self.why_not_realtime is not None:
            said.append(f"without real-time priority: {self.why_not_realtime}")
        return tuple(said)

    _HEAD = ("µs", "min", "median", "99 %", "99.9 %", "max")

    def _rows(self) -> list[tuple[str, ...]]:
        return [
            (name, *(f"{1e6 * value:.4g}" for value in durations[:5]))
            for name, durations in (("wake-up after deadline", self.late), ("step", self.busy))
        ]

    def __repr__(self) -> str:
        return "\n".join([self.headline, text_table(self._HEAD, self._rows()), *self.remarks])

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        return (TextTable(". ".join([self.headline, *self.remarks]), self._HEAD, self._rows()),)
