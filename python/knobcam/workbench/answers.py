"""Answers of the server, in the two forms that the page reads, and the wait for what they tell."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from starlette.responses import Response

from ..base.strict_json import as_json

if TYPE_CHECKING:
    from .jobs import Job


def json_answer(document: dict[str, Any], status: int = 200) -> Response:
    """Return a document as strict JSON."""
    return Response(as_json(document, indent=None), status, media_type="application/json")


def bytes_answer(content: bytes) -> Response:
    """Return packed columns, or any other bytes."""
    return Response(content, media_type="application/octet-stream")


async def finished(job: Job) -> Any:
    """Wait for a job without keeping anybody else waiting; who asked may hang up, the job goes on."""
    return await asyncio.shield(asyncio.wrap_future(job.result))
