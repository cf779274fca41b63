"""Signals of times of their own in one table, one to a row, as where topics are exported together."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.said import OfColumn, said
from ..finding import Finding

_FEWEST = 100  # readings of an angle and of a torque, from which a table is two logs in one
_TOGETHER = 0.1  # of the readings: where more stand in one row, blanks are readings that are missing
_MOST = 0.6  # of the rows: more have both, and the others are readings that are missing
_UNEVEN = 0.4  # of the usual interval, by which a clock of its own may be late
_EVENLY = 0.9  # of the intervals of a clock of its own, that are the usual one
_GAP = 5.0  # times the usual interval between two readings, beyond which nobody knows what was between
_MOTION = ("theta", "omega", "alpha")


def at_one_time(columns: dict[str, FloatArray]) -> tuple[dict[str, FloatArray], tuple[Finding, ...]]:
    """Return the rows of the torque, with the motion there between its readings; the same where none lacks.

    Where the rows that have both come evenly, and most others are of other signals, those are taken.

    Cubic Hermite polynomials, with the slopes of differences (Catmull & Rom 1974), differ from a motion by
    the third power of the interval: at ten readings a wave by a hundredth of it, at thirty by a thousandth.
    """
    if not {"t", "theta", "tau"} <= columns.keys():
        return columns, ()
    t, theta, tau = (np.isfinite(columns[name]) for name in ("t", "theta", "tau"))
    fewer = min(np.sum(t & theta), np.sum(t & tau))
    both = t & theta & tau
    if fewer < _FEWEST:
        return columns, ()
    if np.sum(both) > _TOGETHER * fewer:
        return _slower(columns, both)
    at = t & tau
    taken = _rows(columns, at, t)
    found = said(
        "{theta}: stands in other rows than {tau}, as where signals of times of their own are merged; taken "
        "between its readings, at the {count} times of {tau}",
        theta=OfColumn("theta"),
        tau=OfColumn("tau"),
        count=len(taken["t"]),
    )
    return taken, (Finding("merged", "theta", len(taken["t"]), (), found, "mended"),)


def _rows(columns: dict[str, FloatArray], at: BoolArray, known: BoolArray) -> dict[str, FloatArray]:
    """Return the rows `at` which a torque stands, with the motion there; `known` are those with a time."""
    taken = {name: columns[name][at] for name in ("t", "tau")}
    for name in _MOTION:
        if name in columns:
            taken[name] = _between(taken["t"], columns["t"][known], columns[name][known])
    return taken


def _slower(
    columns: dict[str, FloatArray], both: BoolArray
) -> tuple[dict[str, FloatArray], tuple[Finding, ...]]:
    """Return the rows that have an angle and a torque, where those come evenly and many have not."""
    known = np.isfinite(columns["t"])
    if np.sum(both) > _MOST * np.sum(known):
        return columns, ()
    times = columns["t"][both]
    steps = np.diff(times)
    usual = np.median(steps)
    if np.mean(np.abs(steps - usual) < _UNEVEN * usual) < _EVENLY:
        return columns, ()
    taken = _rows(columns, both, known)
    found = said(
        "{theta}: stands in {count} of {rows} rows beside {tau}, as where signals are read at rates of their "
        "own; these rows are taken",
        theta=OfColumn("theta"),
        tau=OfColumn("tau"),
        count=len(times),
        rows=len(both),
    )
    return taken, (Finding("merged", "theta", len(times), (), found, "mended"),)


def _between(times: FloatArray, t: FloatArray, values: FloatArray) -> FloatArray:
    """Return values at other times than they were read; NaN in gaps, and before and after all of them."""
    read = np.isfinite(values)
    t, first = np.unique(t[read], return_index=True)
    values = values[read][first]
    if len(t) < _FEWEST:
        return np.full(len(times), np.nan)
    slopes = np.gradient(values, t)
    steps = np.diff(t)
    at = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    h = steps[at]
    s = (times - t[at]) / h
    rise = values[at + 1] - values[at]
    found: FloatArray = (
        values[at]
        + s**2 * (3.0 - 2.0 * s) * rise
        + s * (s - 1.0) * h * ((s - 1.0) * slopes[at] + s * slopes[at + 1])
    )
    known = (times >= t[0]) & (times <= t[-1]) & (h <= _GAP * np.median(steps))
    return np.where(known, found, np.nan)
