"""What a command hands back, and how it reaches the two streams."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import InputError

if TYPE_CHECKING:
    from ..capture import Capture
    from ..capture.prepare import Prepared


class Answer(NamedTuple):
    """A finished command: text for people, the document for programs, messages for standard error.

    Messages wait until the command has succeeded: a wrong call says one line and nothing else.
    """

    text: str
    document: Mapping[str, Any]
    messages: tuple[str, ...] = ()


class Unfinished(KeyboardInterrupt):
    """Ctrl-C in a command that has something to answer all the same."""

    def __init__(self, answer: Answer) -> None:
        super().__init__("what was known by then is printed")
        self.answer = answer


def status(text: str | None) -> None:
    """Show what is being done on the last line of a terminal; None takes it away. Files see nothing of it."""
    if sys.stderr.isatty():
        sys.stderr.write("\r\x1b[K" + (f"{text} ..." if text else ""))
        sys.stderr.flush()


def findings(path: str | Path, capture: Capture, signals: Prepared | None = None) -> tuple[str, ...]:
    """Return what was found in a capture and how it was prepared, as lines that name its file."""
    found, notes = (capture.findings, ()) if signals is None else (signals.findings, signals.notes)
    return (*(f"{path}: {one}" for one in found), *(f"{path}: note: {note}" for note in notes))


def check_file(output: Path | None, inputs: Iterable[str | Path] = ()) -> None:
    """Refuse a file that cannot be written, or is one of the inputs, before any work is done."""
    if output is None:
        return
    _check_parent(output)
    if output.is_dir():
        raise InputError(f"{output}: is a folder; name a file in it")
    if any(Path(path).exists() and output.exists() and output.samefile(path) for path in inputs):
        raise InputError(f"{output}: is also read by this command; write to another file")


def check_folder(folder: Path | None, file: Path | None = None) -> None:
    """Refuse a folder that cannot be made; `file` is what the same command writes beside it."""
    if folder is None:
        return
    _check_parent(folder)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file, a folder for pictures is needed; choose another name")
    if file is not None and folder.absolute() == file.absolute():
        raise InputError(f"{folder}: cannot be a file and a folder; choose two names")


def _check_parent(path: Path) -> None:
    parent = path.absolute().parent
    if not parent.is_dir():
        raise InputError(f"{path}: there is no folder {parent}; make it first, or choose another place")
    target = path if path.is_dir() else parent
    if not os.access(target, os.W_OK):
        raise InputError(f"{path}: the folder {target} cannot be written to; choose another place")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn a refusal of the file system (full, read-only) into one line that names `path`."""
    try:
        yield
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{path}: cannot be written ({why}); choose another place") from error


@contextmanager
def about(*paths: str) -> Iterator[None]:
    """Say which captures a refusal is about: the library was handed their samples, not their names."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{', '.join(paths)}: {error}") from error
