"""How far long work is by the clock: the bar moves where the work itself says nothing meanwhile."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from .jobs import Cancelled

if TYPE_CHECKING:
    from .jobs import Job
    from .tell import Tell

_TICK_S = 0.2
_TAKES_S = 4.0  # about, of a stage of a design
_FIRST, _NEXT = 0.1, 0.6  # of the whole: before anything is told, and of the rest each stage after that
_USUAL = 5.0  # times as long as its first weighing a search goes on, about
_FEW, _MANY = 4.0, 20.0
"""Times as long: of two motors, a pendulum, a ball-screw axis and a knob with play the least and the most."""


class Pace(Protocol):
    """How far work is, and about how long it takes in all, where that is known."""

    @property
    def what(self) -> str:
        """What is done."""

    @property
    def share(self) -> float | None:
        """From 0 to 1, and never quite 1; None where nobody can tell."""

    @property
    def takes_s(self) -> tuple[float, float] | None:
        """From how many seconds to how many."""

    def go_on(self, what: str) -> None:
        """Begin another stage, if it is one."""


@contextmanager
def clocked(job: Job, pace: Pace) -> Iterator[Tell]:
    """Say how far work is by the clock, stage by stage."""
    ended = threading.Event()

    def tell(what: str, _: float | None = None, *, last: bool = False) -> None:
        pace.go_on(what)
        job.takes_s = pace.takes_s
        job.tell(what, pace.share, last=last)

    def tick() -> None:
        while not ended.wait(_TICK_S):
            try:
                job.tell(pace.what, pace.share)
            except Cancelled:
                return

    thread = threading.Thread(target=tick, name="knobcam-clock", daemon=True)
    thread.start()
    try:
        yield tell
    finally:
        ended.set()
        thread.join()


class Stages:
    """The pace of a design: each stage begins where the one before came to."""

    takes_s = None

    def __init__(self, what: str) -> None:
        self.what = what
        self._from, self._most, self._begun = 0.0, _FIRST, time.monotonic()

    def go_on(self, what: str) -> None:
        """Begin another stage, if it is one."""
        if what != self.what:
            self._from, self._most = self.share, self.share + _NEXT * (1.0 - self.share)
            self.what, self._begun = what, time.monotonic()

    @property
    def share(self) -> float:
        """From 0 to 1, and never quite 1."""
        passed = (time.monotonic() - self._begun) / _TAKES_S
        return self._from + (self._most - self._from) * (1.0 - math.exp(-passed))


class Weighings:
    """The pace of a search for everything, which takes some multiple of its first weighing.

    What it tells is, after the first fit, that weighing, and then whatever it finds to do.
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self._told: list[float] = []  # when each of the first stages began
        self._begun = time.monotonic()

    def go_on(self, what: str) -> None:
        """Begin another stage, if it is one."""
        if what != self.what:
            self.what = what
            self._told = [*self._told, time.monotonic()][:3]

    @property
    def _weighing_s(self) -> float | None:
        return self._told[2] - self._told[1] if len(self._told) > 2 else None

    @property
    def share(self) -> float | None:
        """From 0 to 1, and never quite 1; None until it is known how long a weighing takes."""
        if self._weighing_s is None:
            return None
        return 1.0 - math.exp(-(time.monotonic() - self._begun) / (_USUAL * max(self._weighing_s, _TICK_S)))

    @property
    def takes_s(self) -> tuple[float, float] | None:
        """From how many seconds to how many."""
        return None if self._weighing_s is None else (_FEW * self._weighing_s, _MANY * self._weighing_s)
