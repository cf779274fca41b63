"""How a file is read: a file and nothing else, whose size was looked at before."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import IO, Any

from ..errors import InputError

UNHURRIED = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_CLOEXEC", 0)
"""Flags with which no file lets whoever opens it wait."""
_AT_ONCE = 2**20  # bytes


def look(path: str | os.PathLike[str]) -> os.stat_result:
    """Return what the system knows of a file or folder.

    InputError where there is none, and for what gives its content but once or for ever, as pipes and devices.
    """
    try:
        found = Path(path).stat()
    except (OSError, ValueError, TypeError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"{path}: cannot be read ({why}); check the name") from error
    _check_kind(path, found)
    return found


def is_folder(path: str | os.PathLike[str]) -> bool:
    """Whether there is a folder, for any path at all."""
    return os.path.isdir(path)  # noqa: PTH112 - where a path is too long, that of pathlib raises


def open_file(path: str | os.PathLike[str]) -> IO[bytes]:
    """Return a file open for reading. InputError for anything else (see `look`)."""
    if stat.S_ISDIR(look(path).st_mode):
        raise InputError(f"{path}: is a folder, not a file; name the file inside")
    try:
        file = os.fdopen(os.open(path, os.O_RDONLY | UNHURRIED), "rb")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the name") from error
    try:
        _check_kind(path, os.fstat(file.fileno()))  # it may be another by now
    except InputError:
        file.close()
        raise
    return file


def read_text(path: str | os.PathLike[str], what: str, most_bytes: int) -> str:
    """Return the text of a small file. InputError for what is longer, or no text, than `what` can be."""
    with open_file(path) as file:
        raw = file.read(most_bytes + 1)
    if len(raw) > most_bytes:
        raise InputError(f"{path}: more than {most_bytes // 1000} kB, so no {what}; check the name")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text, so no {what}; check the name") from None


def read_toml(path: str | os.PathLike[str], what: str, most_bytes: int, advice: str) -> dict[str, Any]:
    """Return the content of a small TOML file. InputError, with advice, for what is none."""
    return parse_toml(path, read_text(path, what, most_bytes), what, advice)


def parse_toml(path: str | os.PathLike[str], text: str, what: str, advice: str) -> dict[str, Any]:
    """Return the content of the text of a TOML file. InputError, with advice, for what is none."""
    import tomllib  # late: few commands need it, and all of them this module

    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: is no {what} ({error}); {advice}") from None


def digest(path: str | os.PathLike[str]) -> str:
    """Return the SHA-256 of a file, or of a folder's files with their names. InputError for anything else."""
    import hashlib  # late, as above

    total = hashlib.sha256()
    if is_folder(path):
        try:
            inside = sorted(one for one in Path(path).rglob("*") if not one.is_dir())
        except OSError as error:
            raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the name") from error
        for one in inside:
            total.update(f"{one.relative_to(path).as_posix()}\0{digest(one)}\n".encode())
        return total.hexdigest()
    with open_file(path) as file:
        while part := file.read(_AT_ONCE):
            total.update(part)
    return total.hexdigest()


def _check_kind(path: str | os.PathLike[str], found: os.stat_result) -> None:
    if stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode):
        return
    kinds = ((stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"))
    what = next((name for is_it, name in kinds if is_it(found.st_mode)), "a device")
    raise InputError(f"{path}: is {what}, not a file; save what comes out of it in a file, and give that one")
