"""Time stamps: duplicate, backward, missing, uneven, implausible."""

from __future__ import annotations

import math
from bisect import bisect_left

import numpy as np

from ...base.arrays import BoolArray, FloatArray, chosen
from ...base.said import Advice, said
from ...errors import InputError
from ..finding import Finding, Rows, rows_in_words, spans
from .order import quantile

JITTER_TOLERANCE = 0.05
"""An interval this far from the usual one (relative) is uneven."""

EVEN_SHARE = 0.9
"""With this share of intervals inside the tolerance, the clock counts as even."""

PLAUSIBLE_RATE_HZ = (10.0, 1e6)
"""Sampling rates outside are more often a unit mistaken than a rig."""

_RUN = 50  # stamps that rise before a clock begins anew, and after it
_TICKING = 0.3  # of the stamps that repeat, above which a clock is slower than the rows
_TICKS = 100  # of a clock: fewer leave the rate unsure by more than a percent
_WITHIN = 1.5  # ticks between the stamps of such a clock and evenly spaced rows, if no row is missing
_NEW = 0.5  # of the rows under a repeated stamp that have to say something new
_SNAP = 1e-9  # a rate this close (relative) to a whole number of Hz was one before it went through text


def check_times(t: FloatArray, rows: Rows, source: str) -> tuple[BoolArray, list[Finding], float]:
    """Return which stamps are usable (finite, strictly rising), the findings, and the rate in Hz.

    `t` in s, shape (samples,); `rows` the data row of each sample. Raises InputError when time stands still.
    """
    usable, findings = _rising(t, rows)
    index = np.flatnonzero(usable)
    if len(index) < 2:
        raise InputError(
            f"{source}: column t does not advance: fewer than 2 usable time stamps; map another column, "
            f"or leave t out and give the sampling rate"
        )
    interval = np.diff(chosen(t, index))
    stride = np.diff(index)  # rows from one usable stamp to the next: masked rows are no gap
    usual = quantile(interval, 0.5)
    ratio = interval / usual
    even = bool(np.mean(np.abs(ratio - 1.0) <= JITTER_TOLERANCE) >= EVEN_SHARE)
    gap = ratio > stride * (1.5 if even else 3.0)
    steps = np.rint(ratio) if even else stride.astype(np.float64)
    rate = float(np.sum(steps[~gap]) / np.sum(interval[~gap]))
    if not (np.isfinite(interval).all() and np.isfinite(ratio).all() and math.isfinite(rate)):
        raise InputError(f"{source}: column t spans more than a float64 can hold; check its unit in the map")
    if abs(rate - round(rate)) <= _SNAP * rate:
        rate = float(round(rate))

    if gap.any():
        before = rows[index[:-1][gap]]
        missing = int(np.sum(np.maximum(np.rint(ratio[gap]) - stride[gap], 1.0)))
        findings.append(
            Finding(
                "gap",
                "t",
                missing,
                spans(before),
                said(
                    "{t}: about {missing} samples are missing after {rows}; nothing is filled in",
                    missing=missing,
                    rows=rows_in_words(before),
                ),
                "warning",
            )
        )
    off = ~gap & (np.abs(ratio / stride - 1.0) > JITTER_TOLERANCE)
    if off.any() and not any(finding.kind in ("duplicate", "backward") for finding in findings):
        late = rows[index[1:][off]]
        share = np.mean(off)
        low, high = 1e3 * interval[~gap].min(), 1e3 * interval[~gap].max()
        findings.append(
            Finding(
                "jitter",
                "t",
                int(off.sum()),
                spans(late),
                said(
                    "{t}: sampling is uneven: intervals from {low:.4g} to {high:.4g} ms, usually {usual:.4g} "
                    "ms; {share:.1%} of them are off by more than {tolerance:.0%} ({rows}); the stamps are "
                    "used as they are",
                    low=low,
                    high=high,
                    usual=1e3 * usual,
                    share=share,
                    tolerance=JITTER_TOLERANCE,
                    rows=rows_in_words(late),
                ),
                "note",
            )
        )
    findings += _implausible(rate)
    return usable, findings, rate


