"""Where an angle alone stands or steps aside in the midst of a motion, and how far it leaps there."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, groups, runs
from .order import medians

_LONGEST = 128  # rows for which it stands
_SPEED = 8  # rows, at least, over which a speed is read
_SPANS = np.array([1, 3])  # times as long as it stands, over which one is read
_BESIDE = 2  # rows to either side of a step that are not asked what step is usual
_STEPS = np.r_[-_BESIDE - 4 : -_BESIDE, _BESIDE + 1 : _BESIDE + 5]  # those that are
_COUNTS = 2.5  # of an encoder, beyond which a step is not one of the motion
_CLEAR = 12.0  # deviations of the angle's noise, of which a step has 1.5
_PLACES = 100  # beyond which the motion is like that
_APART = 3  # rows between two holes, fewer than which tell nothing of the motion between them
_AGREE = 1.6  # times the noise that the curve through what is kept may leave
_SURE = 5.0  # deviations of its error that a leap is at least
_BACK = 0.3  # of a leap, that is left of it and another close by: the angle was away


@dataclass(frozen=True)
class Leap:
    """After sample `before`, and as far as sample `after`, the angle goes `size` too far.

    `between`: where it was at the samples between, by what is before and after; empty where nothing tells.
    """

    before: int
    after: int
    size: float
    between: FloatArray = field(default_factory=lambda: np.empty(0))


class _Joint(NamedTuple):
    """Leaps with their sizes, how sure each is, and what one smooth curve beside them leaves."""

    leaps: list[Leap]
    sds: FloatArray
    rms: float


def holes(values: FloatArray, noise: float, least: float, surely: float) -> list[Leap]:
    """Return where `values`, one a row, stand while the motion goes on by `surely`, and where a step is none.

    Sizes are not yet known. What lies within a few rows of another is one with it.
    """
    own = math.sqrt(max(0.0, noise**2 - (least / 3.0) ** 2))  # a count alone has a noise of 0.29
    clear = max(_COUNTS * least, _CLEAR * own)
    found = [*_stands(values, least if own < 0.3 * least else 0.0, surely), *_steps(values, clear)]
    if len(found) > _PLACES:
        return []
    merged: list[Leap] = []
    for leap in sorted(found, key=lambda leap: leap.before):
        if merged and leap.before < merged[-1].after + _APART:
            merged[-1] = Leap(merged[-1].before, max(merged[-1].after, leap.after), 0.0)
        else:
            merged.append(leap)
    return [leap for leap in merged if leap.after - leap.before <= _LONGEST + 2 * _BESIDE]


def _stands(values: FloatArray, unsteady: float, surely: float) -> list[Leap]:
    """Where the angle stands, but for `unsteady`; a row more on either side may have a part of it."""
    first, end = runs(np.diff(values) == 0.0)
    # What leaps while it stands stands twice.
    one = (first[1:] == end[:-1] + 1) & (np.abs(values[first[1:]] - values[end[:-1]]) > surely)
    first, end = first[np.append(True, ~one)[: len(first)]], end[np.append(~one, True)[: len(end)]]
    last = len(values) - 1

    def slopes(start: IntArray, way: int) -> FloatArray:
        """The swifter of those over as many rows and over some more, which may lie beyond another stand."""
        lengths = np.maximum(_SPEED, end - first) * _SPANS[:, None]
        slopes = way * (values[np.clip(start + way * lengths, 0, last)] - values[start]) / lengths
        return np.asarray(slopes[np.abs(slopes).argmax(axis=0), np.arange(len(start))], dtype=np.float64)

    before, after = slopes(first, -1), slopes(end, 1)
    speed = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    found, known = [], -1
    for k in np.flatnonzero((end - first + 4) * speed > 0.5 * surely).tolist():
        start, stop, fast = int(first[k]), int(end[k]), float(speed[k])
        if start <= known:
            continue
        low, high = sorted((values[start], values[stop]))
        for way in (-1, 1):  # to the count below or to the one above, not to both
            at = start if way < 0 else stop
            while 0 < at < last:
                least, most = min(low, values[at + way]), max(high, values[at + way])
                if most - least > 1.1 * unsteady:
                    break
                low, high, at = least, most, at + way
            start, stop = (at, stop) if way < 0 else (start, at)
        known = stop
        if (stop - start) * fast > surely + unsteady and stop - start <= _LONGEST:
            found.append(Leap(max(0, start - 1), min(last, stop + 1), 0.0))
    return found


def _steps(values: FloatArray, clear: float) -> list[Leap]:
    """Where one step is `clear` of those beside it."""
    step = np.diff(values)
    doubtful = np.flatnonzero(np.abs(np.diff(step, prepend=step[0])) > 0.5 * clear)
    doubtful = np.unique(np.concatenate([doubtful, np.maximum(0, doubtful - 1)]))
    if not doubtful.size or len(doubtful) > 4 * _PLACES:
        return []
    usual = medians(step[np.clip(doubtful[:, None] + _STEPS, 0, len(step) - 1)])
    return [Leap(int(row), int(row) + 1, 0.0) for row in doubtful[np.abs(step[doubtful] - usual) > clear]]


def together(rows: FloatArray, values: FloatArray, found: list[Leap], reach: int, noise: float) -> list[Leap]:
    """Return the leaps of `found`, with their sizes, but for which a smooth curve goes through all around.

    Those within each other's reach are weighed as one; where no curve goes through, as fewer.
    """
    sized: list[Leap] = []
    while True:
        left: list[Leap] = []
        for some in _clusters(found, reach):
            joint = _joint(rows, values, some, reach)
            if joint is None or joint.rms > _AGREE * noise:
                left += some
                continue
            sure = zip(joint.leaps, _SURE * noise * joint.sds, strict=True)
            sized += [leap for leap, least in sure if abs(leap.size) > least]
        reach //= 2
        if not left or reach < _SPEED:
            break
        found = left
    return _without_those_away(sorted(sized, key=lambda leap: leap.before))


def _clusters(found: list[Leap], reach: int) -> list[list[Leap]]:
    some: list[list[Leap]] = []
    for leap in found:
        if some and leap.before - some[-1][-1].after < reach:
            some[-1].append(leap)
        else:
            some.append([leap])
    return some


def _joint(rows: FloatArray, values: FloatArray, some: list[Leap], reach: int) -> _Joint | None:
    """The leaps beside a cubic through `reach` rows on both sides, with a degree more for each between."""
    first, end = max(0, some[0].before - reach + 1), min(len(values), some[-1].after + reach)
    around = np.arange(first, end)
    span = float(rows[end - 1] - rows[first])
    if span > 2.0 * len(around):
        return None
    kept: BoolArray = np.ones(len(around), dtype=np.bool_)
    for leap in some:
        kept &= (around <= leap.before) | (around >= leap.after)
    away = 2.0 * (rows[around] - rows[first]) / span - 1.0
    degree = 3 + max(0, some[-1].before - some[0].after) // reach
    columns = [
        np.polynomial.chebyshev.chebvander(away, degree),
        *((around >= leap.after)[:, None] for leap in some),
    ]
    design = np.column_stack(columns)[kept]
    if len(design) < 2 * design.shape[1]:
        return None
    level = values[around][kept] - values[first]
    factors, _, rank, _ = np.linalg.lstsq(design, level, rcond=None)
    if rank < design.shape[1]:
        return None
    # An angle that rests on a count for many rows says in all of them no more than in one.
    told = 1 + int(np.count_nonzero(np.diff(level)))
    spread = np.sqrt(np.diag(np.linalg.inv(design.T @ design)) * len(level) / told)
    squares = float(np.sum((level - design @ factors) ** 2))
    rms = math.sqrt(squares / (len(design) - design.shape[1]))
    goes_on = values[first] + np.column_stack(columns) @ factors
    sized = [
        Leap(leap.before, leap.after, float(size), goes_on[leap.before + 1 - first : leap.after - first])
        for leap, size in zip(some, factors[-len(some) :], strict=True)
    ]
    return _Joint(sized, spread[-len(some) :], rms)


def _without_those_away(leaps: list[Leap]) -> list[Leap]:
    """Leaps but for those that others close by take back: there the angle was away."""
    kept: list[Leap] = []
    at: IntArray = np.array([leap.before for leap in leaps], dtype=np.intp)
    for some in groups(at, _LONGEST):
        here = [leaps[int(np.searchsorted(at, row))] for row in some]
        sizes = np.array([leap.size for leap in here])
        if len(here) == 1 or abs(float(sizes.sum())) > _BACK * float(np.abs(sizes).max()):
            kept += here
    return kept
