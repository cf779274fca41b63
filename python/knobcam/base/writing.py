"""How a file is written, by everything here but the recorder of a rig: whole or not at all, and in its place.

What a path means is settled first (`place`): a link stands for its target, a FIFO or a device is written
through, and what may not be written is refused by name. Then the content goes to a temporary neighbour that
nobody else can have, is synced, and takes the old file's owner, mode and name. Files that belong together
(`together`) all appear, or none does.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from ..errors import InputError
from .reading import UNHURRIED, open_file

RECORDING = b"knobcam wire log\n"
"""How a recording of a rig begins."""
RECORDING_SUFFIX = ".kcwire"

Content = str | bytes | Callable[[IO[bytes]], object]
"""A text, bytes, or what writes itself into an open file that can seek."""

_EXCLUSIVE = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)
_open = threading.local()
_parts: set[Path] = set()


@dataclass(frozen=True)
class Place:
    """Where a path leads: the file itself, links followed; `old` is what is there, None for nothing."""

    path: Path
    file: Path
    old: os.stat_result | None
    through: bool
    """Whether it is no file to be replaced, but something to write into."""


def place(path: str | os.PathLike[str]) -> Place:
    """Return where a path leads. InputError says why nothing may be written there."""
    try:
        given = Path(path)
    except TypeError:
        raise InputError(f"path={path!r}: is no path; give the name of a file") from None
    try:
        old = _stat(given)
        file = Path(os.path.realpath(given))
        if given.name.lower().endswith(RECORDING_SUFFIX) or file.name.lower().endswith(RECORDING_SUFFIX):
            raise InputError(
                f"{given}: is the name of a recording, which only a rig's is; choose another name"
            )
        if old is not None and not stat.S_ISREG(old.st_mode):
            return _special(given, old)
        _check_folder(given, file.parent)
        if old is None:
            return Place(given, file, None, through=False)
        there = _stat(file)  # which others may have replaced just now
        if there is None and _stat(given) is not None:  # standard output that goes to a deleted file
            return Place(given, given, old, through=True)
        if there is not None:
            _check_file(given, file, there)
        return Place(given, file, there, through=False)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise _refusal(given, error) from error


def is_recording(path: str | os.PathLike[str]) -> bool:
    """Whether a file begins as a recording of a rig does."""
    try:
        with open_file(path) as file:
            return file.read(len(RECORDING)) == RECORDING
    except (InputError, OSError):
        return False


def write(path: str | os.PathLike[str], content: Content) -> Path:
    """Write a file, whole or not at all, and return its path as it was given.

    Raises InputError, one line that names it, where it cannot or may not be written.
    """
    with together() as outputs:
        outputs.add(place(path), content)
    return Path(path)


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Make a folder, and those above it, if need be; it goes again where nothing comes to be in it."""
    folder = Path(path)
    missing = []
    try:
        for one in (folder, *folder.parents):
            if _stat(one) is not None:
                break
            missing.append(one)
        if not missing and not folder.is_dir():
            raise InputError(f"{folder}: is a file, a folder is needed; choose another name")
        with together() as outputs:
            for one in reversed(missing):
                one.mkdir(exist_ok=True)
                outputs.folders.append(one)
    except OSError as error:
        raise _refusal(folder, error) from error
    return folder


@contextmanager
def together() -> Iterator[Outputs]:
    """All that this thread writes inside appears at its end, or, where anything fails, none of it.

    Inside another one it is a part of that.
    """
    around: Outputs | None = getattr(_open, "outputs", None)
    if around is not None:
        yield around
        return
    outputs = Outputs()
    try:
        _open.outputs = outputs
        yield outputs
        outputs.commit()
    finally:
        _open.outputs = None
        try:
            outputs.discard()
        except BaseException:  # Ctrl-C while it tidies up
            outputs.discard()
            raise


def remove_parts() -> None:
    """Remove what is half written: for a process that ends without waiting for its threads."""
    for part in list(_parts):
        with suppress(OSError):
            part.unlink()


@dataclass
class _Staged:
    place: Place
    part: Path | None = None
    inode: int = 0
    held: bytes = b""
    replaces: bool = False
    kept: Path | None = None
    """A second name of the old file, until all have taken their place."""


