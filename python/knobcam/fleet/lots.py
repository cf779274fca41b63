"""What lots and stations tell: how capable a process is, whether it moved, what a lot has more of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import BoolArray, FloatArray
from ..base.optional import require
from ..fit.estimate import Z95
from .limits import Between
from .outliers import deviations
from .row import Row, counts

FEWEST = 5
"""Captures of a lot or of a station, for its mean to be compared."""
LEVEL = 0.01
"""Chance of saying of any lot or station of a table that it moved where none did."""
_USUAL = 4.0  # robust deviations from the middle up to which a value is usual
_TIED = 1e-9  # of the variance of all, below which a combination of parameters is the same in all parts
_NEAR = 2.0  # deviations, as the neighbours of one that is far away alone have: beside a step they have more
# Of the moving average: Montgomery, Introduction to Statistical Quality Control, 9.2.
_STEEP = 0.2
# Charts of normal values that are drawn to find how far the average goes by chance, and the longest of them:
# one that is longer has its band.
_DRAWS, _LONGEST = 2000, 2000


class Capable(NamedTuple):
    """How well a process stays within limits: Cp and Cpk with 95 % intervals; None with one limit only."""

    parameter: str
    lot: str
    captures: int
    mean: float
    deviation: float
    cp: tuple[float, float, float] | None
    cpk: tuple[float, float, float]


def capable(values: FloatArray, limits: Between, lot: str) -> Capable | None:
    """Return the capability of a lot's parameter; None of fewer than `FEWEST` values.

    The interval of Cp is that of the variance (chi-squared), that of Cpk Bissell's (1990) approximation.
    """
    some = values[np.isfinite(values)]
    n = len(some)
    if n < FEWEST:
        return None
    chi2 = require("scipy.stats", "intervals of Cp", "fleet").chi2
    mean, deviation = float(np.mean(some)), float(np.std(some, ddof=1)) or math.nan
    cp = None
    if math.isfinite(limits.low) and math.isfinite(limits.high):
        wide = (limits.high - limits.low) / (6.0 * deviation)
        low, high = (wide * math.sqrt(float(chi2.ppf(at, n - 1)) / (n - 1)) for at in (0.025, 0.975))
        cp = (wide, low, high)
    cpk = min(limits.high - mean, mean - limits.low) / (3.0 * deviation)
    half = Z95 * math.sqrt(1.0 / (9.0 * n) + cpk**2 / (2.0 * (n - 1)))
    return Capable(limits.name, lot, n, mean, deviation, cp, (cpk, cpk - half, cpk + half))


class Chart(NamedTuple):
    """A control chart: the exponentially weighted mean of a parameter, and where chance lets it be."""

    parameter: str
    values: FloatArray
    mean: FloatArray
    middle: float
    half: FloatArray

    @property
    def out(self) -> list[int]:
        """Where the mean is beyond chance."""
        return np.flatnonzero(np.abs(self.mean - self.middle) > self.half).tolist()


def chart(values: FloatArray, parameter: str, begun: int) -> Chart:
    """Return the EWMA chart of a parameter in the order in which captures were made.

    Its middle and width are those of the first `begun` values that are not far from the others: what a
    process was at first. Of one that stays there one chart in a hundred (`LEVEL`) has a point beyond the
    band, however few told what it was. A value that is far away alone, and not with its neighbours, moves no
    mean: one bad part is said as such, and is no drift.
    """
    first = usual(values[:begun])
    known = len(first) > 1
    middle, deviation = (np.mean(first), np.std(first, ddof=1)) if known else (math.nan, math.nan)
    course = np.where(_alone(np.abs(values - middle) / (deviation or math.nan)), np.nan, values)
    mean = _running(course[:, np.newaxis], np.array([middle]))[:, 0]
    half = (
        _wide(min(max(len(first), 2), _LONGEST), min(len(values), _LONGEST))
        * deviation
        * _spread(len(values))
    )
    return Chart(parameter, values, mean, float(middle), half)


def _alone(far: FloatArray) -> BoolArray:
    """Return which of some deviations are far from the middle while those on either side are near it."""
    near = np.concatenate([[True], ~(far > _NEAR), [True]])
    return np.asarray((far > _USUAL) & near[:-2] & near[2:])


def _running(values: FloatArray, middle: FloatArray) -> FloatArray:
    """Return the average of charts side by side, (values, charts), each from its middle on."""
    table = require("pandas", "control charts", "fleet").DataFrame(np.vstack([middle, values]))
    return np.asarray(table.ewm(alpha=_STEEP, adjust=False, ignore_na=True).mean())[1:]


def _spread(values: int) -> FloatArray:
    """Return the deviation of the average after 1, 2 ... values, in those of one value."""
    at = np.arange(1, values + 1)
    left = 1.0 - (1.0 - _STEEP) ** (2 * at)
    return np.asarray(np.sqrt(_STEEP / (2.0 - _STEEP) * left))


@cache
def _wide(begun: int, values: int) -> float:
    """Return how many deviations of its own a chart's average stays within, but for `LEVEL` of all charts.

    Drawn, not looked up: what a process was is known from `begun` values alone, and so is how much it varies.
    """
    drawn = np.random.default_rng(0).standard_normal((_DRAWS, values)).T
    middle, deviation = np.mean(drawn[:begun], axis=0), np.std(drawn[:begun], axis=0, ddof=1)
    off = np.abs(_running(drawn, middle) - middle)
    farthest = np.max(off / _spread(values)[:, np.newaxis], axis=0)
    return float(np.quantile(farthest / deviation, 1.0 - LEVEL))


class Shift(NamedTuple):
    """A lot, or a station, whose mean differs from that of all others beyond chance."""

    by: str
    name: str
    parameter: str
    percent: float
    ci95: tuple[float, float]
    p_value: float

    def __str__(self) -> str:
        low, high = self.ci95
        return (
            f"{self.by} {self.name}: {self.parameter} is {self.percent:+.1f} % ({low:+.1f} to {high:+.1f}) "
            "of the others'"
        )


def shifts(table: Any, names: Sequence[str], by: str) -> list[Shift]:
    """Return which lots or stations differ from the rest in what, the surest first.

    Welch's test without those far from their own middle, which are said one by one; Holm's correction over
    all that is compared. The surest is taken out of the rest that the others are compared with, one after the
    other: beside one that moved, those that did not would seem to have moved the other way.
    """
    holm = require("statsmodels.stats.multitest", "comparing lots", "fleet").multipletests
    moved: dict[tuple[str, str], Shift] = {}
    while True:
        found = []
        for parameter in names:
            left = [one for one in dict.fromkeys(table[by]) if (one, parameter) not in moved]
            for name in left[len(left) <= 2 :]:  # of two, the later is told by the first
                rest = [one for one in left if one != name]
                one = _shift(table, parameter, by, name, rest)
                found += [] if one is None else [one]
        sure = holm([one.p_value for one in found], alpha=LEVEL, method="holm")[0] if found else []
        beyond = [one for one, yes in zip(found, sure, strict=True) if yes]
        if not beyond:
            return sorted(moved.values(), key=lambda one: one.p_value)
        surest = min(beyond, key=lambda one: one.p_value)
        moved[surest.name, surest.parameter] = surest


def _shift(table: Any, parameter: str, by: str, name: str, rest: Sequence[str]) -> Shift | None:
    """Return how a lot or station differs from the rest; None where too few tell."""
    stats = require("scipy.stats", "comparing lots", "fleet")
    column, of = table[parameter], table[by]
    a, b = (usual(column[some].to_numpy(dtype=float)) for some in (of == name, of.isin(rest)))
    if len(a) < FEWEST or len(b) < FEWEST or not np.mean(b) or np.ptp(a) == np.ptp(b) == 0.0:
        return None
    test = stats.ttest_ind(a, b, equal_var=False)
    ends = test.confidence_interval(0.95)
    scale = 100.0 / abs(float(np.mean(b)))
    change = float(np.mean(a) - np.mean(b)) * scale
    return Shift(by, name, parameter, change, (ends.low * scale, ends.high * scale), float(test.pvalue))


def usual(values: FloatArray) -> FloatArray:
    """Return values without those far from their middle, which are said one by one."""
    some = values[np.isfinite(values)]
    if len(some) < FEWEST:
        return some
    return some[_is_usual(some)]


def _is_usual(values: FloatArray) -> BoolArray:
    """Return which values are not far from their middle."""
    return np.asarray(np.abs(deviations(values, np.zeros(len(values)))) < _USUAL)


class Gain(NamedTuple):
    """All torques of a lot or station are off by one factor: the sensor's, and not the parts'."""

    by: str
    name: str
    percent: float
    ci95: tuple[float, float]

    def __str__(self) -> str:
        low, high = self.ci95
        return (
            f"{self.by} {self.name}: all that is in proportion to the torque is {self.percent:+.1f} % "
            f"({low:+.1f} to {high:+.1f}) of the others': look at the gain of its torque sensor first"
        )


def gains(table: Any, units: dict[str, str], found: Sequence[Shift]) -> list[Gain]:
    """Return of which lots and stations all torques are off by one factor, which no part would be.

    It is so where three parameters or more are in proportion to the torque and differ by no more than chance
    from one factor, which itself is beyond chance, and what is not in proportion to it did not move.
    Parameters of a part hang together, and how is not known well of few parts: so the factor is the best for
    their covariance, and what they differ from it by has Hotelling's (1931) distribution.
    """
    said = []
    for by, name in sorted({(one.by, one.name) for one in found}):
        own = [one.parameter for one in found if (one.by, one.name) == (by, name)]
        if any("N" not in units[one].split() for one in own):
            continue
        mine = (table[by] == name).to_numpy(dtype=bool)
        torques = [one for one, unit in units.items() if "N" in unit.split()]
        gain = _factor(*_alike(table[torques].to_numpy(dtype=float), mine))
        if gain is not None:
            said.append(Gain(by, name, *gain))
    return said


def _alike(values: FloatArray, mine: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return usual values of two groups of parts, a row each, of what they can be held against each other by.

    What most parts do not determine, or what changes its sign from one to the other, tells of no factor.
    """

    def compares(column: FloatArray) -> bool:
        groups = [(column[some & np.isfinite(column)], 0.5 * np.sum(some)) for some in (mine, ~mine)]
        if any(len(known) < max(FEWEST, most) for known, most in groups):
            return False
        return bool(np.mean(groups[0][0]) * np.mean(groups[1][0]) > 0.0)

    every = values[:, [compares(column) for column in values.T]]
    return _usual_rows(every[mine]), _usual_rows(every[~mine])


