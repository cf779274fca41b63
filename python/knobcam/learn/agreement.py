"""Captures of one knob that ask for different parameters: evidence that something is missing."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .. import _core
from ..base.said import OfParam, Said, number, said
from ..fit.described import names as names_of
from ..fit.rule import RULE

if TYPE_CHECKING:
    from ..fit import Estimate, Fit


class Disagreement(NamedTuple):
    """A parameter that two captures ask for differently, and by how many standard errors."""

    param: str
    captures: tuple[str, str]
    values: tuple[float, float]
    by_se: float
    unit: str = ""

    def __str__(self) -> str:
        return self.sentence

    @property
    def sentence(self) -> Said:
        """It in words, without a stop; captures by the names of their files where these tell them apart."""
        (one, other), (a, b) = _short(self.captures), self.values
        return said(
            "{param} is {a} in {one} and {b} in {other}, {by} standard errors apart: no one model of this "
            "kind has both, so something is missing or the knob was changed",
            param=OfParam(self.param),
            a=number(a, self.unit) if self.unit else f"{a:.4g}",
            one=one,
            b=number(b, self.unit) if self.unit else f"{b:.4g}",
            other=other,
            by=f"{self.by_se:.3g}",
        )


def _short(names: tuple[str, str]) -> tuple[str, str]:
    one, other = (Path(name).name for name in names)
    return (one, other) if one != other else names


def disagreements(fit: Fit) -> tuple[Disagreement, ...]:
    """Return the parameters on which the captures of a joint fit disagree, the worst pair of each.

    Each capture is fitted by itself with the same model; one capture agrees with itself.
    """
    if len(fit.prepared) < 2:
        return ()
    alone = [
        replace(fit, prepared=(one,), core=_core.fit([one.core], fit.model.core, False), before=None)
        for one in fit.prepared
    ]
    names = names_of(fit.prepared)
    found = []
    apart = {name for every in fit.per_capture.values() for _, name, _ in every}
    for param in (one for one in fit.params if one not in apart):
        pairs = [
            Disagreement(param, (names[i], names[j]), (a.value, b.value), _apart(a, b), a.unit)
            for i, a in _estimates(alone, param)
            for j, b in _estimates(alone, param)
            if i < j
        ]
        worst = max(pairs, key=lambda pair: pair.by_se, default=None)
        if worst is not None and worst.by_se > RULE.apart:
            found.append(worst)
    return tuple(sorted(found, key=lambda one: -one.by_se))


def _estimates(fits: list[Fit], param: str) -> list[tuple[int, Estimate]]:
    every = [(i, fit.params[param]) for i, fit in enumerate(fits) if param in fit.params]
    return [(i, estimate) for i, estimate in every if estimate.determined and estimate.se > 0.0]


def _apart(a: Estimate, b: Estimate) -> float:
    difference = abs(a.value - b.value)
    return difference / math.hypot(a.se, b.se)
