"""What a session remembers: captures, fits as nodes, branches that go back and forth along them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import chain, count
from typing import TYPE_CHECKING, Any, Literal

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from ..capture import Capture
    from ..fit import Fit
    from ..fit.diagnose import Diagnosis
    from ..model import Model
    from .view import View

How = Literal["fitted", "added", "dropped"]


@dataclass(frozen=True, eq=False)
class Opened:
    """A capture of a session; `path` and `options` are those by which `knobcam.load` reads it again.

    `sha256` is that of the file. One that is no file has what it was simulated by as `simulated`, and the
    Python that makes it again as `made`. `rig` is by which the rig that recorded it is found again. `hidden`
    are the effects that were put into its knob for somebody to find. One that is `closed` is shown no more;
    one that was read from a recording again, otherwise, says `of` which capture that was first.
    """

    id: str
    name: str
    capture: Capture
    path: str
    options: Mapping[str, Any] = field(default_factory=dict)
    made: str = ""
    hidden: tuple[str, ...] = ()
    sha256: str = ""
    simulated: Mapping[str, Any] | None = None
    rig: Mapping[str, Any] | None = None
    closed: bool = False
    of: str = ""


def told_apart(new: Iterable[Opened], others: Iterable[Opened]) -> Iterator[Opened]:
    """Yield captures under names that no other has: the second `a.csv` is `a.csv (2)`."""
    taken = {one.name for one in others}
    for one in new:
        counted = (f"{one.name} ({n})" for n in count(2))
        name = next(name for name in chain([one.name], counted) if name not in taken)
        taken.add(name)
        yield replace(one, name=name)


@dataclass(frozen=True, eq=False)
class Start:
    """How a session fits: the options of `knobcam.fit`, and the model that it starts from, if any.

    `name` is by which `Model.load` finds that model again.
    """

    model: Model | None = None
    name: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Node:
    """A fit, and how it came to be; immutable.

    `how` is what made it: all parameters `fitted` to the `captures`, an `effect` `added` to the node before,
    or `dropped` from it. `onward` says that a `fitted` one started from the model of the node before.
    `p_value`, `equivalent` and `diagnosis` are the evidence for an effect that was weighed before it came in,
    `along` what showed beside it and came in by itself, `also_dropped` what it made needless, `again` what
    was looked for anew beside it. One that a search for
    everything came to is the `rung` of its ladder, counted from 0; `cut`: of one that a person ended.
    """

    id: str
    fit: Fit
    captures: tuple[str, ...]
    how: How
    effect: str | None = None
    onward: bool = False
    p_value: float = math.nan
    equivalent: tuple[str, ...] = ()
    diagnosis: Diagnosis | None = None
    along: tuple[str, ...] = ()
    also_dropped: tuple[str, ...] = ()
    again: str | None = None
    rung: int | None = None
    cut: bool = False


def laws_of_others(node: Node, nodes: Iterable[Node]) -> set[str]:
    """Return the formulas that came in at nodes of other captures alone: they are of another machine."""
    own, others = set(node.fit.model.laws), set[str]()
    for one in nodes:
        (others if set(one.captures).isdisjoint(node.captures) else own).update(one.fit.model.laws)
    return others - own


@dataclass
class Branch:
    """A line of nodes; those after `at` were undone and can come back.

    `dragged` is the model of the node with parameters moved by hand, while there are any.
    """

    id: str
    name: str
    steps: list[Node]
    at: int
    dragged: View | None = None

    @property
    def node(self) -> Node:
        """Where the branch is."""
        return self.steps[self.at]

    @property
    def done(self) -> list[Node]:
        """The nodes up to where the branch is."""
        return self.steps[: self.at + 1]

    def go(self, node: Node) -> None:
        """Append a node; what was undone is gone."""
        self.steps = [*self.done, node]
        self.at += 1
        self.dragged = None

    def step(self, by: int) -> None:
        """Go one node back (-1) or forth (1), to the very same fit."""
        to = self.at + by
        if not 0 <= to < len(self.steps):
            raise InputError("there is nothing to undo" if by < 0 else "there is nothing to redo")
        self.at = to
        self.dragged = None

    def copy(self, branch_id: str, name: str) -> Branch:
        """Return a branch of its own with the same past."""
        return Branch(branch_id, name, self.done, self.at)
