"""Where captures lie: a folder of this machine, or behind an address of an object store or a server."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import IO, Any

from ..base.optional import require
from ..base.reading import open_file
from ..errors import InputError

_BY_ARROW = ("s3", "gs", "gcs", "hdfs", "abfs", "abfss")
"""Stores that pyarrow reads by itself."""

_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/")
"""How an address begins, as a path has it too, which keeps one slash of two; one letter is a drive."""


@dataclass(frozen=True)
class Found:
    """A file: its name as it was asked for, and what tells another content of it, without reading it."""

    place: str
    modified: float | None
    """When it was written, s since 1970; None where the store does not say."""
    stamp: str
    bytes: int


def is_address(place: str) -> bool:
    """Whether it is an address, and no path of this machine."""
    return "://" in place


def folder(given: str | os.PathLike[str]) -> Path:
    """Return a folder of this machine, there or not. InputError for an address, and for no name at all."""
    if not os.fspath(given):
        raise InputError("'': names no folder; is a variable of the shell empty?")
    if _ADDRESS.match(os.fspath(given)):
        raise InputError(
            f"{os.fspath(given)}: is an address, and the table grows in a folder of this machine; "
            "give one, and copy it there when it is done"
        )
    return Path(given)


def find(address: str) -> list[Found]:
    """Return the files behind an address: of a pattern, of all below a folder, or the one itself."""
    store, path = _store(address)
    with _refusals(address):
        if any(letter in path for letter in "*?["):
            names = store.glob(path)
        elif store.isdir(path):
            names = store.find(path)
        else:
            names = [path] if store.exists(path) else []
        found = [store.info(name) for name in sorted(names)]
    return [_described(_named(address, store, one["name"]), one) for one in found if one["type"] == "file"]


def below(address: str) -> str:
    """Return how the names begin of all that `find` looks at for an address."""
    folder = _before_pattern(address) if "*" in address else address
    store, path = _store(folder.rstrip("/"))
    return f"{_named(address, store, path.rstrip('/'))}/"


@contextmanager
def opened(place: str) -> Iterator[IO[bytes]]:
    """Open a file of this machine or behind an address for reading."""
    if not is_address(place):
        with open_file(place) as file:
            yield file
        return
    store, path = _store(place)
    with _refusals(place):
        file = store.open(path, "rb")
    with file:
        yield file


@contextmanager
def on_disk(place: str) -> Iterator[Path]:
    """Give a file as a path of this machine: itself, or a copy as long as it is needed."""
    if not is_address(place):
        yield Path(place)
        return
    store, path = _store(place)
    with tempfile.TemporaryDirectory(prefix="knobcam-") as folder:
        copy = Path(folder) / Path(path).name
        with _refusals(place):
            store.get_file(path, str(copy))
        yield copy


def _store(address: str) -> tuple[Any, str]:
    """Return what reads an address, and the path in it."""
    protocol = address.partition("://")[0]
    with _refusals(address):
        if protocol in _BY_ARROW:
            arrow = require("pyarrow.fs", "an object store", "fleet")
            wrapper = require("fsspec.implementations.arrow", "an object store", "fleet").ArrowFSWrapper
            bare = address.partition("?")[0] if "*" not in address else _before_pattern(address)
            store, path = arrow.FileSystem.from_uri(bare)
            return wrapper(store), path + address.partition("?")[0][len(bare) :]
        core = require("fsspec.core", "captures behind an address", "fleet")
        store, path = core.url_to_fs(address)
        return store, str(path)


def _before_pattern(address: str) -> str:
    """Return the folder before the first part of an address that is a pattern."""
    return address[: address.index("*")].rpartition("/")[0]


def _named(address: str, store: Any, path: str) -> str:
    """Return the address of a path in the same store."""
    protocol = address.partition("://")[0]
    return f"{protocol}://{path}" if protocol in _BY_ARROW else str(store.unstrip_protocol(path))


def _described(name: str, info: dict[str, Any]) -> Found:
    modified = info.get("mtime", info.get("LastModified", info.get("created")))
    if isinstance(modified, datetime):
        modified = modified.timestamp()
    known = float(modified) if isinstance(modified, int | float) else None
    size = int(info.get("size") or 0)
    return Found(name, known, f"{size} {known}", size)


@contextmanager
def _refusals(address: str) -> Iterator[None]:
    """Say in one line what a store refuses, whatever its package raises for it."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        raise InputError(
            f"{address}: cannot be read ({why[:300]}); check the address, and the rights to it"
        ) from error
