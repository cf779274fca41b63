"""A session as the lines of its journal, and a session made again from them.

A line holds what a session was begun with, a capture and where it comes from, a fit and how it came to be,
or where the session is. Fits are made again as they were made: by the same captures, in the same order.
"""

from __future__ import annotations

import math
import time
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _core
from ..base.reading import digest
from ..base.said import OfEffect, said
from ..base.writing import write
from ..capture import load
from ..errors import InputError
from ..fit import fit, refit
from ..fit.fitting import as_logged
from ..model import Model
from . import ended, sources
from .adding import came_along
from .designed import Designed
from .journal import SCHEMA, read
from .tree import Branch, Node, Opened, Start
from .view import View

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from ..capture import Capture
    from ..fit import Fit
    from ..learn import LearningResult
    from .journal import Journal, Record
    from .session import Session
    from .tell import Tell

_ALIKE = 1e-6  # of the error of a fit that is made again as it was made
_NEAR = 1e-4
"""The same of one that a search had come to, which is come to from elsewhere: a fit with a joint ends where a
step promises a hundredth of a mean square (`ROUGH` of the core), which is so much of fifty samples."""


def begun(start: Start) -> Record:
    """Return the first line: what a session starts from."""
    model = None if start.model is None else start.model.text()
    told = {"model": model, "name": start.name, "options": dict(start.options)}
    return {"schema": SCHEMA, "start": told, "time": time.time()}


def of_capture(opened: Opened) -> Record:
    """Return the line of a capture."""
    told: dict[str, Any] = {"id": opened.id, "name": opened.name, "path": opened.path, "made": opened.made}
    told |= {"options": dict(opened.options), "sha256": opened.sha256, "hidden": list(opened.hidden)}
    return {"capture": told | {"simulated": opened.simulated, "rig": opened.rig, "of": opened.of}}


def of_node(node: Node, after: Node | None) -> Record:
    """Return the line of a fit; the model stands in it for the day on which its captures are gone."""
    told: dict[str, Any] = {"id": node.id, "after": None if after is None else after.id, "how": node.how}
    told |= {"effect": node.effect, "captures": list(node.captures), "onward": node.onward}
    told |= {"p_value": node.p_value, "equivalent": list(node.equivalent)}
    told |= {"along": list(node.along), "also_dropped": list(node.also_dropped), "again": node.again}
    told |= {"rung": node.rung, "cut": node.cut}
    return {"node": told | {"rmse": node.fit.rmse, "model": node.fit.model.text()}}


def of_design(design: Designed) -> Record:
    """Return the line of a motion that was designed, with what came of it."""
    return {"design": design.record()}


def of_place(session: Session) -> Record:
    """Return the line that says where a session is."""
    branches = [
        {
            "id": one.id,
            "name": one.name,
            "steps": [node.id for node in one.steps],
            "at": one.at,
            "dragged": dict(one.dragged.dragged) if one.dragged else {},
        }
        for one in session.branches.values()
    ]
    told = {"branches": branches, "branch": session.branch_id, "made": session.made, "looked": session.looked}
    told |= {"closed": [one.id for one in session.captures.values() if one.closed]}
    # Else a challenge that goes on would have its whole score again.
    guessed = {capture: sorted(effects) for capture, effects in session.guessed.items()}
    told |= {"hints": dict(session.hints), "guessed": guessed}
    return {"place": told, "time": time.time()}


def nodes(session: Session) -> dict[str, tuple[Node, Node | None]]:
    """Return the fits that a session can still come to, by id, each with the one before it."""
    found: dict[str, tuple[Node, Node | None]] = {}
    for branch in session.branches.values():
        for before, node in zip([None, *branch.steps], branch.steps, strict=False):
            found.setdefault(node.id, (node, before))
    return found


