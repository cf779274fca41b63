"""Long work on a thread of its own: what is being done, how far it is, and an end to it when asked."""

from __future__ import annotations

import itertools
import os
import queue
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

from ..errors import InputError

_numbers = itertools.count(1)
_FINE = 0.01  # of a job; smaller steps are not worth telling
_HUMBLE = 15  # niceness: others have about thirty times its share


class Cancelled(InputError):
    """The work was given up; nothing was changed."""

    def __init__(self) -> None:
        super().__init__("cancelled; nothing was changed")


@dataclass(eq=False)
class Job:
    """Some work: `done` from 0 to 1, None while nobody can tell; `result` fails with what went wrong."""

    what: str
    work: Callable[[Job], Any]
    id: str = field(default_factory=lambda: f"j{next(_numbers)}")
    done: float | None = None
    result: Future[Any] = field(default_factory=Future)
    told: Callable[[Job], None] = lambda _: None
    _given_up: threading.Event = field(default_factory=threading.Event)
    _ending: threading.Lock = field(default_factory=threading.Lock)

    def tell(self, what: str, done: float | None = None) -> None:
        """Say what is being done, and how much of it is. Raises Cancelled if the work is no longer wanted."""
        if self._given_up.is_set():
            raise Cancelled
        if what == self.what and done is not None and self.done is not None and done < self.done + _FINE:
            return
        self.what, self.done = what, done
        self.told(self)

    def rest(self, seconds: float) -> None:
        """Wait before going on. Raises Cancelled if the work is no longer wanted."""
        if self._given_up.wait(seconds):
            raise Cancelled

    def cancel(self) -> None:
        """Give the work up: it ends before its next round, and who waits for it is told at once."""
        self._given_up.set()
        self._end(None, Cancelled())

    @property
    def active(self) -> bool:
        """Whether it is still to come or under way."""
        return not self.result.done()

    def run(self) -> None:
        """Do the work, unless it was given up."""
        try:
            self.tell(self.what)
            self._end(self.work(self))
        except BaseException as error:  # a panic of the core is no Exception, and the thread must live on
            self._end(None, error)

    def _end(self, outcome: Any, error: BaseException | None = None) -> None:
        with self._ending:
            if self.result.done():
                return  # it was given up, and so was what came of it
            if error is None:
                self.result.set_result(outcome)
            else:
                self.result.set_exception(error)
        self.told(self)


class Worker:
    """One thread that does one job after the other. `told` is called whenever a job begins, moves or ends.

    A `humble` one, and the threads of the core that it starts, leave the processors to whoever needs them.
    """

    def __init__(self, name: str, told: Callable[[Job], None], humble: bool = False) -> None:
        self._told = told
        self._humble = humble
        self._waiting: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._jobs: list[Job] = []
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._running = threading.Event()
        self._thread.start()

    def start(self, what: str, work: Callable[[Job], Any]) -> Job:
        """Put work in line and return at once."""
        job = Job(what, work, told=self._told)
        self._jobs = [*(one for one in self._jobs if one.active), job]
        self._waiting.put(job)
        self._told(job)
        return job

    @property
    def current(self) -> Job | None:
        """The job under way, or the next one; None where nothing is to be done."""
        return next((job for job in self._jobs if job.active), None)

    @property
    def busy(self) -> bool:
        """Whether the thread computes, be it something that was given up."""
        return self._running.is_set()

    def cancel(self) -> None:
        """Give up everything that is under way or in line."""
        for job in self._jobs:
            job.cancel()

    def close(self) -> None:
        """Give up everything, and wait for the thread to end: the core cannot be interrupted."""
        self.cancel()
        self._waiting.put(None)
        self._thread.join()

    def _serve(self) -> None:
        if self._humble and sys.platform == "linux":  # where a thread has a niceness of its own
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _HUMBLE)
        while (job := self._waiting.get()) is not None:
            self._running.set()
            job.run()
            self._running.clear()