def _usual_rows(values: FloatArray) -> FloatArray:
    """Return the parts of which every parameter is known and none is far from its middle."""
    some = values[np.isfinite(values).all(axis=1)]
    if len(some) < FEWEST:
        return some
    return some[np.array([_is_usual(column) for column in some.T]).reshape(-1, len(some)).all(axis=0)]


def _factor(mine: FloatArray, others: FloatArray) -> tuple[float, tuple[float, float]] | None:
    """Return the factor between two groups of parts, per cent, and its interval; None where it is not one."""
    fewest, parameters = min(len(mine), len(others)), mine.shape[1]
    free = len(mine) + len(others) - 2
    if parameters < 3 or fewest < FEWEST or free < parameters:
        return None
    means = [np.mean(group, axis=0) for group in (mine, others)]
    shares = [group / mean - 1.0 for group, mean in zip((mine, others), means, strict=True)]
    spread = sum(share.T @ share for share in shares) / free * (1.0 / len(mine) + 1.0 / len(others))
    # One that is tied to another says nothing of its own.
    own = int(np.linalg.matrix_rank(spread, tol=_TIED * float(np.trace(spread)), hermitian=True))
    if own < 3 or not (np.diag(spread) > 0.0).all() or not (means[0] * means[1] > 0.0).all():
        return None
    inverse = np.linalg.pinv(spread, rcond=_TIED, hermitian=True)
    ratios = np.log(means[0] / means[1])
    known = int(np.sum(np.abs(ratios) > 2.0 * np.sqrt(np.diag(spread))))
    weight = inverse.sum(axis=0)
    error = float(np.sum(weight)) ** -0.5
    factor = float(weight @ ratios) * error**2
    apart = ratios - factor
    squares = float(apart @ inverse @ apart)
    f = require("scipy.stats", "comparing stations", "fleet").f
    many = own - 1
    chance = float(f.sf(squares * (free - many + 1) / (free * many), many, free - many + 1))
    if known < 2 or chance <= LEVEL or not abs(factor) > 3.0 * error:
        return None
    low, mid, high = (100.0 * math.expm1(factor + k * error) for k in (-Z95, 0.0, Z95))
    return mid, (low, high)


