"""Columns that are late against each other: the angle stands in the log after the velocity that made it."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding
from .order import quantile

_SPAN_S = 0.02  # over which angles and velocities are compared
_LEAST = 0.6  # rows, below which nobody can tell a delay from how a derivative is taken
_SURE = 8.0  # standard errors
_FEWEST = 50  # spans
_ALIKE = (0.9, 1.1)  # ratio of velocity and derivative within which only a delay sets them apart


def check_late(columns: dict[str, FloatArray], usable: BoolArray, rate_hz: float) -> list[Finding]:
    """Return a warning where theta comes later, or earlier, than the omega beside it.

    What the angle goes in a span is the integral of the velocity; where it is late by d, less by d times what
    the velocity gains in it.
    """
    if "omega" not in columns:
        return []
    index = np.flatnonzero(usable)
    t, theta, omega = (columns[name][index] for name in ("t", "theta", "omega"))
    span = max(2, round(_SPAN_S * rate_hz))
    steps = np.diff(t)
    integral = np.concatenate(([0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * steps)))
    start = np.arange(0, len(t) - span, span)
    start = start[np.abs((t[start + span] - t[start]) * rate_hz - span) < 0.5]  # none across a gap
    if len(start) < _FEWEST:
        return []
    went, should = (values[start + span] - values[start] for values in (theta, integral))
    gained = omega[start + span] - omega[start]
    squares = float(gained @ gained)
    if (
        squares == 0.0
        or not _ALIKE[0] < float(went @ should) / max(float(should @ should), 1e-300) < _ALIKE[1]
    ):
        return []
    late = -float((went - should) @ gained) / squares
    rest = went - should + late * gained
    error = quantile(np.abs(rest), 0.68) / np.sqrt(squares)
    if abs(late) * rate_hz < _LEAST or abs(late) < _SURE * error:
        return []
    which = "after" if late > 0.0 else "before"
    message = (
        f"theta: stands {1e3 * abs(late):.3g} ms ({abs(late) * rate_hz:.3g} rows) {which} the omega that "
        "belongs to it; stamp columns when they are measured, or leave one out"
    )
    return [Finding("late_column", "theta", len(index), (), message, "warning")]
