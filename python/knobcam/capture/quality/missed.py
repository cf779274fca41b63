"""Counts that an encoder missed: from there on the angle is behind by them, and the motion goes on."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, chosen, groups
from ...base.said import said
from ..finding import Finding, Rows, rows_in_words, spans
from .asked import MOST_LOST, REACH
from .order import deviation, quantile
from .stands import Leap, holes, together

_REACH = (8, 16, 32)  # rows to either side through which one cubic goes; those that tell a leap best
_FEWEST = 400  # rows
_EVERY = 4  # of them, of which one tells what is usual
_SURE = 8.0  # deviations of the leaps that are seen where there are none
_COUNTS = 2.5  # of an encoder, below which a leap is how it counts
_ROUNDED = 0.3  # counts that an angle in counts is off by, a deviation
_NOISE = 5.0  # deviations of the angle's noise that a leap is at least
_AGREE = 1.6  # times the noise that the cubic through both sides may leave
_NEARLY = 1.2  # times the least that any rows in which counts are missed leave
_PLAIN = 30.0  # noise variances more that are left by a cubic with a bend in the leap's place
_BESIDE = 3  # rows by which a leap may be elsewhere than where it seems largest
_LONGEST = (64, 160)  # rows in which counts are missed: by the angle alone, and beside a velocity
_SPAN = 10  # rows, over which the way that the velocity tells of is compared with the angle
_TOLD = 0.3  # of the angle's way, that may be left beside it
_IMPULSE = 10.0  # times the acceleration of the rest that the leap would have taken as a motion
_OWN = 0.3  # of a leap, by which a velocity that goes on as before may be off meanwhile
_SMALL = 0.02  # of the way from end to end: two logs that were joined are farther apart
_PLACES = 100  # beyond which the motion is like that
_STEPS = 0.25  # of one: a leap ahead that is nearer to a whole number of steps may be rows that are missing
_ROUNDS = 4


@dataclass(frozen=True)
class Missed:
    """The angle as mended, the rows in which it was between the two, and the findings."""

    theta: FloatArray
    bad: BoolArray
    findings: tuple[Finding, ...]


def check_missed(
    columns: dict[str, FloatArray],
    theta: FloatArray,
    index: IntArray,
    rows: Rows,
    rate_hz: float,
    least: float,
) -> Missed:
    """Return the angle of the samples `index` with the counts that its encoder missed put back.

    The angle leaps, at once or while it stands for a few rows, and one cubic goes through what is before and
    after it but for that; a knob that did so would have taken far more acceleration than it ever has. Where a
    velocity is measured it is looked for in what the angle has beside that, and the velocity says how the
    knob went on meanwhile; an angle alone says by itself where it stands or steps aside (`stands`), and leaps
    that lie close by each other are weighed together. `least` is a count. What is wide, what is a bend of the
    motion, and a leap ahead by a whole number of steps, as where rows are missing, are other things.
    """
    bad = np.zeros(len(theta), dtype=np.bool_)
    t, told = chosen(columns["t"], index), _told(columns, theta, index)
    rest = chosen(theta, index) - told
    leaps: list[Leap] = []
    for _ in range(_ROUNDS):
        found = _leaps(t, rest, told, rate_hz, least)
        if not found:
            break
        leaps += found
        for leap in found:
            if leap.between.size:
                rest[leap.before + 1 : leap.after] = leap.between
        for leap in found:
            rest[leap.after :] -= leap.size
    if not leaps:
        return Missed(theta, bad, ())
    shift = np.zeros(len(theta))
    shift[index[[leap.after for leap in leaps]]] = [leap.size for leap in leaps]
    theta = theta - np.cumsum(shift)
    for leap in leaps:
        between = np.arange(leap.before + 1, leap.after)
        if told.any():
            ends = [leap.before, leap.after]
            theta[index[between]] = told[between] + np.interp(between, ends, rest[ends])
        else:
            bad[index[between]] = True
    at = rows[index[np.unique([leap.after for leap in leaps])]]
    sizes = np.abs([leap.size for leap in leaps])
    words = said(
        "{theta}: leaps by {least:.3g} to {most:.3g} at {rows} in the midst of a smooth motion that goes on, "
        "as where an encoder misses counts; they are put back",
        least=sizes.min(),
        most=sizes.max(),
        rows=rows_in_words(at),
    )
    return Missed(theta, bad, (Finding("missed", "theta", len(at), spans(at), words, "mended"),))


def _told(columns: dict[str, FloatArray], theta: FloatArray, index: IntArray) -> FloatArray:
    """Return the way that a measured velocity tells of, where it is that of the angle; else nothing."""
    nothing = np.zeros(len(index))
    if "omega" not in columns or len(index) < _FEWEST:
        return nothing
    omega, dt = chosen(columns["omega"], index), np.diff(chosen(columns["t"], index))
    told = np.concatenate(([0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * dt)))

    def goes(values: FloatArray) -> float:
        return quantile(np.abs(values[_SPAN:] - values[:-_SPAN]), 0.9)

    way = chosen(theta, index)
    return told if goes(way - told) < _TOLD * goes(way) else nothing


def _leaps(t: FloatArray, rest: FloatArray, told: FloatArray, rate_hz: float, least: float) -> list[Leap]:
    """Return the leaps of `rest` that stand alone; none where it is full of what is like them.

    The angle is `rest` and `told`, the way that the velocity tells of.
    """
    step = 1.0 / rate_hz
    if len(t) < _FEWEST or (t[-1] - t[0]) * rate_hz > 2.0 * len(t):
        return []
    # On an even clock: where stamps are missing, or jitter, a step is none.
    even = t[0] + step * np.arange(round((t[-1] - t[0]) * rate_hz) + 1)
    values = np.interp(even, t, rest)
    seen = min((_seen(values, reach) for reach in _REACH), key=lambda seen: seen.spread)
    noise = max(_noise(values), _ROUNDED * least)
    surely = max(_SURE * seen.spread, _COUNTS * least, _NOISE * noise)
    peaks, beside = _peaks(np.abs(seen.size), surely, seen.reach), told.any()
    if beside and not len(peaks):
        return []
    theta, longest = rest + told, _LONGEST[int(beside)]
    swiftest = _swiftest(values, seen.reach)
    widest = _SMALL * float(np.ptp(theta))

    def counted(leap: Leap) -> Leap:
        return replace(leap, size=round(leap.size / least) * least) if least > noise else leap

    if not beside:
        plain = together(t * rate_hz, theta, holes(theta, noise, least, surely), seen.reach, noise)
        if plain := [
            counted(leap)
            for leap in plain
            if surely <= abs(leap.size) <= widest
            and _impulse(theta, leap, surely) > _IMPULSE * swiftest
            and not _rows_ahead(theta, leap, seen.reach, surely)
        ]:
            return plain
    if len(peaks) > _PLACES:
        return []
    found, unlike, last = [], 0, -1
    for place in np.searchsorted(t, even[peaks]).tolist():
        leap = _fitted(t * rate_hz, rest, place, seen.reach, noise, longest)
        if leap is None:
            unlike += 1
            continue
        if abs(leap.size) < surely or leap.before <= last:
            continue
        if beside:
            own = abs(_beside_the_way(theta, told, leap, seen.reach) - leap.size) < _OWN * abs(leap.size)
            # Of logs that were joined the velocity leaps too.
            if own and leap.after - leap.before <= _BESIDE:
                own = _fitted(t * rate_hz, theta, leap.after, _REACH[1], noise, _BESIDE) is not None
        else:
            own = _impulse(theta, leap, surely) > _IMPULSE * swiftest
        if abs(leap.size) > widest or not own or _rows_ahead(theta, leap, seen.reach, surely):
            unlike += 1
            continue
        found.append(counted(leap))
        last = leap.after + seen.reach
    return found if unlike <= len(found) else []


class _Seen(NamedTuple):
    """How far the angle leaps from each row to the next, by a cubic through `reach` rows on both sides."""

    spread: float
    reach: int
    size: FloatArray


@cache
def _cubic(reach: int) -> FloatArray:
    """What the values of `reach` rows on both sides make of the factors of a cubic and of a leap between."""
    at = np.arange(-reach, reach) + 0.5
    columns = np.column_stack([np.vander(at / reach, 4, increasing=True), at > 0.0])
    return np.asarray(np.linalg.pinv(columns), dtype=np.float64)


def _seen(values: FloatArray, reach: int) -> _Seen:
    size = np.zeros(len(values))
    size[reach - 1 : len(values) - reach] = np.convolve(values, _cubic(reach)[4, ::-1], "valid")
    return _Seen(deviation(np.abs(size[::_EVERY])), reach, size)  # a few leaps among them do not matter


def _swiftest(values: FloatArray, reach: int) -> float:
    """The most acceleration but for one row in a hundred, rad a row squared."""
    bend = np.convolve(values, _cubic(reach)[2, ::-1], "valid") * 2.0 / reach**2
    return quantile(np.abs(bend), 0.99)


def _noise(values: FloatArray) -> float:
    """Deviation of white noise with such third differences, of which 20 times the variance is left."""
    third = np.abs(np.convolve(values, [-1.0, 3.0, -3.0, 1.0], "valid"))
    return deviation(third) / math.sqrt(20.0)


def _peaks(size: FloatArray, least: float, reach: int) -> IntArray:
    """Return where `size` exceeds `least` and is the most within `reach` rows."""
    around = groups(np.flatnonzero(size > least), reach)
    return np.array([rows[np.argmax(size[rows])] for rows in around], dtype=np.intp)


def _fitted(
    rows: FloatArray, theta: FloatArray, place: int, reach: int, noise: float, longest: int
) -> Leap | None:
    """Return the leap near `place` but for which a cubic goes through all rows around; None where none does.

    `rows` are the times, in rows. Where the cubic with a bend goes through them as well it is none either.
    """
    first, end = max(0, place - reach - longest), min(len(theta), place + reach + longest)
    around = np.arange(first, end)
    away = (rows[around] - rows[place]) / reach
    if np.diff(rows[around]).max() > 2.5:
        return None
    powers = np.vander(away, 4, increasing=True)
    level = theta[around] - theta[place]

    def left(kept: BoolArray, shape: FloatArray) -> tuple[float, float]:
        columns = np.column_stack([powers, shape])[kept]
        factors = np.linalg.lstsq(columns, level[kept], rcond=None)[0]
        return float(np.sum((level[kept] - columns @ factors) ** 2)), float(factors[-1])

    hole, enough = 1, longest
    fits: list[tuple[float, int, int, float]] = []
    while hole <= enough:
        tried, beside = [], max(_BESIDE, hole // 4)
        for before in range(place - hole // 2 - beside, place - hole // 2 + beside + 1, max(1, hole // 16)):
            kept = (np.abs(around - (before + 0.5 * hole)) <= reach + 0.5 * hole) & (
                (around <= before) | (around >= before + hole)
            )
            squares, size = left(kept, (around > before).astype(np.float64))
            tried.append((squares / max(1, kept.sum() - 5), hole, before, size))
        variance = min(tried)[0]
        if variance <= (_AGREE * noise) ** 2:
            # Rows at its ends may pass for a part of the motion yet.
            enough = enough if fits else min(longest, 2 * hole + _BESIDE)
            fits.append(min(tried))
        hole += max(1, hole // 8)
    if not fits:
        return None
    variance, hole, before, size = next(fit for fit in fits if fit[0] <= _NEARLY * min(fits)[0])
    kept = np.abs(around - (before + 0.5 * hole)) <= reach + 0.5 * hole
    bends = (np.maximum(0.0, away - bend) for bend in np.linspace(-0.6, 0.6, 13))
    bent = min(left(kept, shape)[0] for shape in bends)
    return Leap(before, before + hole, size) if bent > variance * kept.sum() + _PLAIN * noise**2 else None


def _impulse(theta: FloatArray, leap: Leap, unsure: float) -> float:
    """The acceleration that a leap would have taken as a motion, rad a row squared.

    To where it stands a motion stops, and goes on from there, in two rows.
    """
    rows = leap.after - leap.before
    stands = rows > 2 and float(np.ptp(theta[leap.before + 1 : leap.after])) < unsure
    return abs(leap.size) / rows / (2.0 if stands else 0.25 * rows)


def _beside_the_way(theta: FloatArray, told: FloatArray, leap: Leap, reach: int) -> float:
    """How far the angle goes in a leap beyond what the velocities before and after it let expect.

    Where it is a velocity that was wrong meanwhile that is nothing.
    """
    before, after = leap.before, leap.after
    first, end = max(0, before - reach), min(len(told) - 1, after + reach)
    speeds = (
        (told[before] - told[first]) / max(1, before - first),
        (told[end] - told[after]) / max(1, end - after),
    )
    return float(theta[after] - theta[before] - 0.5 * sum(speeds) * (after - before))


def _rows_ahead(theta: FloatArray, leap: Leap, reach: int, unsure: float) -> bool:
    """Whether the angle leaps ahead by a whole number of its steps, as where rows are missing.

    Where its speed is another one behind the leap, a whole number of steps is known to that much only.
    """
    before, after = leap.before, leap.after
    sides = (
        (theta[before] - theta[max(0, before - reach)]) / min(reach, before or 1),
        (theta[min(len(theta) - 1, after + reach)] - theta[after]) / reach,
    )
    step = 0.5 * sum(sides)
    if step == 0.0 or leap.size / step < 0.5:
        return False
    many = leap.size / step
    doubt = many * abs(sides[1] - sides[0]) / (2.0 * abs(step)) if many >= REACH else 0.0
    off = abs(many - round(many))
    return bool(round(many) <= MOST_LOST and off < max(_STEPS, 0.3 * unsure / abs(step), doubt))
