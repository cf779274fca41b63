"""Gauge repeatability and reproducibility: what of a difference is measurement, by analysis of variance."""

from __future__ import annotations

import math
import warnings
from typing import Any, NamedTuple

import numpy as np

from ..base.optional import require

_POOLED = 0.25  # p-value above which the interaction is repeatability (AIAG, Measurement Systems Analysis)


class Gauge(NamedTuple):
    """Standard deviations of a parameter: of repeats, of stations (with their interaction), of parts.

    `percent` is the share of the gauge in the whole deviation, `distinct` how many classes of parts it tells.
    """

    parameter: str
    captures: int
    repeats: float
    stations: float
    parts: float

    @property
    def percent(self) -> float:
        """Gauge over everything, per cent; AIAG calls up to 10 good, more than 30 too much."""
        gauge = math.hypot(self.repeats, self.stations)
        every = math.hypot(gauge, self.parts)
        return 100.0 * gauge / every if every else math.nan

    @property
    def distinct(self) -> int:
        """How many classes of parts it tells apart; 5 and more are wanted."""
        gauge = math.hypot(self.repeats, self.stations)
        return int(math.sqrt(2.0) * self.parts / gauge) if gauge else 0


def gauge(table: Any, parameter: str) -> Gauge | None:
    """Return the gauge study in a table; None where no part was captured twice at one station.

    Parts and stations are random, crossed where there are two stations or more; an interaction that chance
    explains is part of the repeatability. Where repeats differ in number their harmonic mean counts.
    """
    some = table[(table["part"] != "") & table[parameter].notna()]
    some = some.assign(value=some[parameter].astype(float))
    counts = some.groupby(["part", "station"]).size()
    if len(counts) < 3 or counts.max() < 2 or some["part"].nunique() < 3:
        return None
    crossed = some["station"].nunique() > 1
    if crossed and len(counts) < some["part"].nunique() * some["station"].nunique():
        return None
    r = float(len(counts) / np.sum(1.0 / counts))
    p, s = some["part"].nunique(), some["station"].nunique()
    if not crossed:
        square, _ = _anova(some, "value ~ C(part)")
        repeats = square["Residual"]
        return _of(parameter, len(some), repeats, 0.0, (square["C(part)"] - repeats) / r)
    square, p_value = _anova(some, "value ~ C(part) * C(station)")
    both = "C(part):C(station)"
    if p_value[both] > _POOLED:
        square, _ = _anova(some, "value ~ C(part) + C(station)")
        square[both] = square["Residual"]
    between = max((square[both] - square["Residual"]) / r, 0.0)
    stations = max((square["C(station)"] - square[both]) / (p * r), 0.0) + between
    return _of(
        parameter, len(some), square["Residual"], stations, (square["C(part)"] - square[both]) / (s * r)
    )


def _of(parameter: str, count: int, repeats: float, stations: float, parts: float) -> Gauge:
    return Gauge(parameter, count, *(math.sqrt(max(one, 0.0)) for one in (repeats, stations, parts)))


def _anova(table: Any, formula: str) -> tuple[dict[str, float], dict[str, float]]:
    """Return mean squares and p-values by what they are of."""
    ols = require("statsmodels.formula.api", "gauge studies", "fleet").ols
    anova_lm = require("statsmodels.stats.anova", "gauge studies", "fleet").anova_lm
    scale = float(table["value"].abs().max()) or 1.0  # far from 1 it would round
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = anova_lm(ols(formula, table.assign(value=table["value"] / scale)).fit(), typ=2)
    squares = found["sum_sq"] / found["df"] * scale**2
    return dict(squares), dict(found["PR(>F)"])
