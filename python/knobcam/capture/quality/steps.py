"""Rows that a log repeats or loses, an angle that wraps: found by the angle's steps from row to row."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray, chosen, groups
from ...base.said import Advice, said
from ..finding import Finding, Rows, rows_in_words, spans
from ..formats.units import Coordinate
from .asked import CLEAR, FAR, REACH, Steady, check_asked
from .missed import check_missed
from .order import medians, quantile
from .wild import wild

_AWAY = 100  # rows for which an angle can be away
_BACK = 0.2  # of the leaps, within which it is back where it went on to
_LEAP = 5.0  # times the longest steps but for one in a thousand
_RARE = 0.1  # of the rows that repeat, those that chance would make
_ALONE = 0.5  # of the leap there and back, that the steps beside it may be off
_COUNTS = 1.5  # of an encoder, beyond which a step is not what its neighbours let expect
_FAST = 1.25  # counts a row, from which each row has another
_THROUGH = 0.8  # of its range, that an angle leaps through where a register wraps
_LEAPS = 2  # through all of it, that tell how wide the register is
_SPAN = 10  # rows, over which the way that a velocity tells of is compared with the angle
_OTHER = 0.2  # of the angle's way, that is left beside that of a velocity that is another one
_FEW = 3  # rows that repeat, fewer than which tell nothing unless the angle itself does


@dataclass(frozen=True)
class Steps:
    """What the angle's steps tell: times and angles as mended, rows that cannot be used, and the findings."""

    t: FloatArray
    theta: FloatArray
    bad: BoolArray
    findings: tuple[Finding, ...]


