"""Workers of this machine: `python -m knobcam.fleet.crew COUNT`, with the scheduler's address as its input.

What a worker needs takes longer to be loaded than all else that it begins with. So one process loads it,
while the batch loads its own, and each worker is a fork of it that has all of it at once. One that dies, or
takes more memory than its share, is begun anew; all end with their scheduler, or with whoever began them.
"""

from __future__ import annotations

import asyncio
import gc
import multiprocessing
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import wait
from typing import Any

from ..base.optional import require

_LOOK_S = 0.2
_SHARE = 0.95
"""Of the memory that a worker may have, from which on it is ended, as Dask does with those that it guards."""
_ANSWERS_S = 60.0  # a scheduler that is busy


def main(count: int) -> None:
    """Keep `count` workers until they end by themselves."""
    from . import cluster  # noqa: F401 - what a task needs, for all of them at once

    psutil = require("psutil", "a batch", "fleet")
    system = require("distributed.system", "a batch", "fleet")
    address = sys.stdin.readline().strip()
    if not address:  # whoever began this is gone
        return
    # Elsewhere the system's own libraries do not bear a fork.
    context: Any = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    most = system.MEMORY_LIMIT // count
    gc.freeze()  # what is loaded stays: no worker need go through it for what is not used any more
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    crew = [_begun(context, address, most) for _ in range(count)]
    try:
        while crew:
            wait([one.sentinel for one in crew], _LOOK_S)
            crew = [
                one if one.is_alive() else _begun(context, address, most) for one in crew if one.exitcode != 0
            ]
            for one in crew:
                with suppress(psutil.Error):
                    if psutil.Process(one.pid).memory_info().rss > _SHARE * most:
                        one.kill()
    finally:
        for one in crew:
            one.terminate()


def _begun(context: Any, address: str, most: int) -> Any:
    one = context.Process(target=_work, args=(address, most), daemon=True)
    one.start()
    return one


def _work(address: str, most: int) -> None:
    """Be a worker until the scheduler ends; a code other than 0 asks for another one."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    distributed = require("distributed", "a batch", "fleet")

    async def worker() -> None:
        async with distributed.Worker(
            address, nthreads=1, dashboard=False, memory_limit=most, death_timeout=_ANSWERS_S
        ) as one:
            await one.finished()

    with suppress(OSError, TimeoutError):  # no scheduler any more
        asyncio.run(worker())


if __name__ == "__main__":
    main(int(sys.argv[1]))
