"""Which effects come in, in which order, and when to stop."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from ..base.said import OfEffect, Said, Stretch, number, said
from ..base.said import joined as in_words
from ..capture.prepare import travel
from ..fit.absent import absent
from ..fit.diagnose import Candidate, Diagnosis, diagnose, worth_adding
from ..fit.doubts import at_bounds
from ..fit.plausible import columns_at_fault, filtered_off, friction_drives
from ..fit.refit import converged, drop, gain, with_clipped
from ..fit.rule import RULE
from ..fit.uncounted import tells_nothing
from ..fit.verdict import CHOSEN, judged, within_law
from ..model.effects import base_effects_shown, clipping, descriptions
from .cut import Cut, Deadline, OutOfTime
from .earlier import retested, without_help
from .exchanged import anew, exchanged, straightened, with_detents, with_other_detents
from .joined import chance_of, joined, rejoined
from .joints import followed_to, joints, overlooked
from .knocks import beside_play, knocking, quiet, with_play
from .ladder import LearningStep, Unexplained, first_weighed
from .limitations import width
from .loosened import loosened
from .ties import told_again

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

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


def select(
    first: Fit,
    without: Collection[str],
    tell: Callable[[str], None],
    deadline: Deadline,
    *,
    given: bool,
    detents: bool,
) -> Selection:
    """Add effects as long as one is beyond chance, physical and worth it; re-test the earlier ones each time.

    `given` says that a user gave the first model; the base model has detents where there are any, so that
    these are nothing to find. `detents` says that they come in by themselves where the data show them. The
    deadline, or Ctrl-C, cuts the search short.
    """
    coordinate = first.model.coordinate
    fit = with_clipped(first) if clipping(coordinate) - set(without) else first
    ladder = [LearningStep(fit)]
    try:
        grown = _grown(ladder, without, tell, deadline, given=given, detents=detents)
        if (start := joint_first(grown.ladder)) is not None:
            tell(
                said("weighing what could be missing beside {joint} alone", joint=OfEffect(str(start.added)))
            )
            begun = [ladder[0], start]
            again = _grown(begun, without, tell, deadline, given=given, detents=detents)
            grown = again if again.unexplained is None else grown
        if grown.unexplained is not None and (knocks := knocking(grown.ladder, grown.last)) is not None:
            tell(said("weighing what could be missing between the knocks of {it}", it=OfEffect(knocks.joint)))
            rigid = quiet(knocks, ladder[0].fit)
            begun, beside = [rigid], {*without, *joints(coordinate)}
            again = _grown(begun, beside, tell, deadline, given=given, detents=detents)
            if again.unexplained is None and (steps := with_play(knocks, again.ladder)) is not None:
                base = _nothing_to_find(first, given=given)
                again = concluded(steps, diagnose(steps[-1].fit, only=()), base)
            else:
                begun = [rigid, beside_play(knocks, rigid)]
                again = _grown(begun, without, tell, deadline, given=given, detents=detents)
            found = again.unexplained is None and knocks.joint in again.found
            grown = again if found else grown
        told = told_again(grown.ladder, tell, deadline)
        if told[-1].fit is grown.ladder[-1].fit:
            return grown._replace(ladder=told)
        return concluded([*told], diagnose(told[-1].fit, only=()), _nothing_to_find(first, given=given))
    except (OutOfTime, KeyboardInterrupt) as ended:
        return _cut_short(ladder, deadline.cut(ended), given=given)


def _grown(
    ladder: list[LearningStep],
    without: Collection[str],
    tell: Callable[[str], None],
    deadline: Deadline,
    *,
    given: bool,
    detents: bool,
) -> Selection:
    """Let a ladder grow in place to its end."""
    first = ladder[0].fit
    coordinate = first.model.coordinate
    described, shown = descriptions(coordinate), base_effects_shown(coordinate)
    base = first.model.effects
    nothing_to_find = _nothing_to_find(first, given=given)
    together = sets = False
    helped: set[str] = set()

    def weighed_together(diagnosis: Diagnosis, beside: Fit) -> list[LearningStep] | None:
        tell("weighing what could be missing together with a joint of shaft and knob")
        deadline.weighing = ["sets of a joint and another effect"]
        return joined(diagnosis, beside, {*without, *described}, deadline)

    while True:
        fit = ladder[-1].fit
        there = in_words(", ", map(OfEffect, fit.model.effects))
        tell(said("weighing what could be missing from {there}", there=there))
        deadline.weighing = absent(fit, {*without, *described})[0]
        deadline()
        diagnosis = worth_adding(fit, without, deadline)
        diagnosis = overlooked(diagnosis, {*without, *described}, deadline)
        best = diagnosis.best
        if (freer := loosened(diagnosis, best.score if best else 0.0)) is not None:
            ladder[-1] = replace(ladder[-1], fit=freer)
            continue
        if not together and len(ladder) == 1 and bent(diagnosis):
            together = True
            pair = weighed_together(diagnosis, best.fit if best else fit)
            if pair is not None:
                ladder[1:] = pair
                continue
        if best is None and not sets and not fit.log_fault and fit.noise_floor > 0.0:
            tell("weighing what came in against other sets")
            if (lower := anew(ladder, diagnosis.comparison, deadline)) is not None:
                ladder[-1] = replace(ladder[-1], fit=lower)
                continue
            if (steps := straightened(diagnosis, deadline)) is not None:
                ladder += steps
                continue
            sets = True
            if (steps := exchanged(ladder, diagnosis.comparison, deadline)) is not None:
                ladder[1:] = steps
                continue
            if (steps := rejoined(ladder, {*without, *described}, deadline)) is not None:
                ladder[1:] = steps
                continue
        if best is None or len(ladder) > RULE.most or columns_at_fault(fit.prepared):
            selection = concluded(ladder, diagnosis, nothing_to_find)
            # What is wrong with a log, or lies beyond its filter, no effect explains.
            enough = diagnosis.comparison.complete or within_law(fit)
            if together or fit.log_fault or enough or not fit.noise_floor > 0.0:
                return selection
            led = followed(diagnosis, tell)
            best = led.best if led is not None else None
            diagnosis = led or diagnosis
        if best is None:
            together = True
            pair = weighed_together(first_weighed(ladder) or diagnosis, fit)
            if pair is None:
                return selection
            ladder[1:] = pair
            continue
        tell(said("adding {best}", best=OfEffect(best.effect)))
        best, richer = followed_to(diagnosis, best)
        if detents and richer.model.period is None:
            richer = with_detents(richer)
        tell("re-testing the effects that came in before")
        came = {*(step.added for step in ladder), *shown}
        tested = [one for one in richer.model.effects if one in came and one not in (*base, best.effect)]
        if best.effect not in helped and (lower := without_help(richer, best, fit)) is not None:
            helped.add(best.effect)
            ladder[-1] = replace(ladder[-1], fit=lower)
            continue
        richer, dropped = retested(richer, [*tested, *(one for one in shown if detents and one in base)])
        richer = replace(converged(richer) if dropped else richer, before=fit)
        richer = with_other_detents(richer) if detents else richer
        ladder.append(LearningStep(richer, best.effect, best.p_value, best.equivalent, dropped, diagnosis))


def _nothing_to_find(first: Fit, *, given: bool) -> Collection[str]:
    """Return the effects that are no finding: those of a first model that was given, or the base's."""
    base = first.model.effects
    return base if given else [*base, *base_effects_shown(first.model.coordinate)]


