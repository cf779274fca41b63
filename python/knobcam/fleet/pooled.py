"""What a new lot has that the old one had not, though no capture shows it: small hints of many, added up."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import FloatArray
from ..base.optional import require
from ..fit.rule import RULE
from ..model.effects import Effect, effects
from .lots import FEWEST, LEVEL, usual
from .outliers import unexplained
from .row import Row

_LEAST = 1e-9  # of a standard error: hints are in standard deviations of noise


class Held(NamedTuple):
    """An effect in a lot, held against the first lot, or, in that itself (`against` is None), against chance.

    `score` is the difference of what captures say for it, in standard errors, above zero where the lot has
    more of it; `p_value` is that of the ranks, `sure` whether it is beyond chance among all that is looked
    at, `plausible` whether an effect of the kind can have that sign.
    """

    lot: str
    against: str | None
    effect: str
    score: float
    p_value: float
    captures: tuple[int, int]
    sure: bool = False
    plausible: bool = True
    first: bool = False
    """Whether it is the first lot that has it."""


class Pooled(NamedTuple):
    """An effect that a lot has beyond another one, by all of its captures together.

    `alike` are others that say as much, `weak` whether captures of the lot show nothing one by one.
    """

    lot: str
    than: str | None
    effect: str
    alike: tuple[str, ...]
    captures: tuple[int, int]
    p_value: float
    weak: bool

    def __str__(self) -> str:
        n, m = self.captures
        many = f"{n} captures" if self.than is None else f"{n} captures and {m}"
        beyond = "" if self.than is None else f" that {_lot(self.than)} has not"
        alike = f"; {', '.join(self.alike)} would look the same" if self.alike else ""
        weak = ", too weak for one capture" if self.weak else ""
        return f"{_lot(self.lot)} has {self.effect}{beyond} (p = {self.p_value:.1g}, {many}){weak}{alike}"


def compared(table: Any, rows: Sequence[Row]) -> list[Held]:
    """Return all that the hints of captures are compared for: each lot with the first one, which is the old.

    By ranks (Mann and Whitney), which captures that are unlike their lot do not move; the first lot by signed
    ranks (Wilcoxon) against chance, by which a hint with a sign is as often negative, and only where most of
    its captures show nothing one by one: else `learn` tells what it is. Holm's correction over all: it holds
    however the hints of one capture hang together, and what is said of any lot is false in one of a hundred
    tables at most. That of Benjamini and Yekutieli would let a share of all that is said be false.
    """
    stats = require("scipy.stats", "comparing lots", "fleet")
    by_name = {row["capture"]: row for row in rows}
    some = [by_name[name] for name in table["capture"]]
    known = effects(some[0]["coordinate"])
    lots = list(dict.fromkeys(table["lot"]))
    of = {lot: [row for row, own in zip(some, table["lot"], strict=True) if own == lot] for lot in lots}
    found = []
    for name in sorted({name for row in some for name in row.get("hints") or {}}):
        kind, _, effect = name.partition(".")
        values = {lot: _values(of[lot], name) for lot in lots}
        old = values[lots[0]]
        if kind == "lean" and len(old) >= FEWEST and quiet(of[lots[0]]):
            p = float(stats.wilcoxon(old).pvalue)
            fits = _plausible(known.get(effect), float(np.median(old)))
            found.append(Held(lots[0], None, effect, _score(old, None), p, (len(old), 0), plausible=fits))
        for lot in lots[1:]:
            new = values[lot]
            if min(len(new), len(old)) < FEWEST or np.ptp(np.concatenate([new, old])) == 0.0:
                continue
            p = float(stats.mannwhitneyu(new, old).pvalue)
            middles = [float(np.median(one)) for one in (new, old)]
            sizes = [abs(one) if kind == "lean" else one for one in middles]
            first = sizes[1] > sizes[0]
            fits = kind == "gain" or _plausible(known.get(effect), middles[first])
            count = (len(new), len(old))
            found.append(Held(lot, lots[0], effect, _score(new, old), p, count, plausible=fits, first=first))
    if not found:
        return []
    holm = require("statsmodels.stats.multitest", "comparing lots", "fleet").multipletests
    sure = holm([one.p_value for one in found], alpha=LEVEL, method="holm")[0]
    return [one._replace(sure=bool(yes)) for one, yes in zip(found, sure, strict=True)]


def pooled(every: Sequence[Held], rows: Sequence[Row]) -> list[Pooled]:
    """Return what lots have, of all that they were held against: the effect that says most, and its like.

    Several effects draw nearly the same torque, so that one of them brings hints of the others along. The
    one that explains most is named, and with it those that explain no less beyond doubt, as in one capture.
    """
    said = []
    for lot, against in dict.fromkeys((one.lot, one.against) for one in every):
        sure = [
            one for one in every if (one.lot, one.against) == (lot, against) and one.sure and one.plausible
        ]
        if not sure:
            continue
        best = max(sure, key=lambda one: abs(one.score))
        enough = best.score**2 - RULE.alike
        alike = [one for one in sure if one is not best and one.score**2 >= enough]
        has, than = (against or "", lot) if best.first else (lot, against)
        weak = quiet([row for row in rows if row["error"] is None and (row["lot"] or "") == has])
        count = best.captures[::-1] if best.first else best.captures
        names = tuple(one.effect for one in sorted(alike, key=lambda one: -abs(one.score)))
        said.append(Pooled(has, than, best.effect, names, count, best.p_value, weak))
    known = {(one.lot, one.effect) for one in said if one.than is not None}
    return [one for one in said if one.than is not None or (one.lot, one.effect) not in known]


def quiet(rows: Sequence[Row]) -> bool:
    """Whether most of some captures have no more than chance left, one by one."""
    return sum(map(unexplained, rows)) <= len(rows) / 2


def _values(rows: Sequence[Row], name: str) -> FloatArray:
    given: list[Mapping[str, float]] = [row.get("hints") or {} for row in rows]
    return np.array([one[name] for one in given if name in one], dtype=float)


def _score(new: FloatArray, old: FloatArray | None) -> float:
    """Difference of the means of what is usual, in its standard errors."""
    both = [usual(one) for one in (new, old) if one is not None]
    error = math.sqrt(sum(float(np.var(one, ddof=1)) / len(one) for one in both))
    means = [float(np.mean(one)) for one in both]
    return (means[0] - sum(means[1:])) / max(error, _LEAST)


def _plausible(effect: Effect | None, lean: float) -> bool:
    """Whether an effect can lean that way: by what the first of its parameters, its size, may be."""
    if effect is None or not effect.params:  # one of a plugin may be known no more
        return True
    low, high = effect.params[0].plausible
    return low < 0.0 if lean < 0.0 else high > 0.0


def _lot(name: str) -> str:
    return f"lot {name}" if name else "the lot without a name"