class More(NamedTuple):
    """An effect that a lot has more often than the others."""

    lot: str
    effect: str
    here: tuple[int, int]
    there: tuple[int, int]
    p_value: float

    def __str__(self) -> str:
        (a, n), (b, m) = self.here, self.there
        return f"lot {self.lot}: {self.effect} is missing in {a} of {n} captures, in {b} of {m} of the others"


def more(rows: Sequence[Row]) -> list[More]:
    """Return what some lots have more often than the rest (Fisher's exact test, Holm's correction)."""
    stats = require("scipy.stats", "comparing lots", "fleet")
    holm = require("statsmodels.stats.multitest", "comparing lots", "fleet").multipletests
    good = [row for row in rows if counts(row) and row["learned"]]
    found = []
    for lot in sorted({row["lot"] or "" for row in good}):
        for effect in sorted({name for row in good for name in row["found"]}):
            has = [
                [effect in row["found"] for row in good if ((row["lot"] or "") == lot) is here]
                for here in (True, False)
            ]
            (a, n), (b, m) = ((sum(some), len(some)) for some in has)
            if min(n, m) >= 3:
                test = stats.fisher_exact([[a, n - a], [b, m - b]], alternative="greater")
                found.append(More(lot, effect, (a, n), (b, m), float(float(test.pvalue))))
    sure = holm([one.p_value for one in found], alpha=0.05, method="holm")[0] if found else []
    return [one for one, yes in zip(found, sure, strict=True) if yes]