def concluded(ladder: list[LearningStep], last: Diagnosis, base: Collection[str]) -> Selection:
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
        weighed = first_weighed(ladder) or last
        bare = _unexplained(weighed.comparison) or Unexplained("time", 1.0, "")
        found, unexplained = (), bare._replace(hint=words)
    # Within less than a detent its pull counts as inertia: that is said as what such a motion cannot tell.
    wrong = end.impossible if width(end) is None else friction_drives(end)
    if unexplained is None and wrong is not None:
        # However little it leaves, it is not this knob that it explains, and what stands beside it no cause.
        found, unexplained = (), Unexplained("load", 1.0, wrong)
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


def _cut_short(ladder: list[LearningStep], cut: Cut, *, given: bool) -> Selection:
    """Return what a ladder says whose last step was not weighed to the end: no verdict on what is left."""
    fit = ladder[-1].fit
    last = Diagnosis(fit, (), dict.fromkeys(cut.not_weighed, "the search was cut short"))
    known = concluded(ladder, last, _nothing_to_find(ladder[0].fit, given=given))
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


def joint_first(ladder: Sequence[LearningStep]) -> LearningStep | None:
    """Return the step to a joint alone that came in after others, where more came in than are believed.

    What came in before it may have stood in for it, and what came in after it for what that bent. None where
    it came in first, and without one.
    """
    last, diagnosis = ladder[-1].fit, first_weighed(ladder)
    came = [step.added for step in ladder if step.added in last.model.effects]
    joint = last.model.joint
    if diagnosis is None or joint not in came[1:] or len(came) <= RULE.believed or last.log_fault is not None:
        return None
    bare = last
    for one in came:
        # What changes another went with that.
        if one is not None and one != joint and one in bare.model.effects:
            bare = drop(bare, one)
    alone = replace(converged(bare), before=diagnosis.fit)
    p_value = chance_of(alone, diagnosis.fit, diagnosis)
    return LearningStep(alone, joint, p_value, (), (), diagnosis) if p_value <= RULE.chance else None


def followed(diagnosis: Diagnosis, tell: Callable[[str], None]) -> Diagnosis | None:
    """Return a diagnosis with the coupling that leads the candidates followed to its end; None without one.

    Candidates are sketched, and the error of a coupling is so rough that a sketch may stop far from its end.
    """
    led = [one for one in diagnosis.candidates if one.beyond_chance and not one.implausible]
    best = max(led, key=lambda one: one.score, default=None)
    if best is None or best.place != "coupling":
        return None
    tell(said("following {best} to its end", best=OfEffect(best.effect)))
    fit = diagnosis.fit
    end = replace(best, fit=replace(converged(best.fit), before=fit))
    end = replace(end, gain=gain(fit, end.fit, fit))
    rest = [one for one in diagnosis.candidates if one is not best]
    return replace(diagnosis, candidates=judged(diagnosis.comparison, [end, *rest]))


def bent(diagnosis: Diagnosis) -> bool:
    """Whether a joint leads that cannot be one by its values, and what would be added in its place is a part.

    What loads the shaft beside it bends it so; one after the other neither is found.
    """
    led = max(diagnosis.candidates, key=lambda one: one.score, default=None)
    best = diagnosis.best
    open_still = best is None or best.word == "part"
    return led is not None and led.place == "coupling" and led.word == "implausible" and open_still


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
