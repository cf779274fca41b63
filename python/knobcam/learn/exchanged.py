"""Sets of effects, weighed as one, against what a search one by one came to.

What came in first may have stood in for two others, and what came in after it for what it left of them.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from .. import _core
from ..errors import InputError
from ..fit.doubts import at_floor
from ..fit.plausible import implausible, stands_in
from ..fit.refit import add, converged, cores, drop, gain
from ..fit.rule import RULE
from ..model.effects import base_effects_shown
from .joined import climbed
from .ladder import first_weighed
from .together import follows

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..fit import Fit
    from ..fit.compare import Comparison
    from ..fit.diagnose import Candidate, Diagnosis
    from .ladder import LearningStep

_POOL = 7  # effects whose sets are weighed
_LOWER = 0.02  # of the error: what ends lower by less is where it was
_MOST = 3  # effects of a set, where more than noise is left


def exchanged(
    ladder: Sequence[LearningStep], after: Comparison, progress: Callable[[float], object]
) -> list[LearningStep] | None:
    """Return the steps of a set that explains more for its parameters than what the ladder came to.

    `after` is where its last fit fails.

    None where there is none, where less than two effects came in, or beside a coupling, whose fits take long;
    what `progress` raises ends the work.
    """
    first, last = ladder[0].fit, ladder[-1].fit
    found = _found(first, last)
    diagnosis = first_weighed(ladder)
    if diagnosis is None or len(found) < 2:
        return None
    pool = dict.fromkeys(found, last)
    for one in _best_of_each(ladder):
        if len(pool) < _POOL:
            pool.setdefault(one.effect, one.fit)
    models = [(one, fit.core.model) for one, fit in pool.items()]
    most = len(found) if after.complete else max(_MOST, len(found))
    # As they are beside what came in: the first model may have taken other detents for it.
    base = last.core.model.only([one for one in last.model.effects if one not in found])
    least, behind = _score(last, first), False
    for names, core in _core.sets(cores(last), base, models, most, progress):
        behind |= set(names) == set(found)
        fewer = len(names) < len(found)
        if behind and not fewer:
            continue
        fit = converged(replace(last, core=core, before=None))
        # Of two that explain as much, to the price of a parameter, the one with fewer names is the cause.
        if fit.impossible is None and _score(fit, first) > least + (-RULE.price if fewer else RULE.price):
            return _steps(fit, names, ladder[0], diagnosis)
    return None


def anew(
    ladder: Sequence[LearningStep], after: Comparison, progress: Callable[[float], object]
) -> Fit | None:
    """Return the last fit with one of its effects looked for anew beside the others, where that ends lower.

    What came in first was looked for in the error of all that came after it: its period may be wrong. Where
    chance explains the rest but for what follows a law, any of them may have ended beside its best values.
    `after` and `progress` as of `exchanged`; None where nothing ends lower, or in the same cases as there.
    """
    first, last = ladder[0].fit, ladder[-1].fit
    found = _found(first, last)
    if len(found) < 2 or (after.complete and not follows(last)):
        return None
    # Where chance explains the rest, less is lower.
    sure = functools.partial(_pays, last) if after.complete else functools.partial(_lowers, last)
    lower = looked_anew(last, found if after.complete else found[:-1], progress, sure)
    return None if lower is None else replace(lower[0], before=last.before)


def at_own_values(ladder: Sequence[LearningStep], progress: Callable[[float], object]) -> Fit | None:
    """Return the last fit with an effect at values that can be its own, where it ended at others.

    What repeats over position has a period, and of periods the error has many minima: what else was missing
    led to one that is not its own. Where it explains as much by values that are its own, these are right.
    None where none does; what `progress` raises ends the work.
    """
    first, last = ladder[0].fit, ladder[-1].fit
    for effect in last.model.effects:
        if effect in first.model.effects or not stands_in(effect, last):
            continue
        core = _core.elsewhere(cores(last), last.core, effect, progress)
        if core is None:
            continue
        again = converged(replace(last, core=core))
        if gain(last, again, last) >= -RULE.alike and not stands_in(effect, again):
            return again
    return None


def looked_anew(
    fit: Fit,
    effects: Sequence[str],
    progress: Callable[[float], object],
    lower: Callable[[Fit], bool] | None = None,
) -> tuple[Fit, str] | None:
    """Return a fit with the first of these effects that ends lower, looked for anew beside the others.

    And which that is; None where none does. `lower` says what ends lower, by default what leaves less error
    but for little. What `progress` raises ends the work.
    """
    lower = lower or functools.partial(_lowers, fit)
    for effect in effects:
        try:
            again = add(fit.drop(effect), effect, progress)
        except InputError:
            continue  # it does not go with the others
        if lower(again):
            return again, effect
    return None


def _lowers(fit: Fit, again: Fit) -> bool:
    return again.rmse < (1.0 - _LOWER) * fit.rmse


def _pays(fit: Fit, again: Fit) -> bool:
    return gain(fit, again, fit) > RULE.price


def straightened(diagnosis: Diagnosis, progress: Callable[[float], object]) -> list[LearningStep] | None:
    """Return the steps to an effect that was bent by another that is missing beside it, and to that other.

    Waves of friction over position are a trend where a drag is missing too. What leads by far, but not by its
    values, is looked for anew beside each of the next; None where none of them leaves chance with it.
    """
    fit = diagnosis.fit
    could = sorted((one for one in diagnosis.candidates if one.beyond_chance), key=lambda one: -one.score)
    if not could or could[0].place == "coupling" or not could[0].implausible:
        return None
    led = could[0]
    if led.fit.excess > RULE.pair_leaves * fit.excess:
        return None
    beside = [one for one in could if one.place != "coupling" and not one.implausible]
    for one in beside[:_MOST]:
        alone = replace(converged(one.fit), before=fit)
        try:
            both = add(alone, led.effect, progress)
        except InputError:
            continue  # it does not go with the other
        fits = at_floor(both) and both.impossible is None
        if fits and not implausible(replace(led, fit=replace(both, before=alone)), alone):
            return climbed(both, [one.effect, led.effect], fit, diagnosis)
    return None


def with_detents(fit: Fit) -> Fit:
    """Return the fit with detents where the data show them now."""
    core = _core.fit(cores(fit), fit.core.model, True)
    return converged(replace(fit, core=core)) if core.model.period is not None else fit


def with_other_detents(fit: Fit) -> Fit:
    """Return the fit with other detents than it has, where those end lower while more than noise is left.

    A stop that was not in the model yet may have hidden which there are.
    """
    rows = fit.model.catalogue()
    shown = [one for one in base_effects_shown(fit.model.coordinate) if one in fit.model.effects]
    bound = any(rows[one].needs in shown for one in fit.model.effects) or fit.model.joint is not None
    if not shown or bound or not (1.0 - _LOWER) * fit.rmse > fit.noise_floor:
        return fit
    others = with_detents(functools.reduce(drop, shown, fit))
    found = others.model.period is not None and others.rmse < (1.0 - _LOWER) * fit.rmse
    return replace(others, before=fit.before) if found else fit


def _found(first: Fit, last: Fit) -> list[str]:
    """Return what came in, none beside a coupling."""
    if last.model.joint is not None:
        return []
    return [one for one in last.model.effects if one not in first.model.effects]


def _best_of_each(ladder: Sequence[LearningStep]) -> list[Candidate]:
    """Return what could be missing by any step: the best of each first, then what came next there, and so on.

    What an effect explains of the first error, and what of the one that others left, are not of one scale.
    """
    ranked: list[tuple[int, Candidate]] = []
    for step in ladder:
        weighed = step.diagnosis.candidates if step.diagnosis is not None else ()
        could_be = (one for one in weighed if one.beyond_chance and not one.implausible)
        loads = [one for one in could_be if one.place != "coupling"]
        ranked += enumerate(sorted(loads, key=lambda one: -one.score))
    return [one for _, one in sorted(ranked, key=lambda ranked: ranked[0])]


def _score(fit: Fit, first: Fit) -> float:
    """Return what a fit took off the sum of squares less the price of its parameters."""
    return gain(first, fit, fit) - RULE.price * len(fit.core.free)


def _steps(fit: Fit, names: Sequence[str], start: LearningStep, diagnosis: Diagnosis) -> list[LearningStep]:
    """Return the steps to a set: what explains most for its parameters first, each with those before it.

    Of two that explain the same the one with fewer parameters is the cause: gravity, before a detent that is
    wider than the motion.
    """
    alone = {one.effect: one.score for one in diagnosis.candidates}
    order = sorted(names, key=lambda name: -alone.get(name, -math.inf))
    return climbed(fit, order, start.fit, diagnosis)
