"""A session with its workers and those who listen: what the server holds, without the web."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ..base import pages
from ..base.said import Said
from ..errors import InputError
from . import state
from .jobs import Job, Worker
from .keeper import Keeper
from .proposing import looked_for
from .recorder import Recorder
from .session import Session
from .tree import Start

if TYPE_CHECKING:
    from .tell import Tell
    from .tree import Opened

_PAUSE_S = 0.02
_AFTER_S = 1.0  # so that a page that has just been told of a fit can draw it first
Hear = Callable[[str, Mapping[str, Any]], None]
"""Called with the name of an event and its content, from any thread."""


class Bench:
    """One session, a thread for what a person waits for, one that weighs meanwhile, and one that records."""

    def __init__(self, start: Start | None = None, kept_in: Path | None = None) -> None:
        """`kept_in` is the folder in which the session is kept while it goes on; None: nowhere.

        `unread` are logs that were to be opened, of which a person has to say first which column is which.
        """
        self.session = Session(self._changed, start)
        self.work = Worker("knobcam-work", self._moved)
        self.weighing = Worker("knobcam-weighing", self._moved, humble=True)
        self.drawing = Worker("knobcam-drawing", lambda _: None)
        self.trying = Worker("knobcam-trying", lambda _: None)
        self.recorder = Recorder(self.session, self._moved)
        self.listeners: set[Hear] = set()
        self.unread: list[str] = []
        self.keeper = None if kept_in is None else Keeper(self.session, kept_in, self._say_state)
        self._weighed = ""
        self._lock = threading.Lock()

    def document(self) -> pages.State:
        """Return the state of the session, and what is being done."""
        job, keeper = self.work.current or self.weighing.current, self.keeper
        known = state.document(self.session)
        return {
            **known,
            "job": None if job is None else self._described(job),
            "recording": self.recorder.busy,
            "looked": cast("pages.Looked | None", self.session.looked),
            "unread": [] if known["captures"] else self.unread,
            "left": [] if keeper is None or known["captures"] else keeper.left,
            "notes": [] if keeper is None else [*keeper.notes, *([keeper.unkept] if keeper.unkept else [])],
        }

    def flush(self) -> None:
        """See to it that what was done is kept."""
        if self.keeper is not None:
            self.keeper.flush()

    def go_on(self, name: str, tell: Tell) -> None:
        """Go on with a session that was left. Raises InputError where that cannot be."""
        if self.keeper is None:
            raise InputError("sessions are not kept here; start anew")
        self.keeper.go_on(name, tell)

    def file_of(self, opened: Opened) -> Path:
        """Return where the file of a capture lies. Raises InputError for one that is in no file."""
        if opened.made:
            raise InputError(f"{opened.name}: was simulated, so that there is no log to read otherwise")
        path = Path(opened.path)
        if not path.is_absolute() and self.keeper is not None and opened.sha256:
            path = self.keeper.handed(opened.sha256)
        if not path.is_file():
            raise InputError(
                f"{opened.name}: its file is not there any more; put it back, or open it by its path"
            )
        return path

    def weigh(self, after_s: float = 0.0) -> Job:
        """Weigh what could be missing where the session is, and look for a law of what has no name.

        What was weighed elsewhere is given up.
        """
        node, weighed = self.session.node, threading.Event()

        def work(job: Job) -> None:
            def tell(what: str, done: float | None = None, *, last: bool = False) -> None:
                job.tell(what, done, last=last)
                # Whatever a person waits for goes first, and so does a rig that records.
                while self.work.current is not None or self.recorder.busy:
                    job.rest(_PAUSE_S)
                known = self.session.proposals if weighed.is_set() else self.session.diagnoses
                if node.id in known:  # and may have been just this
                    job.cancel()

            job.rest(after_s)
            self.session.weigh(tell, node)
            weighed.set()
            if self.session.node is node and state.unexplained(self.session):
                looked_for(self.session, tell)

        self.weighing.cancel()
        return self.weighing.start("weighing what could be missing", work)

    def cancel(self) -> bool:
        """Give up what is being done: what a person waits for, else the weighing. False: too late."""
        return (self.work if self.work.current else self.weighing).cancel()

    def enough(self) -> bool:
        """End a search with what it has found by now. False where there is none."""
        job = self.work.current
        if job is None or not job.stops:
            return False
        job.enough.set()
        return True

    @property
    def busy(self) -> bool:
        """Whether anything is still computed, be it something that was given up."""
        return self.work.busy or self.weighing.busy or self.drawing.busy or self.trying.busy

    def close(self) -> None:
        """Give everything up, and wait for the threads to end; a rig that records is disarmed first."""
        self.end()
        self.work.close()
        self.weighing.close()
        self.drawing.close()
        self.trying.close()

    def end(self) -> None:
        """Disarm a rig that records, and write the last of the session: what cannot be left to itself."""
        self.recorder.close()
        if self.keeper is not None:
            self.keeper.close()
            self.keeper = None

    def _changed(self) -> None:
        with self._lock:
            session = self.session
            at = session.node.id if session.branches else ""
            if at and at != self._weighed:
                self._weighed = at
                self.weighing.cancel()
                if session.diagnosis_of(at) is None:
                    self.weigh(_AFTER_S)
        if self.keeper is not None:
            self.keeper.wake()
        self._say_state()

    def _say_state(self) -> None:
        self._say("state", {"revision": self.session.revision})

    def _moved(self, job: Job) -> None:
        if job.active:
            self._say("progress", self._described(job))
        else:
            self._say_state()

    def _say(self, event: str, content: Mapping[str, Any]) -> None:
        for hear in list(self.listeners):
            hear(event, content)

    def _described(self, job: Job) -> pages.Job:
        return {
            "id": job.id,
            "what": Said(job.what).document(),
            "done": job.done,
            "takes_s": job.takes_s,
            "seconds": time.monotonic() - job.begun,
            "stops": job.stops,
            "recording": job is self.recorder.job,
        }
