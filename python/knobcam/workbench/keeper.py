"""Keeps a session while it goes on, and hands out those that were left."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from ..base import pages
from ..base.reading import digest
from ..errors import InputError
from . import ended, journal, kept
from .journal import Journal

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from .journal import Record
    from .session import Session
    from .tell import Tell

_OFFERED = 5


class Keeper:
    """Writes what changes in a session into a journal, on a thread of its own, so that nobody waits for it.

    Whatever it cannot write it says in `unkept`, and tries again with the next change; `told` is called when
    that changes. `left` are the sessions that were left and may go on here.
    """

    def __init__(self, session: Session, root: Path, told: Callable[[], None]) -> None:
        self.root = root
        self.unkept: str | None = None
        self.notes: list[str] = []
        journal.prune(root)
        self.left = _left(root)
        self._session = session
        self._told = told
        self._journal: Journal | None = None
        self._written: set[str] = set()  # captures and fits that the journal has
        self._place: object = None  # the last that the journal has
        self._lock = threading.RLock()
        self._woken = threading.Event()
        self._closing = False
        self._thread = threading.Thread(target=self._serve, name="knobcam-keeping", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Say that the session has changed."""
        self._woken.set()

    def flush(self) -> None:
        """Write what is not written yet, before anybody is told that it is done."""
        with self._lock:
            self._safely(self._keep)

    def close(self) -> None:
        """Write what is not written yet, and that the session was ended by its user."""
        self._closing = True
        self.wake()
        self._thread.join()
        with self._lock:
            if self._journal is not None:
                self._safely(lambda: self._held().append([{"ended": True, "time": time.time()}]))
                self._journal.close()

    @property
    def newest(self) -> str | None:
        """The last session that is over, declined or not; None where there is none."""
        return next((one.name for one in journal.sessions(self.root) if not journal.goes_on(one)), None)

    def hand(self, file: Path) -> str:
        """Keep a file that a browser handed over; return its hash."""
        sha256 = digest(file)
        with self._lock:
            self._safely(lambda: self._held().hand(file, sha256))
        return sha256

    def handed(self, sha256: str) -> Path:
        """Return where a file that a browser handed over is kept. InputError where no session is."""
        with self._lock:
            return self._held().handed(sha256)

    def go_on(self, name: str, tell: Tell) -> None:
        """Let a session that was left go on here. Raises InputError where nothing of it can."""
        folder = self.root / name
        if folder not in journal.sessions(self.root):
            raise InputError(f"session {name!r}: there is none; start anew")
        old = Journal.taken(folder)
        try:
            told = kept.Told.of(folder)
            found = kept.again(told, old, tell)
            if not found.branches:
                raise InputError("; ".join(found.notes) or f"{folder}: nothing was fitted in it; start anew")
            tell("going on where it was", last=True)
            with self._lock:
                self._session.put_back(found)
                self.notes = found.notes
                self.left = []
                old.decline(False)
                if found.whole:
                    self._journal = old
                    self._written = {*told.captures, *told.nodes}
                    self._written |= {_id_of({"design": one}) for one in told.designs.values()}
                    self._written |= {_id_of({"searched": one}) for one in told.searched.values()}
                    return
                # What is left out here stays there, for whoever puts a file back.
                self._safely(lambda: self._hand_on(found, old))
        finally:
            if self._journal is not old:
                old.close()
        self.wake()

    def anew(self) -> None:
        """Offer none of the sessions that were left any more; they stay until they are pruned."""
        for one in self.left:
            try:
                with Journal.taken(self.root / one["id"]) as old:
                    old.decline()
            except InputError:
                continue
        self.left = []

    def _serve(self) -> None:
        closing = False
        while not closing:
            self._woken.wait()
            self._woken.clear()
            closing = self._closing  # asked before the last of it is written
            with self._lock:
                self._safely(self._keep)

    def _keep(self) -> None:
        with self._session.lock:
            if not self._session.captures:
                return
            self.left = []
            records = self._records(self._written)
        place = records[-1]["place"]
        if len(records) == 1 and place == self._place:
            return
        self._held().append(records)
        self._written |= {_id_of(one) for one in records}
        self._place = place
        if self._held().long:
            with self._session.lock:
                every = self._records(set())
            self._held().rewrite([kept.begun(self._session.start), *every])
            self._written = {_id_of(one) for one in every}

    def _hand_on(self, found: kept.Again, old: Journal) -> None:
        """Keep what a browser handed over to another session."""
        for one in found.captures.values():
            if one.sha256 and old.handed(one.sha256).exists():
                self._held().hand(old.handed(one.sha256), one.sha256)

    def _records(self, known: set[str]) -> list[Record]:
        session = self._session
        new: list[Record] = [kept.of_capture(one) for one in session.captures.values() if one.id not in known]
        new += [kept.of_node(*one) for name, one in kept.nodes(session).items() if name not in known]
        there = kept.nodes(session)
        every = [kept.of_design(one) for one in session.designs.values() if one.node in there]
        every += [ended.of_search(*one) for one in session.searched.items() if one[0] in there]
        new += [one for one in every if _id_of(one) not in known]
        return [*new, kept.of_place(session)]

    def _held(self) -> Journal:
        if self._journal is None:
            self._journal = Journal.begun(self.root, kept.begun(self._session.start))
        return self._journal

    def _safely(self, work: Callable[[], object]) -> None:
        before = self.unkept
        try:
            work()
            self.unkept = None
        except InputError as error:
            self.unkept = str(error)
        if self.unkept != before:
            self._told()


def _id_of(record: Record) -> str:
    if (design := record.get("design")) is not None:
        return f"{design['id']} {design['capture']}"  # what came of it makes another line
    if (searched := record.get("searched")) is not None:
        return f"{searched['node']} searched"
    return str((record.get("capture") or record.get("node") or {"id": ""})["id"])


def _left(root: Path) -> list[pages.Left]:
    """The sessions that are over and that nobody has declined, the newest first."""
    found: list[pages.Left] = []
    for folder in journal.sessions(root):
        if len(found) == _OFFERED:
            break
        if journal.declined(folder) or journal.goes_on(folder):
            continue
        left = pages.Left(id=folder.name, when=None, ended=False, captures=[], steps=0, wrong=None)
        try:
            told = kept.Told.of(folder)
        except InputError as error:
            found.append({**left, "wrong": str(error)})
            continue
        if told.steps:
            found.append(
                {**left, "when": told.when, "ended": told.ended, "captures": told.names, "steps": told.steps}
            )
    return found
