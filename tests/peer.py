"""A rig behind a pseudo-terminal in the thread of a test, which can spoil what it says and hears."""

from __future__ import annotations

import contextlib
import os
import threading
import time
import tty
from collections.abc import Callable
from typing import Any, Self

from knobcam import _core
from knobcam.rig.emulator import Emulation

Spoil = Callable[[bytes], bytes]


def as_it_is(frame: bytes) -> bytes:
    return frame


class Peer:
    """An emulated rig; each frame that it says goes through `says`, each that it hears through `hears`."""

    def __init__(
        self, *, says: Spoil = as_it_is, hears: Spoil = as_it_is, speed: float = 10.0, **options: Any
    ) -> None:
        self._rig = Emulation(speed=speed, **options).rig()
        self._says, self._hears, self._speed = says, hears, speed
        self._master, slave = os.openpty()
        self.port = os.ttyname(slave)
        tty.setraw(slave)
        os.set_blocking(self._master, False)
        self._slave = slave
        self._plugged = True
        self.sent = bytearray()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    @property
    def state(self) -> str:
        return self._rig.state

    def unplug(self) -> None:
        """Pull the plug."""
        self._plugged = False
        if self._thread.is_alive():
            self._thread.join()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def _serve(self) -> None:
        now, clock, heard, said, waiting = time.monotonic(), 0.0, b"", b"", b""
        while self._plugged:
            time.sleep(0.001)
            with contextlib.suppress(BlockingIOError):
                heard += os.read(self._master, 1 << 16)
            frames, heard = whole(heard)
            for frame in frames:
                self._rig.hear(self._hears(frame))
            before, now = now, time.monotonic()
            # While this thread has to wait, time stands still for the rig: a real one misses no heartbeat.
            clock += min(now - before, 0.02)
            self._rig.advance(int(clock * self._speed * 1e6))
            if not waiting:
                said += self._rig.speak(1 << 12)
                frames, said = whole(said)
                waiting = b"".join(self._says(frame) for frame in frames)
            with contextlib.suppress(BlockingIOError):
                count = os.write(self._master, waiting)
                self.sent += waiting[:count]
                waiting = waiting[count:]
        os.close(self._slave)
        os.close(self._master)


def whole(stream: bytes) -> tuple[list[bytes], bytes]:
    """The frames in a stream, each with its delimiter, and the rest."""
    *frames, rest = stream.split(b"\0")
    return [frame + b"\0" for frame in frames], rest


def changed(change: Callable[[dict[str, Any]], None]) -> Spoil:
    """Spoils the DESCRIPTOR by changing its fields."""

    def spoil(frame: bytes) -> bytes:
        for event in _core.WireDecoder().push(frame):
            if event["event"] == "frame" and event["message"]["type"] == "DESCRIPTOR":
                change(event["message"]["device"])
                return _core.wire_encode(event["message"], event["sequence"], event["time_us"])
        return frame

    return spoil


def kind(frame: bytes) -> str:
    """Name of the message in a frame."""
    for event in _core.WireDecoder().push(frame):
        if event["event"] == "frame":
            return str(event["message"]["type"])
    return ""


class Nth:
    """Spoils the frames of one kind at these places, counted from 0; by default they get lost."""

    def __init__(self, name: str, places: set[int], spoil: Spoil = lambda frame: b"") -> None:
        self._name, self._places, self._spoil, self._seen = name, places, spoil, -1

    def __call__(self, frame: bytes) -> bytes:
        if kind(frame) != self._name:
            return frame
        self._seen += 1
        return self._spoil(frame) if self._seen in self._places else frame
