"""A session with its workers and those who listen: what the server holds, without the web."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from . import state
from .jobs import Job, Worker
from .session import Session
from .tree import Start

_PAUSE_S = 0.02
_AFTER_S = 1.0  # so that a page that has just been told of a fit can draw it first
Hear = Callable[[str, dict[str, Any]], None]
"""Called with the name of an event and its content, from any thread."""


class Bench:
    """One session, a thread for what a person waits for, and one that weighs what is missing meanwhile."""

    def __init__(self, start: Start | None = None) -> None:
        self.session = Session(self._changed, start)
        self.work = Worker("knobcam-work", self._moved)
        self.weighing = Worker("knobcam-weighing", self._moved, humble=True)
        self.listeners: set[Hear] = set()
        self._weighed = ""
        self._lock = threading.Lock()

    def document(self) -> dict[str, Any]:
        """Return the state of the session, and what is being done."""
        job = self.work.current or self.weighing.current
        return state.document(self.session) | {"job": None if job is None else _described(job)}

    def weigh(self, after_s: float = 0.0) -> Job:
        """Weigh what could be missing where the session is; what was weighed elsewhere is given up."""
        node = self.session.node

        def work(job: Job) -> None:
            def tell(what: str, done: float | None = None) -> None:
                job.tell(what, done)
                while self.work.current is not None:  # whatever a person waits for goes first
                    job.rest(_PAUSE_S)
                if self.session.diagnosis_of(node.id) is not None:  # and may have been just this
                    job.cancel()

            job.rest(after_s)
            self.session.weigh(tell, node)

        self.weighing.cancel()
        return self.weighing.start("weighing what could be missing", work)

    def cancel(self) -> None:
        """Give up what is being done: what a person waits for, else the weighing."""
        (self.work if self.work.current else self.weighing).cancel()

    @property
    def busy(self) -> bool:
        """Whether anything is still computed, be it something that was given up."""
        return self.work.busy or self.weighing.busy

    def close(self) -> None:
        """Give everything up, and wait for the threads to end."""
        self.work.close()
        self.weighing.close()

    def _changed(self) -> None:
        with self._lock:
            session = self.session
            at = session.node.id if session.branches else ""
            if at and at != self._weighed:
                self._weighed = at
                self.weighing.cancel()
                if session.diagnosis_of(at) is None:
                    self.weigh(_AFTER_S)
        self._say("state", {"revision": session.revision})

    def _moved(self, job: Job) -> None:
        if job.active:
            told = _described(job)
            self._say("progress", {"job": told["id"], "what": told["what"], "done": told["done"]})
        else:
            self._say("state", {"revision": self.session.revision})

    def _say(self, event: str, content: dict[str, Any]) -> None:
        for hear in list(self.listeners):
            hear(event, content)


def _described(job: Job) -> dict[str, Any]:
    return {"id": job.id, "what": job.what, "done": job.done}
