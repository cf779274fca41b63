"""Readings that are anything, alone or a few in a row: told by the parabola through what is around them."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, runs
from .order import deviation, quantiles

BESIDE = 6
"""Good rows on either side, through all of which one parabola has to go."""

FAR = 6.0
"""Deviations of noise from that parabola beyond which a reading is none: one in 5e8 by chance."""

AS_USUAL = 4.5
"""The same in a log in which many are."""

HABIT = 30
"""Readings below which wild ones are no habit of the log: an impact looks like a few."""

LONGEST = 30
"""Rows in a row that can be wild."""

_FEWEST = 256  # rows from which the noise of a column can be told
_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])  # what is left of a motion after it is next to nothing,
_GAIN = 20.0  # of the variance of white noise this many times as much
# Shares of the differences and what they do not exceed if all are noise. Where one reading in twenty is wild,
# a fifth of the differences have one in them; without these, the tails of the noise count as well.
_SPOILED = ((0.35, 0.4538), (0.7, 1.0364))
_WITHOUT = (*_SPOILED, (0.9, 1.6449))
_SUSPICIOUS = (3.5, 2.0)  # deviations of a difference beyond which its rows are looked at: once, again
_DOUBT = 3.5  # deviations within which they are as good as the others
_WIDEST = 60  # rows between the first and the last of those beside, beyond which a parabola says nothing
_AGREE = 1.6  # times the noise that a parabola may leave: chance leaves more once in ten thousand
_ROUNDS = 5
_SIDE = 5  # rows on either side, most of which tell what is usual there
_AROUND = 10  # the same, that tell the way from row to row
_FEW = 0.15  # neighbours among the wild, below which they say little
_ALIKE = 0.75  # of these on the same side, above which they are pulses
_RARELY, _UNEVEN = 0.005, 0.01  # intervals between stamps that are left out, and how far others differ
_BEYOND = 0.2  # of the readings that are off by more than the way from row to row: the others may be late


def wild(t: FloatArray, values: FloatArray, least: float) -> BoolArray:
    """Return which of `values`, shape (samples,), are wild; none where they are fewer than `HABIT`.

    `least` is the least noise that the column can have, as by counting. What lasts longer than `LONGEST` is
    no wild reading, nor is what lies where the rows around it do not follow one parabola: a step, an impact.
    And wild readings know nothing of each other, nor of the motion: one that repeats the row before is
    another fault, so is one that was read late, and short pulses of one sign are those of a knob.
    """
    found = np.zeros(len(values), dtype=np.bool_)
    if len(values) < _FEWEST:
        return found
    third = np.abs(np.convolve(values, _THIRD, "valid"))
    noise = _noise(third, _SPOILED, least)
    if not noise > 0.0:
        return found
    fresh = np.append(True, np.diff(values) != 0.0)
    doubtful, clean = found, np.ones(len(third), dtype=np.bool_)
    off, way = np.zeros((2, len(values)))
    for suspicious in _SUSPICIOUS:
        far = clean & (third > suspicious * math.sqrt(_GAIN) * noise)
        doubtful = doubtful | (np.convolve(far, np.ones(len(_THIRD))) > 0.5)
        for _ in range(_ROUNDS):
            rows = np.flatnonzero(doubtful)
            off[rows], way[rows] = _off(t, values, rows, np.flatnonzero(~doubtful), noise)
            found = (np.abs(off) > FAR * noise) & fresh
            doubtful &= ~(np.abs(off) < _DOUBT * noise)
            clean = np.convolve(found, np.ones(len(_THIRD)), "valid") < 0.5
            if found.sum() < HABIT or not clean.any():
                return np.zeros_like(found)
            noise = _noise(third[clean], _WITHOUT, least)
    pairs = found[1:] & found[:-1]
    alike = pairs & (off[1:] * off[:-1] > 0.0)
    pulses = pairs.sum() > _FEW * found.sum() and alike.sum() > _ALIKE * pairs.sum()
    beyond = np.sum(np.abs(off[found]) > way[found])
    late = not _even(t) and beyond < max(HABIT, _BEYOND * found.sum())
    if pulses or late:
        return np.zeros_like(found)
    found |= (np.abs(off) > AS_USUAL * noise) & fresh
    # Steps and the densest places have no parabola: there what is far from most on either side.
    rows = np.flatnonzero(doubtful & ~found & fresh)
    found[rows[_unlike(values, rows, np.flatnonzero(~found)) > FAR * noise]] = True
    for first, end in zip(*runs(found), strict=True):
        found[first:end] = end - first <= LONGEST
    return found


def _even(t: FloatArray) -> bool:
    """Whether the clock is even: who stamps unevenly reads unevenly too."""
    step = np.diff(t)
    low, usual, high = quantiles(step, _RARELY, 0.5, 1.0 - _RARELY)
    return high - low < _UNEVEN * usual


def _noise(third: FloatArray, shares: tuple[tuple[float, float], ...], least: float) -> float:
    """Deviation of white noise with such third differences; the widest where its tails are heavier."""
    return max(deviation(third, shares) / math.sqrt(_GAIN), least)


def _beside(rows: IntArray, good: IntArray) -> tuple[IntArray, IntArray]:
    """Which of `rows`, by index, have enough good ones near on either side, and these, shape (those, 2 n)."""
    after = np.searchsorted(good, rows)
    inside = np.flatnonzero((after >= BESIDE) & (after <= len(good) - BESIDE))
    beside = good[after[inside, None] + np.arange(-BESIDE, BESIDE)]
    near = beside[:, -1] - beside[:, 0] <= _WIDEST
    return inside[near], beside[near]


def _off(
    t: FloatArray, values: FloatArray, rows: IntArray, good: IntArray, noise: float
) -> tuple[FloatArray, FloatArray]:
    """How far `rows` are from the parabola through the `good` ones beside them, NaN where there is none.

    And how far the values usually go there from row to row.
    """
    off, way = np.full((2, len(rows)), np.nan)
    inside, beside = _beside(rows, good)
    away = t[beside] - t[rows[inside], None]
    away /= np.max(np.abs(away), axis=1, keepdims=True)
    powers = np.stack([np.ones_like(away), away, away**2], axis=2)
    level = values[beside] - values[beside[:, :1]]
    moments = np.swapaxes(powers, 1, 2)
    # Next to nothing more, so that rows beside a gap of ages are no parabola and no error.
    factors = np.linalg.solve(moments @ powers + 1e-12 * np.eye(3), moments @ level[:, :, None])
    left = np.sum((level - (powers @ factors)[:, :, 0]) ** 2, axis=1) / (2 * BESIDE - 3)
    own = values[rows[inside]] - values[beside[:, 0]] - factors[:, 0, 0]
    off[inside] = np.where(left <= (_AGREE * noise) ** 2, own, np.nan)
    way[inside] = np.abs(level[:, -1]) / (beside[:, -1] - beside[:, 0])
    return off, way


def _unlike(values: FloatArray, rows: IntArray, others: IntArray) -> FloatArray:
    """How far `rows` are from the median of those before or of those after, beyond the way from there.

    What belongs to either side of a step is not far; next to it two of five may be wild. Zero at the ends.
    """
    off = np.zeros(len(rows))
    at = np.searchsorted(others, rows)
    inside = np.flatnonzero((at >= _AROUND) & (at < len(others) - _AROUND))
    beside = np.delete(np.arange(-_AROUND, _AROUND + 1), _AROUND)
    around = values[others[at[inside, None] + beside]]
    way = 0.5 * (_SIDE + 1) * np.median(np.abs(np.diff(around, axis=1)), axis=1)
    before_and_after = around[:, _AROUND - _SIDE : _AROUND + _SIDE].reshape(-1, 2, _SIDE)
    away = np.abs(np.median(before_and_after, axis=2) - values[rows[inside], None])
    off[inside] = np.min(away, axis=1) - way
    return off
