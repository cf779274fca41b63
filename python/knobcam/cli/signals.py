"""Whoever ends the program, it ends as by Ctrl-C: what is half written goes, and the code says who it was."""

from __future__ import annotations

import signal

_ENDING = [number for name in ("SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None]
_heard: list[int] = []


def listen() -> None:
    """Let a request to end, and a terminal that closes, be heard as Ctrl-C is.

    What the user had ignored, as `nohup` does, stays ignored.
    """
    _heard.clear()
    for number in _ENDING:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)


def interrupted() -> int:
    """Return the exit code that a shell reports for a program that was ended."""
    return 128 + (_heard[0] if _heard else signal.SIGINT)


def _end(number: int, _: object) -> None:
    _heard.append(number)
    for other in _ENDING:  # once is enough: a second one would break off the tidying
        signal.signal(other, signal.SIG_IGN)
    raise KeyboardInterrupt
