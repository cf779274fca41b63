"""Which sets of effects captures could not tell from what was found, and the fits of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import InputError
from ..fit.diagnose import check_effects
from ..fit.refit import converged
from .joints import in_place, joints
from .telling import Rival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..capture.formats.units import Coordinate
    from ..fit import Fit
    from .ladder import LearningStep
    from .learning import LearningResult

BASE = "base"
"""The name of the rival with nothing beyond the base model."""
_MOST = 4
_LIKELY = 0.05  # weight from which on an effect is a rival: as likely as a wrong choice that counts as told


def contenders(story: LearningResult, asked: Sequence[str]) -> tuple[Rival, ...]:
    """Return the rivals: those that are asked for, or what was found and what could have come in instead.

    Nothing where the captures told all of it. Raises InputError for what cannot be fitted, and for fewer than
    two.
    """
    if asked:
        check_rivals(asked, story.model.coordinate)
        sets = [_parsed(one, story) for one in asked]
        return tuple(Rival(one, _asked(story, one)) for one in sets)
    found = story.found
    others = [_instead(found, added, other) for added, other in untold(story.ladder)]
    if not others:
        return ()
    sets = list(dict.fromkeys((found, *others)))[:_MOST]
    rivals = []
    for one in sets:
        try:
            rivals.append(Rival(one, _fit(story, one)))
        except InputError:
            continue  # what cannot be fitted beside the others is none
    return tuple(rivals) if len(rivals) > 1 else ()


def untold(steps: Sequence[LearningStep]) -> list[tuple[str, str]]:
    """Return what came in on a ladder and what could have come in instead, the likeliest first.

    What went again is not told from anything; what the model has now is not instead of anything, nor is a
    joint beside one that stays.
    """
    model = steps[-1].fit.model
    there, joined = set(model.effects), set(joints(model.coordinate))
    rows = []
    for step in steps:
        if step.added is None or step.added not in there:
            continue
        weights = step.weights
        likely = [one for one, weight in weights.items() if weight >= _LIKELY]
        for other in dict.fromkeys((*step.equivalent, *likely)):
            second = other in joined and bool(joined & there - {step.added})
            if other not in there and not second:
                rows.append((-weights.get(other, 0.0), step.added, other))
    return [(added, other) for _, added, other in sorted(rows)]


def untold_of_each(steps: Sequence[LearningStep]) -> dict[str, list[str]]:
    """Return the same by what came in."""
    found: dict[str, list[str]] = {}
    for added, other in untold(steps):
        found.setdefault(added, []).append(other)
    return found


def _instead(found: Sequence[str], added: str, other: str) -> tuple[str, ...]:
    return tuple(other if one == added else one for one in found)


def check_rivals(asked: Sequence[str], coordinate: Coordinate) -> None:
    """Raise InputError for names of rivals that are none, and where any are named but not two."""
    sets = {frozenset(_names(one)) for one in asked}
    for names in sets:
        check_effects("rivals", sorted(names), coordinate)
    if len(sets) == 1:
        raise InputError(f"rivals: {', '.join(asked)}: are not two; name two or more that differ")


def _names(text: str) -> tuple[str, ...]:
    names = tuple(one.strip() for one in text.split("+"))
    return () if names == (BASE,) else names


def _parsed(text: str, story: LearningResult) -> tuple[str, ...]:
    names = _names(text)
    base = story.ladder[0].fit.model.effects
    if there := [one for one in names if one in base]:
        raise InputError(f"rivals: {', '.join(there)}: is part of the base model; name what is beyond it")
    return names


def _asked(story: LearningResult, wanted: Sequence[str]) -> Fit:
    """Return the fit of a rival that is asked for; of one that has none it is said which."""
    try:
        return _fit(story, wanted)
    except InputError as error:
        raise InputError(f"rivals: {'+'.join(wanted) or BASE}: {error}") from None


def _fit(story: LearningResult, wanted: Sequence[str]) -> Fit:
    """Return the fit with a set of effects beyond the first model, from what was fitted on the way to it."""
    base = story.ladder[0].fit
    target = {*base.model.effects, *wanted}
    for step in story.ladder:
        if set(step.effects) == target:
            return step.fit
    for step in (one for one in story.ladder if one.diagnosis is not None):
        assert step.diagnosis is not None
        before = set(step.diagnosis.fit.model.effects)
        for one in step.diagnosis.candidates:
            if before | {one.effect} == target and set(one.fit.model.effects) == target:
                return converged(one.fit)
    joined = set(joints(story.model.coordinate))
    other = [*(target & joined)]
    for step in (one for one in story.ladder if joined & {*one.effects} and len(other) == 1):
        # Another joint lies next to where the one that came in ended.
        found = in_place(step.fit, other[0]) if target - joined == {*step.effects} - joined else None
        if found is not None:
            return found
    fit = base
    for effect in wanted:
        fit = fit.add(effect)
    return fit