def run_on(t: FloatArray, rows: Rows) -> tuple[FloatArray, list[Finding]]:
    """Return a clock that goes on where it began anew, one usual interval after the stamp before, and say so.

    `t` in s, shape (samples,). A stamp or two out of order are no new beginning: before it the clock rose, to
    more than what it rises through afterwards begins with.
    """
    index = np.flatnonzero(np.isfinite(t))
    step = np.diff(chosen(t, index))
    fallen = np.flatnonzero(step < 0.0)
    begins = [
        at
        for at in fallen.tolist()
        if at + 1 >= _RUN
        and at + _RUN < len(step)
        and (step[at + 1 - _RUN : at] >= 0.0).all()
        and (step[at + 1 : at + _RUN] >= 0.0).all()
        and t[index[at + 1]] < t[index[at + 1 - _RUN]]
    ]
    if not begins:
        return t, []
    usual = quantile(step[step > 0.0], 0.5)
    shift = np.zeros(len(t))
    shift[index[np.array(begins) + 1]] = usual - step[begins]
    at = rows[index[np.array(begins) + 1]]
    found = said(
        "{t}: the clock begins anew at {rows}; it is taken on from there, as if no row was lost",
        rows=rows_in_words(at),
    )
    return t + np.cumsum(shift), [Finding("restart", "t", len(at), spans(at), found, "mended")]


def spread(t: FloatArray, others: list[FloatArray], rows: Rows) -> tuple[FloatArray, list[Finding]]:
    """Return the stamps of a clock that ticks more slowly than rows come, spread evenly, and say so.

    `t` in s and the `others`, the measured columns, shape (samples,) each. Only where the rows are even, none
    is missing, and those under one stamp are not the same row again.
    """
    step = np.diff(t)
    repeats = step == 0.0
    # Few ticks do not tell how fast the rows come.
    if not (step >= 0.0).all() or not np.mean(repeats) > _TICKING or np.sum(~repeats) < _TICKS:
        return t, []
    anew = np.any([np.diff(values)[repeats] != 0.0 for values in others], axis=0)
    tick = quantile(step[~repeats], 0.5)
    count = np.arange(len(t), dtype=np.float64)
    off = count - count.mean()
    even = t.mean() + float(off @ (t - t.mean())) / float(off @ off) * off
    if not np.mean(anew) > _NEW or np.ptp(t - even) > _WITHIN * tick:
        return t, []
    many = int(repeats.sum())
    found = said(
        "{t}: {many} samples repeat the time stamp before them: the clock ticks every {tick:.4g} ms, and the "
        "rows between come evenly; their stamps are spread evenly",
        many=many,
        tick=1e3 * tick,
    )
    return even, [Finding("duplicate", "t", many, spans(rows[1:][repeats]), found, "mended")]


def _rising(t: FloatArray, rows: Rows) -> tuple[BoolArray, list[Finding]]:
    """Return the largest set of samples whose stamps rise strictly, and what is wrong with the others."""
    usable = np.isfinite(t)
    findings = []
    index = np.flatnonzero(usable)
    step = np.diff(chosen(t, index))
    duplicate = index[1:][step == 0.0]
    if duplicate.size:
        usable[duplicate] = False
        findings.append(
            Finding(
                "duplicate",
                "t",
                len(duplicate),
                spans(rows[duplicate]),
                said(
                    "{t}: {count} samples repeat the time stamp before them ({rows})",
                    count=len(duplicate),
                    rows=rows_in_words(rows[duplicate]),
                ),
                "masked",
                Advice(
                    "if the stamps are merely rounded, leave t out of the map and give the sampling rate",
                    "command",
                ),
            )
        )
    if np.any(step < 0.0):
        index = np.flatnonzero(usable)
        kept = index[_longest_rise(chosen(t, index))]
        backward = np.setdiff1d(index, kept, assume_unique=True)
        usable[backward] = False
        findings.append(
            Finding(
                "backward",
                "t",
                len(backward),
                spans(rows[backward]),
                said(
                    "{t}: {count} samples have stamps out of order ({rows})",
                    count=len(backward),
                    rows=rows_in_words(rows[backward]),
                ),
                "masked",
            )
        )
    return usable, findings


def _longest_rise(values: FloatArray) -> list[int]:
    """Return the positions of a longest strictly rising subsequence (Fredman 1975, patience sorting).

    A single stamp that leaps ahead costs one sample this way, not all those after it.
    """
    tails: list[float] = []
    ends: list[int] = []
    previous = [-1] * len(values)
    for position, value in enumerate(values.tolist()):
        pile = bisect_left(tails, value)
        previous[position] = ends[pile - 1] if pile else -1
        tails[pile : pile + 1] = [value]
        ends[pile : pile + 1] = [position]
    chain = []
    position = ends[-1]
    while position >= 0:
        chain.append(position)
        position = previous[position]
    return chain[::-1]


def _implausible(rate: float) -> list[Finding]:
    slowest, fastest = PLAUSIBLE_RATE_HZ
    if slowest <= rate <= fastest:
        return []
    unit = (
        "ms or us, map t=... [ms]" if rate < slowest else "min or h, or the counter of a clock, map its unit"
    )
    found = said("{t}: a sampling rate of {rate:.4g} Hz is unusual", rate=rate)
    return [Finding("rate", "t", 1, (), found, "note", Advice(f"if t is in {unit}", "unit"))]
