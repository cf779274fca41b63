"""Torque that sits at the limit of its sensor, or leaps for a single row."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, chosen, runs
from ...base.said import Advice, Said, said
from ..finding import Finding, Rows, rows_in_words, spans
from ..formats.units import GIVEN
from .order import deviation, medians
from .wild import wild

Limit = Literal["sensor", "actuator"]
"""Whose limit it is where a torque sits at its extreme: the sensor's, or that of what drives the motor."""

MIN_RUN = 4
"""Identical extreme samples in a row, below which a limit is not suspected."""

MIN_LEVELS = 16
"""Distinct values, below which a signal is too coarse to tell a limit from a level."""

EXCESS = 5.0
"""How much fuller the extreme level must be than the mean of the next three.

A quantised sine fills its top level at most 3.0 times as much (levels of equal height under a parabola hold
1, sqrt 2 - 1, sqrt 3 - sqrt 2, 2 - sqrt 3), and noise makes the top level the emptiest.
"""

SPIKE = 10.0
"""Deviations of noise by which a reading leaves its neighbours, and they do not: a fault of the reading."""

QUIET = 5.0
"""Deviations within which the readings beside a spike stay: an impact lasts, or rings."""

_ROUNDS = 5
_FEWEST = 64  # rows from which the noise of a column can be told


def usual_limit(torque_unit: str) -> Limit:
    """Return whose limit it is where nobody says: a drive's, where the torque is what a motor was given."""
    return "actuator" if torque_unit in GIVEN else "sensor"


def check_clipping(
    tau: FloatArray, theta: FloatArray, usable: BoolArray, rows: Rows, limit: Limit
) -> tuple[BoolArray, list[Finding]]:
    """Return which samples of `tau` are beyond the sensor, on either side on its own, and the findings.

    What is at the limit of the actuator is only said: that much torque there was. Zero is never a limit (a
    motor that is off), nor is a plateau during motion at an exactly constant step, which noise-free
    simulations have.
    """
    clipped = np.zeros(len(tau), dtype=np.bool_)
    findings = []
    values = chosen(tau, usable)
    for side, extreme in (("upper", values.max()), ("lower", values.min())):
        at = usable & (tau == extreme)
        if extreme == 0.0 or _longest_run(at) < MIN_RUN or not _is_limit(values, extreme):
            continue
        step = np.diff(theta)[at[1:] & at[:-1]]
        if step.size and step[0] != 0.0 and np.ptp(step) <= 1e-6 * abs(step[0]):
            continue
        where = ("tau", int(at.sum()), spans(rows[at]))
        told = said(
            "{tau}: {count} samples sit at its {side} limit {extreme:.6g}, up to {longest} in a row "
            "({rows}): ",
            count=where[1],
            side=side,
            extreme=extreme,
            longest=_longest_run(at),
            rows=rows_in_words(rows[at]),
        )
        if limit == "sensor":
            clipped |= at
            told = Said(told, "the sensor is saturated")
            advice = Advice("if it is the drive's limit, choose --limit actuator", "drive")
            findings.append(Finding("clipped", *where, told, "masked", advice))
        else:
            told = Said(told, "the drive's limit, so they count")
            advice = Advice("if the sensor is saturated, choose --limit sensor", "command")
            findings.append(Finding("limit", *where, told, "note", advice))
    return clipped, findings


def check_spikes(
    columns: dict[str, FloatArray], usable: BoolArray, rows: Rows
) -> tuple[BoolArray, list[Finding]]:
    """Return at which rows the torque leaps for that row alone, and the finding.

    What is felt moves the knob: a leap that the acceleration has too, measured or in the differences of the
    other columns, is none.
    """
    spikes = np.zeros(len(usable), dtype=np.bool_)
    # With the first ones out of the way, others stand alone.
    for _ in range(_ROUNDS):
        index = np.flatnonzero(usable & ~spikes)
        alone = _alone(columns, index)
        if not alone.size:
            break
        spikes[index[alone]] = True
    # Where this is a habit of the log, they are beside each other too.
    index = np.flatnonzero(usable)
    at = np.flatnonzero(wild(chosen(columns["t"], index), chosen(columns["tau"], index), 0.0))
    spikes[index[at[_unfelt(columns, index, at)]]] = True
    if not spikes.any():
        return spikes, []
    found = rows[spikes]
    lasting = "a single row" if (np.diff(found) > 1).all() else "a row or a few"
    told = said(
        "{tau}: leaps for {lasting} at {rows}, which no knob does", lasting=lasting, rows=rows_in_words(found)
    )
    return spikes, [Finding("spike", "tau", len(found), spans(found), told, "masked")]


def _alone(columns: dict[str, FloatArray], index: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return which of the rows `index` have a torque that is far from all that is around it."""
    tau = chosen(columns["tau"], index)
    if len(tau) < _FEWEST:
        return np.empty(0, dtype=np.intp)
    step = np.diff(tau)
    if not np.any(step):
        return np.empty(0, dtype=np.intp)
    noise = _noise(step[step != 0.0])  # of a motor that is off there is none to be read
    # Away from both neighbours to the same side: no step, as of friction at a reversal.
    both = np.minimum(np.abs(step[:-1]), np.abs(step[1:])) > 0.5 * SPIKE * noise
    at = 1 + np.flatnonzero(both & (step[:-1] * step[1:] < 0.0))
    at = at[(at >= 5) & (at < len(tau) - 5)]
    alone = _leaps(tau, at, noise) > SPIKE
    for beside in (-2, -1, 1, 2):
        alone &= _leaps(tau, at + beside, noise) < QUIET
    at = at[alone]
    return at[_unfelt(columns, index, at)]


def _unfelt(columns: dict[str, FloatArray], index: NDArray[np.intp], at: NDArray[np.intp]) -> BoolArray:
    """Return at which of the rows `index[at]` the motion has no leap."""
    still = np.ones(len(at), dtype=np.bool_)
    if not at.size:
        return still  # as in nearly every log: the motion need not be looked at
    at = np.clip(at, 5, len(index) - 6)
    for name, order in (("theta", 2), ("omega", 1), ("alpha", 0)):
        if name in columns:
            jerk = np.diff(chosen(columns[name], index), n=order)
            noise = _noise(np.diff(jerk))
            for late in range(order + 1):  # differences that the row has a part in
                # What is missing between two rows makes a leap too.
                whole = index[at - late + order] - index[at - late] == order
                still &= ~whole | (_leaps(jerk, at - late, noise) < QUIET)
    return still


def _noise(step: FloatArray) -> float:
    """Deviation of white noise with such steps; the wider of two measures where its tails are heavier."""
    return deviation(np.abs(step), ((0.5, 0.6745), (0.8, 1.2816))) / math.sqrt(2.0)


def _leaps(values: FloatArray, at: NDArray[np.intp], noise: float) -> FloatArray:
    """How far values are from the median of the three on either side, in deviations of noise."""
    beside = values[at[:, None] + np.array([-3, -2, -1, 1, 2, 3])]
    off: FloatArray = np.abs(values[at] - medians(beside))
    return off / max(noise, float(np.finfo(np.float64).tiny))


def _longest_run(flags: BoolArray) -> int:
    firsts, ends = runs(flags)
    return int(np.max(ends - firsts, initial=0))


def _is_limit(values: FloatArray, limit: float) -> bool:
    """Whether the level `limit` holds far more samples than the levels beside it."""
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < MIN_LEVELS:
        return False
    if limit == levels[-1]:
        counts = counts[::-1]
    return bool(counts[0] > EXCESS * np.mean(counts[1:4]))