@dataclass
class Told:
    """What a journal tells of its session: the last word on each thing."""

    start: Record
    captures: dict[str, Record] = field(default_factory=dict)
    nodes: dict[str, Record] = field(default_factory=dict)
    designs: dict[str, Record] = field(default_factory=dict)
    searched: dict[str, Record] = field(default_factory=dict)
    place: Record = field(default_factory=dict)
    when: float = math.nan
    ended: bool = False

    @classmethod
    def of(cls, folder: Path) -> Told:
        """Return what the journal in a folder tells. InputError for one that is damaged or foreign."""
        records = read(folder)
        with _as_written(folder):
            told = cls._by(records)
            _ = told.names, told.steps
            return told

    @classmethod
    def _by(cls, records: list[dict[str, Any]]) -> Told:
        told = cls(records[0]["start"], when=records[0].get("time", math.nan))
        for one in records[1:]:
            told.ended = "ended" in one
            told.when = one.get("time", told.when)
            if "capture" in one:
                told.captures[one["capture"]["id"]] = one["capture"]
            elif "node" in one:
                told.nodes[one["node"]["id"]] = one["node"]
            elif "design" in one:
                told.designs.pop(one["design"]["id"], None)  # so that the last word is the newest
                told.designs[one["design"]["id"]] = one["design"]
            elif "searched" in one:
                told.searched[one["searched"]["node"]] = one["searched"]
            elif "place" in one:
                told.place = one["place"]
        return told

    @property
    def names(self) -> list[str]:
        """The captures' names."""
        return [one["name"] for one in self.captures.values()]

    @property
    def steps(self) -> int:
        """How many fits the branches hold."""
        return len({step for one in self.place.get("branches", []) for step in one["steps"]})


