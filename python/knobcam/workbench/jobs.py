"""Long work on a thread of its own: what is being done, how far it is, and an end to it when asked."""

from __future__ import annotations

import itertools
import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

from ..errors import InputError

_numbers = itertools.count(1)
_FINE = 0.01  # of a job; smaller steps are not worth telling
_HUMBLE = 15  # niceness: others have about thirty times its share
_NOTICES_S = 0.5  # within which most work notices that it was given up
_LEFT = 3  # threads that go on with what nobody wants


class Cancelled(InputError):
    """The work was given up; nothing was changed."""

    def __init__(self) -> None:
        super().__init__("cancelled; nothing was changed")


@dataclass(eq=False)
class Job:
    """Some work: `done` from 0 to 1, None while nobody can tell; `result` fails with what went wrong.

    One that `stops` can be ended with what it has by then, which is what `enough` asks for.
    """

    what: str
    work: Callable[[Job], Any]
    id: str = field(default_factory=lambda: f"j{next(_numbers)}")
    done: float | None = None
    takes_s: tuple[float, float] | None = None
    stops: bool = False
    enough: threading.Event = field(default_factory=threading.Event)
    begun: float = field(default_factory=time.monotonic)
    result: Future[Any] = field(default_factory=Future)
    told: Callable[[Job], None] = lambda _: None
    ended: threading.Event = field(default_factory=threading.Event)
    """Set when nothing of it is computed any more, be it long after it was given up."""
    _given_up: threading.Event = field(default_factory=threading.Event)
    _ending: threading.Lock = field(default_factory=threading.Lock)
    _settled: bool = False

    def tell(self, what: str, done: float | None = None, *, last: bool = False) -> None:
        """Say what is being done, and how much of it is. Raises Cancelled if the work is no longer wanted.

        `last`: what comes now can no longer be given up, so that nobody is told that it was.
        """
        with self._ending:
            if self._given_up.is_set():
                raise Cancelled
            self._settled = self._settled or last
        if what == self.what and done is not None and self.done is not None and done < self.done + _FINE:
            return
        self.what, self.done = what, done
        self.told(self)

    def rest(self, seconds: float) -> None:
        """Wait before going on. Raises Cancelled if the work is no longer wanted."""
        if self._given_up.wait(seconds):
            raise Cancelled

    def cancel(self) -> bool:
        """Give the work up: it changes nothing any more, and who waits for it is told at once.

        False where it is too late for that, or where it was done already.
        """
        with self._ending:
            if self._settled or self.result.done():
                return False
            self._given_up.set()
            self.result.set_exception(Cancelled())
        self.told(self)
        return True

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
        finally:
            self.ended.set()

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
    """A thread that does one job after the other. `told` is called whenever a job begins, moves or ends.

    Work that was given up and does not notice is left to itself: another thread takes the next job. What is
    left computes to its end, with its share of the processors and its memory, and what comes of it is
    dropped; of such threads there are at most `_LEFT`, then the next job waits for one of them.

    A `humble` one, and the threads of the core that it starts, leave the processors to whoever needs them.
    """

    def __init__(self, name: str, told: Callable[[Job], None], humble: bool = False) -> None:
        self._name = name
        self._told = told
        self._humble = humble
        self._waiting: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._jobs: list[Job] = []
        self._under_way: list[Job] = []  # by the thread that serves last, and by those that were left
        self._lock = threading.Lock()
        self._threads: list[threading.Thread] = []
        self._serve_anew(None)

    def start(self, what: str, work: Callable[[Job], Any], stops: bool = False) -> Job:
        """Put work in line and return at once."""
        job = Job(what, work, told=self._told, stops=stops)
        with self._lock:
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
        """Whether anything computes, be it something that was given up."""
        return bool(self._under_way)

    def cancel(self) -> bool:
        """Give up everything that is under way or in line; return whether there was anything to give up."""
        given_up = [job for job in list(self._jobs) if job.cancel()]
        with self._lock:
            if self._under_way and self._under_way[-1] in given_up:
                self._serve_anew(self._under_way[-1])
        return bool(given_up)

    def close(self) -> None:
        """Give up everything, and wait for the threads to end: the core cannot be interrupted."""
        self.cancel()
        self._waiting.put(None)
        for thread in list(self._threads):
            thread.join()

    def _serve_anew(self, after: Job | None) -> None:
        """Let another thread serve, once `after` has had the time to notice that it was given up."""
        left = self._under_way[:]
        thread = threading.Thread(target=self._serve, args=(after, left), name=self._name, daemon=True)
        self._threads = [*(one for one in self._threads if one.is_alive()), thread]
        thread.start()

    def _serve(self, after: Job | None, left: list[Job]) -> None:
        if self._humble and sys.platform == "linux":  # where a thread has a niceness of its own
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _HUMBLE)
        if after is not None:
            after.ended.wait(_NOTICES_S)
        while sum(not one.ended.is_set() for one in left) > _LEFT:
            left[0].ended.wait(_NOTICES_S)
            left = [one for one in left if not one.ended.is_set()]
        mine = threading.current_thread()
        while (job := self._waiting.get()) is not None:
            with self._lock:
                self._under_way.append(job)
            job.run()
            with self._lock:
                self._under_way.remove(job)
                if self._threads[-1] is not mine:
                    return  # another one serves by now
