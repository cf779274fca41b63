"""A model by what its torques follow: position, speed, acceleration or more, asked of the effects themselves.

No effect is known here by its name. What it asks of a rig is looked at where a knob turns, so that an effect
of one's own, or one that comes later, is told apart as one of the catalogue is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ...base.arrays import FloatArray
    from ...model import Model

EXACT = 1e-9
"""Share of a torque up to which two are the same: what rounding leaves."""
_PROBES = 257
_REACH = (2.0 * math.pi, 5.0)  # rad and rad/s, where a model does not say how it is turned
_LINES = 128  # samples of a period, which tell as many as 63 waves apart


class Loads(NamedTuple):
    """What an effect asks at instants: N m that push, kg m^2, dry and static friction, each way; SI."""

    drive: FloatArray
    inertia: FloatArray
    back: FloatArray
    forth: FloatArray
    hold_back: FloatArray
    hold_forth: FloatArray


class Wave(NamedTuple):
    """A torque `amplitude sin(per_unit theta + phase)`; N m, 1/rad, rad (1/m on a linear axis)."""

    amplitude: float
    per_unit: float
    phase: float


@dataclass(frozen=True, eq=False)
class Term:
    """One effect of a model, and what it does there."""

    model: Model
    effect: str

    def at(self, theta: ArrayLike, omega: ArrayLike, t: ArrayLike = 0.0) -> Loads:
        """Return what it asks at these places and speeds, and at these times; arrays of one shape, (n,)."""
        zero = np.zeros(np.shape(theta))
        given = [np.ascontiguousarray(column + zero) for column in map(np.asarray, (t, theta, omega, zero))]
        columns, _ = self.model.core.loads(self.effect, given)
        return Loads(*columns)

    @cached_property
    def place(self) -> str:
        """Where in the chain it acts: coupling, load, sensor."""
        return self.model.catalogue()[self.effect].place

    @cached_property
    def _told(self) -> tuple[bool, bool, bool, bool]:
        none = np.zeros(0)
        return self.model.core.loads(self.effect, [none] * 4)[1]

    @property
    def remembers(self) -> bool:
        """Whether more than the present decides on its torque."""
        return self._told[0]

    @property
    def calls_out(self) -> bool:
        """Whether it is a function in Python."""
        return self._told[1]

    @property
    def presses(self) -> bool:
        """Whether other friction may grow with it."""
        return self._told[2]

    @property
    def rubs_by_load(self) -> bool:
        """Whether its friction grows with what presses."""
        return self._told[3]

    @cached_property
    def _probes(self) -> tuple[FloatArray, FloatArray, FloatArray, Loads]:
        """Places, speeds and times all over its reach, and what it asks there."""
        angle, speed = self.model.reach or _REACH
        rng = np.random.default_rng(0)
        theta = rng.uniform(-angle, angle, _PROBES)
        omega = speed * rng.uniform(0.01, 1.0, _PROBES) * rng.choice([-1.0, 1.0], _PROBES)
        t = rng.uniform(0.0, 10.0, _PROBES)
        return theta, omega, t, self.at(theta, omega, t)

    @cached_property
    def _plain(self) -> bool:
        """Whether it is a load that the present alone decides on."""
        return self.place == "load" and not self.remembers and not self.calls_out and not self.rubs_by_load

    @cached_property
    def inertia(self) -> float | None:
        """The inertia that it stores and nothing else; None where that is not all."""
        _, _, _, loads = self._probes
        same = bool(np.ptp(loads.inertia) == 0.0 and loads.inertia[0] > 0.0)
        return float(loads.inertia[0]) if self._plain and same and not loads.drive.any() else None

    @cached_property
    def friction(self) -> tuple[float, float] | None:
        """Dry friction backward and forward, N m, the same wherever it turns; None where that is not all."""
        _, _, _, loads = self._probes
        constant = all(np.ptp(column) == 0.0 for column in (loads.back, loads.forth))
        other = loads.drive.any() or loads.inertia.any() or loads.hold_back.any() or loads.hold_forth.any()
        some = loads.back.any() or loads.forth.any()
        if not self._plain or not constant or other or not some:
            return None
        return float(loads.back[0]), float(loads.forth[0])

    def _pushes(self, same_theta: bool) -> bool:
        """Whether it only pushes, by its place alone or by its speed alone."""
        theta, omega, t, loads = self._probes
        if not self._plain or not loads.drive.any() or any(column.any() for column in loads[1:]):
            return False
        other = self.at(theta if same_theta else theta[::-1], omega[::-1] if same_theta else omega, t[::-1])
        return bool(np.abs(other.drive - loads.drive).max() <= EXACT * np.abs(loads.drive).max())

    @cached_property
    def by_position(self) -> bool:
        """Whether it is a torque of position alone."""
        return self._pushes(same_theta=True)

    @cached_property
    def by_speed(self) -> bool:
        """Whether it is a torque of speed alone."""
        return self._pushes(same_theta=False)

    @property
    def neutral(self) -> bool:
        """Whether its values, but for those tied to others', are those at which an effect does nothing."""
        row = self.model.catalogue()[self.effect]
        own = [p for p in self.model.params.values() if p.name.partition(".")[0] == self.effect]
        values = [p for p in own if p.role in ("free", "fixed")]
        return self.place != "coupling" and all(
            p.value == row.parameter(p.name.partition(".")[2]).neutral for p in values
        )

    def series(self, *powers: int) -> tuple[float, ...] | None:
        """Return the coefficients of these powers in its torque by position; None where it is no such sum."""
        theta, _, _, loads = self._probes
        if not self.by_position:
            return None
        return _fitted(np.stack([theta**power for power in powers], axis=1), loads.drive)

    def damping(self) -> tuple[float, ...] | None:
        """Return its torque by speed as a + b |omega| + c omega^2, times omega; None where it is none."""
        _, omega, _, loads = self._probes
        if not self.by_speed:
            return None
        basis = np.stack([omega, omega * np.abs(omega), omega**3], axis=1)
        return _fitted(basis, loads.drive)

    def curve(self, theta: ArrayLike) -> FloatArray:
        """Return its torque at these places, N m; of one by position."""
        return self.at(theta, np.zeros(np.shape(theta))).drive

    def waves(self) -> tuple[Wave, ...] | None:
        """Return its torque by position as sines of one period: its own, a turn's, the detents'; or None."""
        theta, _, _, loads = self._probes
        if not self.by_position:
            return None
        peak = float(np.abs(loads.drive).max())
        for period in (self._own_period(), 2.0 * math.pi * (self.model.period or 0.0), 2.0 * math.pi):
            if not period > 0.0:
                continue
            spectrum = np.fft.rfft(self.curve(np.linspace(0.0, period, _LINES, endpoint=False))) / _LINES
            orders = np.flatnonzero(np.abs(spectrum) > EXACT * peak)
            waves = tuple(
                Wave(2.0 * float(abs(spectrum[n])), 2.0 * math.pi * n / period, _sine_phase(spectrum[n]))
                for n in map(int, orders)
                if n > 0
            )
            if len(waves) == len(orders) and _error(waves, theta, loads.drive) <= 1e3 * EXACT * peak:
                return waves
        return None

    def _own_period(self) -> float:
        """Return the period that it has if it is one sine, by three neighbours (Prony 1795); 0 for none."""
        step = 1e-3
        for _ in range(2):  # the first period tells how far apart neighbours tell it best
            torque = self.curve(step * np.arange(_PROBES))
            inner = torque[1:-1]
            cosine = float((torque[2:] + torque[:-2]) @ inner / (2.0 * inner @ inner)) if inner.any() else 1.0
            if not abs(cosine) < 1.0:
                return 0.0
            per_unit = math.acos(cosine) / step
            step = 1.0 / per_unit
        return 2.0 * math.pi / per_unit


