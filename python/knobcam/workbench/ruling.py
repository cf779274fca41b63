"""What a person says of a capture, findings overruled and samples left out: it is read again."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from starlette.concurrency import run_in_threadpool

from ..base.reading import digest
from ..capture import load
from ..capture.person import LEFT_OUT
from ..capture.quality.ruled import with_later
from ..errors import InputError
from ..fit.described import by_model
from .answers import answered, finished, json_answer
from .bodies import flag, read_json, text
from .sources import Simulated

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from starlette.requests import Request
    from starlette.responses import Response

    from ..base import pages
    from ..base.arrays import FloatArray
    from ..capture.finding import Finding
    from ..fit import Fit
    from .bench import Bench
    from .jobs import Job
    from .session import Session
    from .tell import Tell
    from .tree import Opened

_MOST_RUNS = 1000  # that can be left out at once
_SIGN = "it says what the model cannot be: turn the sign of the torque in the map"
_SAVED = "it was overruled before the capture was saved"


class Ruling:
    """The answers, one method for each name of the interface."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.gets = {"finding": self.finding}
        self.posts = {"overrule": self.overrule, "leave-out": self.leave_out}

    async def overrule(self, request: Request) -> Response:
        """Leave a finding of a capture undone, or let it stand again."""
        body = await read_json(request)
        capture, finding, on = text(body, "capture"), text(body, "finding"), flag(body, "on", True)
        session, find = self.bench.session, self.bench.file_of
        return await self._read(lambda job: overrule(session, capture, finding, on, find, job.tell))

    async def leave_out(self, request: Request) -> Response:
        """Leave runs of samples out."""
        runs = (await read_json(request)).get("runs")
        if not isinstance(runs, dict) or not runs or not all(map(_is_runs, runs.values())):
            raise InputError(
                f'runs: give at most {_MOST_RUNS} runs for each capture, as {{"c1": [[120, 480]]}}'
            )
        session, find = self.bench.session, self.bench.file_of
        return await self._read(lambda job: leave_out(session, runs, find, job.tell))

    async def finding(self, request: Request) -> Response:
        """The samples that a finding names."""
        asked = request.query_params
        runs = samples(self.bench.session, asked.get("capture", ""), asked.get("finding", ""))
        return json_answer({"runs": runs})

    async def _read(self, work: Callable[[Job], str]) -> Response:
        await finished(self.bench.work.start("reading", work))
        await run_in_threadpool(self.bench.flush)
        return answered(self.bench.session)


def _is_runs(given: object) -> bool:
    """Whether something is runs of samples: pairs of whole numbers."""
    return (
        isinstance(given, list)
        and 0 < len(given) <= _MOST_RUNS
        and all(
            isinstance(one, list) and len(one) == 2 and all(type(at) is int for at in one) for one in given
        )
    )


def overrule(
    session: Session, capture: str, finding: str, on: bool, find: Callable[[Opened], Path], tell: Tell
) -> str:
    """Overrule a finding of a capture by its key, or let it stand again, and return the id of what was read.

    Raises InputError for a finding that is not there, and as `_read_again` does.
    """
    old = _opened(session, capture)
    keys = [one.key for one in old.capture.findings if one.overruled and one.key != finding]
    options = {**old.options, "overrule": [*keys, finding] if on else keys}
    return _read_again(session, old, options, find, tell)


def leave_out(
    session: Session,
    runs: Mapping[str, Sequence[tuple[int, int]]],
    find: Callable[[Opened], Path],
    tell: Tell,
) -> str:
    """Leave runs of samples out, the first and last of each, by the ids of captures; return the last new id.

    What was left out before stays so. Raises InputError for samples that are not there, and as `_read_again`
    does.
    """
    new = ""
    for capture, those in runs.items():
        old = _opened(session, capture)
        t = old.capture.t
        if not all(0 <= first <= last < len(t) for first, last in those):
            raise InputError(f"{old.name}: samples are from 0 to {len(t) - 1}")
        before = [(float(first), float(last)) for first, last in old.options.get("leave_out", ())]
        stretches = joined([*before, *(around(t, first, last) for first, last in those)])
        options = {**old.options, "leave_out": stretches}
        # Whoever leaves out more means it of what was left out before, too.
        keys = [one for one in old.options.get("overrule", ()) if one != LEFT_OUT]
        new = _read_again(session, old, options | {"overrule": keys}, find, tell)
    return new


