"""What a session leaves behind: the model, the report, the figures, the script."""

from __future__ import annotations

import io
import os
import threading
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, TYPE_CHECKING

from ..base.writing import make_folder, place, together, write
from ..errors import InputError
from ..show import plot
from .adding import story
from .script import script

if TYPE_CHECKING:
    from ..learn import LearningResult
    from ..model.effects import Effect
    from .session import Session
    from .tell import Tell

FILES = {
    "model": "knobcam-model.toml",
    "report": "knobcam-report.html",
    "figures": "knobcam-figures.zip",
    "script": "knobcam-session.py",
}
"""What can be saved, and the name that it has when a browser keeps it."""
_ASKS_S = 0.1
_drawing = threading.Lock()


def save(session: Session, what: str, path: Path, tell: Tell) -> Path:
    """Write one of `FILES` and return where it is: a file, or a folder for figures if the name is no .zip.

    Raises InputError for anything else, and for a place that is taken or cannot be written to.
    """
    if what not in FILES:
        raise InputError(f"what={what!r} cannot be saved; there are {', '.join(FILES)}")
    target = path.absolute()
    if os.path.lexists(target) or place(target).old is not None:
        raise InputError(f"{path}: exists already; choose another name")
    _WRITE[what](session, target, tell)
    return target


def told(session: Session, tell: Tell) -> LearningResult:
    """Return what the current branch has learned; what is not weighed yet is weighed for it."""
    return story(session, tell)


def drawn(effect: Effect, tell: Tell) -> bytes:
    """Return the picture of where an effect shows, as PNG."""
    with _pen(tell), io.BytesIO() as stream:
        effect.plot().savefig(stream, format="png", dpi=90)
        return stream.getvalue()


@contextmanager
def _pen(tell: Tell) -> Iterator[None]:
    """Wait for what somebody else draws: the style of a picture is a setting of all."""
    while not _drawing.acquire(timeout=_ASKS_S):
        tell("waiting for a picture")
    try:
        yield
    finally:
        _drawing.release()


def _model(session: Session, target: Path, tell: Tell) -> None:
    tell("writing the model", last=True)
    session.view.model.save(target)


def _report(session: Session, target: Path, tell: Tell) -> None:
    whole = told(session, tell)
    tell("drawing the report")
    with _pen(tell), together():
        whole.report(target)
        tell("putting the report in its place", last=True)


def _script(session: Session, target: Path, tell: Tell) -> None:
    tell("writing the script", last=True)
    write(target, script(session.branch.done, session.captures, session.start))


def _figures(session: Session, target: Path, tell: Tell) -> None:
    if target.suffix != ".zip":
        with together():
            _draw_all(session, target, tell)
            tell("putting the figures in their place", last=True)
        return
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "figures"
        _draw_all(session, folder, tell)
        tell("putting the figures in their place", last=True)
        write(target, lambda file: _zipped(folder, file))


def _draw_all(session: Session, folder: Path, tell: Tell) -> None:
    whole = told(session, tell)
    tell("drawing the figures")
    with _pen(tell), together():
        make_folder(folder)
        plot.save_all(whole.fit, folder / "fit", whole.after)
        plot.save_learning(whole, folder / "story")


def _zipped(folder: Path, file: IO[bytes]) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        for picture in sorted(folder.rglob("*.png")):
            archive.write(picture, picture.relative_to(folder).as_posix())


_WRITE: Mapping[str, Callable[[Session, Path, Tell], None]] = {
    "model": _model,
    "report": _report,
    "figures": _figures,
    "script": _script,
}
