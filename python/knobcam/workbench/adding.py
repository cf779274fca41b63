"""What comes into the model of a session: an effect that a person adds, or all that `learn` finds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..base.said import OfEffect, Said, joined, number, said
from ..errors import InputError
from ..fit import refit
from ..fit.fitting import as_logged
from ..learn import LearningResult
from ..learn.cut import Deadline, OutOfTime
from ..learn.earlier import retested
from ..learn.exchanged import looked_anew, with_detents
from ..learn.search import Search
from ..model.effects import base_effects_shown
from .learned import in_vain, ladder, learned
from .tree import Node, Start

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..fit import Fit
    from ..learn.ladder import LearningStep
    from ..learn.selection import Selection
    from .session import Session
    from .tell import Tell


def add(session: Session, effect: str, tell: Tell) -> None:
    """Add an effect and fit anew; detents come along where they show beside it, as in a search.

    Detents that nobody asked for go where it makes them needless.

    Raises InputError for an effect that the model cannot be given.
    """
    branch, node = session.branch, session.node
    refit.check(effect, node.fit.model)
    doing = said("adding {effect}", effect=OfEffect(effect))
    tell(doing)
    diagnosis = session.diagnosis_of(node.id)
    weighed = [one for one in diagnosis.candidates if one.effect == effect] if diagnosis else []
    evidence: dict[str, Any] = {"diagnosis": diagnosis}
    if weighed:
        evidence |= {"p_value": weighed[0].p_value, "equivalent": weighed[0].equivalent}
    # What was weighed has been fitted with the effect already, and only has to converge; where clipped
    # samples were counted for that, it was a fit of something else.
    if weighed and diagnosis is not None and diagnosis.fit is node.fit:
        richer = refit.converged(weighed[0].fit)
    else:
        richer = refit.add(node.fit, effect, lambda _: tell(doing))
    by_themselves = unasked(session, effect, richer)
    richer, along = came_along(richer) if _may_come(session, richer) else (richer, ())
    richer, gone = retested(richer, by_themselves)
    richer, again = _beside(ladder(branch.done), richer, effect, lambda _: tell(doing))
    evidence |= {"along": along, "also_dropped": gone, "again": again}
    tell(said("putting {effect} in place", effect=OfEffect(effect)), last=True)
    made = Node(session.new("n"), richer, node.captures, "added", effect, **evidence)
    session.put([made], branch, node)


def came_along(fit: Fit) -> tuple[Fit, tuple[str, ...]]:
    """Return the fit with detents where the data show them beside what came in, and what came so."""
    richer = with_detents(fit)
    return richer, tuple(one for one in richer.model.effects if one not in fit.model.effects)


def _may_come(session: Session, fit: Fit) -> bool:
    """Whether detents may come in by themselves: there are none, and nobody took them out."""
    if fit.model.period is not None or not _by_themselves(session.start):
        return False
    out = {node.effect for node in session.branch.done if node.how == "dropped"}
    return out.isdisjoint(base_effects_shown(fit.model.coordinate))


def _by_themselves(start: Start) -> bool:
    """Whether what the data show of the base model is in it, unless somebody said what is."""
    return start.model is None and start.options.get("detents", "auto") == "auto"


def _beside(
    steps: Sequence[LearningStep], fit: Fit, effect: str, progress: Callable[[float], object]
) -> tuple[Fit, str | None]:
    """Return a fit in which what came in before is what it is beside a new effect, and what was sought anew.

    It was looked for in the error of both: friction that rises towards standstill, say, over the whole range
    of speeds where a drag was missing, and from there no fit comes back.
    """
    came = [one.added for one in steps if one.added in fit.model.effects and one.added != effect]
    if not came or fit.model.joint is not None or fit.compare().complete:
        return fit, None
    return looked_anew(fit, [one for one in came if one], progress) or (fit, None)


def unasked(session: Session, effect: str, fit: Fit) -> list[str]:
    """Return the effects of a fit that came by themselves, as detents do where the data show some.

    None that somebody added, nor what an effect that comes in now builds on.
    """
    if not _by_themselves(session.start):
        return []
    asked = {effect, fit.model.catalogue()[effect].needs, *(one.effect for one in session.branch.done)}
    return [
        one
        for one in base_effects_shown(fit.model.coordinate)
        if one in fit.model.effects and one not in asked
    ]


def needless(session: Session, node: Node) -> list[str]:
    """Return what somebody added before and what came in since does as well: `learn` takes it out again.

    What took off too little from the first is none of it, for that is said.
    """
    done, fit = session.branch.done, node.fit
    if done[-1] is not node or node.rung is not None or not fit.noise_floor > 0.0:
        return []
    there = [one for one in ladder(done)[:-1] if one.added in fit.model.effects]
    came = [one.added for one in there if one.added and one.added != node.effect]
    vain = in_vain(ladder(done))
    return list(retested(fit, [one for one in came if one not in vain])[1])


class _Heard(Deadline):
    """The time of a search that a person sees go on, and can end: how much of each stage is done is told."""

    def __init__(self, tell: Tell, enough: Callable[[], bool]) -> None:
        super().__init__(float("inf"))
        self._tell, self._enough, self._doing = tell, enough, ""

    def say(self, doing: str) -> None:
        """Begin a stage."""
        self._doing = doing
        self._tell(doing)

    def __call__(self, done: float | None = None) -> None:
        """Say how much of the stage is done; what that raises ends the search."""
        self._tell(self._doing, done or None)
        if self._enough():
            raise OutOfTime


def search(session: Session, tell: Tell, enough: Callable[[], bool]) -> Said:
    """Find everything that is missing, as `knobcam learn` does, and put its steps in place one by one.

    It begins with the first model, whatever has come in by hand. Where a person has `enough` before its end,
    what it had come to is put in place all the same, and it is said that it was ended. Raises InputError as
    `knobcam.learn` does, and where that was done already.
    """
    branch, node, start = session.branch, session.node, session.start
    if node.id in session.searched:
        raise InputError("everything that is found of these captures is in the model already")
    heard = _Heard(tell, enough)
    heard.say("fitting the first model")
    captures = [session.captures[one].capture for one in node.captures]
    first = as_logged(captures, start.model, **start.options)
    foreign = session.laws_of_others(node) & set(first.model.catalogue())
    given = start.model is not None
    found = Search(first, foreign, heard.say, heard, given=given, detents=_by_themselves(start)).selected()
    if found.cut is not None and len(found.ladder) == 1:
        return _ended(found)  # nothing had come in
    told = LearningResult(*found)
    _ = told.params  # computed here, where it is seen that it takes its time
    tell("putting what was found in place", last=True)
    made = _nodes(session, found, node)
    with session.lock:
        if found.cut is None:  # else what could be missing is still to be weighed
            session.searched[made[-1].id if made else node.id] = told
        for one, step in zip([node, *made], found.ladder[-len(made) :] if made else (), strict=False):
            if step.diagnosis is not None and step.diagnosis.whole and step.diagnosis.fit is one.fit:
                session.diagnoses[one.id] = step.diagnosis  # for whoever goes back
        if made:
            session.put(made, branch, node)
        else:
            session.touched()
    return _ended(found)


def _ended(found: Selection) -> Said:
    """Return what is to be said of a search that a person ended, nothing of any other."""
    if found.cut is None:
        return Said()
    came = [OfEffect(step.added) for step in found.ladder if step.added]
    after = number(found.cut.after_s, "s", ".0f")
    if not came:
        return said("the search was ended after {after}; nothing had come in yet", after=after)
    what = joined(", ", came)
    return said("the search was ended after {after}; by then it had found: {what}", after=after, what=what)


def _nodes(session: Session, found: Selection, node: Node) -> list[Node]:
    """Return the steps of a search as those of a session, without the first where it is there already."""
    rungs = list(enumerate(found.ladder))
    if not node.onward and node.how == "fitted" and _same(node.fit, found.ladder[0].fit):
        rungs = rungs[1:]
    return [
        Node(
            session.new("n"),
            step.fit,
            node.captures,
            "fitted" if step.added is None else "added",
            step.added,
            p_value=step.p_value,
            equivalent=step.equivalent,
            diagnosis=step.diagnosis,
            also_dropped=step.dropped,
            rung=rung,
            cut=found.cut is not None,
        )
        for rung, step in rungs
    ]


def _same(one: Fit, other: Fit) -> bool:
    """Whether two fits are of the same samples and came to the same model."""
    counted = [sum(int(signals.core.used) for signals in fit.prepared) for fit in (one, other)]
    return counted[0] == counted[1] and one.model.text() == other.model.text()


def story(session: Session, tell: Tell) -> LearningResult:
    """Return what was learned where a session is: by a search that ended there, or on the way to it."""
    node = session.node.id
    if (searched := session.searched.get(node)) is not None:
        return searched
    last = session.weigh(tell)
    return learned(session.branch.done, last, session.needless.get(node, ()))
