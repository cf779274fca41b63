"""Rows that are lost though the clock counted on, and rows that are no readings though it did.

A machine that is asked at other times than it reads repeats a reading here and skips one there; a log that
loses rows skips them alone. Either way the angle tells, by steps that are a whole number of its usual ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, groups
from ...base.said import said
from ..finding import Finding, Rows, rows_in_words, spans

REACH = 8
"""Steps to either side from which the step between two rows is expected."""

CLEAR = 8.0
"""Noise deviations beyond which a step is not what its neighbours let expect: one in 1e15 by chance."""

FAR = 4.0
"""Steps, further than which none is too long by what those beside it are too short."""

MOST_LOST = 50
"""Rows at one place, beyond which the speed says too little about where the angle would be."""

_BESIDE = 3  # steps to either side of some that are off, which make up for them where they can
_ASYNCHRONOUS = 0.5  # rows that repeat and do not catch up, to each that seems lost
_SPEED = 0.05  # of the speed, by which it may be another one while rows are lost
_WHOLE = 0.15  # a step of lost rows is a whole number of steps, to this share of one


@dataclass(frozen=True)
class Steady:
    """Steps of an angle, shape (steps,), and those that its neighbours let expect, to this noise.

    `doubt` is by how much those on either side let expect another one than both together. `clear` are those
    that are clearly other ones; into a `stale` row, which repeats the one before, the angle made none; `long`
    are those of the clear ones that may have lost rows.
    """

    step: FloatArray
    expected: FloatArray
    doubt: FloatArray
    noise: float
    long: BoolArray
    clear: BoolArray
    stale: BoolArray

    def off(self) -> FloatArray:
        """By how much each is further than expected."""
        return self.step - self.expected


@dataclass(frozen=True)
class Asked:
    """Rows that each step, to one of the samples `index[1:]`, lost or has too many; which lead amiss."""

    index: NDArray[np.intp]
    lost: NDArray[np.int64]
    amiss: BoolArray
    findings: list[Finding]

    def late(self, samples: int) -> FloatArray:
        """Rows by which each sample was taken later than the clock says."""
        shift = np.zeros(samples)
        more, less = self.lost > 0, self.lost < 0
        shift[self.index[1:][more]] = self.lost[more]
        shift[np.minimum(self.index[1:][less] + 1, samples - 1)] += self.lost[less]
        late: FloatArray = np.cumsum(shift)
        return late


def check_asked(steps: Steady, rows: Rows, index: NDArray[np.intp]) -> Asked:
    """Look for rows that were lost, or are no readings, among those at `index`."""
    off = steps.off()
    # An angle that was read late makes one step longer, and the one before or after it shorter.
    ordinary = np.abs(off) < np.maximum(0.25 * np.abs(steps.expected), 0.5 * CLEAR * steps.noise)
    far = np.abs(off) > FAR * np.abs(steps.expected)
    ordinary |= far & steps.long
    alone = far | (np.append(ordinary[1:], True) & np.append(True, ordinary[:-1]))
    lost, amiss = _lost(steps, steps.long & ~steps.stale & alone), np.zeros(len(off), dtype=np.bool_)
    net = np.convolve(off, np.ones(2 * REACH + 1), "same")
    lost[_caught_up(net, lost * steps.expected)] = 0
    idle = steps.stale & (steps.expected != 0.0) & ~_caught_up(net, -steps.expected)
    if (idle & steps.clear).any():
        lost, amiss = _by_groups(steps)
    elif idle.sum() >= _ASYNCHRONOUS * lost.sum():  # neither is clear
        lost[:] = 0
    if not (lost.any() or amiss.any()):
        return Asked(index, lost, amiss, [])
    return Asked(index, lost, amiss, [_said(rows, index, lost, amiss)])


def _said(rows: Rows, index: NDArray[np.intp], lost: NDArray[np.int64], amiss: BoolArray) -> Finding:
    at, late = rows[index[:-1][lost != 0]], rows[index[1:][amiss]]
    count, idle = int(lost.clip(0).sum()), int((-lost).clip(0).sum())
    if not idle and not amiss.any():
        words = said(
            "{t}: about {count} rows are missing after {rows}, where the angle advances by several steps in "
            "one though the clock counted on; later times are moved, nothing is filled in",
            count=count,
            rows=rows_in_words(at),
        )
        return Finding("lost", "t", count, spans(at), words, "mended")
    if not lost.any():
        words = said(
            "{count} rows were read late, and those after them not ({rows}), as where a machine is asked at "
            "other times than it reads",
            count=len(late),
            rows=rows_in_words(late),
        )
        return Finding("asked", "theta", len(late), spans(late), words, "masked")
    at = np.union1d(at, late)
    words = said(
        "{idle} rows are no readings and {count} readings were skipped, though the clock counted on "
        "({rows}), as where a machine is asked at other times than it reads; times are moved to its own, "
        "{late} rows between are masked",
        idle=idle,
        count=count,
        rows=rows_in_words(at),
        late=len(late),
    )
    return Finding("asked", "theta", len(at), spans(at), words, "mended")


def _caught_up(net: FloatArray, gone: FloatArray) -> BoolArray:
    """Which of the steps that are too long by what is `gone` are so by what steps near them are too short.

    `net` is by how much those around each are too long together.

    An angle that was read late for a row or two catches up; rows that are lost leave it further on.
    """
    caught: BoolArray = net * np.sign(gone) < 0.5 * np.abs(gone)
    return caught


def _lost(steps: Steady, clear: BoolArray) -> NDArray[np.int64]:
    """How many rows are missing within each step: one less than the steps that it is as long as."""
    expected = steps.expected
    many = np.where(clear, steps.step, expected) / np.where(expected == 0.0, 1.0, expected)
    whole = np.rint(many)
    # Over a few rows the speed is what it was; over many it may have been another one.
    doubt = whole * np.where(whole >= REACH, np.maximum(steps.doubt, _SPEED * np.abs(expected)), 0.0)
    most = 0.5 * CLEAR * steps.noise + _WHOLE * np.abs(expected) + doubt
    near = np.abs(many - whole) * np.abs(expected) < most
    lost = np.where(clear & near & (whole >= 2.0) & (whole <= MOST_LOST + 1.0), whole - 1.0, 0.0)
    return lost.astype(np.int64)


def _by_groups(steps: Steady) -> tuple[NDArray[np.int64], BoolArray]:
    """The same of steps that are too long or too short by each other, where a row that repeats is one less.

    And which lead to a row that was not read at its time, for which those after it make up.
    """
    off, stale = steps.off(), steps.stale
    lost, amiss = np.zeros(len(off), dtype=np.int64), np.zeros(len(off), dtype=np.bool_)
    for group in groups(np.flatnonzero(steps.clear), REACH):
        around = np.arange(max(0, group[0] - _BESIDE), min(len(off), group[-1] + _BESIDE + 1))
        usual = float(np.median(steps.expected[group]))
        if not (usual and steps.expected[around].all()):
            amiss[around] |= len(group) > REACH  # of so many nobody can tell
            continue
        ahead = np.cumsum(off[around]) / usual
        whole = round(ahead[-1])
        near = abs(ahead[-1] - whole) < 0.5 * CLEAR * steps.noise / abs(usual) + _WHOLE * len(group)
        if near and 0 < whole <= MOST_LOST:
            lost[group[np.argmax(np.abs(steps.step[group]))]] = whole
        elif near and whole < 0 and -whole <= stale[group].sum():
            lost[group[stale[group]][whole:]] = -1
        amiss[around] = np.abs(ahead - np.cumsum(lost[around])) > 0.5
    return lost, amiss & ~stale
