"""Answers of the server, in the two forms that the page reads, and the wait for what they tell."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Unpack

from starlette.responses import Response

from ..base import pages, pages_sources
from ..base.strict_json import as_json

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .jobs import Job
    from .session import Session


def json_answer(document: Mapping[str, Any], status: int = 200) -> Response:
    """Return a document as strict JSON."""
    return Response(as_json(document, indent=None), status, media_type="application/json")


def answered(session: Session, **more: Unpack[pages.More]) -> Response:
    """Return at which revision and node a session is, and what else there is to say."""
    node = session.view.id if session.branches else None
    answer: pages.Answer = {"revision": session.revision, "node": node, **more}
    return json_answer(answer)


def refusal(said: str, status: int, **more: Unpack[pages_sources.Why]) -> Response:
    """Return what is wrong, and what else there is to say of it."""
    refused: pages_sources.Refused = {"error": said, **more}
    return json_answer(refused, status)


def bytes_answer(content: bytes) -> Response:
    """Return packed columns, or any other bytes."""
    return Response(content, media_type="application/octet-stream")


async def finished(job: Job) -> Any:
    """Wait for a job without keeping anybody else waiting; who asked may hang up, the job goes on."""
    return await asyncio.shield(asyncio.wrap_future(job.result))
