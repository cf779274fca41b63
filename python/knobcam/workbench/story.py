"""What a branch tells: its ladder, and the story that a report is made of."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..learn import Story
from ..learn.ladder import Rung
from ..learn.selection import Selection, concluded, unpaid
from ..model.effects import base_effects_shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..fit.diagnose import Diagnosis
    from .tree import Node


def ladder(done: Sequence[Node]) -> list[Rung]:
    """Return the ladder of nodes: one rung for the first model, one for each effect that was added.

    An effect that was dropped changes the rung that it was dropped from. Where other captures came in the
    ladder starts anew: errors on different captures cannot be compared.
    """
    rungs: list[Rung] = []
    for node in done:
        if node.how == "fitted":
            rungs = [Rung(node.fit)]
        elif node.how == "added":
            fitted = replace(node.fit, before=rungs[-1].fit)
            evidence = (node.effect, node.p_value, node.equivalent, (), node.diagnosis)
            rungs.append(Rung(fitted, *evidence))
        else:
            last = rungs.pop()
            before = rungs[-1].fit if rungs else None
            dropped = (*last.dropped, node.effect) if node.effect else last.dropped
            rungs.append(replace(last, fit=replace(node.fit, before=before), dropped=dropped))
    return rungs


def in_vain(rungs: Sequence[Rung]) -> list[str]:
    """Return the effects that were added and took off no more than chance does, for their parameters."""
    return [
        rung.added
        for rung in rungs
        if rung.added is not None
        and rung.fit.before is not None
        and rung.fit.noise_floor > 0.0
        and unpaid(rung.fit, rung.fit.before)
    ]


def conclusion(rungs: list[Rung], last: Diagnosis) -> Selection:
    """Return what a ladder says that ends where `last` was weighed."""
    base = rungs[0].fit.model
    return concluded(rungs, last, [*base.effects, *base_effects_shown(base.axis), *in_vain(rungs)])


def story(done: Sequence[Node], last: Diagnosis) -> Story:
    """Return the story of nodes that end where `last` was weighed."""
    return Story(*conclusion(ladder(done), last))