@dataclass
class Outputs:
    """Files that are written but not yet in their places."""

    staged: list[_Staged] = field(default_factory=list)
    folders: list[Path] = field(default_factory=list)
    done: bool = False

    def add(self, at: Place, content: Content) -> None:
        """Write a file beside its place."""
        if any(one.place.file == at.file for one in self.staged):
            raise InputError(f"{at.path}: is written twice by this call; choose two names")
        one = _Staged(at)
        self.staged.append(one)
        try:
            if at.through:
                one.held = _in_memory(content)
            else:
                self._fill(one, content)
        except (OSError, UnicodeEncodeError) as error:
            raise _refusal(at.path, error) from error

    def _fill(self, one: _Staged, content: Content) -> None:
        old = one.place.old
        part = _neighbour(one.place.file)
        one.part = part
        _parts.add(part)
        # A file that was not there gets the mode that the user's umask gives to all others.
        descriptor = os.open(part, _EXCLUSIVE, 0o666 if old is None else 0o600)
        with os.fdopen(descriptor, "w+b") as file:
            _put(file, content)
            file.flush()
            if old is not None:
                _take_after(one.place.path, file.fileno(), old)
            os.fsync(file.fileno())
            one.inode = os.fstat(file.fileno()).st_ino

    def commit(self) -> None:
        """Put every file in its place; where one cannot be, those before it go back to what was there."""
        for one in self.staged:
            if one.place.through:
                _write_through(one.place.path, one.held)
        files = [(one, one.part) for one in self.staged if one.part is not None]
        try:
            for one, part in files:
                self._take_place(one, part, alone=len(files) == 1)
            self.done = True
        except BaseException:
            self._undo()
            raise
        for folder in {part.parent for _, part in files}:
            _sync(folder)

    def _take_place(self, one: _Staged, part: Path, alone: bool) -> None:
        at = one.place
        try:
            one.replaces = _check_unchanged(at)
            if one.replaces and not alone:
                one.kept = _neighbour(at.file)
                _keep(at.file, one.kept)
            part.replace(at.file)
        except OSError as error:
            raise _refusal(at.path, error) from error

    def _undo(self) -> None:
        for one in self.staged:
            with suppress(OSError):
                if one.part is None or one.place.file.lstat().st_ino != one.inode:
                    continue
                if one.kept is not None:
                    one.kept.replace(one.place.file)
                elif not one.replaces:
                    one.place.file.unlink()

    def discard(self) -> None:
        """Remove all that is temporary."""
        for one in self.staged:
            for path in (one.part, one.kept):
                if path is not None:
                    with suppress(OSError):
                        path.unlink()
                    _parts.discard(path)
        if not self.done:
            for folder in reversed(self.folders):
                with suppress(OSError):
                    folder.rmdir()


def _stat(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None


def _refusal(path: Path, error: Exception) -> InputError:
    why = getattr(error, "strerror", None) or error
    shown = str(path) if len(str(path)) < 300 else f"{str(path)[:100]}...{str(path)[-100:]}"
    return InputError(f"{shown}: cannot be written ({why}); choose another place")


def _special(path: Path, old: os.stat_result) -> Place:
    if stat.S_ISDIR(old.st_mode):
        raise InputError(f"{path}: is a folder; name a file in it")
    if stat.S_ISFIFO(old.st_mode) or stat.S_ISCHR(old.st_mode):
        return Place(path, path, old, through=True)
    what = "a socket" if stat.S_ISSOCK(old.st_mode) else "a block device"
    raise InputError(f"{path}: is {what}, not a file; choose another place")


def _check_folder(path: Path, folder: Path) -> None:
    if not folder.is_dir():
        raise InputError(f"{path}: there is no folder {folder}; make it first, or choose another place")
    if not os.access(folder, os.W_OK):
        raise InputError(f"{path}: the folder {folder} cannot be written to; choose another place")


def _check_file(path: Path, file: Path, old: os.stat_result) -> None:
    # Of the mode itself: to the superuser nothing else is read-only.
    if not old.st_mode & 0o222 or not os.access(file, os.W_OK):
        raise InputError(f"{path}: is read-only (mode {stat.S_IMODE(old.st_mode):04o}); choose another name")
    if is_recording(file):
        raise InputError(f"{path}: holds a recording, which is never written over; choose another name")


def _check_unchanged(at: Place) -> bool:
    """Refuse to replace what came meanwhile, as a recording or a device; return whether a file is there."""
    now = place(at.path)
    if now.through or now.file != at.file:
        raise InputError(f"{at.path}: leads somewhere else than it did; choose another place")
    return now.old is not None


def _keep(file: Path, kept: Path) -> None:
    """Give a file a second name, or where the file system knows no such thing a copy."""
    try:
        os.link(file, kept)
    except OSError:
        import shutil  # slow to load, and hardly ever needed

        shutil.copy2(file, kept)


def _take_after(path: Path, descriptor: int, old: os.stat_result) -> None:
    """Give a file the owner and the mode of the one that it replaces."""
    mine = os.fstat(descriptor)
    if (mine.st_uid, mine.st_gid) != (old.st_uid, old.st_gid):
        try:
            os.fchown(descriptor, old.st_uid, old.st_gid)
        except PermissionError:
            raise InputError(
                f"{path}: belongs to user {old.st_uid} and group {old.st_gid}, and would not any more; "
                f"choose another name"
            ) from None
    os.fchmod(descriptor, stat.S_IMODE(old.st_mode))


def _neighbour(file: Path) -> Path:
    # Short, as the name itself may be as long as a name can be.
    return file.with_name(f".knobcam-{os.urandom(8).hex()}.part")


def _put(file: IO[bytes], content: Content) -> None:
    if callable(content):
        content(file)
    else:
        file.write(content.encode() if isinstance(content, str) else content)


def _in_memory(content: Content) -> bytes:
    with io.BytesIO() as held:
        _put(held, content)
        return held.getvalue()


def _write_through(path: Path, content: bytes) -> None:
    try:
        # A FIFO that nobody reads would not let go.
        descriptor = os.open(path, os.O_WRONLY | UNHURRIED)
        with os.fdopen(descriptor, "wb", buffering=0) as file:
            os.set_blocking(descriptor, True)
            rest = memoryview(content)
            while rest:
                rest = rest[file.write(rest) :]
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise InputError(f"{path}: nobody reads from it; start its reader first") from None
        raise _refusal(path, error) from error


def _sync(folder: Path) -> None:
    """Keep the names in a folder, where the file system can: the files themselves are safe already."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY | getattr(os, "O_DIRECTORY", 0))
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
