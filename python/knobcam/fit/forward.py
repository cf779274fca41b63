"""The motion that the measured torque makes of a model, beside the motion that was measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from ..base import showing
from ..base.door import checked
from ..base.tables import TextTable, text_table
from ..capture.formats.units import SI
from . import origin
from .described import names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import FloatArray, IntArray
    from ..base.showing import Figure
    from ..capture.prepare import Prepared
    from .fitting import Fit

_ASTRAY = 0.9  # R2 below which one run tells little: what it lost early it keeps


@dataclass(frozen=True, eq=False)
class ForwardRun:
    """A capture and its simulation; arrays of shape (samples,) over the capture, rad or m.

    `measured` is NaN at masked samples, `simulated` outside of every stretch without gap; `starts` are the
    samples at which the simulation took over the measured position and speed.
    """

    signals: Prepared
    measured: FloatArray
    simulated: FloatArray
    starts: IntArray

    @property
    def error(self) -> FloatArray:
        """Simulated minus measured position; NaN where there is no such."""
        return self.simulated - self.measured

    @property
    def counts(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """The samples at which there is an error."""
        return np.isfinite(self.error)


@dataclass(frozen=True, eq=False, repr=False)
class Forward(showing.Tabled):
    """The simulated motion of each capture, and how far it is from the measured one.

    The torque on the shaft is the measured one, less what sensors of the model did to it; nothing leads the
    motion back. `horizon_s` is the time after which each simulation began anew; None: one run from the state
    at the start, as the EMPS benchmark scores it (Janot, Gautier & Brunot 2019).
    """

    fit: Fit
    runs: tuple[ForwardRun, ...]
    horizon_s: float | None

    @cached_property
    def rmse(self) -> float:
        """Root mean square of the position error, rad (m)."""
        return self._rmse(self.runs)

    @cached_property
    def r2(self) -> float:
        """Coefficient of determination: 1 minus the squared error over the measured position's variance."""
        return self._r2(self.runs)

    @property
    def nrmse(self) -> float:
        """The RMS error over the standard deviation of the measured position."""
        return math.sqrt(1.0 - self.r2)

    @cached_property
    def largest(self) -> float:
        """The largest distance of both positions, rad (m)."""
        return max(float(np.max(np.abs(run.error[run.counts]))) for run in self.runs)

    @property
    def unit(self) -> str:
        """What positions are in."""
        return SI[self.fit.model.coordinate]["theta"]

    @staticmethod
    def _rmse(runs: Sequence[ForwardRun]) -> float:
        errors = np.concatenate([run.error[run.counts] for run in runs])
        return math.sqrt(float(np.mean(errors**2)))

    @staticmethod
    def _r2(runs: Sequence[ForwardRun]) -> float:
        left = sum(float(np.sum(run.error[run.counts] ** 2)) for run in runs)
        spread = sum(float(np.var(run.measured[run.counts]) * np.sum(run.counts)) for run in runs)
        return 1.0 - left / spread if spread > 0.0 else math.nan

    @property
    def summary(self) -> str:
        """How far the simulated motion is from the measured one, and what was simulated."""
        what = "force" if self.fit.model.coordinate == "linear" else "torque"
        head = (
            f"Position simulated from the measured {what}: RMSE {self._shown(self.rmse)}, R2 {self.r2:.4f}, "
            f"NRMSE {100.0 * self.nrmse:.3g} %, at most {self._shown(self.largest)} off"
        )
        begun = sum(len(run.starts) for run in self.runs)
        if self.horizon_s is not None:
            ahead = f"{self.horizon_s:g} s"
            return (
                f"{head}; begun anew from the measured state every {ahead} ({begun} starts), so these are "
                f"errors of up to {ahead} ahead."
            )
        stretches = len(self.runs)
        gaps = f", anew after each gap ({begun} starts)" if begun > stretches else ""
        return f"{head}; open loop from the measured state at the start{gaps}."

    @property
    def remarks(self) -> tuple[str, ...]:
        """What else there is to say of it, a sentence each."""
        told = []
        catalogue = self.fit.model.catalogue()
        sensors = [one for one in self.fit.model.effects if catalogue[one].place == "sensor"]
        if sensors:
            told.append(f"What {' and '.join(sensors)} did to the reading was taken off the torque first.")
        if self.horizon_s is None and not self.r2 >= _ASTRAY:
            told.append("One run keeps what it lost early: a horizon shows how long the model holds.")
        return tuple(told)

    @property
    def origin(self) -> str:
        """What has to be known of a model that was not fitted to these captures, in one sentence."""
        return origin.in_words(self.fit.model, [run.signals for run in self.runs], self._names)

    @property
    def text(self) -> str:
        """All that it says but its origin."""
        each = [text_table(self._HEAD, self._rows())] if len(self.runs) > 1 else []
        return "\n".join([self.summary, *self.remarks, *each])

    @property
    def _names(self) -> list[str]:
        return names([run.signals for run in self.runs])

    def _shown(self, length: float) -> str:
        return f"{1e3 * length:.4g} mm" if self.unit == "m" else f"{length:.4g} {self.unit}"

    def plot(self) -> Figure:
        """Measured and simulated position over time, and the error."""
        return showing.plot(self)

    def document(self) -> dict[str, Any]:
        """Return what `knobcam compare --forward --json` has under `forward`."""
        return {
            "rmse": self.rmse,
            "r2": self.r2,
            "nrmse": self.nrmse,
            "largest": self.largest,
            "unit": self.unit,
            "horizon_s": self.horizon_s,
            "summary": self.summary,
            "remarks": list(self.remarks),
            "captures": [
                {
                    "path": str(run.signals.capture.meta.get("source", "")),
                    "rmse": self._rmse([run]),
                    "r2": self._r2([run]),
                    "samples": int(np.sum(run.counts)),
                    "starts": len(run.starts),
                }
                for run in self.runs
            ],
        }

    _HEAD = ("capture", "RMSE", "R2", "starts")

    def _rows(self) -> list[tuple[str, ...]]:
        return [
            (name, self._shown(self._rmse([run])), f"{self._r2([run]):.4f}", f"{len(run.starts)}")
            for name, run in zip(self._names, self.runs, strict=True)
        ]

    def __repr__(self) -> str:
        return "\n".join([self.text, *([self.origin] if self.origin else [])])

    def tables(self) -> tuple[TextTable, ...]:
        """What it says of itself, as text."""
        whole = " ".join([self.summary, *self.remarks, self.origin]).rstrip()
        return (TextTable(whole, self._HEAD, self._rows()),)


@checked
def forward(fit: Fit, horizon_s: float | None = None) -> Forward:
    """Return the motion that the measured torque makes of a fitted model; see `Fit.forward`."""
    runs = []
    for signals in fit.prepared:
        theta, starts = _core.forward(fit.model.core, signals.core, horizon_s)
        capture = signals.capture
        measured = np.where(capture.mask, capture.theta, np.nan)
        runs.append(ForwardRun(signals, measured, signals.on_capture(theta), signals.rows[starts]))
    return Forward(fit, tuple(runs), horizon_s)