@dataclass
class Again:
    """A session made again: what there is of it, and in words what there is not."""

    start: Start
    captures: dict[str, Opened] = field(default_factory=dict)
    branches: dict[str, Branch] = field(default_factory=dict)
    nodes: dict[str, Node] = field(default_factory=dict)
    designs: dict[str, Designed] = field(default_factory=dict)
    searched: dict[str, LearningResult] = field(default_factory=dict)
    branch_id: str = ""
    made: int = 0
    looked: Mapping[str, Any] | None = None
    hints: dict[str, int] = field(default_factory=dict)
    guessed: dict[str, set[str]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    whole: bool = True


@contextmanager
def _as_written(folder: Path) -> Iterator[None]:
    """Refuse lines that are whole and yet not what is written here."""
    try:
        yield
    except (KeyError, TypeError, AttributeError, IndexError):
        raise InputError(
            f"{folder / 'journal'}: is not what this version writes; its session cannot go on. "
            f"Remove the folder {folder}"
        ) from None


def again(told: Told, journal: Journal, tell: Tell) -> Again:
    """Make a session again from what its journal tells.

    A file that is gone, or is another than it was, is said in `notes` and left out with what was fitted to
    it; the model of such a branch is written beside the journal.
    """
    with _as_written(journal.folder):
        return _again(told, journal, tell)


def _again(told: Told, journal: Journal, tell: Tell) -> Again:
    model = told.start["model"]
    start = Start(None if model is None else Model.parse(model), told.start["name"], told.start["options"])
    found = Again(start, made=told.place.get("made", 0), looked=told.place.get("looked"))
    found.hints = {**told.place.get("hints", {})}
    found.guessed = {capture: {*effects} for capture, effects in told.place.get("guessed", {}).items()}
    for one in told.captures.values():
        tell(f"reading {one['name']}")
        try:
            closed = one["id"] in told.place.get("closed", [])
            found.captures[one["id"]] = replace(_capture(one, journal), closed=closed)
        except InputError as error:
            found.notes.append(f"{error}; what was fitted to it is left out")
            found.whole = False
    wanted = {step for one in told.place.get("branches", []) for step in one["steps"]}
    for one in told.nodes.values():
        if one["id"] in wanted:
            what = OfEffect(one["effect"]) if one["effect"] else "the first model"
            tell(said("fitting {what} again", what=what))
            _fit_again(one, found, start)
    for one in told.designs.values():
        if one["node"] in found.nodes:
            found.designs[one["id"]] = Designed.again(one)
    for one in told.place.get("branches", []):
        _branch_again(one, found, told, journal)
    for branch in found.branches.values():
        for at, node in enumerate(branch.steps):
            if node.id in told.searched and node.id not in found.searched:
                found.searched[node.id] = ended.again(told.searched[node.id], branch.steps[: at + 1])
    found.branch_id = told.place.get("branch", "")
    if found.branch_id not in found.branches:
        found.branch_id = next(iter(found.branches), "")
    return found


def _capture(told: Record, journal: Journal) -> Opened:
    def as_it_was(capture: Capture) -> Opened:
        hidden, made = tuple(told["hidden"]), told["made"]
        origin = (told["path"], told["options"], made, hidden, told["sha256"], told["simulated"])
        return Opened(told["id"], told["name"], capture, *origin, rig=told.get("rig"), of=told.get("of", ""))

    if told["simulated"] is not None:
        return as_it_was(sources.Simulated.again(told["simulated"]).capture(told["options"]))
    name, path = told["path"], Path(told["path"])
    if not path.is_absolute():  # handed over by a browser
        path = journal.handed(told["sha256"])
    try:
        now = digest(path)
    except InputError:
        raise InputError(f"{name}: is not there any more; put it back and continue that session") from None
    if now != told["sha256"]:
        raise InputError(f"{name}: has changed since; put back what it was and continue that session")
    return as_it_was(load(path, **told["options"]))


def _fit_again(told: Record, found: Again, start: Start) -> None:
    before = None if told["after"] is None else found.nodes.get(told["after"])
    if any(one not in found.captures for one in told["captures"]):
        return
    if told["after"] is not None and before is None and (told["how"] != "fitted" or told["onward"]):
        return
    try:
        fitted = _fitted(told, before, found, start)
    except InputError as error:
        found.notes.append(f"a fit cannot be made again: {error}")
        found.whole = False
        return
    if not math.isclose(fitted.rmse, told["rmse"], rel_tol=_ALIKE if told.get("rung") is None else _NEAR):
        found.notes.append(
            f"a fit came out otherwise than it was, error {fitted.rmse:.6g} and not {told['rmse']:.6g}: "
            f"the program or the computer is another"
        )
    p_value = math.nan if told["p_value"] is None else told["p_value"]
    evidence: dict[str, Any] = {"p_value": p_value, "equivalent": tuple(told["equivalent"])}
    evidence |= {name: tuple(told.get(name, ())) for name in ("along", "also_dropped")}
    evidence |= {name: told.get(name) for name in ("again", "rung")}
    evidence |= {"cut": told.get("cut", False)}
    captures = tuple(told["captures"])
    found.nodes[told["id"]] = Node(
        told["id"], fitted, captures, told["how"], told["effect"], told["onward"], **evidence
    )


def _fitted(told: Record, before: Node | None, found: Again, start: Start) -> Fit:
    captures = [found.captures[one].capture for one in told["captures"]]
    if told["how"] == "added" and before is not None:
        known = Model.parse(told["model"])
        if told.get("rung") is not None:
            return replace(_come_to(captures, known, start), before=before.fit)
        if told["effect"] not in known.laws:
            richer = before.fit.add(told["effect"])
            # Older journals do not have all of these.
            richer = came_along(richer)[0] if told.get("along") else richer
            for effect in told.get("also_dropped", ()):
                richer = richer.drop(effect)
            again = told.get("again")
            return richer.drop(again).add(again) if again else richer
        # A formula has no start of its own: it begins where it came to.
        return replace(fit(captures, known, **_options(start)), before=before.fit)
    if told["how"] == "dropped" and before is not None:
        return before.fit.drop(told["effect"])
    if told.get("rung") is not None:
        return _come_to(captures, Model.parse(told["model"]), start)
    model = before.fit.model if before is not None and told["onward"] else start.model
    return fit(captures, model, **start.options if model is start.model else _options(start))


def _come_to(captures: Sequence[Capture], model: Model, start: Start) -> Fit:
    """Return the fit that a search for everything had come to: which way it went is not gone again."""
    near = refit.with_clipped(as_logged(captures, model, **_options(start)))
    return refit.converged(replace(near, core=_core.refine(refit.cores(near), model.core, True)))


def _options(start: Start) -> Mapping[str, Any]:
    """Return the options of a fit that begins with a model, which detents are no choice of."""
    return {name: value for name, value in start.options.items() if name != "detents"}


def _branch_again(told: Record, found: Again, was: Told, journal: Journal) -> None:
    """Put a branch together as far as its fits could be made again."""
    there = [step for step in told["steps"] if step in found.nodes]
    steps = [found.nodes[step] for step in there]
    at = told["steps"][told["at"]]
    if at not in there:
        found.whole = False
        lost = was.nodes[at]
        kept = write(journal.folder / f"model-{told['id']}.toml", lost["model"])
        found.notes.append(f"{told['name']}: its model is kept in {kept}")
    if not steps:
        return
    branch = Branch(told["id"], told["name"], steps, there.index(at) if at in there else len(steps) - 1)
    if told["dragged"] and at in there:
        node = branch.node
        model = node.fit.model
        for name, value in told["dragged"].items():
            model = model.with_value(name, value)
        branch.dragged = View(f"{node.id}~{branch.id}", node, model, told["dragged"])
    found.branches[branch.id] = branch
