"""What was measured over two variables: means of the samples around each place of a plane.

A smooth surface alone is no picture of it: where a motion hardly leaves one line of the plane, that may hold
what the parameters of the model take back, far beyond anything that was measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..base.arrays import FloatArray
    from ..capture.prepare import Prepared
    from .left import Map

MAGNITUDE = "abs(omega)"
_BESIDE = 2
"""Cells to either side over which a torque is averaged, for few are passed through."""


class Around:
    """The samples around each place of a map at which the motion went."""

    def __init__(self, prepared: Sequence[Prepared], mapped: Map) -> None:
        columns = [_columns(one, mapped) for one in prepared]
        x, y, self._times = (np.concatenate(parts) for parts in zip(*columns, strict=True))
        self._sum = x + y
        self._cells = _nearest(mapped.y, y) * len(mapped.x) + _nearest(mapped.x, x)
        self._went = np.isfinite(mapped.value)

    def mean(self, torque: FloatArray) -> FloatArray:
        """Return the mean of a torque around each place where the motion went, a sample each."""
        counts = np.isfinite(self._sum + torque) & (self._times != 0.0)
        # As a factor: of a torque that has the direction's sign, the mean of both with their signs.
        cells, times = self._cells[counts], self._times[counts]
        sums, weight = (
            _around(np.bincount(cells, one, self._went.size).astype(np.float64), self._went.shape)
            for one in (torque[counts] * times, times**2)
        )
        mean = np.divide(sums, weight, out=np.full(self._went.shape, np.nan), where=weight > 0.0)
        return np.where(self._went, mean, np.nan)


def _around(cells: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return for each cell of a map the sum over those beside it."""
    wide = np.pad(cells.reshape(shape), _BESIDE)
    windows = np.lib.stride_tricks.sliding_window_view(wide, (2 * _BESIDE + 1, 2 * _BESIDE + 1))
    summed: FloatArray = windows.sum(axis=(2, 3))
    return summed


def _columns(signals: Prepared, mapped: Map) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the two variables of a map at all samples of a capture, and the factor of it."""
    known = {
        "t": signals.capture.t - signals.capture.t[0],
        "theta": signals.on_capture(signals.theta),
        "omega": signals.on_capture(signals.omega),
        "alpha": signals.on_capture(signals.alpha),
        "s": signals.on_capture(np.asarray(signals.core.column("history"))),
    }
    known[MAGNITUDE] = np.abs(known["omega"])
    times = np.sign(known["omega"]) if mapped.times else np.ones(len(known["omega"]))
    return known[mapped.over[0]], known[mapped.over[1]], times


def _nearest(places: FloatArray, values: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return which of ascending places each value is nearest to."""
    found: np.ndarray[tuple[int], np.dtype[np.int64]] = np.searchsorted(
        0.5 * (places[1:] + places[:-1]), values
    )
    return found
