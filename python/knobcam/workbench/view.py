"""What is looked at: the model of a node, or the same with parameters that a hand has moved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, cast, get_args

import numpy as np

from ..base import pages
from ..base.pages_said import Along
from ..show.plot.components import effects_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.arrays import FloatArray
    from ..fit import Fit
    from ..model import Model
    from ..show.plot.components import Part
    from .tree import Node


@dataclass(frozen=True, eq=False)
class View:
    """A model held against the captures of a node; immutable. `dragged` are the values that a hand gave."""

    id: str
    node: Node
    model: Model
    dragged: Mapping[str, float] = field(default_factory=dict)

    @property
    def fit(self) -> Fit:
        """The fit that the model came from."""
        return self.node.fit

    @property
    def rmse(self) -> float:
        """RMS error of the model, N m."""
        return self._moved_rmse if self.dragged else self.fit.rmse

    @property
    def rmse_heldout(self) -> float:
        """The same on blocks that the fit did not see; a model moved by hand has seen none of them."""
        return math.nan if self.dragged else self.fit.rmse_heldout

    @cached_property
    def _moved_rmse(self) -> float:
        squares = np.concatenate([self.squares(at) for at in range(len(self.fit.prepared))])
        counted = squares[~np.isnan(squares)]
        with np.errstate(over="ignore"):  # of squares that are finite each
            return math.sqrt(float(np.mean(counted))) if len(counted) else math.nan

    def squares(self, at: int) -> FloatArray:
        """Squared residual on a capture, (N m)^2; a hand may move a parameter to where that is infinite."""
        with np.errstate(over="ignore"):
            return np.square(self.residual(at))

    def torque(self, at: int) -> FloatArray:
        """The model's torque on a capture through the measurement filter, N m, NaN at masked samples."""
        signals = self.fit.prepared[at]
        return signals.on_capture(self.model.core.torque(signals.core))

    def residual(self, at: int) -> FloatArray:
        """Measured minus modelled torque on a capture, N m; NaN at samples that do not count."""
        return self._moved[at] if self.dragged else self.fit.residuals[at]

    @cached_property
    def _moved(self) -> list[FloatArray]:
        """The residuals of a model that a hand has moved: asked for twice, as an error and as samples."""
        prepared, core = self.fit.prepared, self.model.core
        rests = [np.where(one.used, one.tau - core.torque(one.core), np.nan) for one in prepared]
        return [one.on_capture(rest) for one, rest in zip(prepared, rests, strict=True)]

    def masked(self, at: int) -> FloatArray:
        """The torque of a capture as it was recorded where its samples are masked, N m; NaN elsewhere."""
        signals = self.fit.prepared[at]
        masked = np.ones(signals.capture.samples, dtype=bool)
        masked[signals.rows] = ~signals.capture.mask[
            signals.rows
        ]  # what is bridged is there in its neighbours
        return np.where(masked, signals.capture.tau, np.nan)

    def since_reversal(self, at: int) -> FloatArray:
        """Distance travelled on a capture since the direction last changed, rad (m); NaN before it did."""
        signals = self.fit.prepared[at]
        return signals.on_capture(cast("FloatArray", signals.core.column("history")))

    def splits(self) -> list[pages.Split]:
        """Return the error along every axis; none of a model that a hand has moved.

        Bins without a sample are left out: they would be drawn as if the model were right there.
        """
        known = get_args(Along)
        found = [] if self.dragged else [one for one in self.fit.compare().splits if one.axis in known]
        return [
            {
                "axis": cast("Along", one.axis),
                "low": one.low[there].tolist(),
                "high": one.high[there].tolist(),
                "direction": one.direction[there].tolist(),
                "mean": one.mean[there].tolist(),
                "band": one.band[there].tolist(),
            }
            for one in found
            for there in (one.count > 0.0,)
        ]

    def part(self, at: int, part: Part) -> FloatArray:
        """Torque of the position or velocity part alone, N m, through the same filter."""
        signals = self.fit.prepared[at]
        effects = effects_of(self.model, part)
        torque = np.zeros(len(signals.rows))
        if effects:
            torque = self.model.core.only(effects).torque(signals.core)
        return signals.on_capture(torque)

    def band(self, at: int) -> FloatArray:
        """Half-width of the 95 % band of the fitted model's torque, N m."""
        signals = self.fit.prepared[at]
        return signals.on_capture(self.fit.band(signals))
