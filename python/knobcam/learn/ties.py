"""Whether what could not be told apart when it came in still cannot, beside what came in after it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.said import OfEffect, Said, joined, said
from ..errors import InputError
from ..fit.diagnose import diagnose
from ..fit.doubts import at_floor
from ..fit.refit import converged, drop, paid, started
from ..fit.rule import RULE
from .cut import OutOfTime
from .joined import climbed
from .ladder import first_weighed

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from ..fit import Fit
    from .cut import Deadline
    from .ladder import LearningStep


def with_ties(found: Sequence[str], ladder: Sequence[LearningStep]) -> list[Said]:
    """Return what was found, each with what the captures cannot tell it from in brackets."""
    there = ladder[-1].fit.model.effects
    alike = {step.added: [one for one in step.equivalent if one not in there] for step in reversed(ladder)}
    return [_or(one, alike.get(one, ())) for one in found]


def _or(found: str, alike: Sequence[str]) -> Said:
    if not alike:
        return Said(OfEffect(found))
    others = joined(" or ", map(OfEffect, alike))
    return said("{found} (or {others})", found=OfEffect(found), others=others)


def told_again(
    ladder: Sequence[LearningStep], tell: Callable[[str], None], deadline: Deadline
) -> tuple[LearningStep, ...]:
    """Return the steps, each with what still explains as much in the place of what it added.

    What explains more there beside a joint takes the place: what came in before it was told from others in
    what the joint bent. Where the time is over, and beside a joint where more than noise is left, ties stay
    as they were.
    """
    last = ladder[-1].fit
    rows = last.model.catalogue()
    joint = any(rows[one].place == "coupling" for one in last.model.effects)
    if joint and not at_floor(last):
        return tuple(ladder)
    steps = list(ladder)
    for at, step in enumerate(ladder[:-1]):
        others = [one for one in step.equivalent if one not in last.model.effects]
        if step.added not in last.model.effects or not others:
            continue
        bare = drop(last, step.added)
        if len(bare.model.effects) < len(last.model.effects) - 1:
            continue  # what changes it would have to go too
        names = joined(", ", map(OfEffect, others))
        tell(said("weighing {added} against {others} again", added=OfEffect(step.added), others=names))
        try:
            deadline()
            if joint:
                ends = _as_far(bare, step, others)
                if (better := _better(ends, last)) is not None:
                    return _with(better, ladder, at)
                still: Collection[str] = ends
            else:
                still = _alike(converged(bare), step, others, deadline)
        except OutOfTime:
            break
        steps[at] = replace(step, equivalent=tuple(one for one in step.equivalent if one in still))
    return tuple(steps)


def _alike(bare: Fit, step: LearningStep, others: Sequence[str], deadline: Deadline) -> tuple[str, ...]:
    """Return what explains as much beside the others as what a step added."""
    assert step.added is not None
    weighed = diagnose(bare, only=[step.added, *others], progress=deadline)
    known = {one.effect: one for one in weighed.candidates}
    return known[step.added].equivalent if step.added in known else ()


def _as_far(bare: Fit, step: LearningStep, others: Sequence[str]) -> dict[str, Fit]:
    """Return what leaves chance alone beside a joint too, from the values that it had when it was weighed."""
    ends = {}
    for other in others:
        weighed = step.diagnosis[other].parameters if step.diagnosis is not None else {}
        start = {name.partition(".")[2]: one.value for name, one in weighed.items() if "@" not in name}
        try:
            near = started(bare, other, start, RULE.hopeless * bare.noise_floor)
        except InputError:
            continue  # another joint does not go beside the one that there is
        if near.rmse < RULE.hopeless * near.noise_floor and at_floor(end := converged(near)):
            ends[other] = end
    return ends


def _better(ends: Mapping[str, Fit], last: Fit) -> tuple[str, Fit] | None:
    """Return the end that explains most for its parameters, if it is told from the fit that there is."""
    won = {name: paid(fit, last, last) for name, fit in ends.items()}
    name = max(won, key=won.__getitem__, default=None)
    if name is None or won[name] <= RULE.alike or ends[name].impossible is not None:
        return None
    return name, ends[name]


def _with(better: tuple[str, Fit], ladder: Sequence[LearningStep], at: int) -> tuple[LearningStep, ...]:
    """Return the steps that lead to a fit with another effect in the place of what a step added."""
    other, fit = better
    diagnosis = first_weighed(ladder)
    assert diagnosis is not None  # a tie is of what was weighed
    came = [other if step is ladder[at] else step.added for step in ladder]
    names = [one for one in came if one is not None and one in fit.model.effects]
    return (ladder[0], *climbed(fit, names, ladder[0].fit, diagnosis))
