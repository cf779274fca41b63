"""SIGTERM and SIGHUP end a program as Ctrl-C does: torque goes first, and files are whole."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_asked: list[Ended] = []
_NAMES = [name for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]


class Ended(SystemExit):
    """The program was told to end by the signal `number`; its exit code is what a shell reports for that.

    `kept` says, once the torque is off, what is kept of the work.
    """

    def __init__(self, number: int, kept: str = "") -> None:
        super().__init__(128 + number)
        self.number = number
        self.kept = kept

    def __str__(self) -> str:
        name = signal.Signals(self.number).name
        return f"ended by {name}; {self.kept}" if self.kept else f"ended by {name}"


def asked() -> Ended | None:
    """Return by what the program was last told to end, if it was; who caught that may have raised another."""
    return _asked[-1] if _asked else None


@contextmanager
def by_exception() -> Iterator[None]:
    """Make SIGTERM and SIGHUP raise `Ended` in the main thread, so that whatever is open is closed first.

    Who handles or ignores a signal already keeps it so. A second one does not interrupt what the first began.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = [int(getattr(signal, name)) for name in _NAMES]
    ours = [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]

    def end(number: int, _: Any) -> None:
        for one in ours:
            signal.signal(one, signal.SIG_IGN)
        _asked.append(Ended(number))
        raise _asked[-1]

    if ours:
        _asked.clear()
    for number in ours:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in ours:
            if signal.getsignal(number) in (end, signal.SIG_IGN):
                signal.signal(number, signal.SIG_DFL)


@contextmanager
def heard() -> Iterator[Callable[[], None]]:
    """Give what raises the KeyboardInterrupt or `Ended` that was lost, for long work to call as it goes on.

    Python prints and forgets what is raised in a finaliser, and libraries have some that run at any time;
    what is raised again is not printed.
    """
    lost: list[BaseException] = []
    before = signal.getsignal(signal.SIGINT)
    ours = before is signal.default_int_handler and threading.current_thread() is threading.main_thread()
    known = len(_asked)

    def interrupt(number: int, frame: Any) -> None:
        lost.append(KeyboardInterrupt())
        signal.default_int_handler(number, frame)

    def check() -> None:
        for one in (*_asked[known:], *lost):
            raise one

    printed = sys.unraisablehook

    def unless_lost(ignored: sys.UnraisableHookArgs) -> None:
        if not isinstance(ignored.exc_value, KeyboardInterrupt | Ended):
            printed(ignored)

    sys.unraisablehook = unless_lost
    if ours:
        signal.signal(signal.SIGINT, interrupt)
    try:
        yield check
    finally:
        if sys.unraisablehook is unless_lost:
            sys.unraisablehook = printed
        if ours:
            signal.signal(signal.SIGINT, before)
