"""The answers about the search for everything that is missing: begun, and ended with what it has found."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.concurrency import run_in_threadpool

from .answers import answered, finished
from .pace import Weighings, clocked

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from ..base.said import Said
    from .bench import Bench
    from .jobs import Job


class Searching:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.posts = {"search": self.search, "enough": self.enough}

    async def search(self, _: Request) -> Response:
        """Find everything that is missing; of one that was ended before, what came of it is said."""

        def work(job: Job) -> Said:
            with clocked(job, Weighings(job.what)) as tell:
                return self.bench.session.search(tell, job.enough.is_set)

        cut: Said = await finished(self.bench.work.start("finding everything", work, stops=True))
        await run_in_threadpool(self.bench.flush)
        return answered(self.bench.session, cut=cut.document())

    async def enough(self, _: Request) -> Response:
        """End the search with what it has found by now."""
        return answered(self.bench.session, cancelled=self.bench.enough())
