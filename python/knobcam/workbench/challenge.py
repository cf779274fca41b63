"""Knobs that hide something to be found: of three levels, with hints and a score, and each can be solved.

That `knobcam.learn` itself ends each of `challenges.toml` with what is hidden, alone and told from all else,
is what `benches/study_challenge.py` holds.
"""

from __future__ import annotations

import secrets
import tomllib
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from ..errors import InputError
from ..model.effects import base_effects_shown
from ..model.effects import effect as catalogued
from .sources import Simulated

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base import pages_sources
    from .session import Session

PERFECT = 100
"""The score of who finds it unaided."""
HINT, WRONG, LIST = 15, 10, 40
"""What a hint costs, an effect that was added and is not there, and the list of what the program weighed."""
SECONDS = 6.0
_PLACES = {
    "load": "It is in the knob, or in what the knob drives.",
    "coupling": "It lies between the shaft and the knob.",
    "sensor": "It is in what measures or makes the torque.",
}


@cache
def levels() -> Mapping[str, Sequence[tuple[str, tuple[str, ...], int]]]:
    """Return of each level knobs, what they hide, and the seed of the noise."""
    told = tomllib.loads(resources.files(__package__).joinpath("challenges.toml").read_text("utf-8"))
    return {
        level: [(one["knob"], tuple(one["hides"]), one["seed"]) for one in some]
        for level, some in told.items()
    }


def drawn(level: str, session: Session) -> Simulated:
    """Return a knob of a level, by chance, that the session has not had; where it had all, any.

    Raises InputError for a level that there is not.
    """
    if level not in levels():
        raise InputError(f"level={level!r} is unknown; choose {', '.join(levels())}")
    every = [Simulated(*one[:2], "sweep", SECONDS, one[2], level=level) for one in levels()[level]]
    had = [Simulated.again(one.simulated) for one in session.captures.values() if one.simulated]
    return secrets.choice([one for one in every if one not in had] or every)


def standing(session: Session, capture: str) -> pages_sources.Challenge:
    """Return how it goes with what a capture hides. Raises InputError for one that hides nothing."""
    opened = session.captures.get(capture)
    if opened is None or not opened.hidden:
        raise InputError(f"capture {capture!r} hides nothing; make a new one")
    # One that was read again otherwise, with samples left out, say, is the same to be found.
    first = opened.of or capture
    same = {one.id for one in session.captures.values() if first in (one.of, one.id)}
    unsealed, told = (bool(session.hints.get(f"{first} {what}")) for what in ("list", "told"))
    taken = min(session.hints.get(first, 0), len(_hints(opened.hidden)))
    fits = [node for node in session.nodes.values() if same & {*node.captures}]
    here = session.node
    base = {*base_effects_shown(opened.capture.coordinate)}
    if fits:
        base |= {*fits[0].fit.model.effects}
    guessed = set().union(*(session.guessed.get(one, set()) for one in same))
    wrong = sorted(guessed - base - {*opened.hidden})
    own = {*here.fit.model.effects} if capture in here.captures else set()
    found = [one for one in opened.hidden if one in own]
    solved = len(found) == len(opened.hidden) and own <= base | {*opened.hidden}
    level = (opened.simulated or {}).get("level") or ""
    graded = bool(level)
    score = 0 if told else max(0, PERFECT - HINT * taken - WRONG * len(wrong) - LIST * unsealed)
    return {
        "hints": _hints(opened.hidden)[:taken],
        "more": taken < len(_hints(opened.hidden)),
        "wrong": wrong,
        "found": len(found),
        "hidden": len(opened.hidden),
        "solved": solved,
        "given_up": told,
        "graded": graded,
        "level": level,
        "sealed": graded and not (unsealed or solved or told),
        "score": score,
    }


def answer(session: Session, capture: str) -> list[str]:
    """Return what is hidden in a capture; who has not found it by then gives up.

    Raises InputError for a capture that there is not.
    """
    opened = session.captures.get(capture)
    if opened is None:
        raise InputError(f"capture {capture!r} is not in this session")
    if opened.hidden and not standing(session, capture)["solved"]:
        _note(session, f"{opened.of or capture} told")
    return list(opened.hidden)


def hint(session: Session, capture: str, whole: bool) -> None:
    """Give away a little more of what a capture hides, or the `whole` list of what the program weighed.

    Raises InputError for a capture that hides nothing.
    """
    standing(session, capture)
    first = session.captures[capture].of or capture
    _note(session, f"{first} list" if whole else first)


def _note(session: Session, of: str) -> None:
    with session.lock:
        session.hints[of] = session.hints.get(of, 0) + 1
        session.touched()


def _hints(hidden: Sequence[str]) -> list[str]:
    """First where what is hidden acts, then where it shows, then what makes it; each tells of all."""
    effects = [catalogued(one) for one in hidden]
    acts = [f"{_PLACES[one.place]}{' It is friction.' if one.friction else ''}" for one in effects]
    shows = [f"It shows {one.shows}." for one in effects]
    return [_of_each(one) for one in (acts, shows, [f"It could come of {one.causes[0]}." for one in effects])]


def _of_each(said: Sequence[str]) -> str:
    """What is said of each effect; what is the same of all is said once."""
    first, *others = dict.fromkeys(said)
    if not others:
        return first if len(said) == 1 else f"Of each of them: {first}"
    return f"One: {first} {' '.join(f'Another: {one}' for one in others)}"
