"""What is left over two variables, beside what each law makes of it there: both as means around each place.

The smooth map of the core is no picture of what is left: where a motion hardly leaves one line of the plane,
it may hold what the parameters of the model take back, far beyond anything that was measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..base.pages_left import Surface
    from ..capture.prepare import Prepared
    from ..learn.left import Map
    from ..learn.proposals import Proposals

_MAGNITUDE = "abs(omega)"
_BESIDE = 2
"""Cells to either side over which a torque is averaged, for few are passed through."""


def document(found: Proposals | None) -> Surface | None:
    """Return what is left as a map with those of the laws; None where no law is of two variables."""
    mapped = None if found is None else found.map
    if found is None or mapped is None:
        return None
    names = {"omega" if one == _MAGNITUDE else one for one in mapped.over}
    both = [names <= {*one.variables} for one in found.laws]
    if not any(both):
        return None
    left = found.beside.residual
    around = _Around(found, mapped)
    laws = [
        around.mean(left - one.fit.residual) if of_both else None
        for one, of_both in zip(found.laws, both, strict=True)
    ]
    return {
        "over": mapped.over,
        "times": mapped.times,
        "x": mapped.x.tolist(),
        "y": mapped.y.tolist(),
        "value": _told(around.mean(left)),
        "laws": [None if law is None else _told(law) for law in laws],
    }


def _told(value: FloatArray) -> list[list[float | None]]:
    return [[float(one) if np.isfinite(one) else None for one in row] for row in value]


class _Around:
    """The samples around each place of a map."""

    def __init__(self, found: Proposals, mapped: Map) -> None:
        columns = [_columns(one, mapped) for one in found.beside.prepared]
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
    known[_MAGNITUDE] = np.abs(known["omega"])
    times = np.sign(known["omega"]) if mapped.times else np.ones(len(known["omega"]))
    return known[mapped.over[0]], known[mapped.over[1]], times


def _nearest(places: FloatArray, values: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return which of ascending places each value is nearest to."""
    found: np.ndarray[tuple[int], np.dtype[np.int64]] = np.searchsorted(
        0.5 * (places[1:] + places[:-1]), values
    )
    return found
