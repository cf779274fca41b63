"""Recordings, one at a time, each on a thread of its own: begun, watched, stopped, taken into the session."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..base.reading import digest
from ..errors import InputError
from ..rig.record import Enough
from .jobs import Job
from .live import Live
from .trying import tried

if TYPE_CHECKING:
    from pathlib import Path

    from ..rig.figures import Figures
    from .designed import Designed
    from .session import Session
    from .sources import Source


class Recorder:
    """Records by `kc.record`, as `knobcam capture` does; `told` is called whenever a recording moves.

    On every way out the rig is disarmed and the wire log keeps what came.
    """

    def __init__(self, session: Session, told: Callable[[Job], None]) -> None:
        self.live: Live | None = None
        self.job: Job | None = None
        self._session = session
        self._told = told
        self._thread = threading.Thread()
        self._lock = threading.Lock()

    @property
    def busy(self) -> bool:
        """Whether a recording goes on, be it one that was given up and is being disarmed."""
        return self._thread.is_alive()

    def start(self, source: Source, log: Path, together: bool, design: Designed | None = None) -> Live:
        """Begin to record and return at once; `together`: with the captures that are open, of the same knob.

        `design` is the motion that is recorded, where one was designed.
        Raises InputError while another recording goes on.
        """
        with self._lock:
            if self.busy:
                raise InputError("a recording is under way; stop it first")
            live = Live(f"{source.name}, {source.made_of}", log)
            doing = f"recording {live.what}"
            job = Job(doing, lambda job: self._work(job, live, source, together, design), told=self._told)

            def run() -> None:
                job.run()
                live.end()
                self._told(job)

            self.live, self.job = live, job
            self._thread = threading.Thread(target=run, name="knobcam-recording", daemon=True)
            self._thread.start()
        return live

    def stop(self, keep: bool) -> None:
        """End the run; what came is taken into the session, or stays in the wire log alone."""
        if self.live is None or self.job is None or not self.busy:
            raise InputError("nothing is being recorded")
        if keep:
            self.live.enough.set()
        else:
            self.job.cancel()

    def close(self) -> None:
        """Give up what is being recorded, and wait until the rig is disarmed."""
        if self.job is not None:
            self.job.cancel()
        if self.busy:
            self._thread.join()

    def _work(self, job: Job, live: Live, source: Source, together: bool, design: Designed | None) -> None:
        def watch(figures: Figures) -> None:
            live.see(figures)
            job.tell(f"recording {live.what}", live.done)
            if live.enough.is_set():
                raise Enough

        try:
            capture = source.record(live.log, job.tell, watch)
            origin: dict[str, Any] = {
                "path": str(live.log),
                "hidden": source.hidden,
                "sha256": digest(live.log),
                "rig": source.known,
            }
            try:
                name, session = live.log.name, self._session
                if design is not None:
                    live.capture = tried(session, design, capture, name, job.tell, **origin)
                else:
                    live.capture = session.take(capture, name, None, job.tell, together=together, **origin)
            except InputError as error:
                raise InputError(f"{error}; the recording is kept in {live.log}") from error
        except Exception as error:
            live.failure = error
            raise
