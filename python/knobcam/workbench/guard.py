"""Who may talk to the workbench: this machine's own page, with the token that the command printed."""

from __future__ import annotations

import json
import secrets
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

if TYPE_CHECKING:
    from collections.abc import Collection

    from starlette.types import ASGIApp, Message, Receive, Scope, Send

HEADER = "x-knobcam-token"
POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}


class Guard:
    """Refuses whatever does not come from the page itself, and says to the browser what the page may do.

    The Host must be this machine's own at this port, which a page that rebinds its name to it is not. The
    Origin, where a browser sends one, must be the same. Everything but the `free` paths (the files that the
    page is made of, which hold nothing of anybody's) needs the token: in a header, or in the query where a
    browser cannot send one.
    """

    def __init__(self, app: ASGIApp, token: str, port: int, free: Collection[str] = ()) -> None:
        self.app = app
        self.token = token
        self.hosts = frozenset({f"127.0.0.1:{port}", f"localhost:{port}"})
        self.free = frozenset(free)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may pass."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
        elif scope["type"] == "http":
            refusal = self.refusal(scope)
            if refusal is None:
                await self.app(scope, receive, lambda message: send(_told(message)))
            else:
                await _refuse(send, refusal)
        # Anything else, such as a web socket, has no answer here.

    def refusal(self, scope: Scope) -> str | None:
        """Return why a request is refused; None for one that may pass."""
        headers: dict[str, str] = {}
        for raw, value in scope["headers"]:
            name = raw.decode("latin-1").lower()
            # One that is given twice says nothing for certain.
            headers[name] = "" if name in headers else value.decode("latin-1")
        host = headers.get("host", "")
        if host not in self.hosts:
            return "the workbench answers to this machine alone"
        if "origin" in headers and headers["origin"] != f"http://{host}":
            return "the workbench answers to its own page alone"
        if scope["path"] in self.free:
            return None
        query = parse_qs(scope["query_string"].decode("latin-1"))
        given = headers.get(HEADER) or next(iter(query.get("token", [])), "")
        # Compared in constant time, so that an answer's delay tells nothing.
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            return "the token is missing or wrong; open the address that `knobcam workbench` printed"
        return None


def _told(message: Message) -> Message:
    if message["type"] != "http.response.start":
        return message
    sent = message.get("headers", [])
    own = [(name, value) for name, value in sent if name.decode("latin-1") not in _HEADERS]
    ours = [(name.encode(), value.encode()) for name, value in _HEADERS.items()]
    return {**message, "headers": [*own, *ours]}


async def _refuse(send: Send, why: str) -> None:
    body = json.dumps({"error": why}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())]
    await send(_told({"type": "http.response.start", "status": 403, "headers": headers}))
    await send({"type": "http.response.body", "body": body})
