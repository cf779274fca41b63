"""A recording as the page sees it while it goes on: its figures, and a thinned-out picture of its samples."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING

import numpy as np

from ..base import pages_sources
from ..rig.tail import Tail
from .arrays import packed
from .jobs import Cancelled
from .thinning import Thinned

if TYPE_CHECKING:
    from pathlib import Path

    from ..rig.figures import Figures

_SHOWN = 40_000  # samples of a whole run, which a page draws in a few ms
_COLUMNS = {"t": "t_s", "theta": "theta_rad", "omega": "omega_rad_s", "tau": "tau_Nm"}


class Live:
    """What there is to see of one recording; several threads may look at it.

    `begun` is done when the first figures have come, and fails where they never will. `enough` is set by who
    wants the run to end here and to be kept. `ended` is set when the port is closed and torque is zero, with
    the `failure` that ended it, or the id of the `capture` in the session.
    """

    def __init__(self, what: str, log: Path) -> None:
        self.what = what
        self.log = log
        self.begun: Future[None] = Future()
        self.enough = threading.Event()
        self.ended = threading.Event()
        self.capture: str | None = None
        self.failure: Exception | None = None
        self._figures: Figures | None = None
        self._tail: Tail | None = None
        self._thinned = Thinned(1)
        self._lock = threading.Lock()

    def see(self, figures: Figures) -> None:
        """Take the newest figures of the recording."""
        with self._lock:
            if self._tail is None:
                self._tail = Tail(self.log)
                self._thinned = Thinned(max(1, -(-self._tail.planned // _SHOWN)))
            self._figures = figures
        if not self.begun.done():
            self.begun.set_result(None)

    def end(self) -> None:
        """Say that the thread that recorded has done all that it will do."""
        if not self.begun.done():
            self.begun.set_exception(self.failure or Cancelled())
        self.ended.set()

    @property
    def done(self) -> float | None:
        """The part of the run that has passed, from 0 to 1; None before it began."""
        if self._figures is None or self._tail is None:
            return None
        return min(1.0, (self._figures.received + self._figures.missing) / self._tail.planned)

    def answer(self, since: int) -> bytes:
        """Return the figures, and the shown samples from the one at `since` on, as columns of floats."""
        with self._lock:
            if self._tail is not None and (came := self._tail.more()):
                n = len(came["t_s"])
                gap = np.full(n, np.nan)  # of a rig that has no such sensor
                self._thinned.add({name: came.get(key, gap) for name, key in _COLUMNS.items()})
            columns = self._thinned.since(since) or {name: np.zeros(0) for name in _COLUMNS}
            return packed(columns, live=self._told())

    def _told(self) -> pages_sources.Live:
        told: pages_sources.Live = {
            "what": self.what,
            "log": str(self.log),
            "every": self._thinned.every,
            "done": self.done,
            "ended": self.ended.is_set(),
            "error": None if self.failure is None else " ".join(str(self.failure).split()),
            "capture": self.capture,
        }
        if self._figures is None or self._tail is None or self._tail.device is None:
            return told
        figures, device = self._figures, self._tail.device
        rate = device["rate_hz"]
        return {
            **told,
            "elapsed_s": (figures.received + figures.missing) / rate,
            "total_s": self._tail.planned / rate,
            "received": figures.received,
            "missing": figures.missing,
            "rate_hz": figures.rate_hz,
            "peak_torque": figures.peak_torque,
            "torque_limit": device["torque_limit"],
            "clipped": dict(zip(("omega", "alpha", "tau"), figures.clipped, strict=True)),
            "temperature": figures.temperature,
        }
