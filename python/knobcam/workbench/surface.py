"""What is left over two variables, beside what each law makes of it there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..base.arrays import FloatArray
    from ..base.pages_left import Surface
    from ..capture.prepare import Prepared
    from ..learn.left import Map
    from ..learn.proposals import Proposal, Proposals

_MAGNITUDE = "abs(omega)"
_BESIDE = (
    2  # cells to either side over which a law is averaged: a map is smooth, and few cells are passed through
)


def document(found: Proposals | None) -> Surface | None:
    """Return what is left as a map with those of the laws; None where no law is of two variables."""
    mapped = None if found is None else found.map
    if found is None or mapped is None:
        return None
    laws = [_of_law(found, mapped, one) for one in found.laws]
    if all(law is None for law in laws):
        return None
    return {
        "over": mapped.over,
        "times": mapped.times,
        "x": mapped.x.tolist(),
        "y": mapped.y.tolist(),
        "value": _told(mapped.value),
        "laws": [None if law is None else _told(law) for law in laws],
    }


def _told(value: FloatArray) -> list[list[float | None]]:
    return [[float(one) if np.isfinite(one) else None for one in row] for row in value]


def _of_law(found: Proposals, mapped: Map, law: Proposal) -> FloatArray | None:
    """Return what a law explains, fitted with the whole model, on average around each place of a map.

    None for a law that is not of both variables.
    """
    names = {"omega" if one == _MAGNITUDE else one for one in mapped.over}
    if not names <= {*law.variables}:
        return None
    columns = [_columns(one, mapped) for one in found.beside.prepared]
    x, y, times = (np.concatenate(parts) for parts in zip(*columns, strict=True))
    explained = found.beside.residual - law.fit.residual
    counts = np.isfinite(x + y + explained) & (times != 0.0)
    cells = _nearest(mapped.y, y[counts]) * len(mapped.x) + _nearest(mapped.x, x[counts])
    shape = mapped.value.shape
    # As a factor: of a torque that has the direction's sign, the mean of both with their signs.
    sums, weight = (
        _around(np.bincount(cells, one[counts], mapped.value.size).astype(np.float64), shape)
        for one in (explained * times, times**2)
    )
    mean = np.divide(sums, weight, out=np.full(shape, np.nan), where=weight > 0.0)
    return np.where(np.isfinite(mapped.value), mean, np.nan)


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
