"""The answers about a session that goes on: where another was left, and how a page looks at it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

from starlette.concurrency import run_in_threadpool

from ..base import pages
from ..base.pages_said import Along
from ..errors import InputError
from .answers import answered, finished
from .bodies import flag, number, read_json, text, whole

if TYPE_CHECKING:
    from collections.abc import Mapping

    from starlette.requests import Request
    from starlette.responses import Response

    from .bench import Bench

_PLOTS = 100
_FAR = 1e300


class Continuing:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.posts = {"continue": self.go_on, "anew": self.anew, "look": self.look}

    async def go_on(self, request: Request) -> Response:
        """Go on with a session that was left."""
        name = text(await read_json(request), "session")
        doing = "continuing a session"
        await finished(self.bench.work.start(doing, lambda job: self.bench.go_on(name, job.tell)))
        return answered(self.bench.session)

    async def anew(self, _: Request) -> Response:
        """Offer no session any more."""
        if self.bench.keeper is not None:
            await run_in_threadpool(self.bench.keeper.anew)
        return answered(self.bench.session)

    async def look(self, request: Request) -> Response:
        """Remember what is brushed and drawn."""
        self.bench.session.look(_looked(await read_json(request)))
        return answered(self.bench.session)


def _looked(body: Mapping[str, Any]) -> pages.Looked:
    """What a page says of how it looks. Raises InputError for anything else."""
    view, brush, beside = body.get("view"), body.get("brush"), body.get("beside")
    if not isinstance(view, dict) or not isinstance(brush, dict | None):
        raise InputError(f"view={view!r}, brush={brush!r}: give objects")
    seen: pages.Seen = {
        "axes": _axes(view.get("axes", list(pages.USUAL))),
        "isolated": flag(view, "isolated", False),
        "band": flag(view, "band", False),
        "held": flag(view, "held", True),
    }
    return {
        "view": seen,
        "beside": None if beside is None else text(body, "beside")[:20],
        "brush": None if brush is None else _brush(brush),
    }


def _axes(told: object) -> list[Along]:
    known, rows = get_args(Along), len(pages.USUAL)
    if not isinstance(told, list) or len(told) != rows or not all(one in known for one in told):
        raise InputError(f"axes={told!r}: give {rows} of {', '.join(known)}")
    return told


def _brush(told: Mapping[str, Any]) -> pages.Brush:
    def interval(name: str) -> tuple[float, float]:
        ends = told.get(name)
        if not isinstance(ends, list) or len(ends) != 2:
            raise InputError(f"{name}={ends!r}: give two numbers")
        low, high = (number({name: end}, name, 0.0, -_FAR, _FAR) for end in ends)
        return low, high

    return {"plot": whole(told, "plot", 0, 0, _PLOTS), "x": interval("x"), "y": interval("y")}
