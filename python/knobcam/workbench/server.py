"""The page's server: requests in, the session's answers out. Nothing is computed here."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Unpack

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route
from starlette.types import ASGIApp

from ..base import pages, pages_sources
from ..base.said import OfEffect, said
from ..base.strict_json import as_json, island
from ..capture import load
from ..capture.formats import DEFAULT_MAX_BYTES
from ..errors import InputError
from ..learn.experiment import NoMotion
from ..model.effects import effect as catalogued
from ..rig.record import Latched
from . import arrays, closing, saving
from .answers import answered, bytes_answer, finished, json_answer, refusal
from .bench import Bench
from .bodies import Busy, Unread, file_name, flag, indices, read_json, reading, receive, text
from .continuing import Continuing
from .designing import Designing
from .guard import Guard
from .jobs import Cancelled, Job
from .preview import Unmapped, explained
from .proposing import Proposing
from .recording import Recording
from .ruling import Ruling
from .searching import Searching
from .shared import Shared

UPLOAD_BYTES = 200_000_000
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
_KEPT_ALIVE_S = 15.0
_UPLOADS = 4  # at once
Answers = Callable[[Request], Awaitable[Response]]


def page_files() -> dict[str, bytes]:
    """Return the files that the page is made of, by name."""
    folder = resources.files(__package__).joinpath("page")
    found = folder.iterdir() if folder.is_dir() else ()
    return {one.name: one.read_bytes() for one in found if Path(one.name).suffix in _TYPES}


def application(bench: Bench, token: str, port: int, upload_bytes: int = UPLOAD_BYTES) -> ASGIApp:
    """Return the server of a bench, which answers to those alone who have the token."""
    files = page_files()
    index = files.pop("index.html", b"")
    server, recording = _Server(bench, index, files, upload_bytes), Recording(bench)
    designing, proposing, ruling = Designing(bench), Proposing(bench), Ruling(bench)
    posts: dict[str, Answers] = {
        **{"add": server.add, "drop": server.drop, "undo": server.undo, "redo": server.redo},
        **{"branch": server.branch, "switch": server.switch, "params": server.params, "snap": server.snap},
        **{"diagnose": server.diagnose, "cancel": server.cancel, "share": server.share, "use": server.use},
        "close": server.close,
        **{"open": server.open, "upload": server.upload, "save": server.save, **recording.posts},
        **Continuing(bench).posts,
        **designing.posts,
        **proposing.posts,
        **ruling.posts,
        **Searching(bench).posts,
    }
    gets: dict[str, Answers] = {
        **{
            "state": server.state,
            "arrays": server.arrays,
            "splits": server.splits,
            "signature": server.signature,
        },
        **{"events": server.events, "download": server.download, "picture": server.picture},
        **recording.gets,
        **designing.gets,
        **proposing.gets,
        **ruling.gets,
    }
    routes = [
        Route("/", server.page),
        *(Route(f"/{name}", server.file) for name in files),
        *(Route(f"/api/{name}", answer) for name, answer in gets.items()),
        *(Route(f"/api/{name}", answer, methods=["POST"]) for name, answer in posts.items()),
    ]
    handlers: dict[Any, Any] = {InputError: _wrong, HTTPException: _unknown, Exception: _failed}
    handlers[ClientDisconnect] = _unheard
    free = [f"/{name}" for name in files]  # the page itself has the session in it
    return Guard(Starlette(routes=routes, exception_handlers=handlers), token, port, free)


def new_token() -> str:
    """Return a token that nobody guesses."""
    return secrets.token_urlsafe(32)


async def _wrong(_: Request, error: Exception) -> Response:
    more: pages_sources.Why = {}
    if isinstance(error, Unmapped):
        more |= {"columns": error.columns, "guess": error.guess}
    if isinstance(error, Latched):
        more["fault"] = {"code": error.code, "told": error.told}
    if isinstance(error, NoMotion) and error.enough is not None:
        more["enough"] = {"limit": error.enough[0], "to": error.enough[1]}
    return refusal(str(error), error.status if isinstance(error, Unread) else 400, **more)


async def _unheard(_: Request, __: Exception) -> Response:
    return Response(status_code=408)  # to nobody: who asked has left


async def _unknown(_: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 500
    return refusal("there is nothing of that name", status)


async def _failed(_: Request, error: Exception) -> Response:
    said = " ".join(f"{type(error).__name__}: {error}".split())
    return refusal(f"the program failed ({said}); please report it", 500)


class _Server:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench, index: bytes, files: dict[str, bytes], upload_bytes: int) -> None:
        self.bench = bench
        self.session = bench.session
        self.index = index
        self.files = files
        self.upload_bytes = upload_bytes
        self.pictures: dict[str, bytes] = {}
        self.shared = Shared()
        self.uploads = 0

    async def page(self, request: Request) -> Response:
        """The page, with what it would ask for first."""
        document = await run_in_threadpool(self.bench.document)
        head = arrays.ahead(document, request.query_params.get("token", "")) + island(document, "first-state")
        body = self.index.replace(b"</head>", head.encode() + b"</head>", 1)
        return Response(body, headers={"content-type": _TYPES[".html"]})

    async def file(self, request: Request) -> Response:
        """A file that the page asks for, which is in memory: no name leads to any other file."""
        name = request.url.path.removeprefix("/")
        return Response(self.files[name], headers={"content-type": _TYPES[Path(name).suffix]})

    async def state(self, _: Request) -> Response:
        """Everything that the page shows but the samples."""
        return json_answer(await run_in_threadpool(self.bench.document))

    async def arrays(self, request: Request) -> Response:
        """Columns of a capture at a node."""
        asked = request.query_params
        view = self.session.view_of(asked.get("node", ""))
        at = self.session.place(view, asked.get("capture", ""))
        names = [name for name in asked.get("names", "").split(",") if name]
        return bytes_answer(await run_in_threadpool(arrays.columns, view, at, names))

    async def splits(self, request: Request) -> Response:
        """The error at a node along every axis."""
        view = self.session.view_of(request.query_params.get("node", ""))
        return json_answer({"splits": await run_in_threadpool(view.splits)})

    async def signature(self, request: Request) -> Response:
        """What a weighed effect would explain of a capture's residual, or the torque of it alone."""
        asked = request.query_params
        view = self.session.view_of(asked.get("node", ""))
        at = self.session.place(view, asked.get("capture", ""))
        diagnosis = self.session.diagnosis_of(view.node.id)
        effect = asked.get("effect", "")
        weighed = [one for one in diagnosis.candidates if one.effect == effect] if diagnosis else []
        if not weighed:
            raise InputError(f"effect {effect!r} is not weighed at this node")
        told = arrays.own if "own" in asked else arrays.signature
        return bytes_answer(await run_in_threadpool(told, weighed[0], view, at))

    async def picture(self, request: Request) -> Response:
        """Where an effect of the catalogue shows."""
        effect = catalogued(request.query_params.get("effect", ""))
        if effect.id not in self.pictures:
            # On a thread of its own: nobody who works waits for all the pictures of a catalogue.
            self.pictures[effect.id] = await self.shared.done(
                request,
                self.bench.drawing,
                ("picture", effect.id),
                f"drawing {effect.id}",
                lambda job: saving.drawn(effect, job.tell),
            )
        return Response(self.pictures[effect.id], media_type="image/png")

    async def add(self, request: Request) -> Response:
        """Add an effect."""
        effect = text(await read_json(request), "effect")
        doing = said("adding {effect}", effect=OfEffect(effect))
        return await self._long(doing, lambda job: self.session.add(effect, job.tell))

    async def drop(self, request: Request) -> Response:
        """Take an effect out."""
        effect = text(await read_json(request), "effect")
        doing = said("dropping {effect}", effect=OfEffect(effect))
        return await self._long(doing, lambda job: self.session.drop(effect, job.tell))

    async def use(self, request: Request) -> Response:
        """Fit to these of the captures that were opened."""
        captures = (await read_json(request)).get("captures")
        if not isinstance(captures, list) or not all(isinstance(one, str) for one in captures):
            raise InputError("captures: give a list of their ids")
        return await self._long("fitting", lambda job: self.session.use(captures, job.tell))

    async def close(self, request: Request) -> Response:
        """Show a capture no more."""
        capture = text(await read_json(request), "capture")
        return await self._long("closing", lambda job: closing.close(self.session, capture, job.tell))

    async def undo(self, _: Request) -> Response:
        """Go one step back."""
        return await self._short(self.session.undo)

    async def redo(self, _: Request) -> Response:
        """Go one step forth."""
        return await self._short(self.session.redo)

    async def branch(self, request: Request) -> Response:
        """Copy the branch and go on in the copy."""
        name = text(await read_json(request), "name", "")
        return await self._short(self.session.fork, name)

    async def switch(self, request: Request) -> Response:
        """Go on in another branch."""
        return await self._short(self.session.switch, text(await read_json(request), "branch"))

    async def params(self, request: Request) -> Response:
        """Move parameters by hand."""
        await run_in_threadpool(self.session.drag, await read_json(request))
        return self._now()

    async def snap(self, _: Request) -> Response:
        """Put them back to the fit."""
        return await self._short(self.session.snap)

    async def diagnose(self, _: Request) -> Response:
        """Weigh what could be missing; answers at once."""
        return self._now(job=self.bench.weigh().id)

    async def cancel(self, _: Request) -> Response:
        """Give up what is being done."""
        return self._now(cancelled=self.bench.cancel())

    async def share(self, request: Request) -> Response:
        """The share of the squared error that some samples hold."""
        body = await read_json(request)
        capture, samples = text(body, "capture"), indices(body)
        return self._now(share=await run_in_threadpool(self.session.share, capture, samples))

    async def open(self, request: Request) -> Response:
        """Read a capture by its path on this machine: for itself, or `together` with the open ones."""
        body = await read_json(request)
        path, options = str(Path(text(body, "path")).expanduser()), reading(body)
        together = flag(body, "together", False)

        def work(job: Job) -> tuple[str, ...]:
            try:
                return self.session.open(path, tell=job.tell, together=together, **options)
            except Cancelled:
                raise
            except InputError as error:
                raise explained(error, Path(path), options, DEFAULT_MAX_BYTES) from error

        return await self._long("reading", work)

    async def upload(self, request: Request) -> Response:
        """Read a capture that the browser hands over, by the importers and their limits; else as `open`."""
        name = file_name(request.headers.get("x-filename", ""))
        options = reading(request.query_params)
        together = request.query_params.get("together") == "true"
        with self._room(), TemporaryDirectory(prefix="knobcam-") as folder:
            target = Path(folder) / "capture"
            await receive(request, target, self.upload_bytes)

            def work(job: Job) -> str:
                try:
                    capture = load(target, max_bytes=self.upload_bytes, **options)
                except InputError as error:
                    said = InputError(str(error).replace(str(target), name))
                    raise explained(said, target, options, self.upload_bytes, name) from error
                if capture.meta.get("source") == str(target):
                    capture = replace(capture, meta={**capture.meta, "source": name})
                keeper = self.bench.keeper
                sha256 = "" if keeper is None else keeper.hand(target)
                return self.session.take(capture, name, options, job.tell, together=together, sha256=sha256)

            return await self._long(f"reading {name}", work)

    async def save(self, request: Request) -> Response:
        """Write the model, report, figures or script to a path on this machine."""
        body = await read_json(request)
        what, path = text(body, "what"), Path(text(body, "path"))
        saved = await self._done(
            f"making the {what}", lambda job: saving.save(self.session, what, path, job.tell)
        )
        return self._now(path=str(saved))

    async def download(self, request: Request) -> Response:
        """The same as a file for the browser."""
        what = request.query_params.get("what", "")
        name = saving.FILES.get(what, "none")

        def work(job: Job) -> bytes:
            with TemporaryDirectory(prefix="knobcam-") as folder:
                return saving.save(self.session, what, Path(folder) / name, job.tell).read_bytes()

        asked = (what, self.session.revision)
        content = await self.shared.done(request, self.bench.work, asked, f"making the {what}", work)
        named = {"content-disposition": f'attachment; filename="{name}"'}
        return Response(content, media_type="application/octet-stream", headers=named)

    async def events(self, _: Request) -> Response:
        """What happens, as it happens."""
        return StreamingResponse(self._events(), media_type="text/event-stream")

    async def _events(self) -> AsyncIterator[str]:
        loop, came = asyncio.get_running_loop(), asyncio.Event()
        news: dict[
            str, str
        ] = {}  # of each kind the last: who listens slowly, or not at all, misses the others

        def note(event: str, line: str) -> None:
            news.pop(event, None)
            news[event] = line
            came.set()

        def hear(event: str, content: Mapping[str, Any]) -> None:
            line = f"event: {event}\ndata: {as_json(content, indent=None)}\n\n"
            with suppress(RuntimeError):  # the server has ended
                loop.call_soon_threadsafe(note, event, line)

        self.bench.listeners.add(hear)
        try:
            hear("state", {"revision": self.session.revision})
            while True:
                try:
                    await asyncio.wait_for(came.wait(), _KEPT_ALIVE_S)
                except TimeoutError:
                    yield ": still here\n\n"
                came.clear()
                while news:
                    yield news.pop(next(iter(news)))
        finally:
            self.bench.listeners.discard(hear)

    @contextmanager
    def _room(self) -> Iterator[None]:
        """Room for one file more on the disk."""
        if self.uploads == _UPLOADS:
            raise Busy(f"{_UPLOADS} files are being handed over; try again when one of them is done")
        self.uploads += 1
        try:
            yield
        finally:
            self.uploads -= 1

    def _now(self, **more: Unpack[pages.More]) -> Response:
        return answered(self.session, **more)

    async def _short(self, change: Callable[..., Any], *given: Any) -> Response:
        await run_in_threadpool(change, *given)
        await run_in_threadpool(self.bench.flush)
        return self._now()

    async def _long(self, what: str, work: Callable[[Job], Any]) -> Response:
        await self._done(what, work)
        await run_in_threadpool(self.bench.flush)
        return self._now()

    async def _done(self, what: str, work: Callable[[Job], Any]) -> Any:
        """Let the worker do it, and wait for that."""
        return await finished(self.bench.work.start(what, work))