def check_steps(
    columns: dict[str, FloatArray],
    usable: BoolArray,
    rows: Rows,
    coordinate: Coordinate,
    rate_hz: float,
    overruled: Collection[str] = (),
) -> Steps:
    """Look at the step of the angle into each usable row: too short, too long, or there and back.

    Of the columns t, theta, tau and, where there, omega and alpha only the first two are ever mended: an
    angle that jumps by whole turns goes on where it was, a clock that counted on over lost rows is moved.
    Nothing is done about a finding whose key is `overruled`.
    """
    t, theta = columns["t"], columns["theta"]
    index = np.flatnonzero(usable)
    if len(index) < 4 * REACH:
        return Steps(t, theta, np.zeros(len(rows), dtype=np.bool_), ())
    bad = {
        kind: np.zeros(len(rows), dtype=np.bool_) for kind in ("missed", "stale", "spike", "jump", "asked")
    }
    findings: list[Finding] = []
    # Where wild readings are a habit of the log they lie beside each other, and hide what else there is.
    angle = chosen(theta, index)
    anything = wild(chosen(t, index), angle, 0.3 * _count(np.diff(angle)))
    bad["spike"][index[anything]] = True
    index = index[~anything]
    if coordinate == "rotary":
        unwrapped, found = _unwrap(t, theta, index, rows)
        theta = theta if "wrap:theta" in overruled else unwrapped
        findings += found
    missed = check_missed(columns, theta, index, rows, rate_hz, _count(np.diff(chosen(theta, index))))
    findings += missed.findings
    if "missed:theta" not in overruled:
        theta = missed.theta
        bad["missed"] = missed.bad
        index = index[~missed.bad[index]]
    angle, interval = chosen(theta, index), np.diff(chosen(t, index))
    step = np.diff(angle)
    least = _count(step)
    expected, doubt, spread = _expected(step, interval, least)
    noise = max(spread, 0.5 * least)
    sure = np.abs(expected) > 0.5 * CLEAR * noise
    if (told := _by_velocity(columns, theta, index, rate_hz)) is not None:
        # Of a leap where the angle itself is too slow to say so, or turns; a velocity may be late.
        way, error = told
        leaps = np.abs(step - way) > np.maximum(CLEAR * noise, FAR * np.abs(way))
        better = ~sure & leaps & (np.abs(way) > 0.5 * CLEAR * error)
        expected, doubt = np.where(better, way, expected), np.where(better, error, doubt)
        sure |= better
    off = np.abs(step - expected)
    # An angle in counts is off by one at most, and a step that is expected by another quarter.
    short = off > (_COUNTS * least if spread < 0.5 * least else CLEAR * noise)
    clear = sure & (off > np.maximum(CLEAR * noise, 0.5 * np.abs(expected)))

    stale = _stale(columns, index, step, least, short & (off > 0.5 * np.abs(expected)))
    if not (stale.any() or bad["spike"].any() or (off > CLEAR * noise).any()):  # nothing of what follows
        return _told(t, theta, bad, findings, overruled)
    bad["stale"][index[1:][stale]] = True
    if stale.any():
        at = rows[index[1:][stale]]
        words = said(
            "{count} rows repeat the row before them while the knob moves ({rows}): they were not measured",
            count=len(at),
            rows=rows_in_words(at),
        )
        findings.append(Finding("stale", "theta", len(at), spans(at), words, "masked"))

    spike = _there_and_back(step - expected, CLEAR * noise) & ~stale[:-1] & ~stale[1:]
    bad["spike"][index[1:-1][spike]] = True
    # A leap that stays is beyond all steps of the motion; so wide a gap is not bridged.
    longest = _LEAP * quantile(np.abs(step), 0.999)
    leap = ~stale & (off > CLEAR * noise) & (off > longest)
    in_time = interval < 1.5 / rate_hz
    leap &= in_time & (np.diff(index) == 1)  # else time passed
    if coordinate == "rotary":  # what is near a whole turn may be an angle that wraps around
        part = np.abs(step - math.tau * np.rint(step / math.tau))
        leap &= (np.abs(step) <= math.pi) | (part > longest)
    leap &= ~(np.append(spike, False) | np.append(False, spike))
    away = _away(angle, np.flatnonzero(leap))
    bad["spike"][index[away]] = True
    leap &= ~(away[1:] | away[:-1])
    findings += _leapt_away(rows, bad["spike"] & usable & ~bad["stale"])
    if leap.any() and leap.sum() <= len(step) // 1000 + 1:
        at = np.flatnonzero(leap)
        for row in (-2, -1, 0, 1):
            bad["jump"][index[np.clip(1 + at + row, 0, len(index) - 1)]] = True
        leapt = rows[index[1:][at]]
        what = said(
            "{theta}: leaps by {by:.4g} at {rows} and goes on from there",
            by=step[at[0]],
            rows=rows_in_words(leapt),
        )
        apart = "positions of one part are not those of the other"
        if len(at) == 1:
            shorter = min(index[: at[0] + 1], index[at[0] + 1 :], key=len)
            bad["jump"][shorter] = True
            words = said(
                "{what}, as where two logs were joined: {apart}, so the shorter one, {count} rows, is left "
                "out",
                what=what,
                apart=apart,
                count=len(shorter),
            )
            out, advice = rows[shorter], Advice("--start and --end choose the other", "parts")
            findings.append(Finding("jump", "theta", len(out), spans(out), words, "masked", advice))
        else:
            words = said(
                "{what}; what lies before and after is filtered apart, but {apart}", what=what, apart=apart
            )
            advice = Advice("keep one with --start and --end if the log was joined", "parts")
            findings.append(Finding("jump", "theta", len(leapt), spans(leapt), words, "warning", advice))
        clear &= ~leap

    # What a repeated row held back comes with the next one.
    follows = np.concatenate(([False], (stale | np.concatenate((spike, [False])))[:-1]))
    kept = ~follows & in_time  # else the clock says so itself
    asked = check_asked(Steady(step, expected, doubt, noise, clear & kept, clear, stale), rows, index)
    bad["asked"][index[1:][asked.amiss]] = True
    findings += asked.findings
    if asked.findings and asked.findings[0].key not in overruled:
        t = t + asked.late(len(t)) / rate_hz
    return _told(t, theta, bad, findings, overruled)


def _told(
    t: FloatArray,
    theta: FloatArray,
    bad: dict[str, BoolArray],
    findings: list[Finding],
    overruled: Collection[str],
) -> Steps:
    """What is told of all, without the rows that are bad for a reason that nobody overruled."""
    masked = np.zeros(len(t), dtype=np.bool_)
    for kind, off_it in bad.items():
        masked |= off_it & (f"{kind}:theta" not in overruled)
    return Steps(t, theta, masked, tuple(findings))


def _leapt_away(rows: Rows, off: BoolArray) -> list[Finding]:
    """Say at which of the rows that are `off` the angle is away for a while."""
    if not off.any():
        return []
    at = rows[off]
    lasting = "a row" if (np.diff(at) > 1).all() else "a row or a few"
    words = said(
        "{theta}: leaps away and back within {lasting} at {rows}", lasting=lasting, rows=rows_in_words(at)
    )
    return [Finding("spike", "theta", len(at), spans(at), words, "masked")]


