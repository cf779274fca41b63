"""What a branch tells: its ladder, and the learning result that a report is made of."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from ..fit import refit
from ..fit.diagnose import diagnose
from ..learn import LearningResult
from ..learn.ladder import LearningStep
from ..learn.selection import Selection, concluded
from ..model.effects import base_effects_shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..fit.diagnose import Candidate, Diagnosis
    from .tree import Node


def ladder(done: Sequence[Node]) -> list[LearningStep]:
    """Return the ladder of nodes: one step for the first model, one for each effect that was added.

    An effect that was dropped changes the step that it was dropped from. Where other captures came in the
    ladder starts anew, for errors on different captures cannot be compared: with all that came in before
    where the model went on, fitted to these captures.
    """
    steps: list[LearningStep] = []
    for node in done:
        if node.how == "fitted":
            steps = _carried(node, steps) if node.onward else [LearningStep(node.fit)]
        elif node.how == "added":
            fitted = replace(node.fit, before=steps[-1].fit)
            evidence = (node.effect, node.p_value, node.equivalent, node.also_dropped, node.diagnosis)
            steps.append(LearningStep(fitted, *evidence))
        else:
            last = steps.pop()
            before = steps[-1].fit if steps else None
            dropped = (*last.dropped, node.effect) if node.effect else last.dropped
            steps.append(replace(last, fit=replace(node.fit, before=before), dropped=dropped))
    return steps


def carried(done: Sequence[Node]) -> list[LearningStep]:
    """Return the steps of what a model brought along to the captures of a branch; none of a new model."""
    last = max((at for at, node in enumerate(done) if node.how == "fitted"), default=0)
    return ladder(done[: last + 1]) if done and done[last].onward else []


_CARRIED: WeakKeyDictionary[Node, list[LearningStep]] = WeakKeyDictionary()


def _carried(node: Node, before: Sequence[LearningStep]) -> list[LearningStep]:
    """Return the steps to a fit that went on with what had come in; fitted once, for it takes its time."""
    if node not in _CARRIED:
        came = [step for step in before if step.added in node.fit.model.effects]
        fits = [node.fit]
        for step in reversed(came):
            assert step.added is not None
            fits.insert(0, fits[0].drop(step.added))
        steps = [LearningStep(fits[0])]
        for step, bare, fit in zip(came, fits, fits[1:], strict=False):
            of = (step.added, step.p_value, (), step.dropped, diagnose(bare, only=()))
            steps.append(LearningStep(replace(fit, before=bare), *of))
        _CARRIED[node] = steps
    return list(_CARRIED[node])


def in_vain(steps: Sequence[LearningStep]) -> list[str]:
    """Return the effects that were added and took off no more than an effect has to.

    One that was weighed before and could be missing is none of them, as it is not where `learn` takes it in.
    """
    return [
        step.added
        for step in steps
        if step.added is not None
        and step.fit.before is not None
        and step.fit.noise_floor > 0.0
        and refit.needless(step.fit, step.fit.before)
        and not any(one.effect == step.added and one.could_be for one in _weighed(step))
    ]


def _weighed(step: LearningStep) -> Sequence[Candidate]:
    return () if step.diagnosis is None else step.diagnosis.candidates


def conclusion(steps: list[LearningStep], last: Diagnosis, needless: Sequence[str] = ()) -> Selection:
    """Return what a ladder says that ends where `last` was weighed.

    What is `needless` is named as no cause, though it is still there: `learn` would have taken it out.
    """
    base = steps[0].fit.model
    no_causes = [*base.effects, *base_effects_shown(base.coordinate), *in_vain(steps), *needless]
    return concluded(steps, last, no_causes)


def learned(done: Sequence[Node], last: Diagnosis, needless: Sequence[str] = ()) -> LearningResult:
    """Return what was learned along nodes that end where `last` was weighed."""
    return LearningResult(*conclusion(ladder(done), last, needless))
