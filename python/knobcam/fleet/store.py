"""RESULTS: a folder with the table of a batch, and, while it runs, the parts of what is done.

A part is a small file that appears whole or not at all; whatever ends a batch, what stands in parts is not
done again. At the end the table is made of all rows, by their names: the same rows make the same bytes.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

from .._core import __version__
from ..base.lock import hold
from ..base.reading import is_folder, read_text
from ..base.strict_json import as_json
from ..base.writing import make_folder, together, write
from ..errors import InputError
from ..model import Model
from . import table
from .limits import Limits
from .row import Row, compact
from .settings import Settings
from .sources import RESULTS

SCHEMA = "knobcam.batch/1"
_PARTS = "_parts"
_LOCK = "_lock"
_LIMITS = "_limits.toml"
_MOST_BYTES = 1_000_000
_PARTITIONS = ("lot", "station", "date")
_DAY = len("2026-11-24")  # letters of a date, behind which files of their own have the time of day


@dataclass
class Store:
    """The rows of a batch by the names of their captures, and where they are kept."""

    folder: Path
    settings: Settings
    limits: str = ""
    """The file of limits by which the rows are judged at the end, or before it where it does not come."""
    rows: dict[str, Row] = field(default_factory=dict)
    _number: int = 0
    _lock: int = -1
    _held: bool = False
    """Whether the limits stand beside the parts of this run."""

    @classmethod
    def open(cls, folder: Path, settings: Settings, limits: Limits | None = None) -> Store:
        """Return the store in a folder, which is made with the first row.

        InputError where nothing can be written there, or it is of another batch or kind.
        """
        there = next(one for one in (folder, *folder.absolute().parents) if one.exists())
        if not is_folder(there):
            raise InputError(f"{there}: is a file, a folder is needed; choose another name")
        if not os.access(there, os.W_OK):
            raise InputError(f"{there}: the folder cannot be written to; choose another place")
        if (folder / RESULTS).exists():
            known = _about(folder)
            if known.get("settings") != settings.digest:
                raise InputError(
                    f"{folder}: holds a batch with another model, other options or of another version "
                    f"({known.get('version')}); choose another folder, or remove this one"
                )
        elif there == folder and any(folder.iterdir()):
            raise InputError(f"{folder}: is not empty and no results of a batch; choose another folder")
        rows, number = _kept(folder)
        return cls(folder, settings, "" if limits is None else limits.text, rows, number)

    def _begin(self) -> None:
        """Make the folder what it is, if it is not yet."""
        about = make_folder(self.folder) / RESULTS
        if not about.exists():
            known = {name: getattr(self.settings, name) for name in ("model", "hints")}
            known |= {"settings": self.settings.digest, "version": __version__}
            write(about, as_json({"schema": SCHEMA, **known}))
        self._hold()

    def _hold(self) -> None:
        """Keep others from writing there at the same time."""
        if self._lock >= 0:
            return
        lock = os.open(self.folder / _LOCK, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            hold(lock)
        except OSError:
            os.close(lock)
            raise InputError(
                f"{self.folder}: another batch or watch writes there; wait for its end"
            ) from None
        self._lock = lock

    def close(self) -> None:
        """Let others write there."""
        if self._lock >= 0:
            os.close(self._lock)
            self._lock = -1

    def put(self, rows: list[Row]) -> None:
        """Keep rows, in a part."""
        if not rows:
            return
        lines = [json.dumps(one, allow_nan=False) for one in rows]
        self._begin()
        held = make_folder(self.folder / _PARTS) / _LIMITS
        if not self._held:
            write(held, self.limits)
            self._held = True
        self._number += 1
        write(self.folder / _PARTS / f"{self._number:08d}.json", "\n".join(lines))
        self.rows |= {one["capture"]: compact(one) for one in rows}

    def finish(self, judged: list[Row]) -> None:
        """Write the table of all rows, as judged by limits, over the one before; remove the parts."""
        self._begin()
        schema = table.schema_of(judged)
        groups: dict[str, list[Row]] = {}
        for row in sorted(judged, key=lambda one: str(one["capture"])):
            groups.setdefault(_partition(row), []).append(row)
        before = set(_files(self.folder))
        with together():
            write(self.folder / _LIMITS, self.limits)
            for where, rows in sorted(groups.items()):
                make_folder(self.folder / where)
                path = self.folder / where / "rows.parquet"
                write(path, table.content(rows, schema))
                before.discard(path)
        for old in before:
            old.unlink()
        shutil.rmtree(self.folder / _PARTS, ignore_errors=True)
        self._number, self._held = 0, False


def read(folder: str | os.PathLike[str]) -> list[Row]:
    """Return the rows in a folder of results, sorted by capture; InputError where there are none."""
    path = Path(folder)
    if not is_folder(path) or not (path / RESULTS).is_file():
        raise InputError(f"{path}: holds no results of knobcam batch; name the folder that it wrote")
    _about(path)
    rows, _ = _kept(path)
    if not rows:
        raise InputError(f"{path}: has no row yet; run knobcam batch first")
    return [rows[name] for name in sorted(rows)]


def hinted(folder: str | os.PathLike[str]) -> bool | None:
    """Return whether the rows in a folder have hints; None where there are none yet."""
    path = Path(folder)
    return bool(_about(path).get("hints")) if (path / RESULTS).is_file() else None


def limits_of(folder: str | os.PathLike[str]) -> Limits | None:
    """Return the limits by which the rows in a folder are judged; None where there are none.

    Those of a batch that was ended before its table was made stand beside its parts.
    """
    both = (Path(folder) / _PARTS / _LIMITS, Path(folder) / _LIMITS)
    path = next((one for one in both if one.is_file()), None)
    if path is None or not (text := read_text(path, "file of limits", _MOST_BYTES)):
        return None
    model = _about(Path(folder)).get("model")
    return Limits.parse(text, path, None if model is None else Model.parse(model), learned=True)


def _about(folder: Path) -> dict[str, Any]:
    try:
        known = json.loads((folder / RESULTS).read_text("utf-8"))
        if known["schema"] == SCHEMA:
            return dict(known)
    except (OSError, ValueError, TypeError, KeyError):
        pass
    raise InputError(f"{folder}: its {RESULTS} is damaged or of another version; choose another folder")


def _kept(folder: Path) -> tuple[dict[str, Row], int]:
    """Return the rows of the table and, over them, those of the parts; and the number of the last part."""
    rows: dict[str, Row] = {}
    for path in _files(folder):
        rows |= {one["capture"]: one for one in table.rows_in(path)}
    number = 0
    for part in sorted((folder / _PARTS).glob("*.json")):
        number = int(part.stem)
        try:
            done = [json.loads(line) for line in part.read_text("utf-8").splitlines()]
        except (OSError, ValueError) as error:
            raise InputError(
                f"{part}: is damaged ({error}); remove it, its captures are done again"
            ) from None
        rows |= {one["capture"]: compact(one) for one in done}
    return rows, number


def _files(folder: Path) -> list[Path]:
    return sorted(folder.rglob("rows.parquet"))


def _partition(row: Row) -> str:
    """Return the folder of a row in the table, by what it belongs to and the day."""
    known = {name: str(row[name]) for name in _PARTITIONS if row.get(name) is not None}
    if re.match(r"\d{4}-\d{2}-\d{2}T", known.get("date", "")):
        known["date"] = known["date"][:_DAY]
    return "/".join(f"{name}-{quote(value, safe=' ')}" for name, value in known.items())
