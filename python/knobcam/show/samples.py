"""What linked plots are made of: samples, what a model leaves of them, what a candidate would explain."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base import pages
from ..base.said import Said
from ..model.effects import titles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import FloatArray
    from ..fit import Fit
    from ..fit.diagnose import Diagnosis
    from ..learn import LearningResult
    from ..learn.ladder import Unexplained

_MOTION = ("theta", "omega", "tau")


class Shown(NamedTuple):
    """A fit to look at; `weighed` is what could be missing from it, `unexplained` what nothing explains."""

    label: str
    fit: Fit
    weighed: Diagnosis | None = None
    unexplained: Unexplained | None = None

    @property
    def effects(self) -> tuple[str, ...]:
        """Ids of the candidates, best first."""
        return tuple(one.effect for one in self.weighed.candidates) if self.weighed else ()

    def explained(self, effect: str) -> FloatArray:
        """Return what a candidate would explain of the residual, N m, the captures one after the other."""
        if self.weighed is None:
            raise KeyError(effect)
        core = self.weighed[effect].fit.model.core
        parts = [one.on_capture(core.torque(one.core) - one.tau) for one in self.fit.prepared]
        return self.fit.residual + np.concatenate(parts)

    def document(self) -> pages.ShownStep:
        """Return what a page lists of it."""
        weighed = None if self.weighed is None else candidates(self.weighed, self.unexplained)
        return {"label": self.label, "rmse": self.fit.rmse, "candidates": weighed}


def candidates(weighed: Diagnosis, unexplained: Unexplained | None) -> pages.Candidates:
    """Return what a page lists of what was weighed."""
    rest: pages.Unexplained | None = None
    if unexplained is not None:
        hint = Said(unexplained.hint).document()
        rest = {"axis": unexplained.axis, "share": unexplained.share, "hint": hint}
    return {
        "ready": True,
        "rows": [one.evidence() for one in weighed.candidates],
        "unexplained": rest,
        "left_out": dict(weighed.left_out),
    }


def steps(learned: LearningResult) -> tuple[Shown, ...]:
    """Return every step of a ladder, with what was weighed on it."""
    weighed = [*(step.diagnosis for step in learned.ladder[1:]), learned.last]
    left = [*(None for _ in learned.ladder[1:]), learned.unexplained]
    called = titles(learned.model.coordinate)
    labels = [f"+ {called[step.added]}" if step.added else "first model" for step in learned.ladder]
    fits = [step.fit for step in learned.ladder]
    return tuple(map(Shown, labels, fits, weighed, left))


def head(shown: Sequence[Shown]) -> pages.Shown:
    """Return all but the samples: units, noise floor, how many samples there are, the steps."""
    last = shown[-1].fit
    return {
        "unit": last.torque_unit,
        "peak": peak(last),
        "below_hz": below_hz(last),
        "coordinate": last.model.coordinate,
        "noise": last.noise_floor,
        "titles": titles(last.model.coordinate),
        "captures": len(last.prepared),
        "all": sum(one.capture.samples for one in last.prepared),
        "steps": [step.document() for step in shown],
    }


def peak(fit: Fit) -> float:
    """Return the largest torque that a model is fitted to, N m (or what stands for it), a magnitude."""
    return max(float(np.max(np.abs(one.tau[one.used]), initial=0.0)) for one in fit.prepared)


def below_hz(fit: Fit) -> float | None:
    """Return the edge of the filter that torques are seen through; None where they are seen as they came."""
    return min((one.core.edge_hz for one in fit.prepared if one.core.edge_hz is not None), default=None)


def measured(fit: Fit) -> dict[str, FloatArray]:
    """Return time, motion and torque in SI, the captures one after the other; NaN at masked samples."""
    columns = {"t": _times([signals.capture.t for signals in fit.prepared])}
    for name in _MOTION:
        columns[name] = np.concatenate([one.on_capture(getattr(one, name)) for one in fit.prepared])
    return columns


def _times(captures: Sequence[FloatArray]) -> FloatArray:
    """Time of captures one after the other, s."""
    parts, elapsed = [], 0.0
    for t in captures:
        parts.append(t - t[0] + elapsed)
        elapsed = float(parts[-1][-1])
    return np.concatenate(parts)
