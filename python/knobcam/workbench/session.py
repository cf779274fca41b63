"""A session at the workbench: captures, fits, branches, what was weighed. Knows nothing of the web."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.reading import digest, look
from ..base.said import OfEffect, Said, said
from ..capture import load
from ..errors import InputError
from ..fit import Fit, fit
from ..fit.diagnose import Diagnosis, diagnose
from ..learn.agreement import disagreements
from . import adding
from .learned import ladder
from .tell import quiet
from .tree import Branch, How, Node, Opened, Start, laws_of_others, told_apart
from .view import View

if TYPE_CHECKING:
    from ..capture import Capture
    from ..capture.formats.columnmap import ColumnMap
    from ..learn import LearningResult
    from ..learn.agreement import Disagreement
    from ..learn.proposals import Proposals
    from .designed import Designed
    from .kept import Again
    from .tell import Tell

_VIEWS = 8  # of a dragged parameter that can still be looked at
_NAME = 80  # characters of a branch's name


class Session:
    """What one person does with captures of one knob.

    Every change is made at once or not at all: long work is done on the side, and its fit is then put in
    place, unless the session has moved on meanwhile. Methods may be called from several threads; `changed` is
    called after every change.
    """

    def __init__(self, changed: Callable[[], None] = lambda: None, start: Start | None = None) -> None:
        self.start = start or Start()
        self.captures: dict[str, Opened] = {}
        self.branches: dict[str, Branch] = {}
        self.branch_id = ""
        self.revision = 0
        self.changed = changed
        self.lock = threading.RLock()
        self.nodes: dict[str, Node] = {}
        self._views: dict[str, View] = {}
        self.diagnoses: dict[str, Diagnosis] = {}
        self.disagreed: dict[str, tuple[Disagreement, ...]] = {}
        self.needless: dict[str, list[str]] = {}  # of each node, see adding.needless
        self.searched: dict[str, LearningResult] = {}  # of the nodes at which a search for everything ended
        self.designs: dict[str, Designed] = {}
        self.proposals: dict[str, Proposals] = {}
        self.tried: tuple[str, Fit] | None = None
        self.hints: dict[str, int] = {}
        self.guessed: dict[str, set[str]] = {}  # of each capture, what was ever added to its model
        self.made = 0
        self.looked: Mapping[str, Any] | None = None

    # What there is

    @property
    def branch(self) -> Branch:
        """The branch that is worked on. Raises InputError before the first capture."""
        if not self.branches:
            raise InputError("there is no capture yet; open one first")
        return self.branches[self.branch_id]

    @property
    def node(self) -> Node:
        """Where the branch is. Raises InputError before the first capture."""
        return self.branch.node

    @property
    def view(self) -> View:
        """What is looked at. Raises InputError before the first capture."""
        with self.lock:
            return self.branch.dragged or self.view_of(self.node.id)

    def view_of(self, view_id: str) -> View:
        """Return the view of this id; that of a node has the node's. Raises InputError if there is none."""
        with self.lock:
            if view_id in self._views:
                return self._views[view_id]
            if view_id in self.nodes:
                node = self.nodes[view_id]
                return View(node.id, node, node.fit.model)
        raise InputError(f"node {view_id!r} is not in this session")

    def diagnosis_of(self, node_id: str) -> Diagnosis | None:
        """Return what was weighed at a node; None where nothing was yet."""
        return self.diagnoses.get(node_id)

    @property
    def experiment(self) -> Designed | None:
        """The last motion that was designed where the branch is, or recorded on the way there."""
        done = self.branch.done if self.branches else []
        return next((one for one in reversed(self.designs.values()) if one.of_use(done)), None)

    def laws_of_others(self, node: Node) -> set[str]:
        """Return the formulas of other captures than a node's."""
        with self.lock:
            return laws_of_others(node, self.nodes.values())

    def place(self, view: View, capture: str) -> int:
        """Return where a capture is among those of a view. Raises InputError if it is not."""
        if capture not in view.node.captures:
            raise InputError(f"capture {capture!r} is not part of this fit")
        return view.node.captures.index(capture)

    # Captures

    def open(
        self,
        *paths: str,
        map: ColumnMap | None = None,
        tell: Tell = quiet,
        together: bool = True,
        **options: Any,
    ) -> tuple[str, ...]:
        """Read captures, take them in together with the active ones or for themselves; return their ids.

        Options as `knobcam.load` takes them. Raises InputError for what cannot be read or fitted.
        """
        given = {name: value for name, value in {"map": map, **options}.items() if value is not None}
        opened = []
        for path in paths:
            tell(f"reading {Path(path).name}")
            whole = str(Path(path).absolute())
            before = look(path)
            capture = load(path, **given)
            # Of what changed while it was read no hash is known, so that it is not taken for the same later.
            sha256 = digest(path)
            sha256 = sha256 if look(path).st_mtime_ns == before.st_mtime_ns else ""
            opened.append(Opened(self.new("c"), Path(path).name, capture, whole, given, sha256=sha256))
        self._take(opened, tell, together)
        return tuple(one.id for one in opened)

    def take(
        self,
        capture: Capture,
        name: str,
        options: Mapping[str, Any] | None = None,
        tell: Tell = quiet,
        *,
        path: str = "",
        together: bool = True,
        onward: bool = False,
        **origin: Any,
    ) -> str:
        """Take a capture in together with those that are active, or for itself, and return its id.

        `onward`: it was made for the model that there is, which is fitted to it too with all that it has.
        `path`, by default its name, and `options` are by which it can be read again; `origin` is what else
        `Opened` knows of where it comes from. Raises InputError for one that cannot be fitted.
        """
        opened = Opened(self.new("c"), name, capture, path or name, dict(options or {}), **origin)
        self._take([opened], tell, together, onward)
        return opened.id

    def _take(
        self, opened: Sequence[Opened], tell: Tell, together: bool = True, onward: bool = False
    ) -> None:
        new = {one.id: one for one in told_apart(opened, self.captures.values())}
        active = self.node.captures if self.branches and together else ()
        every = {**self.captures, **new}
        node, branch = self._fitted([*active, *new], every, tell, together, onward)
        tell("putting the fit in place", last=True)
        with self.lock:
            self.captures |= new
            self.put([node], branch)

    def use(self, captures: Sequence[str], tell: Tell = quiet) -> None:
        """Fit the model to these captures, of those that were opened."""
        unknown = [one for one in captures if one not in self.captures]
        if unknown:
            raise InputError(f"capture {unknown[0]!r} is not in this session")
        node, branch = self._fitted(captures, self.captures, tell)
        tell("putting the fit in place", last=True)
        self.put([node], branch)

    def _fitted(
        self,
        ids: Sequence[str],
        known: Mapping[str, Opened],
        tell: Tell,
        same_knob: bool = True,
        onward: bool = False,
    ) -> tuple[Node, Branch | None]:
        branch = self.branch if self.branches else None
        before = branch.node if branch else None
        # A base model that nobody has changed may still find detents that it lacked, and another knob has
        # effects of its own.
        changed = branch is not None and any(one.how != "fitted" or one.onward for one in branch.done)
        onward = same_knob and (onward or changed)
        tell("fitting")
        model = before.fit.model if before and onward else self.start.model
        fitted = fit([known[one].capture for one in ids], model, **self.start.options)
        node = self._node(fitted, tuple(ids), "fitted", onward=onward)
        ladder([*(branch.done if branch else ()), node])  # here, where it is seen that it takes its time
        return node, branch

    # Effects

    def add(self, effect: str, tell: Tell = quiet) -> None:
        """Add an effect and fit anew. Raises InputError for one that the model cannot be given."""
        adding.add(self, effect, tell)

    def search(self, tell: Tell = quiet, enough: Callable[[], bool] = lambda: False) -> Said:
        """Find everything that is missing, and take it in step by step; see `adding.search`."""
        return adding.search(self, tell, enough)

    def drop(self, effect: str, tell: Tell = quiet) -> None:
        """Take an effect out and fit anew. Raises InputError for one that the model does not have."""
        branch, node = self.branch, self.node
        tell(said("dropping {effect}", effect=OfEffect(effect)))
        barer = node.fit.drop(effect)
        without = said("putting the model without {effect} in place", effect=OfEffect(effect))
        tell(without, last=True)
        self.put([self._node(barer, node.captures, "dropped", effect)], branch, node)

    def accept(self, effect: str, richer: Fit, p_value: float) -> None:
        """Put the fit with a law in place, which is an effect of this name by now."""
        node = self._node(richer, self.node.captures, "added", effect, p_value=p_value)
        self.put([node], self.branch, self.node)

    def weigh(self, tell: Tell = quiet, node: Node | None = None) -> Diagnosis:
        """Return which effects could be missing at a node, by default here; weighed once for each."""
        node = node or self.node
        known = self.diagnoses.get(node.id)
        if known is not None:
            return known
        doing = "weighing what could be missing"
        tell(doing)
        foreign = self.laws_of_others(node) & set(node.fit.model.catalogue())
        diagnosis = diagnose(node.fit, without=foreign, progress=lambda share: tell(doing, share))
        # Computed here, where nobody waits for it.
        _ = diagnosis.comparison.summary
        self.disagreed[node.id] = disagreements(node.fit)
        self.needless[node.id] = adding.needless(self, node)
        self.diagnoses[node.id] = diagnosis  # whoever comes back to the node has it, wanted now or not
        with self.lock:
            self.touched()
        return diagnosis

    # The next experiment

    def keep(self, design: Designed) -> None:
        """Take in a motion that was designed, which gets its id here, or what came of it."""
        with self.lock:
            design = design if design.id else replace(design, id=self.new("e"))
            self.designs.pop(design.id, None)
            self.designs[design.id] = design
            self.touched()

    def designed(self, design: str) -> Designed:
        """Return the motion of this id. Raises InputError if there is none."""
        if design not in self.designs:
            raise InputError(f"experiment {design!r} is not in this session")
        return self.designs[design]

    def captures_of(self, design: Designed) -> tuple[str, ...]:
        """Return the captures from which a motion was designed."""
        return self.nodes[design.node].captures

    # Back, forth, aside

    def undo(self) -> None:
        """Go back to the fit before, the very same. Raises InputError where there is none."""
        with self.lock:
            self.branch.step(-1)
            self.touched()

    def redo(self) -> None:
        """Go forth to the fit that was undone, the very same. Raises InputError where there is none."""
        with self.lock:
            self.branch.step(1)
            self.touched()

    def fork(self, name: str = "") -> str:
        """Copy the branch up to where it is, go on in the copy, and return its id."""
        with self.lock:
            branch = self.branch
            branch_id = self.new("b")
            said = " ".join(name.split())[:_NAME] or f"branch {len(self.branches) + 1}"
            self.branches[branch_id] = branch.copy(branch_id, said)
            self.branch_id = branch_id
            self.touched()
            return branch_id

    def switch(self, branch_id: str) -> None:
        """Go on in another branch. Raises InputError if there is none of this id."""
        with self.lock:
            if branch_id not in self.branches:
                raise InputError(f"branch {branch_id!r} is not in this session")
            self.branch_id = branch_id
            self.touched()

    # Parameters by hand

    def drag(self, values: Mapping[str, float]) -> None:
        """Move parameters by hand, without fitting. Raises InputError for a value that none can have."""
        with self.lock:
            branch, node = self.branch, self.node
            moved = {**(branch.dragged.dragged if branch.dragged else {}), **values}
            model = node.fit.model
            for name, value in moved.items():
                if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                    raise InputError(f"parameter '{name}': {value!r} is no number")
                model = model.with_value(name, float(value))
            view = View(f"{node.id}~{self.new('')}", node, model, moved)
            self._views[view.id] = view
            for old in list(self._views)[:-_VIEWS]:
                del self._views[old]
            branch.dragged = view
            self.touched()

    def snap(self) -> None:
        """Put the dragged parameters back to the fit."""
        with self.lock:
            self.branch.dragged = None
            self.touched()

    # What is looked at, and a session that goes on

    def look(self, looked: Mapping[str, Any]) -> None:
        """Remember how a page looks at it: the brush, what is drawn."""
        with self.lock:
            self.looked = looked
            self.changed()

    def put_back(self, found: Again) -> None:
        """Go on where another session was. Raises InputError where this one has begun already."""
        with self.lock:
            if self.captures:
                raise InputError(
                    "captures are open here already; start another workbench to continue that session"
                )
            self.start, self.captures, self.branches = found.start, found.captures, found.branches
            self.branch_id, self.looked = found.branch_id, found.looked
            self.hints, self.guessed, self.searched = found.hints, found.guessed, found.searched
            self.made = max(self.made, found.made)
            self.nodes, self.designs = dict(found.nodes), dict(found.designs)
            self._views = {one.dragged.id: one.dragged for one in found.branches.values() if one.dragged}
            self.touched()

    def share(self, capture: str, samples: Collection[int] | np.ndarray[Any, np.dtype[np.uint32]]) -> float:
        """Return the share of the squared error of all captures that these samples of one of them hold."""
        at = self.place(view := self.view, capture)
        squares = [np.nan_to_num(view.squares(one), posinf=math.inf) for one in range(len(view.fit.prepared))]
        index = np.unique(np.asarray(samples, dtype=np.int64))
        if len(index) and not 0 <= index[0] <= index[-1] < len(squares[at]):
            raise InputError(f"indices must be from 0 to {len(squares[at]) - 1}")
        with np.errstate(over="ignore"):  # of squares that are finite each
            whole = float(sum(np.sum(one) for one in squares))
        return float(np.sum(squares[at][index])) / whole if 0.0 < whole < math.inf else 0.0

    # How it is done

    def new(self, kind: str) -> str:
        """Return an id that nothing in the session has."""
        with self.lock:
            self.made += 1
            return f"{kind}{self.made}"

    def _node(self, fitted: Fit, captures: tuple[str, ...], how: How, *told: Any, **evidence: Any) -> Node:
        return Node(self.new("n"), fitted, captures, how, *told, **evidence)

    def put(self, nodes: Sequence[Node], branch: Branch | None, after: Node | None = None) -> None:
        """Put nodes in place, one after the other, if their branch is still where the work on them began."""
        with self.lock:
            if after is not None and branch is not None and branch.node is not after:
                raise InputError("the session has moved on meanwhile; nothing was changed")
            for node in nodes:
                self.nodes[node.id] = node
                if node.how == "added" and node.effect is not None:
                    for capture in node.captures:
                        self.guessed.setdefault(capture, set()).add(node.effect)
                if branch is None:
                    branch = Branch(self.new("b"), "main", [node], 0)
                    self.branch_id, self.branches[branch.id] = branch.id, branch
                else:
                    branch.go(node)
            self.touched()

    def touched(self) -> None:
        """Say that something is other than it was."""
        self.revision += 1
        self.changed()
