"""What a search for everything came to, as a line of a journal, and again by that line."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.said import Said
from ..fit.diagnose import diagnose
from ..learn import LearningResult
from ..learn.ladder import Unexplained
from ..learn.loosened import with_shapes
from ..learn.rivals import with_choice
from ..model.effects import effects
from .learned import ladder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .journal import Record
    from .tree import Node


def of_search(node: str, told: LearningResult) -> Record:
    """Return the line of what a search found that ended at a node."""
    what, best = told.unexplained, told.weighed.best
    left = None if what is None else what._asdict() | {"hint": Said(what.hint).document()}
    known = {"node": node, "found": list(told.found), "unexplained": left}
    own, wider = told.fit.params, with_choice(told.fit.params, told.ladder)
    # How far the rivals of what came in spread a value, which only their fits tell.
    spread = {name: one.se**2 - own[name].se ** 2 for name, one in wider.items() if one.se > own[name].se}
    return {"searched": known | {"best": None if best is None else best.effect, "spread": spread}}


def again(told: Record, done: Sequence[Node]) -> LearningResult:
    """Return what a search found that ended at the last of these nodes.

    All that was weighed on its way is not weighed again: the one effect alone that its verdict may name.
    """
    fit, left, best = done[-1].fit, told["unexplained"], told["best"]
    only = [best] if best in effects(fit.model.coordinate) else []
    weighed = replace(diagnose(fit, only=only), whole=False)
    what = None if left is None else Unexplained(left["axis"], left["share"], Said.of(left["hint"]))
    found = LearningResult(tuple(ladder(done)), tuple(told["found"]), weighed, what)
    wider = {name: fit.params[name].widened(more) for name, more in told["spread"].items()}
    vars(found)["params"] = with_shapes({**fit.params, **wider}, fit)  # as if it had computed them
    return found
