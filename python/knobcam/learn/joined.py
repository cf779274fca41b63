"""A coupling and what hides beside it, which one after the other are not found."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..fit.diagnose import absent
from ..fit.refit import converged, cores, gain, needless
from ..fit.rule import RULE
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
            bare = replace(converged(bare), before=fit)
            chance = chance_of(bare, fit, diagnosis)
            if chance <= RULE.chance:
                return [LearningStep(bare, coupling, chance, (), (), diagnosis)]
            continue
        chance = chance_of(pair, alone.fit, diagnosis)
        if chance <= RULE.chance:
            before = replace(converged(alone.fit), before=fit)
            step = LearningStep(before, companion, alone.p_value, (), (), diagnosis)
            return [step, LearningStep(replace(pair, before=before), coupling, chance, (), (), diagnosis)]
    return None


def chance_of(richer: Fit, before: Fit, diagnosis: Diagnosis) -> float:
    """Return how often chance would do as well as a richer fit: no oftener than what takes off less."""
    if not diagnosis.fit.noise_floor > 0.0:
        return 1.0
    falls = gain(before, richer, diagnosis.fit)
    return min((one.p_value for one in diagnosis.candidates if one.gain <= falls), default=1.0)
