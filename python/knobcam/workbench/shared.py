"""Work that several ask for is done once, and for nobody who has left."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any

from starlette.requests import ClientDisconnect

if TYPE_CHECKING:
    from starlette.requests import Request

    from .jobs import Job, Worker


class Shared:
    """The work that requests wait for, by what they ask; it is given up when the last of them hangs up."""

    def __init__(self) -> None:
        self._jobs: dict[Hashable, Job] = {}
        self._waiting: dict[str, int] = {}  # requests for each job, by its id

    async def done(
        self, request: Request, worker: Worker, asked: Hashable, what: str, work: Callable[[Job], Any]
    ) -> Any:
        """Return what comes of the work, which is begun unless it is under way. Requests have no body."""
        job = self._jobs.get(asked)
        if job is None or not job.active:
            job = self._jobs[asked] = worker.start(what, work)
        self._waiting[job.id] = self._waiting.get(job.id, 0) + 1
        result = asyncio.wrap_future(job.result)
        result.add_done_callback(_looked_at)
        gone = asyncio.ensure_future(_gone(request))
        try:
            await asyncio.wait({result, gone}, return_when=asyncio.FIRST_COMPLETED)
            if result.done():
                return result.result()
            raise ClientDisconnect
        finally:
            gone.cancel()
            self._waiting[job.id] -= 1
            if not self._waiting[job.id]:
                del self._waiting[job.id]
                job.cancel()  # which is nothing to what is done
                if self._jobs.get(asked) is job:
                    del self._jobs[asked]


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _looked_at(result: asyncio.Future[Any]) -> None:
    """What nobody waits for any more may fail in silence."""
    if not result.cancelled():
        result.exception()
