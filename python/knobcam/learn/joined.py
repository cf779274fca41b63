"""A coupling and what hides beside it, which one after the other are not found."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..fit.absent import absent
from ..fit.refit import converged, cores, gain, needless
from ..fit.rule import RULE
from ..fit.verdict import within_law
from ..model.effects import effects
from .joints import beside_others, chance, joints
from .ladder import LearningStep, first_weighed

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

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


def rejoined(
    ladder: Sequence[LearningStep], without: Collection[str], progress: Callable[[float], object]
) -> list[LearningStep] | None:
    """Return the steps to another joint in the place of the one that came in, where that explains it better.

    A joint is chosen among others in what everything that comes in after it leaves. None where nothing came
    in after it, where it stays, and without one; and where noise alone is left, or less than laws may be off
    by and the joint has no simpler rival. What `progress` raises ends the work.
    """
    last = ladder[-1].fit
    own = last.model.joint
    diagnosis = first_weighed(ladder)
    came = [step.added for step in ladder if step.added in last.model.effects]
    if diagnosis is None or own is None or own not in came[:-1]:
        return None
    rows = effects(last.model.coordinate)
    few = min(len(rows[one].params) for one in joints(last.model.coordinate))
    simplest = len(rows[own].params) == few
    if last.rmse <= RULE.converged * last.noise_floor or (within_law(last) and simplest):
        return None
    rigid = converged(last.drop(own))
    step = _step(beside_others(diagnosis, own, last, rigid, without, progress), own)
    if step is None or step.added == own:
        return None
    others = [one for one in came if one is not None and one != own]
    return [*climbed(rigid, others, ladder[0].fit, diagnosis), step]


def climbed(fit: Fit, names: Sequence[str], first: Fit, diagnosis: Diagnosis) -> list[LearningStep]:
    """Return the steps that lead from the first fit to one with these effects, in this order."""
    fits = [fit]
    for name in reversed(names[1:]):
        fits.insert(0, converged(fits[0].drop(name)))
    steps, before = [], first
    for name, own in zip(names, fits, strict=True):
        own = replace(own, before=before)
        steps.append(LearningStep(own, name, chance_of(own, before, diagnosis), (), (), diagnosis))
        before = own
    return steps


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
