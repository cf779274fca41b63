"""How sure a name is: the weight of an effect against what else could have been added, and what that adds.

Weights are those of BIC (Schwarz 1978; Raftery 1995: Laplace's approximation of a posterior probability, each
effect as likely before), with the effective number of samples: what noise leaves behind the filter, in
variances of the raw noise, and as many parameters as there was a choice of: one that may be anything within
its range is none. Where more than noise is left with the best of them, that counts as noise. What a choice
adds to the variance of a parameter is the weighted spread over the rivals (Buckland, Burnham & Augustin
1997).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..fit.one_way import twins
from ..fit.rule import RULE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from ..fit import Estimate
    from ..fit.diagnose import Candidate, Diagnosis
    from .ladder import LearningStep


def weights(diagnosis: Diagnosis | None, added: str | None) -> dict[str, float]:
    """Return the weights of what could have been added, the largest first; they add up to one.

    Empty where `added` was not chosen out of these candidates alone, as the first of a pair is not.
    """
    return {one.effect: weight for one, weight in _weighed(diagnosis, added)}


def with_choice(params: Mapping[str, Estimate], ladder: Iterable[LearningStep]) -> dict[str, Estimate]:
    """Return parameters with intervals that carry the spread over the rivals on the way to them."""
    steps = [(step.added, _weighed(step.diagnosis, step.added)) for step in ladder]
    wider = {}
    for name, estimate in params.items():
        told = estimate.determined and estimate.se
        more = sum(_spread(added, rivals, name) for added, rivals in steps) if told else 0.0
        wider[name] = estimate.widened(more) if more else estimate
    return wider


def _weighed(diagnosis: Diagnosis | None, added: str | None) -> list[tuple[Candidate, float]]:
    if diagnosis is None or not diagnosis.fit.noise_floor > 0.0:
        return []
    could = diagnosis.could_be
    best = max(could, key=lambda one: one.score, default=None)
    if best is None or added not in (best.effect, *best.equivalent):
        return []
    fit = diagnosis.fit
    noise = min(1.0, (fit.noise_floor / best.rmse) ** 2)
    samples = max(fit.white_squares, math.e)
    same = twins(could, best)
    gains = [best.gain if one.effect in same else one.gain for one in could]
    prices = [one.charged * math.log(samples) for one in could]
    logs = [0.5 * (noise * gain - price) for gain, price in zip(gains, prices, strict=True)]
    largest = max(logs)
    parts = [math.exp(log - largest) for log in logs]
    both = [(one, part / sum(parts)) for one, part in zip(could, parts, strict=True)]
    return sorted((pair for pair in both if pair[1] >= RULE.least_weight), key=lambda pair: -pair[1])


def _spread(added: str | None, rivals: Sequence[tuple[Candidate, float]], name: str) -> float:
    """Variance of a parameter over the rivals of what a step added, about its value with that."""
    chosen = next((one for one, _ in rivals if one.effect == added), None)
    here = chosen.fit.params.get(name) if chosen else None
    if here is None or not here.determined:
        return 0.0
    spread = 0.0
    for one, weight in rivals:
        there = one.fit.params.get(name)
        if there is not None and there.determined:
            off = there.value - here.value
            if here.unit == "rad" and name.endswith(".S"):
                off = math.remainder(off, 2.0 * math.pi)
            spread += weight * off**2
    return spread


def in_percent(weight: float | None) -> str:
    """Return a weight for people."""
    if weight is None:
        return ""
    return "> 99.9 %" if weight > 0.999 else f"{100.0 * weight:.1f} %"
