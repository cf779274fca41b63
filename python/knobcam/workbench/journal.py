"""Where sessions are kept while they go on: a folder for each, which only its user may enter.

In it stand `journal`, lines that are added as the session changes, the files that a browser handed over, and
`lock`, held by the process whose session it is for as long as that lives, however it ends. A line is the
CRC-32 of its JSON and the JSON; a last line that was cut is as if it had never been begun.
"""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import stat
import zlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

import platformdirs

from ..base.lock import hold
from ..base.reading import open_file
from ..base.strict_json import as_json
from ..base.writing import write
from ..errors import InputError

SCHEMA = "knobcam.session/1"
Record = Mapping[str, Any]

_KEPT = 8  # sessions that are over
_MOST_BYTES = 32_000_000  # of a journal; a long session has some 100 kB
_MOST_HANDED = 1_000_000_000  # bytes of all files that browsers handed over
_COMPACT_BYTES = 500_000  # of a journal that is written anew without what is past
_NUMBER = re.compile(r"\d{6}")
_PRIVATE = 0o600
_OURS = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)
_NEW = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | _OURS


def usual_folder() -> Path:
    """Return the folder in which this user's sessions are kept."""
    return Path(platformdirs.user_state_dir("knobcam")) / "sessions"


def sessions(root: Path) -> list[Path]:
    """Return the folders of all sessions that were kept, the newest first; the clock has no say in it."""
    return [one for one in _numbered(root) if (one / "journal").is_file()]


def _numbered(root: Path) -> list[Path]:
    try:
        return sorted((one for one in root.iterdir() if _NUMBER.fullmatch(one.name)), reverse=True)
    except OSError:
        return []


def read(folder: Path) -> list[dict[str, Any]]:
    """Return the lines of a journal. InputError names one that is damaged or foreign."""
    path = folder / "journal"
    with open_file(path) as file:
        raw = file.read(_MOST_BYTES + 1)
    out = f"; its session cannot go on. Remove the folder {folder}"
    if len(raw) > _MOST_BYTES:
        raise InputError(f"{path}: more than {_MOST_BYTES // 1_000_000} MB, so no journal{out}")
    whole, _, _ = raw.rpartition(b"\n")
    lines = whole.split(b"\n") if whole else []
    records = [_record(line) for line in lines]
    if records and records[-1] is None:  # what a disk had not yet when the power went
        records.pop()
    for number, record in enumerate(records, 1):
        if record is None:
            raise InputError(f"{path}: line {number} is damaged{out}")
    known = [record for record in records if record is not None]
    if not known or known[0].get("schema") != SCHEMA:
        raise InputError(f"{path}: does not begin as a journal of this version does{out}")
    return known


def line(record: Record) -> bytes:
    """Return a record as a line of the journal."""
    content = as_json(record, indent=None).encode()
    return f"{zlib.crc32(content):08x} ".encode() + content + b"\n"


def _record(raw: bytes) -> dict[str, Any] | None:
    check, _, content = raw.partition(b" ")
    if check != f"{zlib.crc32(content):08x}".encode():
        return None
    try:
        found = json.loads(content)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def prune(root: Path) -> None:
    """Remove the oldest sessions that are over, beyond as many and as much as are kept."""
    handed = 0
    for place, folder in enumerate(_numbered(root)):
        with suppress(OSError):
            handed += sum(one.stat().st_size for one in folder.glob("handed-*"))
        if place < _KEPT and (handed <= _MOST_HANDED or place == 0):
            continue
        with suppress(InputError), Journal.taken(folder):
            shutil.rmtree(folder, ignore_errors=True)


