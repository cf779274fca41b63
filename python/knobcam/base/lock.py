"""A file that one process holds at a time; the system lets go of it whatever ends the process."""

from __future__ import annotations

import sys


def hold(lock: int) -> None:
    """Hold an open file, by its descriptor, until that is closed. OSError where another process does."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(lock, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
