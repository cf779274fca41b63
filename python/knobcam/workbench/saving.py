"""What a session leaves behind: the model, the report, the figures, the script."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.atomic import write_atomically, write_text_atomically
from ..errors import InputError
from ..show import plot
from .learned import learned
from .script import script

if TYPE_CHECKING:
    from ..learn import LearningResult
    from ..model.effects import Effect
    from .session import Session, Tell

FILES = {
    "model": "knobcam-model.toml",
    "report": "knobcam-report.html",
    "figures": "knobcam-figures.zip",
    "script": "knobcam-session.py",
}
"""What can be saved, and the name that it has when a browser keeps it."""


def save(session: Session, what: str, path: Path, tell: Tell) -> Path:
    """Write one of `FILES` and return where it is: a file, or a folder for figures if the name is no .zip.

    Raises InputError for anything else, and for a place that is taken or cannot be written to.
    """
    if what not in FILES:
        raise InputError(f"what={what!r} cannot be saved; there are {', '.join(FILES)}")
    target = path.absolute()
    if target.exists():
        raise InputError(f"{path}: exists already; choose another name")
    if not target.parent.is_dir():
        raise InputError(f"{path}: there is no folder {target.parent}; make it first")
    _WRITE[what](session, target, tell)
    return target


def told(session: Session, tell: Tell) -> LearningResult:
    """Return what the current branch has learned; what is not weighed yet is weighed for it."""
    return learned(session.branch.done, session.weigh(tell))


def drawn(effect: Effect) -> bytes:
    """Return the picture of where an effect shows, as PNG."""
    with io.BytesIO() as stream:
        effect.plot().savefig(stream, format="png", dpi=90)
        return stream.getvalue()


def _model(session: Session, target: Path, tell: Tell) -> None:
    tell("writing the model")
    session.view.model.save(target)


def _report(session: Session, target: Path, tell: Tell) -> None:
    whole = told(session, tell)
    tell("drawing the report")
    whole.report(target)


def _script(session: Session, target: Path, tell: Tell) -> None:
    tell("writing the script")
    write_text_atomically(target, script(session.branch.done, session.captures, session.start))


def _figures(session: Session, target: Path, tell: Tell) -> None:
    if target.suffix == ".zip":
        write_atomically(target, lambda part: _zipped(session, part, tell))
        return
    whole = told(session, tell)
    tell("drawing the figures")
    try:
        plot.save_all(whole.fit, target / "fit", whole.after)
        plot.save_learning(whole, target / "story")
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{target}: cannot be written ({why}); choose another place") from error


def _zipped(session: Session, part: Path, tell: Tell) -> None:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "figures"
        _figures(session, folder, tell)
        with zipfile.ZipFile(part, "w") as archive:
            for picture in sorted(folder.rglob("*.png")):
                archive.write(picture, picture.relative_to(folder).as_posix())


_WRITE: Mapping[str, Callable[[Session, Path, Tell], None]] = {
    "model": _model,
    "report": _report,
    "figures": _figures,
    "script": _script,
}