class Journal:
    """A session's folder that this process holds. Raises InputError where it cannot be written."""

    def __init__(self, folder: Path, lock: int) -> None:
        self.folder = folder
        self._lock = lock
        self._file = -1
        self._size = 0
        self._compacted = 0

    @classmethod
    def begun(cls, root: Path, first: Record) -> Self:
        """Make the folder of a new session."""
        try:
            _make_private(root)
            number = 1 + max((int(one.name) for one in _numbered(root)), default=0)
            while True:
                folder = root / f"{number:06d}"
                try:
                    folder.mkdir(mode=0o700)
                    break
                except FileExistsError:  # of another workbench that began just now
                    number += 1
        except OSError as error:
            raise _unwritable(root, error) from error
        journal = cls.taken(folder)
        journal.rewrite([first])
        return journal

    @classmethod
    def taken(cls, folder: Path) -> Self:
        """Take the folder of a session whose process has ended. InputError while another process has it."""
        try:
            lock = os.open(folder / "lock", os.O_RDWR | os.O_CREAT | _OURS, _PRIVATE)
        except OSError as error:
            raise _unwritable(folder, error) from error
        try:
            hold(lock)
        except OSError as error:
            os.close(lock)
            if error.errno in (errno.EACCES, errno.EAGAIN, errno.EDEADLK):
                raise InputError(
                    f"{folder}: the session goes on in another workbench; use that one"
                ) from None
            raise _unwritable(folder, error) from error
        return cls(folder, lock)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of it."""
        for one in (self._file, self._lock):
            if one >= 0:
                os.close(one)
        self._file = self._lock = -1

    def append(self, records: Iterable[Record]) -> None:
        """Add lines, all or none, so that they outlive this process and this machine's power."""
        content = b"".join(line(one) for one in records)
        try:
            if self._file < 0:
                self._reopen()
            try:
                rest = memoryview(content)
                while rest:
                    rest = rest[os.write(self._file, rest) :]
                os.fsync(self._file)
            except OSError:
                with suppress(OSError):  # half a line must not stand before the next one
                    os.ftruncate(self._file, self._size)
                raise
        except OSError as error:
            raise _unwritable(self.folder, error) from error
        self._size += len(content)

    @property
    def long(self) -> bool:
        """Whether most of it is past, so that it had better be written anew."""
        return self._size > _COMPACT_BYTES + 2 * self._compacted

    def rewrite(self, records: Sequence[Record]) -> None:
        """Put these lines in the place of all others, at one stroke."""
        content = b"".join(line(one) for one in records)
        path = self.folder / "journal"
        try:
            os.close(os.open(path, os.O_WRONLY | os.O_CREAT | _OURS, _PRIVATE))
        except OSError as error:
            raise _unwritable(self.folder, error) from error
        write(path, content)
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
        self._compacted = self._size = len(content)

    def hand(self, source: Path, sha256: str) -> None:
        """Keep a file that a browser handed over, which is nowhere else."""
        target = self.handed(sha256)
        if target.exists():
            return
        part = target.with_suffix(".part")
        try:
            with open_file(source) as file, os.fdopen(os.open(part, _NEW, _PRIVATE), "wb") as copy:
                shutil.copyfileobj(file, copy)
                copy.flush()
                os.fsync(copy.fileno())
            part.replace(target)
        except OSError as error:
            with suppress(OSError):
                part.unlink()
            raise _unwritable(self.folder, error) from error

    def handed(self, sha256: str) -> Path:
        """Return where a file that was handed over is kept."""
        return self.folder / f"handed-{sha256}"

    def decline(self, declined: bool = True) -> None:
        """Say whether nobody wants this session offered again."""
        mark = self.folder / "declined"
        with suppress(OSError):
            if declined:
                os.close(os.open(mark, _NEW, _PRIVATE))
            else:
                mark.unlink(missing_ok=True)

    def _reopen(self) -> None:
        """Open the file at the end of its last whole line."""
        file = os.open(self.folder / "journal", os.O_RDWR | _OURS)
        content = os.read(file, _MOST_BYTES)
        end = content.rfind(b"\n") + 1
        if end and _record(content[:end].splitlines()[-1]) is None:
            end = content.rfind(b"\n", 0, end - 1) + 1
        os.ftruncate(file, end)
        os.lseek(file, end, os.SEEK_SET)
        self._file, self._size = file, end


def declined(folder: Path) -> bool:
    """Whether nobody wants this session offered again."""
    return (folder / "declined").exists()


def goes_on(folder: Path) -> bool:
    """Whether the process whose session it is lives."""
    try:
        with Journal.taken(folder):
            return False
    except InputError:
        return True


def _make_private(folder: Path) -> None:
    """Make a folder of this user's own, or see to it that it is."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    found = folder.stat()
    if hasattr(os, "geteuid") and found.st_uid != os.geteuid():
        raise PermissionError(errno.EPERM, "belongs to another user")
    if stat.S_IMODE(found.st_mode) & 0o077:
        folder.chmod(0o700)


def _unwritable(place: Path, error: OSError) -> InputError:
    return InputError(f"{place}: cannot be written ({error.strerror or error}), so the session is not kept")
