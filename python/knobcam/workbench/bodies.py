"""What requests carry, checked before anything is done with it."""

from __future__ import annotations

import base64
import binascii
import json
import re
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from starlette.requests import Request

_JSON_BYTES = 16_000_000  # the indices of a million samples, and room to spare
_ALL_BYTES = 64_000_000  # of all bodies that come at once
_NAME = 100  # characters of a file's name
_OPTIONS = ("map", "coordinate", "joint", "rate_hz", "start", "end", "overrule")


class Unread(InputError):
    """A body that is not read to its end; `status` is what HTTP has for the reason."""

    status = 400


class TooLarge(Unread):
    """A body is longer than it may be."""

    status = 413

    def __init__(self, limit: int, way: str = "leave samples or columns out") -> None:
        super().__init__(f"more than {limit // 1_000_000} MB; {way}")


class Busy(Unread):
    """There is no room for another body now."""

    status = 503


class _Room:
    """The memory that the bodies under way have together, bytes."""

    taken = 0


async def read_json(request: Request) -> dict[str, Any]:
    """Return the JSON object in a body. Raises InputError for anything else, Busy where there is no room."""
    parts = bytearray()
    try:
        async for part in request.stream():
            parts += part
            _Room.taken += len(part)
            if len(parts) > _JSON_BYTES:
                raise TooLarge(_JSON_BYTES)
            if _Room.taken > _ALL_BYTES:
                raise Busy("too much is being handed over at once; try again in a moment")
        body = json.loads(parts or b"{}")
    except (ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("the body is no JSON") from None
    finally:
        _Room.taken -= len(parts)
    if not isinstance(body, dict):
        raise InputError("the body is no JSON object")
    return body


async def receive(request: Request, target: Path, limit: int) -> None:
    """Write a body into a file as it comes; TooLarge as soon as it is longer than `limit` bytes."""
    way = "that is as much as a browser may hand over: open it by its path, which may be larger"
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced) > limit:
        raise TooLarge(limit, way)
    size = 0
    with target.open("xb") as file:
        async for part in request.stream():
            size += len(part)
            if size > limit:
                raise TooLarge(limit, way)
            file.write(part)


def text(body: Mapping[str, Any], name: str, default: str | None = None) -> str:
    """Return a text of a body. Raises InputError where it is missing or something else."""
    value = body.get(name, default)
    if not isinstance(value, str) or "\0" in value:
        raise InputError(f"{name}={value!r} is no text")
    return value


def flag(body: Mapping[str, Any], name: str, default: bool) -> bool:
    """Return a truth of a body. Raises InputError for anything else."""
    value = body.get(name, default)
    if not isinstance(value, bool):
        raise InputError(f"{name}={value!r}: give true or false")
    return value


def number(body: Mapping[str, Any], name: str, default: float, low: float, high: float) -> float:
    """Return a number of a body, between two limits. Raises InputError for anything else."""
    value = body.get(name, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InputError(f"{name}={value!r}: give a number from {low:g} to {high:g}")
    return float(value)


def whole(body: Mapping[str, Any], name: str, default: int, low: int, high: int) -> int:
    """Return a whole number of a body, between two limits. Raises InputError for anything else."""
    value = number(body, name, default, low, high)
    if value != int(value):
        raise InputError(f"{name}={value!r}: give a whole number")
    return int(value)


def file_name(header: str) -> str:
    """Return the bare name of a file from what a browser says; no folder, no control character in it."""
    bare = re.split(r"[/\\]", unquote(header))[-1]
    kept = "".join(letter for letter in bare if letter.isprintable())[:_NAME].strip()
    return kept if kept.strip(".") else "capture"


def reading(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of `knobcam.load` that a query or body holds. Raises InputError for broken ones."""
    options: dict[str, Any] = {}
    for name in _OPTIONS:
        value = given.get(name)
        if value is None or value == "":
            continue
        if name == "overrule":
            options[name] = text(given, name).split()
            continue
        if name in ("map", "coordinate", "joint"):
            options[name] = text(given, name)
            continue
        try:
            options[name] = float(value)
        except (TypeError, ValueError):
            raise InputError(f"{name}={value!r} is no number; give one in SI") from None
    if options.get("coordinate", "rotary") not in ("rotary", "linear"):
        raise InputError(f"coordinate={options['coordinate']!r} is unknown; choose rotary or linear")
    return options


def indices(body: Mapping[str, Any]) -> np.ndarray[Any, np.dtype[np.uint32]]:
    """Return the indices in a body: base64 of 32-bit numbers, the lowest byte first."""
    try:
        raw = base64.b64decode(text(body, "indices"), validate=True)
        return np.frombuffer(raw, dtype="<u4")
    except (binascii.Error, ValueError) as error:
        raise InputError(f"indices: {error}; give base64 of 32-bit numbers") from None