def terms_of(model: Model) -> dict[str, Term]:
    """Return every effect of a model as a term, in the order of the chain."""
    return {effect: Term(model, effect) for effect in model.effects}


def sum_of(waves: tuple[Wave, ...], theta: FloatArray) -> FloatArray:
    """Return the torque of waves at these places, N m."""
    total = np.zeros_like(theta)
    for wave in waves:
        total += wave.amplitude * np.sin(wave.per_unit * theta + wave.phase)
    return total


def _error(waves: tuple[Wave, ...], theta: FloatArray, torque: FloatArray) -> float:
    return float(np.abs(sum_of(waves, theta) - torque).max())


def _sine_phase(line: complex) -> float:
    """Return the phase of a line of a spectrum as that of a sine."""
    return math.atan2(line.imag, line.real) + 0.5 * math.pi


def _fitted(basis: FloatArray, torque: FloatArray) -> tuple[float, ...] | None:
    """Return the coefficients of a torque in a basis; None where it is not of it."""
    scale = np.abs(basis).max(axis=0)
    found = np.linalg.lstsq(basis / scale, torque, rcond=None)[0]
    peak = np.abs(torque).max()
    if np.abs(basis / scale @ found - torque).max() > EXACT * peak:
        return None
    # What rounding leaves of a power that it does not have is none of it.
    return tuple(float(x) for x in np.where(np.abs(found) > EXACT * peak, found / scale, 0.0))
