"""What a command hands back, and how it reaches the two streams."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..base.reading import is_folder
from ..errors import InputError

if TYPE_CHECKING:
    from ..capture import Capture
    from ..capture.prepare import Prepared


class Answer(NamedTuple):
    """A finished command: text for people, the document for programs, messages for standard error.

    Messages wait until the command has succeeded: a wrong call says one line and nothing else. `code` is 1
    where a part of what was asked for failed, as the answer says.
    """

    text: str
    document: Mapping[str, Any]
    messages: tuple[str, ...] = ()
    code: int = 0


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
    from ..base.writing import place

    there = place(output)
    if there.through or there.old is None:
        return
    if any(_is_same(path, there.file) for path in inputs):
        raise InputError(f"{output}: is also read by this command; write to another file")


def check_kind(output: Path | None, what: str, *kinds: str) -> None:
    """Refuse a name that says of a file that it is something else than what will be in it."""
    if output is not None and output.suffix and not output.name.lower().endswith(kinds):
        raise InputError(f"{output}: {what} is written as {', '.join(kinds)}; name it so")


def check_folder(folder: Path | None, file: Path | None = None) -> None:
    """Refuse a folder that cannot be made; `file` is what the same command writes beside it."""
    if folder is None:
        return
    if not is_folder(folder):
        from ..base.writing import place

        if place(folder).old is not None:
            raise InputError(f"{folder}: is a file, a folder for pictures is needed; choose another name")
    elif not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: the folder cannot be written to; choose another place")
    if file is not None and folder.absolute() == file.absolute():
        raise InputError(f"{folder}: cannot be a file and a folder; choose two names")


def _is_same(path: str | Path, file: Path) -> bool:
    try:
        return file.samefile(path)
    except (OSError, ValueError):
        return False


@contextmanager
def about(*paths: str) -> Iterator[None]:
    """Say which captures a refusal is about: the library was handed their samples, not their names."""
    try:
        yield
    except InputError as error:
        said = str(error)
        if any(said.startswith(f"{one}: ") for path in paths for one in (path, Path(path).name)):
            raise  # the library knew
        raise InputError(f"{', '.join(paths)}: {said}") from error
