"""Columns that are late against each other: the angle stands in the log after the velocity that made it."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray, chosen
from ...base.said import Advice, said
from ..finding import Finding
from .order import quantile

_SPAN_S = 0.02  # over which angles and velocities are compared
_LEAST = 0.6  # rows, below which nobody can tell a delay from how a derivative is taken
_SURE = 8.0  # standard errors
_FEWEST = 50  # spans
_WILD = 6.0  # times what two in three spans stay below
_ALIKE = (0.9, 1.1)  # ratio of velocity and derivative within which only a delay sets them apart


def check_late(
    columns: dict[str, FloatArray], usable: BoolArray, rate_hz: float
) -> tuple[dict[str, FloatArray], list[Finding]]:
    """Return the columns as mended where theta comes later or earlier than the omega beside it; the finding.

    An alpha that goes with omega says that it is theta which is late, and it is put back in its place, with
    NaN where it had none. Else omega is left out: a driver's filter makes it late, and theta alone
    contradicts nothing.
    """
    if "omega" not in columns:
        return columns, []
    index = np.flatnonzero(usable)
    seen = {name: chosen(values, index) for name, values in columns.items()}
    late = _late(seen["t"], seen["theta"], seen["omega"], rate_hz)
    if late is None or abs(late) * rate_hz < _LEAST:
        return columns, []
    which = "after" if late > 0.0 else "before"
    found = said(
        "{theta}: stands {ms:.3g} ms ({rows:.3g} rows) {which} the {omega} that belongs to it",
        ms=1e3 * abs(late),
        rows=abs(late) * rate_hz,
        which=which,
    )
    advice = None
    other = _late(seen["t"], seen["omega"], seen["alpha"], rate_hz) if "alpha" in columns else None
    if other is not None and abs(other) < 0.5 * abs(late):
        mended = columns | {"theta": _at(columns["t"] + late, seen["t"], seen["theta"], 1.5 / rate_hz)}
        found = said("{found}, and {alpha} goes with {omega}: {theta} is put where they are", found=found)
    else:
        mended = {name: values for name, values in columns.items() if name != "omega"}
        found = said("{found}: {omega} is left out", found=found)
        advice = Advice("stamp columns when they are measured")
    return mended, [Finding("late_column", "theta", len(index), (), found, "mended", advice)]


def _at(wanted: FloatArray, t: FloatArray, values: FloatArray, longest: float) -> FloatArray:
    """Return values at other times, NaN where the readings beside one are farther apart than `longest`."""
    after = np.searchsorted(t, wanted, side="right")
    inside = (after > 0) & (after < len(t))
    near = np.clip(after, 1, len(t) - 1)
    inside &= t[near] - t[near - 1] <= longest
    found: FloatArray = np.where(inside, np.interp(wanted, t, values), np.nan)
    return found


def _tame(values: FloatArray) -> BoolArray:
    tame: BoolArray = np.abs(values) <= _WILD * quantile(np.abs(values), 0.68)
    return tame


def _late(t: FloatArray, values: FloatArray, rate: FloatArray, rate_hz: float) -> float | None:
    """How late values come after their rate of change, s; zero where that is not sure, None if unknown.

    What they go in a span is the integral of the rate; where they are late by d, less by d times what the
    rate gains in it.
    """
    span = max(2, round(_SPAN_S * rate_hz))
    integral = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))))
    start = np.arange(0, len(t) - span, span)
    start = start[np.abs((t[start + span] - t[start]) * rate_hz - span) < 0.5]  # none across a gap
    if len(start) < _FEWEST:
        return None
    went, should = (column[start + span] - column[start] for column in (values, integral))
    gained = rate[start + span] - rate[start]
    # Wild readings are among them.
    tame = _tame(gained) & _tame(went - should)
    went, should, gained = went[tame], should[tame], gained[tame]
    squares = float(gained @ gained)
    alike = float(went @ should) / max(float(should @ should), 1e-300)
    if squares == 0.0 or not _ALIKE[0] < alike < _ALIKE[1]:
        return None
    late = -float((went - should) @ gained) / squares
    rest = went - should + late * gained
    error = quantile(np.abs(rest), 0.68) / np.sqrt(squares)
    return late if abs(late) >= _SURE * error else 0.0
