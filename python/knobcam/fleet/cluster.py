"""The workers of a batch, by Dask: processes of this machine, or an existing cluster's, one thread each."""

from __future__ import annotations

import asyncio
import logging
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any

from ..base.ended import heard
from ..base.optional import require
from ..errors import InputError, KnobcamError
from .row import Row, lost, row_of
from .settings import Settings
from .sources import Source

CHUNK = 8
"""Captures of a task: what Dask asks for a task is shared by them, and no more is lost with a worker."""
_ANSWERS_S, _ARRIVES_S = 5.0, 120.0  # a scheduler, and its first worker
_LOOK_S = 1.0  # between two looks at whether workers of this machine could not start
_AHEAD = 3  # tasks that wait for each worker, so that none waits for a task
_ENVIRONMENT = {
    **{f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")},
    # Dask's own would give every freed block back to the system, for half as much time again by page faults.
    "MALLOC_TRIM_THRESHOLD_": str(2**27),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",  # looks at every thread each 10 ms
}
"""Of a worker, unless the user's own says otherwise."""

Task = tuple[Source, str | None]
"""A capture, and the digest of its content where that is done already."""
Rows = list[Row | None]


class Gone(KnobcamError):
    """The scheduler went away in the midst of a batch."""


def work(tasks: Sequence[Task], settings: Settings, learned: bool) -> Rows:
    """Return the rows of some captures, on a worker. RuntimeError where it has another version."""
    from .._core import __version__, at_most

    at_most(1)  # each worker has a core
    if __version__ != settings.version:
        raise RuntimeError(f"a worker has knobcam {__version__}, this process {settings.version}")
    return [row_of(source, settings, learned, known) for source, known in tasks]


@contextmanager
def workers(scheduler: str | None) -> Iterator[Any]:
    """Give a client of an existing scheduler, or of one of this process with a worker for each core."""
    if scheduler is not None:
        distributed = require("distributed", "a batch", "fleet")
        with _quiet():
            _greet(distributed, scheduler)
            with _client(distributed, scheduler) as client:
                yield client
        return
    with _crew(cores()) as crew:  # which loads what it needs while this process does
        distributed = require("distributed", "a batch", "fleet")
        how = {"n_workers": 0, "dashboard_address": "127.0.0.1:0", "silence_logs": False}
        with _quiet(), distributed.LocalCluster(**how) as cluster:
            _unheard(cluster.loop)
            _tell(crew, cluster.scheduler_address)
            with _client(distributed, cluster.scheduler_address, crew) as client:
                yield client


@contextmanager
def _quiet() -> Iterator[None]:
    """Let Dask log nothing: what happens is said by the batch, in a line."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if _of_dask(name)]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)


def _unheard(loop: Any) -> None:
    """Let a loop of Dask's own thread tell nobody what it still waited for when it was stopped.

    It is told when the wait is collected, which may be after the batch has ended.
    """
    loop.asyncio_loop.set_exception_handler(lambda _, __: None)


def _of_dask(name: str) -> bool:
    return name.partition(".")[0] in ("distributed", "tornado", "asyncio")


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _tell(crew: subprocess.Popen[bytes], address: str) -> None:
    if crew.stdin is not None:
        with suppress(BrokenPipeError), crew.stdin as told:
            told.write(f"{address}\n".encode())


@contextmanager
def _crew(count: int) -> Iterator[subprocess.Popen[bytes]]:
    """Give workers that wait for an address, and that Ctrl-C at this terminal leaves to this process."""
    quiet = subprocess.DEVNULL
    crew = subprocess.Popen(
        [sys.executable, "-m", f"{__package__}.crew", str(count)],
        env=_ENVIRONMENT | os.environ,
        stdin=subprocess.PIPE,
        stdout=quiet,
        stderr=quiet,
        start_new_session=True,
    )
    try:
        yield crew
    finally:
        crew.terminate()
        with suppress(subprocess.TimeoutExpired):
            crew.wait(5.0)
        crew.kill()
        crew.wait()


def _greet(distributed: Any, address: str) -> None:
    """Have a scheduler say that it is one: a client of Dask waits for ever for what else listens there."""

    async def asked() -> Any:
        about = distributed.Security().get_connection_args("client")
        comm = await distributed.core.connect(address, timeout=_ANSWERS_S, **about)
        try:
            await comm.write({"op": "identity"})
            return await comm.read()
        finally:
            comm.abort()

    def answer() -> Any:
        return asyncio.run(asyncio.wait_for(asked(), 2.0 * _ANSWERS_S))

    with ThreadPoolExecutor(1) as own:  # whoever calls may have a loop in this thread, as notebooks do
        try:
            kind = own.submit(answer).result()["type"]
        except Exception as error:  # whatever Dask makes of bytes that are not its own
            raise _unanswered(address, error) from None
    if kind != "Scheduler":
        raise InputError(
            f"--scheduler {address}: a {kind.lower()} answers there; give its scheduler's address"
        )


def _unanswered(address: str, error: Exception) -> InputError:
    return InputError(
        f"--scheduler {address}: no scheduler answers there ({type(error).__name__}); "
        "start one with: dask scheduler"
    )


@contextmanager
def _client(distributed: Any, address: str, crew: subprocess.Popen[bytes] | None = None) -> Iterator[Any]:
    try:
        client = distributed.Client(address, timeout=_ANSWERS_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise _unanswered(address, error) from None
    _unheard(client.loop)
    try:
        _wait(client, address, crew)
        yield client
    finally:
        with suppress(Exception):
            client.close(timeout=2.0)


def _wait(client: Any, address: str, crew: subprocess.Popen[bytes] | None) -> None:
    """Wait for the first worker; a batch without one would wait for ever."""
    until = time.monotonic() + _ARRIVES_S
    while time.monotonic() < until and (crew is None or crew.poll() is None):
        with suppress(TimeoutError):
            client.wait_for_workers(1, timeout=_LOOK_S)
            return
    if crew is not None:
        raise KnobcamError(
            "no worker could be started on this machine; see what this says: "
            f"echo {address} | {sys.executable} -m {__package__}.crew 1"
        )
    raise InputError(
        f"--scheduler {address}: has no worker; start one with: dask worker {address} --nthreads 1"
    )


def run(
    client: Any,
    tasks: Sequence[Task],
    settings: Settings,
    learned: bool,
    take: Callable[[list[Task], Rows], object],
) -> None:
    """Have tasks done; `take` gets what is done, in any order, with its rows.

    A worker that dies costs what it was at. A capture with which workers die gets a row that says so. Raises
    Gone where the scheduler goes away.
    """
    distributed = require("distributed", "a batch", "fleet")
    size = 1 if learned else CHUNK
    waiting = [list(tasks[at : at + size]) for at in range(0, len(tasks), size)][::-1]
    under_way: dict[Any, list[Task]] = {}
    done = distributed.as_completed(loop=client.loop)
    try:
        with heard() as check:  # the futures of Dask have finalisers
            while True:
                check()
                if not (waiting or under_way):
                    return
                while waiting and len(under_way) < _AHEAD * max(len(client.nthreads()), 1):
                    some = waiting.pop()
                    future = client.submit(work, some, settings, learned, pure=False)
                    under_way[future] = some
                    done.add(future)
                future = next(done)
                some = under_way.pop(future)
                if future.status == "finished":
                    take(some, future.result())
                elif future.status == "error":
                    waiting += _again(some, future.exception(), settings, learned, take)
                else:
                    raise Gone("the scheduler went away")
    except (OSError, TimeoutError) as error:
        raise Gone("the scheduler went away") from error


def _again(
    some: list[Task],
    error: Any,
    settings: Settings,
    learned: bool,
    take: Callable[[list[Task], Rows], object],
) -> list[list[Task]]:
    """Return what to do once more after a task failed as a whole: each capture by itself."""
    if not isinstance(error, require("distributed", "a batch", "fleet").KilledWorker):
        raise KnobcamError(" ".join(str(error).split())) from error
    if len(some) > 1:
        return [[one] for one in some]
    take(
        some,
        [lost(some[0][0], settings, learned, "its workers ended while they were at it; is it too large?")],
    )
    return []
