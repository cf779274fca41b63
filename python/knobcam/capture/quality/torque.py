"""Torque that sits at the limit of its sensor, or at an implausible size."""

from __future__ import annotations

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ..finding import Finding, Rows, first_rows, rows_in_words
from ..formats.units import Coordinate

MIN_RUN = 4
"""Identical extreme samples in a row, below which a limit is not suspected."""

MIN_LEVELS = 16
"""Distinct values, below which a signal is too coarse to tell a limit from a level."""

EXCESS = 5.0
"""How much fuller the extreme level must be than the mean of the next three.

A quantised sine fills its top level at most 3.0 times as much (levels of equal height under a parabola hold
1, sqrt 2 - 1, sqrt 3 - sqrt 2, 2 - sqrt 3), and noise makes the top level the emptiest.
"""

IMPLAUSIBLE_RMS_NM = 20.0
"""A hand-turned knob above this RMS torque (N m) is more often recorded in mN m."""


def check_clipping(
    tau: FloatArray, theta: FloatArray, usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return which samples of `tau` are saturated, on either side on its own, and the findings.

    Zero is never a limit (a motor that is off), nor is a plateau during motion at an exactly constant step,
    which noise-free simulations have.
    """
    clipped = np.zeros(len(tau), dtype=np.bool_)
    findings = []
    values = tau[usable]
    for side, limit in (("upper", values.max()), ("lower", values.min())):
        at = usable & (tau == limit)
        if limit == 0.0 or _longest_run(at) < MIN_RUN or not _is_limit(values, limit):
            continue
        step = np.diff(theta)[at[1:] & at[:-1]]
        if step.size and step[0] != 0.0 and np.ptp(step) <= 1e-6 * abs(step[0]):
            continue
        clipped |= at
        findings.append(
            Finding(
                "clipped",
                "tau",
                int(at.sum()),
                first_rows(rows[at]),
                f"tau: {int(at.sum())} samples sit at its {side} limit {limit:.6g}, up to "
                f"{_longest_run(at)} in a row ({rows_in_words(rows[at])}): the sensor is saturated; masked",
                "masked",
            )
        )
    return clipped, findings


def check_size(tau: FloatArray, usable: BoolArray, coordinate: Coordinate) -> list[Finding]:
    """Return a note when a rotary torque is larger than hands turn."""
    rms = float(np.sqrt(np.mean(np.square(tau[usable]))))
    if coordinate == "linear" or rms <= IMPLAUSIBLE_RMS_NM:
        return []
    message = f"tau: {rms:.4g} N m RMS is much for a knob; if the column is in mN m, map tau=... [mNm]"
    return [Finding("scale", "tau", int(usable.sum()), (), message, "note")]


def _longest_run(flags: BoolArray) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False]))))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def _is_limit(values: FloatArray, limit: float) -> bool:
    """Whether the level `limit` holds far more samples than the levels beside it."""
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < MIN_LEVELS:
        return False
    if limit == levels[-1]:
        counts = counts[::-1]
    return bool(counts[0] > EXCESS * np.mean(counts[1:4]))
