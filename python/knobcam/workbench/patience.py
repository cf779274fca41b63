"""How long a connection may take, and how many there may be: whoever stalls goes."""

from __future__ import annotations

import asyncio
from typing import cast

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

MOST = 256
"""Connections; of more the one goes whose request has been waited for longest."""
HEAD_S = 10.0
"""Within which a request comes, or the first part of its body."""
SLOWEST = 20_000.0
"""Bytes a second of a body, on a connection that never leaves this machine."""
READS_S = 60.0
"""Within which a client reads a part of what it asked for."""
_LOOKS_S = 0.5
_TOO_LATE = b"HTTP/1.1 408 Request Timeout\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"


class Patient(H11Protocol):
    """A connection that is looked at from time to time, and ended where nothing comes of it."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take a new connection, for which an old one may have to go."""
        super().connection_made(transport)
        self._began()
        self._unread, self._unread_since = 0, self.loop.time()
        there = [cast("Patient", one) for one in self.connections if not one.transport.is_closing()]
        if len(there) > MOST:
            waiting = [one for one in there if one.waits and one is not self]
            min(waiting, key=lambda one: one.since, default=self).transport.abort()
        self._next = self.loop.call_later(_LOOKS_S, self._look)

    def connection_lost(self, exc: Exception | None) -> None:
        """Look no more at what is gone: its transport has nothing left to end."""
        self._next.cancel()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Count what comes."""
        self.came += len(data)
        super().data_received(data)

    def handle_events(self) -> None:
        """A request that has come gives time for its body."""
        before = self.cycle
        super().handle_events()
        if self.cycle is not before:
            self._began()

    def on_response_complete(self) -> None:
        """An answer gives time for the next request."""
        self._began()
        super().on_response_complete()

    @property
    def waits(self) -> bool:
        """Whether it is the client's turn."""
        if self.cycle is None or self.cycle.response_complete:
            return True
        return self.conn.their_state is h11.SEND_BODY

    def _began(self) -> None:
        self.since, self.came = self.loop.time(), 0

    def _look(self) -> None:
        if self.transport.is_closing():
            self.transport.abort()  # what nobody reads would keep it open
            return
        now, unread = self.loop.time(), self.transport.get_write_buffer_size()
        if unread != self._unread or not unread:
            self._unread, self._unread_since = unread, now
        if now - self._unread_since > READS_S:
            self.transport.abort()
        elif self.waits and now - self.since > HEAD_S + self.came / SLOWEST:
            if self.came and (self.cycle is None or not self.cycle.response_started):
                self.transport.write(_TOO_LATE)
            self.transport.close()
        self._next = self.loop.call_later(_LOOKS_S, self._look)
