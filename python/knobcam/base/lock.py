"""A file that one process holds at a time, which the system lets go of whatever ends that; and who writes."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

from .reading import UNHURRIED


def hold(lock: int) -> None:
    """Hold an open file, by its descriptor, until that is closed. OSError where another process does."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(lock, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_written(path: str | os.PathLike[str]) -> bool:
    """Whether a program has a file open for writing; False where the system does not tell.

    Linux tells it by refusing a lease, of files of one's own that lie on its own disks.
    """
    if sys.platform != "linux":
        return False
    import fcntl

    try:
        file = os.open(path, os.O_RDONLY | UNHURRIED)
    except OSError:
        return False
    try:
        with suppress(OSError):  # who opens it meanwhile is told by a signal that ends no program
            fcntl.fcntl(file, fcntl.F_SETSIG, signal.SIGURG)
        fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_RDLCK)
        fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_UNLCK)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(file)
    return False
