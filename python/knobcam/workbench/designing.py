"""The answers about a next experiment: the motion, what it looks like, the recording that it asks for."""

from __future__ import annotations

import asyncio
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from ..errors import InputError
from . import sources, trying
from .answers import answered, bytes_answer, finished
from .arrays import packed
from .bodies import flag, number, read_json, text, whole
from .pace import Stages, clocked
from .sources import Simulated

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from starlette.requests import Request

    from .bench import Bench
    from .designed import Designed
    from .jobs import Job
    from .session import Session
    from .sources import Emulated, OnPort
    from .tree import Opened

_MOST = 8  # effects to be told apart
_FASTEST = 100.0


class Designing:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.gets = {"motion": self.motion, "motion-file": self.file}
        self.posts = {"design": self.design, "try": self.attempt}

    async def design(self, request: Request) -> Response:
        """Design the motion that tells effects apart; of none, what the captures could not tell.

        With `sharpen` it is the one that makes this parameter known best.
        """
        body = await read_json(request)
        names, limits = body.get("effects", []), body.get("limits", {})
        if (
            not isinstance(names, list)
            or not all(isinstance(one, str) for one in names)
            or len(names) > _MOST
        ):
            raise InputError(f"effects: give a list of at most {_MOST} ids of the catalogue")
        if not isinstance(limits, dict):
            raise InputError('limits: give an object such as {"omega_rad_s": 5.0}')
        by_hand, sharpen = flag(body, "by_hand", False), text(body, "sharpen", "")

        def work(job: Job) -> None:
            with clocked(job, Stages(job.what)) as tell:
                trying.design(self.bench.session, names, limits, by_hand, tell, sharpen)

        await finished(self.bench.work.start("designing the next motion", work))
        await run_in_threadpool(self.bench.flush)
        return answered(self.bench.session)

    async def motion(self, request: Request) -> Response:
        """The samples of a motion, and by what its rivals part on it."""
        design = self._asked(request)
        return bytes_answer(await run_in_threadpool(lambda: packed(design.columns())))

    async def file(self, request: Request) -> Response:
        """The motion as a file, for a rig elsewhere."""
        named = {"content-disposition": 'attachment; filename="motion.toml"'}
        content = self._asked(request).plan.text()
        return Response(content, media_type="application/octet-stream", headers=named)

    async def attempt(self, request: Request) -> Response:
        """Record a motion, from the same knob as before or from a rig on a port, and fit all rivals to it."""
        body = await read_json(request)
        design = self.bench.session.designed(text(body, "experiment"))
        source = wanted(self.bench.session, design, body)

        if isinstance(source, Simulated):

            def work(job: Job) -> None:
                job.tell(f"simulating {source.name}")
                origin: dict[str, Any] = {"made": source.made, "hidden": source.hidden}
                origin["simulated"] = asdict(source)
                name = f"{source.name}, simulated designed motion"
                trying.tried(self.bench.session, design, source.capture(), name, job.tell, **origin)

            await finished(self.bench.work.start(f"simulating {source.name}", work))
            await run_in_threadpool(self.bench.flush)
            return answered(self.bench.session)
        log = await run_in_threadpool(sources.new_log, text(body, "folder", ""), source)
        live = self.bench.recorder.start(source, log, True, design)
        await asyncio.shield(asyncio.wrap_future(live.begun))
        return answered(self.bench.session, log=str(log))

    def _asked(self, request: Request) -> Designed:
        return self.bench.session.designed(request.query_params.get("experiment", ""))


def origin(captures: Sequence[Opened]) -> Simulated | Emulated | OnPort | None:
    """Return the knob that captures are of, where it is known how to have another one of it."""
    for one in captures:
        if one.simulated is not None:
            return Simulated.again(one.simulated)
        if one.rig is not None:
            return sources.again(one.rig)
    return None


def wanted(session: Session, design: Designed, body: Mapping[str, Any]) -> Simulated | Emulated | OnPort:
    """Return what a body wants the motion to be recorded from. Raises InputError for what cannot be."""
    plan, by_hand = design.plan.text(), flag(body, "by_hand", False)
    port = text(body, "port", "").strip()
    clears = None if body.get("clear_fault") is None else whole(body, "clear_fault", 0, 0, 255)
    if port:
        return replace(sources.on_port(body), plan=plan, by_hand=by_hand, limits=design.limits, clears=clears)
    same = origin([session.captures[one] for one in session.captures_of(design)])
    if same is None:
        raise InputError("these captures are files; name the port of the rig, or take the motion file to it")
    if isinstance(same, sources.OnPort):
        return replace(same, plan=plan, by_hand=by_hand, limits=design.limits, clears=clears)
    seed = same.seed + len(session.captures)
    if isinstance(same, Simulated):
        return same.trying(plan, design.limits.sample_rate_hz, seed)
    speed = number(body, "speed", same.speed, 0.1, _FASTEST)
    return replace(same, plan=plan, by_hand=by_hand, seed=seed, speed=speed)
