"""The search for laws of what a story leaves: beside which models, and which of them is said."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base.said import OfEffect, said
from ..errors import InputError
from ..fit.beyond import incoherent
from ..fit.diagnose import Diagnosis, diagnose
from ..fit.doubts import at_floor, below_zero
from ..fit.refit import converged, cores, gain, started
from ..fit.rule import RULE
from ..model.effects import base_effects_shown, descriptions, effects
from ..model.own import forget_effect
from ..model.own_law import free_name, own_law
from .exchanged import with_detents
from .left import Need, drawn, mapped
from .proposals import Proposal, Proposals

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..fit import Fit
    from .learning import LearningResult

_SCALE = re.compile(r"a\d*")  # what the search calls the amplitudes of its laws
FITTED = 5
"""Laws that are fitted with the whole model, and so end up in the front: the best and the shortest."""
NAMED = 2
"""Parameters that a sum of laws has to do without before it takes the place of a name."""
MOSTLY = 0.8
"""Share of what a law with a constant that nothing determines explains, from which one without is as good."""
SAME = 1.0
"""Variances of the noise by which two laws that are one, written anew, may differ in what they explain."""


def propose(story: LearningResult, progress: Callable[[float], object] | None = None) -> Proposals:
    """Return laws for what a story leaves unexplained, none where a name or chance explains as much.

    `progress` is told the share of the work that is done; what it raises ends the work.
    """
    last = story.fit
    if why := _needless(story):
        return Proposals(last, why=why)

    def spoken(one: tuple[Any, ...]) -> float:
        return _speaks(story, one[0], one[1], one[-1])

    several = {fit.model.effects: fit for fit in _bases(story)}
    best = max((_found(story, fit, progress) for fit in several.values()), key=spoken)
    # Of what came in without explaining it, nothing is needed if a law explains as much without.
    more = not _closed(story) and last.model.effects not in several
    if more and _most(story, last) > spoken(best):
        best = max(best, _found(story, last, progress), key=spoken)
    if best[1] and (detented := _detented(best[0], best[1][0])) is not None:
        best = max(best, _found(story, detented, progress), key=spoken)
    fit, laws, p_value, curve, shapes = best
    none = Proposals(fit, p_value=p_value)
    if _closed(story) and _speaks(story, fit, laws) <= _speaks(story, last, []) + RULE.alike:
        return replace(none, why="what came in explains as much, and has names")
    if not laws:
        return replace(none, why="what is left is no more than chance makes of so many laws, or too little")
    shortest = min(laws, key=lambda row: row[5])
    rows = laws[:FITTED] if shortest in laws[:FITTED] else [*laws[: FITTED - 1], shortest]
    ordered = _ordered([(_fitted(fit, row), row[4]) for row in rows])
    if (name := _named(story, fit, max(ordered, key=lambda one: one.score))) is not None:
        return replace(none, why=said("{name} explains as much, and has a name", name=OfEffect(name)))
    needs, surface, written = shapes
    if written is not None:
        row, unseen = written
        ordered = (*ordered, replace(_fitted(fit, row), unseen=unseen * fit.rmse))
    line = None if curve is None else drawn(curve, [row[0] for row in laws])
    return Proposals(
        fit,
        ordered,
        p_value,
        line,
        needs=tuple(Need(tuple(sorted(names)), left, p) for names, left, p in needs),
        map=None if surface is None else mapped(surface, fit),
    )


def _found(story: LearningResult, fit: Fit, progress: Callable[[float], object] | None) -> tuple[Any, ...]:
    """What the core proposes beside a model, after it; no sum of which a part is what the first model has."""
    whole = {*story.ladder[0].fit.model.effects} <= {*fit.model.effects}
    return (fit, *_core.propose(cores(fit), fit.core.model, whole, progress))


def _bases(story: LearningResult) -> list[Fit]:
    """The models beside which laws are looked for anyway: the first, and without what it need not have.

    Detents of the first model may be a law's wave.
    """
    first = story.ladder[0].fit
    shown = base_effects_shown(first.model.coordinate)
    bare = [first.drop(one) for one in shown if one in first.model.effects]
    return [first, *bare]


def _detented(fit: Fit, row: Any) -> Fit | None:
    """The fit with the detents that only show beside a law; None where there are none."""
    if fit.model.period is not None or not base_effects_shown(fit.model.coordinate):
        return None
    law = _fitted(fit, row)
    whole = with_detents(law.fit)
    if whole.model.period is None:
        return None
    core = whole.core.model.only([one for one in whole.model.effects if one != law.name])
    return replace(fit, core=_core.refine(cores(fit), core, False))


def _closed(story: LearningResult) -> bool:
    """Whether names leave chance alone, though it may take so many that they are no explanation."""
    return story.verdict != "unexplained" or story.after.complete


def _needless(story: LearningResult) -> str:
    """Why there is nothing to propose; empty where there is."""
    if story.verdict != "unexplained" and len(story.found) < 2:
        (cause,) = story.found or ("",)
        explains = said("{cause} explains what is missing", cause=OfEffect(cause))
        return explains if cause else "chance explains what is left"
    if story.cut is not None:
        return "the search for names was cut short"
    fit = story.fit
    if fit.log_fault is not None:
        return "the log is to be mended first"
    if not fit.noise_floor > 0.0:
        return "how much of the error is noise is not known"
    if incoherent(fit):
        return "what is left cannot be told from errors of the recorded motion"
    if story.after.complete and len(story.ladder) == 1:
        return "what is left is chance"
    return ""


def _speaks(story: LearningResult, fit: Fit, laws: list[Any], shapes: Any = None) -> float:
    """What speaks for a model with the first of some laws, or what no formula says, beside the first step's.

    A sum of laws in place of what came in under a name has to explain it with less.
    """
    first = story.ladder[0].fit
    effects = len(fit.core.free) - len(first.core.free)
    own = _worth(laws[0]) if laws else 0.0
    if laws and laws[0][6] > 1 and story.found and fit is not story.fit:
        own -= NAMED * RULE.price
    if shapes is not None and shapes[-1] is not None:
        law = shapes[-1][0]
        own = max(own, law[3] - RULE.price * law[5])
    return float(gain(first, fit, first) - RULE.price * effects + own)


def _most(story: LearningResult, fit: Fit) -> float:
    """What could speak for a model with laws at the most: that they leave noise alone, with one parameter."""
    beyond = (fit.rmse**2 / fit.noise_floor**2 - 1.0) * fit.white_squares
    return _speaks(story, fit, []) + beyond - RULE.price


def _worth(row: Any) -> float:
    """What a law of the search takes off, less the price of its parameters."""
    return float(row[3] - RULE.price * row[7])


def _fitted(fit: Fit, row: Any) -> Proposal:
    """A law of the search, fitted with the whole model."""
    law, values, variables, _, _, complexity, *_ = row
    name = free_name(fit.model)
    own_law(name, law)
    try:
        richer = converged(started(fit, name, dict(values)))
    finally:
        forget_effect(name)
    taken = gain(fit, richer, fit)
    return Proposal(law, name, tuple(sorted(variables)), richer, float(taken), complexity)


def _ordered(proposals: list[tuple[Proposal, bool]]) -> tuple[Proposal, ...]:
    """Laws in the order of the search, one of those that say the same, written anew or not; some later.

    Of those that explain as much as the best those that bend what resists below zero beyond doubt; and of
    which a part may be nothing, where one without such a part explains most of as much. There those with a
    constant that nothing determines are none: what they mean is their limit, and no number says it.
    """
    bent = [(not alike, len(below_zero(one.fit)) if alike else 0) for one, alike in proposals]
    laws = [proposals[at][0] for at in sorted(range(len(proposals)), key=bent.__getitem__)]
    # The same formula may end with other constants: they are one law, whose best ones come first.
    laws = [one for at, one in enumerate(laws) if all(one.label != other.label for other in laws[:at])]
    laws = [one for one in laws if not any(_anew(one, other) for other in laws)]
    most = MOSTLY * max((one.gain for one in laws), default=0.0)
    known = [one for one in laws if all(e.determined for e in one.params.values())]
    if any(one.gain >= most for one in known):
        laws = known
    whole = [one for one in laws if one.gain >= most and not _in_part(one)]
    if whole:
        # The best for its parameters: the search's order is of laws that were fitted alone.
        best = max(whole, key=lambda one: one.score)
        laws.sort(key=lambda one: one is not best)
    return tuple(laws)


def _in_part(one: Proposal) -> bool:
    """Whether what scales a law, or a part of a sum, is not known to be more than nothing."""
    scales = [e for name, e in one.params.items() if _SCALE.fullmatch(name)]
    return any(not e.determined or e.ci95[0] <= 0.0 <= e.ci95[1] for e in scales)


def _anew(one: Proposal, other: Proposal) -> bool:
    """Whether a law is another one that is shorter, written anew: it explains the same."""
    same = one.variables == other.variables and abs(one.gain - other.gain) <= SAME
    return same and one.complexity > other.complexity


def _named(story: LearningResult, fit: Fit, law: Proposal) -> str | None:
    """The effect of the catalogue that explains as much beside the same model, if one does."""
    weighed = _weighed(story, fit)
    came = gain(weighed.fit, fit, fit)
    # A law that leaves noise alone shows what a name is off by: either may be by as much as a textbook's.
    share = (2.0 * RULE.law) ** 2 if at_floor(law.fit) else RULE.relative
    # A spring has a centre, and costs a parameter more than a law through zero.
    margin = max(RULE.alike + RULE.price, share * law.gain)
    alike = [
        one
        for one in weighed.candidates
        if one.beyond_chance and not one.implausible and one.score >= law.score + came - margin
    ]
    return max(alike, key=lambda one: one.score).effect if alike else None


def _weighed(story: LearningResult, fit: Fit) -> Diagnosis:
    """What was weighed beside a model, or is now where it was none of the story's; joints take too long."""
    if fit is story.fit:
        return story.last
    if fit is story.ladder[0].fit:
        return story.first_diagnosis
    catalogue = effects(fit.model.coordinate)
    joints = {one for one, row in catalogue.items() if row.place == "coupling"}
    return diagnose(fit, without={*story.without, *descriptions(fit.model.coordinate), *joints})


def accepted(proposals: Proposals, number: int, name: str | None = None) -> tuple[str, Fit]:
    """Register a proposed law under a name, and return the name and the fit with it.

    Raises InputError for a number that no law has.
    """
    if not 1 <= number <= len(proposals.laws):
        have = f"there are {len(proposals.laws)}" if proposals.laws else f"there are none: {proposals.why}"
        raise InputError(f"--accept {number}: no proposal has that number; {have}")
    one = proposals.laws[number - 1]
    name = name or free_name(proposals.beside.model)
    start = {param: estimate.value for param, estimate in one.params.items()}
    own_law(name, one.law)
    return name, converged(started(proposals.beside, name, start))
