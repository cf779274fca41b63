"""How long work at the workbench says what it does."""

from __future__ import annotations

from typing import Protocol


class Tell(Protocol):
    """Told what long work does and how much of that is done; raises where it is no longer wanted."""

    def __call__(self, what: str, done: float | None = None, /, *, last: bool = False) -> None:
        """`done` is from 0 to 1, or None where nobody can tell; after the `last` there is no way back."""


def quiet(_: str, __: float | None = None, *, last: bool = False) -> None:
    """Tell nobody."""
