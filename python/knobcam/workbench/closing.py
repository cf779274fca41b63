"""A capture that nobody wants to see any more."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    from .session import Session
    from .tell import Tell
    from .tree import Opened


def close(session: Session, capture: str, tell: Tell) -> None:
    """Close a capture: the model is fitted to the others, and going back finds it where it was fitted to.

    Raises InputError for one that is not open, and for the only one that the model is fitted to.
    """
    if capture not in session.captures:
        raise InputError(f"capture {capture!r} is not in this session")
    fitted = session.node.captures
    if capture in fitted:
        rest = [one for one in fitted if one != capture]
        if not rest:
            name = session.captures[capture].name
            raise InputError(f"{name} is all that the model is fitted to; choose or open another one first")
        session.use(rest, tell)
    with session.lock:
        for one in [
            one for one in session.captures.values() if _first(one) == _first(session.captures[capture])
        ]:
            session.captures[one.id] = replace(one, closed=True)
        session.touched()


def open_ones(session: Session) -> list[Opened]:
    """Return the captures that are open; a closed one is while the model is fitted to it.

    Of a recording that was read again, otherwise, it is the one that the model is fitted to, else the last.
    """
    fitted = session.node.captures if session.branches else ()
    shown: dict[str, Opened] = {}
    for one in session.captures.values():
        before = shown.get(_first(one))
        if one.id in fitted or not (one.closed or (before is not None and before.id in fitted)):
            shown[_first(one)] = one
    return [*shown.values()]


def _first(opened: Opened) -> str:
    return opened.of or opened.id
