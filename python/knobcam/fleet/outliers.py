"""Which captures of a lot are unlike the others: by their parameters, or by what the model leaves."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..base.arrays import FloatArray
from ..fit.estimate import Z95
from .row import Row

FEWEST = 8
"""Captures of a lot, for what is usual in it to be known."""
FAR = 4.5
"""Robust standard deviations from the median of a lot that are unlike it: by chance 1 of 10^5 are."""
_MORE_ERROR = 1.05  # times the error that is usual in the lot, at least
_SIGMA = 1.4826  # of a normal distribution, over its median absolute deviation
ERROR = "rmse"
LIMIT = "limits"
TYPICAL = "typical"
UNEXPLAINED = "unexplained"


def first(row: Row) -> Row:
    """Return a row with what its first model gave, which all captures of a lot have."""
    return row if row.get("first") is None else {**row, **row["first"]}


def groups(rows: Sequence[Row]) -> dict[tuple[Any, ...], list[Row]]:
    """Return the rows of what was read, by lot, kind of axis and unit: what can be compared."""
    found: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        if row["error"] is None:
            found.setdefault(group(row), []).append(row)
    return dict(sorted(found.items()))


def group(row: Row) -> tuple[Any, ...]:
    """Return what tells the captures that a row can be compared with."""
    return row["lot"] or "", row["coordinate"], row["unit"]


def outliers(rows: Sequence[Row], fails: Callable[[Row], bool]) -> dict[str, list[str]]:
    """Return which captures ask for a closer look, and by what; `fails` tells who is beyond a limit.

    Of a lot in which most captures have more than chance left, the one in its middle is `typical`.
    """
    why: dict[str, list[str]] = {}
    for some in groups(rows).values():
        firsts = [first(row) for row in some]
        far = _far(firsts) if len(some) >= FEWEST else {}
        for at, row in enumerate(firsts):
            reasons = [LIMIT] if fails(row) else []
            reasons += [name for name, score in far.items() if abs(score[at]) > FAR]
            if len(some) < FEWEST and not reasons and unexplained(row):
                reasons = [UNEXPLAINED]
            if reasons:
                why[row["capture"]] = reasons
        if len(some) >= FEWEST and sum(map(unexplained, firsts)) > len(some) / 2:
            usual = _middle(firsts, far)
            why.setdefault(usual["capture"], [TYPICAL])
    return why


def unexplained(row: Row) -> bool:
    """Whether the first model leaves more than chance; a capture that was learned says so by its verdict."""
    if row.get("first") is not None:
        return bool(row["verdict"] != "complete")
    return row["verdict"] is None


def _far(rows: Sequence[Row]) -> dict[str, FloatArray]:
    """Return how many robust deviations each capture is from the middle of all, by what."""
    scores = {}
    for name in sorted({name for row in rows for name in row["params"]}):
        values = np.array([_number(row["params"].get(name)) for row in rows])
        width = np.array([_half(row["params"].get(name)) for row in rows])
        if np.isfinite(values).sum() >= FEWEST:
            scores[name] = deviations(values, width)
    error = np.array([_ratio(row) for row in rows])
    if np.isfinite(error).sum() >= FEWEST:
        score = deviations(np.log(error), np.zeros(len(rows)))
        more = error > _MORE_ERROR * np.nanmedian(error)
        scores[ERROR] = np.where(more, score, 0.0)
    return scores


def deviations(values: FloatArray, width: FloatArray) -> FloatArray:
    """Return values from their median, in robust deviations of all, or in their own if that is more."""
    middle = np.nanmedian(values)
    spread = _SIGMA * np.nanmedian(np.abs(values - middle))
    sizes = np.maximum(np.maximum(spread, np.nan_to_num(width)), 1e-12 * abs(middle) + 1e-300)
    scores: FloatArray = np.nan_to_num((values - middle) / sizes)
    return scores


def _middle(rows: Sequence[Row], far: Mapping[str, FloatArray]) -> Row:
    total = np.sum(np.square(list(far.values())), axis=0)
    return min(zip(total.tolist(), rows, strict=True), key=lambda one: (one[0], one[1]["capture"]))[1]


def _number(values: Sequence[float | None] | None) -> float:
    return math.nan if values is None or values[0] is None else values[0]


def _half(values: Sequence[float | None] | None) -> float:
    """Return the standard error of a value, from its interval."""
    if values is None or values[1] is None or values[2] is None:
        return math.nan
    return (values[2] - values[1]) / (2.0 * Z95)


def _ratio(row: Row) -> float:
    """Return the error, in what noise alone would leave where that is known."""
    error = row["rmse"] if row["rmse"] else math.nan
    return error / row["noise_floor"] if row["noise_floor"] else error
