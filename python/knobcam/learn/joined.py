"""A coupling and what hides beside it, which one after the other are not found."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..fit.diagnose import absent
from ..fit.refit import converged, cores, gain, needless
from ..fit.rule import RULE
from .joints import beside_others, chance
from .ladder import LearningStep

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from ..fit import Fit
    from ..fit.diagnose import Diagnosis


def joined(
    diagnosis: Diagnosis, last: Fit, without: Collection[str], progress: Callable[[float], object]
) -> list[LearningStep] | None:
    """Return the steps of a coupling and another effect that explain what a search one by one left.

    `diagnosis` is what was weighed beside the first model, `last` where the search ended; what `progress`
    raises ends the work. Of a pair whose other effect is not needed the coupling alone. None where no pair
    takes off half of what that left.
    """
    fit = diagnosis.fit
    weighed = absent(fit, without)[0]
    for coupling, companion, core in _core.pairs(cores(fit), fit.model.core, weighed, progress):
        pair = replace(fit, core=core, before=None)
        alone = next((one for one in diagnosis.candidates if one.effect == companion), None)
        if alone is None or pair.rmse >= last.rmse or pair.excess > RULE.pair_leaves * last.excess:
            continue
        pair = converged(pair)
        bare = pair.drop(companion)
        if needless(pair, bare):
            # It only led to the joint.
            bare = converged(bare)
            if chance_of(bare, fit, diagnosis) <= RULE.chance:
                told = beside_others(diagnosis, coupling, bare, fit, without, progress)
                if (step := _step(told, coupling)) is not None:
                    return [step]
            continue
        if chance_of(pair, alone.fit, diagnosis) <= RULE.chance:
            before = replace(converged(alone.fit), before=fit)
            told = beside_others(diagnosis, coupling, pair, before, without, progress)
            if (step := _step(told, coupling)) is not None:
                return [LearningStep(before, companion, alone.p_value, (), (), diagnosis), step]
    return None


def _step(told: Diagnosis, coupling: str) -> LearningStep | None:
    """Return the step on which a joint comes in: that one, or another that is named in its place.

    None where it is none by its values, as a gap of nothing.
    """
    best = told.best
    one = best if best is not None and best.place == "coupling" else told[coupling]
    if one.implausible:
        return None
    return LearningStep(one.fit, one.effect, one.p_value, one.equivalent, (), told)


def chance_of(richer: Fit, before: Fit, diagnosis: Diagnosis) -> float:
    """Return how often chance would do as well as a richer fit."""
    return chance(gain(before, richer, diagnosis.fit), diagnosis) if diagnosis.fit.noise_floor > 0.0 else 1.0