def _away(theta: FloatArray, leaps: NDArray[np.intp]) -> BoolArray:
    """Which samples lie between leaps (each from that sample to the next) after which the angle is back."""
    away = np.zeros(len(theta), dtype=np.bool_)
    for group in groups(leaps, _AWAY):
        if len(group) < 2:
            continue
        first, last = int(group[0]), int(group[-1])
        before, after = max(0, first - REACH), min(len(theta) - 1, last + 1 + REACH)
        speeds = (
            (theta[first] - theta[before]) / max(1, first - before),
            (theta[after] - theta[last + 1]) / REACH,
        )
        went = theta[last + 1] - theta[first] - 0.5 * sum(speeds) * (last + 1 - first)
        if abs(went) < _BACK * float(np.abs(theta[group + 1] - theta[group]).min()):
            away[first + 1 : last + 1] = True
    return away


def _unwrap(
    t: FloatArray, theta: FloatArray, index: NDArray[np.intp], rows: Rows
) -> tuple[FloatArray, list[Finding]]:
    """Return an angle without what it jumps by where it wraps: whole turns, or the range of a register."""
    jump = np.diff(chosen(theta, index))
    turns = np.rint(jump / math.tau)
    usual = np.abs(jump[turns == 0.0])
    # A knob that turns half a turn from row to row cannot be told from one that wraps.
    most = float(usual.max()) if usual.size else math.inf
    wraps = (turns != 0.0) & (np.abs(jump - math.tau * turns) <= 2.0 * most)
    by = math.tau * turns
    what = said("jumps by whole turns")
    if (found := _register(chosen(t, index), chosen(theta, index), jump)) is not None:
        wraps, size = found
        most, by = 0.0, size * np.sign(jump)
        what = said("jumps by {size:.5g}, from one end of its range to the other,", size=size)
    if not wraps.any() or most > 0.25 * math.pi or wraps.sum() > len(index) // 10:
        return theta, []
    at = rows[index[1:][wraps]]
    theta = theta.copy()
    theta[index[1:]] -= np.cumsum(np.where(wraps, by, 0.0))
    words = said(
        "{theta}: {what} at {rows}, where it wraps; it is taken on from there",
        what=what,
        rows=rows_in_words(at),
    )
    return theta, [Finding("wrap", "theta", len(at), spans(at), words, "mended")]


def _register(t: FloatArray, theta: FloatArray, jump: FloatArray) -> tuple[BoolArray, float] | None:
    """Return where an angle leaps through all its range, as a register of ±12.5 rad does, and by how much.

    By whole turns it would be 0.13 rad off behind each. None where these leaps are none, or whole turns.
    """
    low, high = float(theta.min()), float(theta.max())
    wraps = np.abs(jump) > _THROUGH * (high - low)
    if wraps.sum() < _LEAPS or wraps[0] or wraps[-1] or (wraps[1:] & wraps[:-1]).any():
        return None
    most = float(np.abs(jump[~wraps]).max())
    at = np.flatnonzero(wraps)
    ends = np.sort(np.stack([theta[at], theta[at + 1]]), axis=0)
    if (ends[0] > low + 2.0 * most).any() or (ends[1] < high - 2.0 * most).any():
        return None
    speed = jump / np.diff(t)
    leaps = np.abs(jump[at] - 0.5 * (speed[at - 1] + speed[at + 1]) * np.diff(t)[at])
    size = float(np.median(leaps))
    error = float(np.abs(leaps - size).max())
    if error > most or abs(size - math.tau * np.rint(size / math.tau)) <= 2.0 * error:
        return None
    return wraps, size