def around(t: FloatArray, first: int, last: int) -> tuple[float, float]:
    """Return from and to which time (s) samples lie, halfway to their neighbours where these are known."""
    ends = [float(t[first]), float(t[last])]
    for at, other, end in ((first, first - 1, 0), (last, last + 1, 1)):
        if 0 <= other < len(t) and (t[other] < t[at]) == (end == 0) and math.isfinite(t[other]):
            ends[end] = 0.5 * float(t[at] + t[other])
    return ends[0], ends[1]


def joined(stretches: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return stretches in order, those that meet as one."""
    found: list[tuple[float, float]] = []
    for first, last in sorted(stretches):
        if found and first <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], last)
        else:
            found.append((first, last))
    return found


def _opened(session: Session, capture: str) -> Opened:
    if capture not in session.captures:
        raise InputError(f"capture {capture!r} is not in this session")
    return session.captures[capture]


def _read_again(
    session: Session,
    old: Opened,
    options: Mapping[str, Any],
    find: Callable[[Opened], Path],
    tell: Tell,
) -> str:
    """Read a capture with other options, and return the id of what was read.

    That takes the place of the capture in the model's fit; going back finds the one that was. What is decided
    is an option of `knobcam.load`, with which the session, its script and its journal go on. `find` says
    where the file of a capture lies. Raises InputError for a file that is gone or another by now.
    """
    tell(f"reading {old.name}")
    if old.simulated is None:
        path = find(old)
        if old.sha256 and digest(path) != old.sha256:
            raise InputError(
                f"{old.name}: has changed since it was read; put back what it was, or open it anew"
            )
        read = load(path, **options)
    else:
        read = Simulated.again(old.simulated).capture(options)
    read = replace(read, meta={**read.meta, "source": old.capture.meta.get("source", old.name)})
    new = replace(old, id=session.new("c"), capture=read, options=options, of=old.of or old.id, closed=False)
    with session.lock:
        session.captures[new.id] = new
    fitted = session.node.captures
    if old.id in fitted:
        try:
            session.use([new.id if one == old.id else one for one in fitted], tell)
        except BaseException:
            del session.captures[new.id]
            raise
    else:
        session.touched()
    return new.id


def found(opened: Opened, fit: Fit | None, at: int) -> tuple[Finding, ...]:
    """Return what was found in a capture, and on the way from it to a fit in whose `prepared` it is `at`.

    What a fit says of all its captures is said of the first.
    """
    if fit is None:
        return opened.capture.findings
    return with_later(fit.prepared[at].findings, by_model(fit) if at == 0 else ())


def document(opened: Opened, fit: Fit | None = None, at: int = 0) -> list[pages.Finding]:
    """Return what was found in a capture, and by a fit to it, as a page is told it."""
    told = opened.options.get("overrule", ())
    return [
        {
            "key": one.key,
            "said": one.told.document(),
            "advice": one.advice.document() if one.advice and not one.overruled else None,
            "severity": one.severity,
            "overruled": one.overruled,
            "stands": _SAVED if one.overruled and one.key not in told else _stands(one),
            "seen": bool(opened.capture.where(one)),
        }
        for one in found(opened, fit, at)
    ]


def _stands(finding: Finding) -> str:
    return _SIGN if finding.kind == "sign" else finding.stands


def samples(session: Session, capture: str, finding: str) -> list[tuple[int, int]]:
    """Return the samples that a finding names, first and last of each run, from 0."""
    opened, node = _opened(session, capture), session.node
    fitted = capture in node.captures
    told = found(opened, node.fit, node.captures.index(capture)) if fitted else opened.capture.findings
    named = [one for one in told if one.key == finding]
    if not named:
        raise InputError(f"finding {finding!r} is not among those of {opened.name}")
    return sorted({span for one in named for span in opened.capture.where(one)})
