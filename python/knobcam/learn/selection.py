"""What a ladder says: which effects were causes, and what remains."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from ..base.said import OfEffect, Said, Stretch, number, said
from ..base.said import joined as in_words
from ..capture.prepare import travel
from ..fit.diagnose import Candidate, Diagnosis
from ..fit.doubts import at_bounds
from ..fit.plausible import filtered_off, friction_drives
from ..fit.rule import RULE
from ..fit.uncounted import tells_nothing
from ..fit.verdict import CHOSEN, judged, within_law
from ..model.effects import base_effects_shown
from .cut import Cut
from .ladder import LearningStep, Unexplained, first_weighed
from .limitations import width
from .together import in_doubt

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from ..fit import Fit
    from ..fit.compare import Comparison


class Selection(NamedTuple):
    """The ladder, which effects were missing, what was weighed last and not added, and what none explains.

    `cut` says what a search did not weigh that did not come to its end.
    """

    ladder: tuple[LearningStep, ...]
    found: tuple[str, ...]
    last: Diagnosis
    unexplained: Unexplained | None
    cut: Cut | None = None


def concluded(ladder: Sequence[LearningStep], last: Diagnosis, base: Collection[str]) -> Selection:
    """Return what the ladder says: which effects were causes, and what remains."""
    end = ladder[-1].fit
    came = dict.fromkeys(step.added for step in ladder if step.added is not None)
    # Detents may come with a joint, whose step bears its name alone.
    came |= dict.fromkeys(base_effects_shown(end.model.coordinate))
    effects_now = end.model.effects
    found = tuple(one for one in came if one in effects_now and one not in base)
    if (fault := end.log_fault) is not None:
        # What is wrong is the log, not the knob.
        return Selection(tuple(ladder), (), last, Unexplained("load", 1.0, fault))
    if (lost := tells_nothing(end.prepared)) is not None:
        # Of the tenth that counts effects explain what they like, and of a line over time what drifts.
        return Selection(tuple(ladder), (), last, Unexplained("load", 1.0, lost))
    unexplained = None if within_law(end) else _unexplained(last.comparison)
    mainly = _causes(ladder, found)
    # Torques of position alone: two of them together draw nearly any map, so together they name no cause.
    maps = [one for one in found if _is_map(one, end)]
    if len(maps) > 1:
        template = "it takes {names} together to draw it, and so many draw any map of position"
        words = said(template, names=in_words(" and ", map(OfEffect, maps)))
        # Where they leave chance alone, it is of the error before them that position has a share.
        before = next(step.diagnosis for step in ladder if step.added in maps)
        seen = last if unexplained or before is None else before
        share = seen.comparison["position"].share
        found = tuple(one for one in found if one not in maps and one in mainly)
        unexplained = Unexplained("position", share, words)
    elif unexplained is not None:
        found = tuple(one for one in found if one in mainly)
    elif len(names := [one for one in found if one not in end.model.laws]) > RULE.believed:
        template = "it takes {names} together to draw it, and so many draw nearly anything"
        words = said(template, names=in_words(", ", map(OfEffect, names)))
        found, unexplained = (), _before(ladder, last)._replace(hint=words)
    # Within less than a detent its pull counts as inertia: that is said as what such a motion cannot tell.
    wrong = end.impossible if width(end) is None else friction_drives(end)
    if unexplained is None and wrong is not None:
        # However little it leaves, it is not this knob that it explains, and what stands beside it no cause.
        found, unexplained = (), Unexplained("load", 1.0, wrong)
    if unexplained is None and (doubt := in_doubt(end, found, _before(ladder, last))) is not None:
        none, unexplained = doubt
        found = tuple(one for one in found if one in mainly and one not in none)
    if unexplained is None and (beyond := end.beyond) is not None:
        unexplained = Unexplained(beyond.axis, beyond.share, beyond.words)
    if unexplained is None and (fast := _out_of_sight(last)) is not None:
        words = said(
            "{effect} would take {fall} off it, in waves of which the torque filter lets too little pass",
            effect=OfEffect(fast.effect),
            fall=number(100.0 * fast.error_fall, "%", ".1f"),
        )
        found = tuple(one for one in found if one in mainly)
        unexplained = Unexplained("position", last.comparison["position"].share, words)
    return Selection(tuple(ladder), found, last, unexplained)


def _out_of_sight(last: Diagnosis) -> Candidate | None:
    """Return what would come in, but for the filter that took off most of what it would make.

    It is not named then, and what came in without it is not all that there is.
    """

    def fast(one: Candidate) -> bool:
        return len(one.implausible) == 1 and [*one.implausible] == filtered_off(one.effect, one.fit)

    ruled_out = {one.effect for one in last.candidates if fast(one)}
    if not ruled_out:
        return None
    weighed = [replace(one, implausible=()) if one.effect in ruled_out else one for one in last.candidates]
    best = next((one for one in judged(last.comparison, weighed) if one.word in CHOSEN), None)
    return best if best is not None and best.effect in ruled_out else None


def cut_short(ladder: Sequence[LearningStep], cut: Cut, base: Collection[str]) -> Selection:
    """Return what a ladder says whose last step was not weighed to the end: no verdict on what is left."""
    fit = ladder[-1].fit
    last = Diagnosis(fit, (), dict.fromkeys(cut.not_weighed, "the search was cut short"))
    known = concluded(ladder, last, base)
    worst = max(last.comparison.splits, key=lambda split: split.share, default=None)
    axis, share = (worst.axis, worst.share) if worst else ("time", 0.0)
    if known.unexplained is not None:
        axis, share = known.unexplained.axis, known.unexplained.share
    return known._replace(unexplained=Unexplained(axis, share, cut.words), cut=cut)


def _is_map(effect: str, fit: Fit) -> bool:
    """Whether an effect draws maps of position, and is not bound to return with each of many detents."""
    row, period = fit.model.catalogue()[effect], fit.model.period
    crossed = 0.0 if row.needs is None or period is None else travel(fit.prepared) / (2.0 * math.pi * period)
    return row.map and crossed < RULE.many


def _causes(ladder: Sequence[LearningStep], found: Collection[str]) -> set[str]:
    """Return the effects that are causes, however much is left: each took off most of what there was.

    Where more came in than are believed, those up to the first in the model that did not: it stands in for
    something else and bends what is left, and what takes off much of that may do no more than straighten it.
    """
    end = ladder[-1].fit
    came = {step.added: _mainly(step) for step in ladder if step.added in end.model.effects}
    mainly = {one for one, most in came.items() if most and one is not None}
    if end.model.joint in mainly:
        # A joint that is missing bends what comes in before it: what each does is seen beside it.
        mainly |= {one for one in found if _most(end, one)}
    elif len(came) > RULE.believed:
        mainly &= {one for one, _ in takewhile(lambda step: step[1], came.items())}
    # What ended at a bound stands in for something else, however much it took off.
    return mainly - {name.split(".", 1)[0] for name in at_bounds(end)}


def _mainly(step: LearningStep) -> bool:
    """Whether the effect of a step took off most of what noise did not explain before it."""
    before = step.fit.before
    return before is not None and before.rmse**2 - step.fit.rmse**2 >= RULE.mainly * before.excess


def _most(fit: Fit, effect: str) -> bool:
    """Whether an effect takes off most of what noise would not explain without it, to first order."""
    worth = fit.core.worth(effect) * fit.noise_floor**2 / fit.white_squares
    return worth * (1.0 - RULE.mainly) >= RULE.mainly * fit.excess


def _before(ladder: Sequence[LearningStep], last: Diagnosis) -> Unexplained:
    """Return what there was to explain before anything came in."""
    weighed = first_weighed(ladder) or last
    return _unexplained(weighed.comparison) or Unexplained("time", 1.0, "")


def _unexplained(comparison: Comparison) -> Unexplained | None:
    if comparison.complete or not comparison.splits:
        return None
    if math.isnan(comparison.fit.noise_floor):
        # No all-clear without it, however little is left.
        largest = max(comparison.splits, key=lambda split: split.mean_share)
        why = said("no noise floor: chance cannot be told from it")
        return Unexplained(largest.axis, largest.mean_share, why)
    worst = comparison.worst or max(comparison.splits, key=lambda split: split.share)
    hint = said("worst at {where}", where=worst.where()) if worst.fails else said("it shows on no axis alone")
    axis = worst.axis
    if axis == "frequency":
        # A disturbance with a rhythm of its own is an event in time.
        axis = "time"
        line = worst.regions[0]
        words = f"a line at {0.5 * (line.start + line.end):.1f} Hz"
        hint = Said(Stretch("frequency", line.start, line.end, "Hz", 0, words))
    return Unexplained(axis, worst.share, hint)