def _expected(step: FloatArray, dt: FloatArray, least: float) -> tuple[FloatArray, FloatArray, float]:
    """The step into each row that its neighbours let expect, its doubt, and how far steps are from it.

    By the speed of a few of them; where the step is another, by the median speeds of those before and after,
    and where these two are not nearly the same, nothing is expected: zero. Stamps that jitter say little
    about when a row was sampled: a step is expected by its own interval or by the usual one, whichever it is
    nearer to.
    """
    usual = quantile(dt, 0.5)
    speed = step / dt
    near = np.pad(speed, 4, mode="edge")
    count = len(step)
    expected = 0.25 * dt * sum(near[4 + k : 4 + k + count] for k in (-4, -3, 3, 4))
    off = np.abs(step - expected)
    # Half the values lie within 0.6745 deviations of noise; the mean of four adds a quarter to its variance.
    spread = quantile(off, 0.5) / 0.6745 / math.sqrt(1.25)
    doubtful = np.flatnonzero(off > 3.0 * max(spread, 0.5 * least))
    # The nearest on either side may belong to the same fault.
    reach = np.arange(2, REACH + 1)
    sides = [speed[np.clip(doubtful[:, None] + side * reach, 0, count - 1)] for side in (-1, 1)]
    before, after = (medians(side) for side in sides)
    steady = (before * after > 0.0) & (np.abs(before - after) < np.abs(before + after) / 3.0)
    speed = np.where(steady, 0.5 * (before + after), 0.0)
    doubt = np.zeros(count)
    doubt[doubtful] = np.where(steady, 0.5 * np.abs(before - after), 0.0) * usual
    own, even = speed * dt[doubtful], speed * usual
    nearer = np.abs(step[doubtful] - own) < np.abs(step[doubtful] - even)
    expected[doubtful] = np.where(nearer, own, even)
    return expected, doubt, spread


def _by_velocity(
    columns: dict[str, FloatArray], theta: FloatArray, index: NDArray[np.intp], rate_hz: float
) -> tuple[FloatArray, float] | None:
    """The step into each row that a measured velocity lets expect, and its noise; None of any other one."""
    if "omega" not in columns:
        return None
    omega, angle = chosen(columns["omega"], index), chosen(theta, index)
    way = 0.5 * (omega[1:] + omega[:-1]) / rate_hz
    rest = angle - np.append(0.0, np.cumsum(way))
    went, off = (np.abs(values[_SPAN:] - values[:-_SPAN]) for values in (angle, rest))
    if not quantile(off, 0.5) < _OTHER * quantile(went, 0.5):
        return None
    # A velocity that is late, or filtered, is off by as much as that makes of the way.
    return way, quantile(off, 0.5) / 0.6745 / _SPAN


def _count(step: FloatArray) -> float:
    """The least step there is: a count of an encoder, or next to nothing."""
    steps = np.abs(step[step != 0.0])
    return float(steps.min()) if steps.size else 0.0


def _stale(
    columns: dict[str, FloatArray],
    index: NDArray[np.intp],
    step: FloatArray,
    least: float,
    clear: BoolArray,
) -> BoolArray:
    """Which rows repeat all of the row before, and cannot have measured it.

    An angle in counts repeats by itself; then it is the torque beside it that never would.
    """
    others = [values for name, values in columns.items() if name not in ("t", "theta")]
    same = [step == 0.0]
    for values in others:
        if not np.logical_and.reduce(same).any():
            return np.zeros(len(step), dtype=np.bool_)
        same.append(np.diff(chosen(values, index)) == 0.0)
    repeats: BoolArray = np.logical_and.reduce(same)
    if not repeats.any():
        return repeats
    # At rest, with its motor off, a knob repeats all that it says.
    theta = chosen(columns["theta"], index)
    row = np.arange(1, len(theta))
    wide = theta[np.minimum(row + REACH, len(theta) - 1)] - theta[np.maximum(row - REACH, 0)]
    fast = np.abs(wide) >= 2.0 * _FAST * REACH * least
    # A count is passed in less than a row there, and the angle never stands by itself.
    told: BoolArray = np.logical_and(repeats, clear)
    for moving in (fast, ~fast & (np.abs(wide) >= 2.0 * least)):
        # Columns that repeat by chance, each as often as where another does not, do so together this often.
        alone = [
            (np.sum(one & ~repeats & moving) + 1.0)
            / (np.sum(moving & ~np.delete(same, k, axis=0).all(axis=0)) + 1.0)
            for k, one in enumerate(same)
        ]
        by_chance = moving.sum() * float(np.prod(alone))
        found = repeats & moving
        if found.sum() >= _FEW and by_chance < _RARE * found.sum():
            told |= found
    return told


def _there_and_back(off: FloatArray, clear: float) -> BoolArray:
    """Which rows the angle leaps to and away from again: two steps off by as much the other way.

    A blow that a knob is dealt makes steps that are off as well; others on either side are off with them.
    """
    first, second = off[:-1], off[1:]
    leap = np.minimum(np.abs(first), np.abs(second))
    beside = np.maximum(np.abs(np.append(0.0, off[:-2])), np.abs(np.append(off[2:], 0.0)))
    found: BoolArray = (leap > clear) & (beside < _ALONE * leap)
    return found & (np.abs(first + second) < 0.2 * np.abs(first - second))
