"""What is said of each effect that could be missing: the one rule, which the core holds, in one set of words.

`learn` adds what is chosen here, `diagnose`, the workbench and reports say the same of it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, get_args

import numpy as np

from .. import _core
from ..base.pages import Word
from ..base.said import OfEffect, said
from .doubts import at_floor, below_zero
from .one_way import twins
from .rule import RULE

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from .compare import Comparison
    from .diagnose import Candidate
    from .fitting import Fit

CHOSEN: tuple[Word, ...] = ("missing", "part")
"""Of the one effect that comes in next; `part`: it explains less than half of what noise does not."""
COULD_BE: tuple[Word, ...] = (*CHOSEN, "alike", "less")
"""Of all that could be missing."""
_WORDS: dict[Word, str] = {
    "missing": "missing",
    "part": "a part of what is missing",
    "alike": "could be missing",
    "less": "could be missing, but {chosen} explains more",
    "implausible": "not by its values",
    "too_little": "explains too little",
    "unpaid": "not worth its parameters",
    "chance": "no more than chance",
    "untold": "the noise is not known, nor what is chance",
}
_RANKS = get_args(Word)
_STRETCHES = 40  # long beside the memory of the filter, and enough to see how the error varies


def explained(fit: Fit) -> float:
    """Return the mean squared error that what was added so far took off, (N m)^2."""
    first = fit
    while first.before is not None:
        first = first.before
    return first.rmse**2 - fit.rmse**2


def off_by_law(fit: Fit) -> float:
    """Return the mean squared error by which the laws that were added so far may be off, (N m)^2."""
    return (RULE.law_of_play if _knocks_or_builds_up(fit) else RULE.law) ** 2 * explained(fit)


def _knocks_or_builds_up(fit: Fit) -> bool:
    """Whether a play is among the effects, or friction that builds up: what knocks and reversals leave."""
    catalogue = fit.model.catalogue()
    rows = (catalogue[one] for one in fit.model.effects)
    return any(row.section == "gap" or row.over == "reversal" for row in rows)


def within_law(fit: Fit) -> bool:
    """Whether what is left is hardly more than noise, and no more than what added laws may be off by."""
    return at_floor(fit) and fit.excess <= off_by_law(fit)


def judged(comparison: Comparison, candidates: Collection[Candidate]) -> tuple[Candidate, ...]:
    """Return candidates with what is said of each, those for which most speaks first.

    `comparison` is where the fit that they were weighed beside fails.
    """
    several = list(candidates)
    fit = comparison.fit
    doubts = _doubts(several)
    evidence = [
        (
            one.gain,
            one.count,
            one.charged,
            one.p_value,
            one.rmse,
            _felt(one, fit),
            doubt,
            bool(one.implausible),
            len(below_zero(one.fit)),
        )
        for one, doubt in zip(several, doubts, strict=True)
    ]
    # What a law with a memory leaves may be more than noise, and is drawn by many effects.
    law = off_by_law(fit) if at_floor(fit) or _knocks_or_builds_up(fit) else 0.0
    told = _core.judge(comparison.judged, law, evidence)
    chosen = next((one.effect for one, (word, _) in zip(several, told, strict=True) if word in CHOSEN), "")
    known = [
        replace(
            one,
            word=word,
            said=said(_WORDS[word], chosen=OfEffect(chosen)),
            equivalent=tuple(several[at].effect for at in alike),
        )
        for one, (word, alike) in zip(several, told, strict=True)
    ]
    return tuple(sorted(known, key=lambda one: (_RANKS.index(one.word), -one.score)))


def _doubts(candidates: Sequence[Candidate]) -> list[float]:
    """Return how uncertain it is what each takes off beside the one that takes off most.

    That is the standard error of the difference of their squared errors, in variances of the raw noise, from
    how it varies between stretches of the captures; infinite where the motion cannot tell them.
    """
    paid = [one for one in candidates if one.score > 0.0 and not one.implausible]
    same = twins(paid, max(paid, key=lambda one: one.score, default=None))
    could = [one for one in paid if not at_floor(one.fit)]
    best = max(could, key=lambda one: one.score, default=None)
    # Of a single one there is nothing to ask, and its residual costs a prediction.
    squares = {one.effect: np.square(one.fit.residual) for one in could} if len(could) > 1 else {}
    known = np.isfinite(squares[best.effect]) if best and squares else np.empty(0)

    def doubt(one: Candidate) -> float:
        if one.effect in same:
            return math.inf
        if best is None or one.effect not in squares or one.effect == best.effect:
            return 0.0
        more = (squares[one.effect] - squares[best.effect])[known]
        sums = [float(np.nansum(stretch)) for stretch in np.array_split(more, _STRETCHES)]
        noise = one.fit.noise_floor**2 / one.fit.white_squares
        return float(np.std(sums)) * math.sqrt(len(sums)) / len(more) / noise

    return [doubt(one) for one in candidates]


def _felt(candidate: Candidate, before: Fit) -> float:
    """Return the largest share of a capture's squared error that an effect takes off."""
    share = 1.0 - (candidate.rmse / before.rmse) ** 2 if before.rmse > 0.0 else 0.0
    if len(before.prepared) == 1 or share >= RULE.worth or candidate.score <= 0.0:
        return share
    left, right = ([np.nansum(rest**2) for rest in fit.residuals] for fit in (candidate.fit, before))
    return max(share, *(float(1.0 - a / b) for a, b in zip(left, right, strict=True) if b > 0.0))
