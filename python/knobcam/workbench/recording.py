"""The answers about captures that are made here: what can be recorded, the recording itself, its samples."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Unpack

from starlette.concurrency import run_in_threadpool

from ..base import pages
from ..errors import InputError
from . import challenge, sources
from .answers import answered, bytes_answer, finished, json_answer
from .bodies import flag, read_json, text

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from .bench import Bench
    from .jobs import Job


class Recording:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.gets = {"sources": self.sources, "live": self.live}
        self.gets["challenge"] = self.challenge
        self.posts = {"simulate": self.simulate, "record": self.record, "stop": self.stop}
        self.posts |= {"hint": self.hint, "hidden": self.hidden}

    async def sources(self, _: Request) -> Response:
        """What there is to choose from."""
        return json_answer(await run_in_threadpool(sources.document))

    async def simulate(self, request: Request) -> Response:
        """Simulate a knob and take its capture in."""
        body = await read_json(request)
        level = text(body, "level", "")
        if level:
            source = await run_in_threadpool(challenge.drawn, level, self.bench.session)
        else:
            source = await run_in_threadpool(sources.simulated, body)
        together = flag(body, "together", False)
        name = f"{source.name}, simulated {source.motion}"

        def work(job: Job) -> str:
            capture = source.capture()
            origin: dict[str, Any] = {"made": source.made, "hidden": source.hidden}
            origin["simulated"] = asdict(source)
            return self.bench.session.take(capture, name, None, job.tell, together=together, **origin)

        await finished(self.bench.work.start(f"simulating {source.name}", work))
        return self._now()

    async def record(self, request: Request) -> Response:
        """Begin a recording; answers when samples come, or when they never will."""
        body = await read_json(request)
        source = await run_in_threadpool(sources.recorded, body)
        log = await run_in_threadpool(sources.new_log, text(body, "folder", ""), source)
        live = self.bench.recorder.start(source, log, flag(body, "together", False))
        await asyncio.shield(asyncio.wrap_future(live.begun))
        return self._now(log=str(log))

    async def stop(self, request: Request) -> Response:
        """End the recording; `keep`: take in what came."""
        self.bench.recorder.stop(flag(await read_json(request), "keep", True))
        return self._now()

    async def live(self, request: Request) -> Response:
        """How the recording goes, and the samples to show from the one at `since` on."""
        since, live = request.query_params.get("since", "0"), self.bench.recorder.live
        if not since.isdecimal() or len(since) > 9:
            raise InputError(f"since={since!r} is no count of samples")
        if live is None:
            raise InputError("nothing was recorded yet")
        return bytes_answer(await run_in_threadpool(live.answer, int(since)))

    async def hidden(self, request: Request) -> Response:
        """What was hidden in the knob of a capture, for who gives up or wants to compare."""
        capture = text(await read_json(request), "capture")
        hidden = await run_in_threadpool(challenge.answer, self.bench.session, capture)
        return self._now(hidden=hidden)

    async def challenge(self, request: Request) -> Response:
        """How it goes with what a capture hides."""
        capture = request.query_params.get("capture", "")
        return json_answer(await run_in_threadpool(challenge.standing, self.bench.session, capture))

    async def hint(self, request: Request) -> Response:
        """Give a little of it away."""
        body = await read_json(request)
        capture, whole = text(body, "capture"), flag(body, "whole", False)
        await run_in_threadpool(challenge.hint, self.bench.session, capture, whole)
        return self._now()

    def _now(self, **more: Unpack[pages.More]) -> Response:
        return answered(self.bench.session, **more)
