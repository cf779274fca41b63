"""Which part of the torque an effect belongs to, and each part by itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...capture.motions import MotionTrack
from ...fit.estimate import Z95
from ...model.simulate import exact

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.arrays import BoolArray, FloatArray
    from ...capture.prepare import Prepared
    from ...fit import Fit
    from ...model import Model
    from ...model.effects import Effect, Over

Part = Literal["position", "velocity", "acceleration", "sensor", "other"]

# The parts of Equation 1; an effect that depends on more than one coordinate belongs to none ("other").
_PARTS: dict[Over, Part] = {
    "position": "position",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "torque": "sensor",
}
_RATE_HZ = 1000.0  # any will do: each sample stands for itself
SHORT = {"position": "pos", "velocity": "vel"}


def part_of(effect: Effect) -> Part:
    """Return the part that an effect belongs to."""
    return _PARTS.get(effect.over, "other")


def effects_of(model: Model, part: Part) -> list[str]:
    """Return the ids of a model's effects that belong to a part."""
    catalogue = model.catalogue()
    return [one for one in model.effects if one in catalogue and part_of(catalogue[one]) == part]


def torque_at(
    model: Model, effects: list[str], *, theta: FloatArray, omega: FloatArray, alpha: FloatArray
) -> FloatArray:
    """Return the torque of some effects of a model on an exact motion, unfiltered, N m, shape (samples,)."""
    n = len(theta)
    if not effects:
        return np.zeros(n)
    track = MotionTrack(np.arange(n) / _RATE_HZ, theta, omega, alpha)
    return model.core.only(effects).torque(exact(model.coordinate, track), filtered=False)


def curve(model: Model, part: Part, at: FloatArray) -> FloatArray:
    """Return the position part over positions, or the velocity part over velocities, N m, shape of `at`."""
    still = np.zeros(len(at))
    theta, omega = (at, still) if part == "position" else (still, at)
    return torque_at(model, effects_of(model, part), theta=theta, omega=omega, alpha=still)


def curve_band(fit: Fit, part: Part, at: FloatArray) -> FloatArray:
    """Return the half-width of the 95 % band of a part's curve, N m, shape of `at`.

    By the delta method from the covariance of the fit; parameters that the capture does not determine are
    left out.
    """
    effects = effects_of(fit.model, part)
    se = fit.core.standard_errors
    mine = [
        i
        for i, name in enumerate(fit.core.free)
        if name.split(".")[0] in effects and np.isfinite(se[i]) and se[i] > 0.0
    ]
    if not mine:
        return np.zeros(len(at))
    columns = []
    for i in mine:
        name, value = fit.core.free[i], fit.params[fit.core.free[i]].value
        step = 1e-3 * se[i]
        up = curve(fit.model.with_value(name, value + step), part, at)
        down = curve(fit.model.with_value(name, value - step), part, at)
        columns.append((up - down) * (se[i] / (2.0 * step)))
    jacobian = np.stack(columns, axis=1)
    correlation = fit.core.correlation[np.ix_(mine, mine)]
    variance: FloatArray = np.einsum("ni,ij,nj->n", jacobian, correlation, jacobian)
    return Z95 * np.sqrt(np.maximum(variance, 0.0))


@dataclass(frozen=True, eq=False)
class Samples:
    """The samples that count in a fit, all captures one after the other; SI, shape (samples,) each.

    `every` takes those along that do not count, as while the knob sticks; a stretch too short to be filtered
    has no modelled torque and stays out.
    """

    fit: Fit
    every: bool = False

    def _gather(self, of: Callable[[Prepared], FloatArray]) -> FloatArray:
        return np.concatenate([of(s)[kept] for s, kept in zip(self.fit.prepared, self._kept, strict=True)])

    @cached_property
    def _kept(self) -> list[BoolArray]:
        model = self.fit.model.core
        if not self.every:
            return [s.used for s in self.fit.prepared]
        return [np.isfinite(model.torque(s.core)) for s in self.fit.prepared]

    @cached_property
    def theta(self) -> FloatArray:
        """Position."""
        return self._gather(lambda s: s.theta)

    @cached_property
    def omega(self) -> FloatArray:
        """Velocity."""
        return self._gather(lambda s: s.omega)

    @cached_property
    def tau(self) -> FloatArray:
        """Measured torque after the measurement filter."""
        return self._gather(lambda s: s.tau)

    @cached_property
    def modelled(self) -> FloatArray:
        """Torque of the whole model, through the same filter."""
        model = self.fit.model.core
        return self._gather(lambda s: model.torque(s.core))

    @cached_property
    def band(self) -> FloatArray:
        """Half-width of the 95 % band of the whole model's torque."""
        return self._gather(self.fit.band)

    def modelled_part(self, part: Part) -> FloatArray:
        """Torque of a part of the model, through the measurement filter."""
        effects = effects_of(self.fit.model, part)
        if not effects:
            return np.zeros(len(self.theta))
        model = self.fit.model.core.only(effects)
        return self._gather(lambda s: model.torque(s.core))

    def isolated(self, part: Part) -> FloatArray:
        """Measured torque minus everything of the model that does not belong to the part."""
        return self.tau - self.modelled + self.modelled_part(part)
