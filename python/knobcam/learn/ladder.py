"""The error ladder: one step for the first model, one for each effect that came in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..fit.described import documented
from ..fit.estimate import Z95
from ..fit.refit import describe
from .rivals import weights

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from ..fit import Estimate, Fit
    from ..fit.diagnose import Diagnosis
    from ..fit.refit import Moved

_BLOCKS = 40  # long beside the memory of the filter, and enough to see how the error varies


class Unexplained(NamedTuple):
    """Structure that no effect explains: its axis, its share of the remaining error variance, its shape."""

    axis: str
    share: float
    hint: str


@dataclass(frozen=True, eq=False)
class LearningStep:
    """A model on the way: `added` is what came in last (None for the first model), `dropped` what went.

    `fit` is the fit of the whole model, `p_value` and `equivalent` are the evidence for `added`, and
    `diagnosis` is what it was chosen from.
    """

    fit: Fit
    added: str | None = None
    p_value: float = math.nan
    equivalent: tuple[str, ...] = ()
    dropped: tuple[str, ...] = ()
    diagnosis: Diagnosis | None = None

    @property
    def effects(self) -> tuple[str, ...]:
        """Ids of the effects of the model."""
        return self.fit.model.effects

    @property
    def rmse(self) -> float:
        """RMS error, N m."""
        return self.fit.rmse

    @cached_property
    def rmse_ci95(self) -> tuple[float, float]:
        """Interval of the RMS error, N m, from how its square varies between blocks of the captures."""
        rest = self.fit.residual
        squares = np.square(rest[np.isfinite(rest)])
        blocks = [float(np.mean(block)) for block in np.array_split(squares, _BLOCKS) if len(block)]
        half = Z95 * float(np.std(blocks)) / math.sqrt(max(len(blocks) - 1, 1))
        mean = self.rmse**2
        return math.sqrt(max(mean - half, 0.0)), math.sqrt(mean + half)

    @property
    def rmse_heldout(self) -> float:
        """The error on blocks that the fit did not see, N m."""
        return self.fit.rmse_heldout

    @property
    def params(self) -> Mapping[str, Estimate]:
        """All parameters of the model."""
        return self.fit.params

    @property
    def error_fall(self) -> float:
        """The part of the RMS error of the step before that is gone."""
        return self.fit.error_fall

    @property
    def moved(self) -> Mapping[str, Moved]:
        """How far the parameters went that were there before."""
        return self.fit.moved

    @cached_property
    def weights(self) -> Mapping[str, float]:
        """Weight of `added` and of each rival: how likely each is, of what could have come in; see `rivals`.

        Empty where nothing came in, or not by itself.
        """
        return weights(self.diagnosis, self.added)

    def document(self, params: Mapping[str, Estimate] | None = None) -> dict[str, Any]:
        """Return it as the document of `knobcam learn --json` has it, with `params` for those of its fit."""
        known: dict[str, Any] = {
            "added": self.added,
            "effects": list(self.effects),
            "rmse": self.rmse,
            "rmse_ci95": list(self.rmse_ci95),
            "rmse_heldout": self.rmse_heldout,
            "params": documented(params or self.params),
        }
        if self.added is None:
            return known
        return known | {
            "error_fall": self.error_fall,
            "p_value": self.p_value,
            "equivalent": list(self.equivalent),
            "weight": self.weights.get(self.added) if self.weights else None,
            "rivals": {one: weight for one, weight in self.weights.items() if one != self.added},
            "moved": describe(self.moved),
            "dropped": list(self.dropped),
        }


def first_weighed(ladder: Iterable[LearningStep]) -> Diagnosis | None:
    """Return what was weighed on the first step of a ladder; None where nothing was yet."""
    return next((step.diagnosis for step in ladder if step.diagnosis is not None), None)
