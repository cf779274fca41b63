"""A next experiment in a session: the motion is designed, and what was recorded of it is taken in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import designed
from .adding import story

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..capture import Capture
    from .designed import Designed
    from .session import Session
    from .tell import Tell


def design(
    session: Session,
    names: Sequence[str],
    limits: Mapping[str, Any],
    by_hand: bool,
    tell: Tell,
    sharpen: str = "",
) -> None:
    """Design the motion that would tell models with each of these effects apart; none: what is not told.

    With `by_hand` it is one that a hand can make, with `sharpen` the one that makes a parameter known best.
    Raises InputError for what cannot be fitted, and for limits within which nothing moves.
    """
    node = session.node
    found = designed.designed(story(session, tell), names, limits, by_hand, node.id, tell, sharpen)
    tell("putting the motion in place", last=True)
    session.keep(found)


def tried(session: Session, design: Designed, capture: Capture, name: str, tell: Tell, **origin: Any) -> str:
    """Take in what was recorded of a motion, and return its id; the model becomes that of who was right.

    Where it is not told who was, or the branch has moved on, the model keeps its effects. `origin` as of
    `Session.take`. Raises InputError for one that cannot be fitted.
    """
    before = [session.captures[one].capture for one in session.captures_of(design)]
    told = designed.came(design, [*before, capture], name, session.start.options, tell)
    there = session.node
    session.keep(told)  # first: of one that was recorded is told while the model changes, too
    try:
        if told.right is not None and there.id == design.node:
            right, now = told.models[told.right].effects, there.fit.model.effects
            for effect in [one for one in now if one not in right]:
                session.drop(effect, tell)
            for effect in [one for one in right if one not in now]:
                session.add(effect, tell)
        return session.take(capture, name, None, tell, onward=True, **origin)
    except BaseException:
        session.keep(design)
        raise
